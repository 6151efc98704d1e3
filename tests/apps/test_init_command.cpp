// `seldinger init`: a first scene for a mesh of one's own, in whatever unit it is, that `check` and `run` accept as it stands.

#include "apps/app_fixture.h"
#include "support/approx.h"

#include <array>

namespace seldinger::test::test_init_command {

namespace {

/// A generated vessel in a file: `tube_scene`'s tube of 5 mm radius and 100 mm length, or a shape of one's own.
fs::path made_mesh(const ScratchFolder& folder, const std::string& scene = tube_scene())
{
    folder.write("made.toml", scene);
    run_ok(folder, "vessel made.toml -o V");
    fs::rename(folder.path / "V" / "vessel.stl", folder.path / "mm.stl");
    return folder.path / "mm.stl";
}

/// The same mesh in other numbers: an OBJ of V/vessel.vtp's points times a factor would need a reader, so an STL's floats.
fs::path scaled(const ScratchFolder& folder, const fs::path& stl, const std::string& name, float factor)
{
    std::string bytes = slurp(stl);
    std::fill_n(bytes.begin(), 80, ' ');  // the header names the unit
    const auto at = [&](std::size_t k) { return bytes.data() + k; };
    std::uint32_t triangles = 0;
    std::copy_n(at(80), 4, reinterpret_cast<char*>(&triangles));
    for (std::size_t t = 0; t < triangles; ++t)
        for (std::size_t k = 0; k < 9; ++k) {
            float value = 0;
            char* place = at(84 + 50 * t + 12 + 4 * k);
            std::copy_n(place, 4, reinterpret_cast<char*>(&value));
            value *= factor;
            std::copy_n(reinterpret_cast<char*>(&value), 4, place);
        }
    return folder.write(name, bytes);
}

}  // namespace

TEST_SUITE("apps/init_command")
{
    TEST_CASE("property: a mesh in millimetres, centimetres or metres: the right unit, and a scene that is checked and runs")
    {
        const ScratchFolder folder;
        const fs::path mm = made_mesh(folder);
        scaled(folder, mm, "cm.stl", 0.1f);
        scaled(folder, mm, "m.stl", 0.001f);
        for (const std::string unit : {"mm", "cm", "m"}) {
            CAPTURE(unit);
            const AppResult made = run_app(folder, fmt::format("init {}.stl -o s-{}.toml", unit, unit));
            CAPTURE(made.err);
            REQUIRE(made.code == 0);
            CHECK(has(made.out, fmt::format("units \"{}\"", unit)));
            CHECK(has(made.out, "inlet 1: "));
            CHECK(has(made.out, "terumo-angled-035"));  // 0.89 mm in a lumen of 5 mm radius: the thickest of the usual passes
            const std::string scene = slurp(folder.path / fmt::format("s-{}.toml", unit));
            CHECK(has(scene, fmt::format("units = \"{}\"", unit)));
            CHECK(has(scene, "inlet = 1\n"));
            const AppResult checked = run_app(folder, fmt::format("check s-{}.toml", unit));
            CAPTURE(checked.err);
            CHECK(checked.code == 0);
            CHECK(has(checked.out, "inlet 1 of 2: "));
            CHECK(has(checked.out, "] m = ["));
            const AppResult ran =
                run_app(folder, fmt::format("run s-{}.toml -o r-{} --verbose --set scene.duration_s=0.3", unit, unit));
            CAPTURE(ran.err);
            CHECK(ran.code == 0);
            CHECK(has(ran.out, "entered at 1 of 2"));
            // fed at 20 mm/s
            CHECK(summary_of(folder.path / ("r-" + unit)).at("inserted_m").get<double>() == about(0.006).epsilon(1e-6));
        }
    }

    TEST_CASE("property: a mesh in a folder of an odd name: the scene that is written reads it")
    {
        const ScratchFolder folder;
        const fs::path odd = folder.path / "a \"b\"\n\tc\\d";
        fs::create_directory(odd);
        fs::rename(made_mesh(folder), odd / "mm.stl");
        run_ok(folder, "init a*/mm.stl -o s.toml");
        run_ok(folder, "check s.toml");
    }

    TEST_CASE("property: a narrow lumen gets a thinner wire, and one that is asked for is taken")
    {
        const ScratchFolder folder;
        std::string narrow = tube_scene();
        narrow.replace(narrow.find("radius_m = 0.005"), 16, "radius_m = 0.0008");
        narrow.replace(narrow.find("-0.0035]"), 8, "0.0]");
        narrow.replace(narrow.find("triangles = 2000"), 16, "triangles = 20000");  // about as long as wide
        const fs::path mm = made_mesh(folder, narrow);
        const AppResult made = run_ok(folder, "init mm.stl -o narrow.toml");
        // 0.7 of 0.8 mm is less than 0.89 mm and more than 0.46 mm
        CHECK(has(made.out, "control-018"));
        CHECK(has(slurp(folder.path / "narrow.toml"), "preset = \"control-018\""));
        run_ok(folder, "init mm.stl -o asked.toml --instrument coronary-soft-014 --inlet 2");
        const std::string asked = slurp(folder.path / "asked.toml");
        CHECK(has(asked, "preset = \"coronary-soft-014\""));
        CHECK(has(asked, "inlet = 2\n"));
        run_ok(folder, "check asked.toml");
    }

    TEST_CASE("property: axes in the header set the patient, gravity lies along the back, and every inlet has its reason")
    {
        const ScratchFolder folder;
        std::string bytes = slurp(made_mesh(folder));
        const std::string header = "3D Slicer output. SPACE=RAS";
        std::fill_n(bytes.begin(), 80, '\0');
        std::copy(header.begin(), header.end(), bytes.begin());
        folder.write("ras.stl", bytes);
        const AppResult made = run_ok(folder, "init ras.stl -o ras.toml");
        CHECK(has(made.out, "axes: The file says SPACE=RAS"));
        CHECK(has(made.out, "<- taken, the widest end"));
        CHECK(has(made.out, "inlet 2: "));
        CHECK(has(made.out, "; about as wide"));
        const std::string scene = slurp(folder.path / "ras.toml");
        CHECK(has(scene, "gravity = [0, -9.81, 0]"));
        CHECK(has(scene, "back = [0, -1, 0]"));
        run_ok(folder, "check ras.toml");
        // a scene of one's own, without [carm]: the run folder has it
        folder.write(
            "own.toml",
            "[scene]\nduration_s = 0.002\ndt_s = 0.001\n[vessel]\nmesh = \"ras.stl\"\n[wire]\npreset = \"terumo-angled-035\"\n"
            "length_m = 0.1\n[feed]\ninlet = 1\nkeys = [{t_s = 0.0, advance_m = 0.0}]\n");
        const AppResult checked = run_app(folder, "check own.toml");
        CHECK(has(checked.out, "axes: the mesh's header says SPACE=RAS"));
        CHECK(has(checked.out, "vessel: The file says SPACE=RAS"));
        CHECK(has(run_app(folder, "init mm.stl -o mm.toml").out, "LPS is taken"));
    }

    TEST_CASE("bad input: what is there stays, and each mistake is one line")
    {
        const ScratchFolder folder;
        const fs::path mm = made_mesh(folder);
        folder.write("mine.toml", "precious");
        scaled(folder, mm, "huge.stl", 1e6f);
        const auto refused = [&](const std::string& arguments, int code, const std::string& names) {
            CAPTURE(arguments);
            check_refused(folder, arguments, code, names);
        };
        refused("init mm.stl -o mine.toml", 2, "--overwrite");
        CHECK(slurp(folder.path / "mine.toml") == "precious");
        refused("init mm.stl -o x.toml --instrument terumo-angled-35", 2, "terumo-angled-035");
        refused("init mm.stl -o x.toml --inlet 3", 2, "2 inlets");
        refused("init mm.stl -o x.toml --units furlong", 2, "furlong");
        refused("init huge.stl -o x.toml", 2, "--units");
        refused("init gone.stl -o x.toml", 3, "gone.stl");
        refused("init made.toml -o x.toml", 2, "expected a mesh");
        CHECK_FALSE(fs::exists(folder.path / "x.toml"));
        run_ok(folder, "init mm.stl -o mine.toml --overwrite");
        CHECK(slurp(folder.path / "mine.toml") != "precious");
    }

    TEST_CASE("bad input: a unit that cannot be right, and a wire thicker than its lumen, stop in check")
    {
        const ScratchFolder folder;
        made_mesh(folder);
        run_ok(folder, "init mm.stl -o s.toml");
        check_refused(folder, "check s.toml --set vessel.units=m", 2, "units = \"mm\" would fit");
        check_refused(folder, "check s.toml --set wire.radius_m=0.006", 2, "the wire's 6 mm");
        check_refused(folder, "check s.toml --set feed.inlet=7", 2, "2 inlets");
        // the fault is named by its meaning
        check_refused(folder, "check s.toml --set wire.diameter_in=0.035", 2, "wire.radius_m");
        const AppResult speed = run_app(folder, "check s.toml --set feed.speed=0.02");
        CHECK(has(speed.err, "feed.keys"));
        const AppResult friction = run_app(folder, "check s.toml --set wire.friction=0.1");
        CHECK(has(friction.err, "wire.mu_static"));
    }

    TEST_CASE("property: who closes the pipe has read enough")
    {
        const ScratchFolder folder;
        made_mesh(folder);
        // the reader is gone before anything is written
        const std::string command = fmt::format("cd '{}' && {{ sleep 0.5; '{}' instruments; echo $? >code; }} 2>err | true",
                                                folder.path.string(), app_path());
        CHECK(std::system(command.c_str()) == 0);
        for (int k = 0; k < 200 && slurp(folder.path / "code").empty(); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        CHECK(slurp(folder.path / "code") == "0\n");
        CHECK(slurp(folder.path / "err").empty());
    }
}

}  // namespace seldinger::test::test_init_command
