// Mistakes in the command line, scene, mesh, folder or device: the exact exit code, one line on stderr that names the fault,
// nothing on stdout, and no run begun.

#include "apps/app_fixture.h"
#include "support/scenes.h"
#include "support/skip.h"

#include <array>

namespace seldinger::test::test_bad_input {

namespace {

void refused(const ScratchFolder& folder, const std::string& arguments, int code, const std::string& names,
             const std::string& prefix = "")
{
    const AppResult result = check_refused(folder, arguments, code, names, prefix);
    CHECK(result.out.empty());
    CHECK_FALSE(fs::exists(folder.path / "D"));
}

std::string mesh_scene(const std::string& mesh, const std::string& units = "mm", const std::string& feed = "inlet = \"auto\"")
{
    return scene_text(0.01) + wire_text(0.1, 1e-5, 8e-6, 21, 0.0004445) +
           fmt::format("[vessel]\nmesh = \"{}\"\nunits = \"{}\"\n[feed]\n{}\n", mesh, units, feed) +
           "keys = [ {t_s = 0.0, advance_m = 0.0}, {t_s = 1.0, advance_m = 0.02} ]\n";
}

/// An open tube along x as OBJ: radius 5, length 40, 16 facets around, in whatever unit.
std::string tube_obj()
{
    std::string text;
    const int around = 16, rings = 9;
    for (int r = 0; r < rings; ++r)
        for (int k = 0; k < around; ++k)
            text += fmt::format("v {} {} {}\n", 5.0 * r, 5 * std::cos(k * 6.283185307 / around),
                                5 * std::sin(k * 6.283185307 / around));
    for (int r = 0; r + 1 < rings; ++r)
        for (int k = 0; k < around; ++k) {
            const int a = r * around + k + 1, b = r * around + (k + 1) % around + 1;
            text += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, a + around, b, b + around, a + around);
        }
    return text;
}

}  // namespace

TEST_SUITE("apps/bad_input")
{
    TEST_CASE("property: a wrong command line is exit 2")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        refused(folder, "", 2, "subcommand");
        refused(folder, "fly", 2, "fly");
        refused(folder, "run", 2, "SCENE");
        refused(folder, "run s.toml -o D --colour", 2, "--colour");
        refused(folder, "run s.toml -o D --resume --overwrite", 2, "--resume");
        refused(folder, "run s.toml -o D --time-limit soon", 2, "--time-limit");
        refused(folder, "run s.toml -o D --time-limit -3", 2, "--time-limit");
        refused(folder, "run s.toml -o D --device x", 2, "--device");
        refused(folder, "run s.toml -o D --set wire", 2, "--set wire");
        refused(folder, "run s.toml -o D --set wire.colour=red", 2, "wire.colour");
        refused(folder, "run s.toml -o D --set wire.radius_m=-1", 2, "wire.radius_m");
        refused(folder, "render nothing --size 12", 2, "--size");
        refused(folder, "vessel m.stl --units ell", 2, "--units");
        refused(folder, "plan s.toml --tolerance 0.2parsec", 2, "--tolerance");
        refused(folder, "bench --device x", 2, "--device");
        refused(folder, "vessel m.stl --subdivide 9", 2, "--subdivide");
    }

    TEST_CASE("property: a wrong scene is exit 2 and names file, line and key")
    {
        const ScratchFolder folder{{"syntax.toml", "[scene\nname = 1\n"}};
        refused(folder, "run syntax.toml -o D", 2, "syntax.toml:1");
        folder.write("unknown.toml", free_scene() + "[contact]\nmu_statc = 0.1\n");
        refused(folder, "run unknown.toml -o D", 2, "contact.mu_static");
        refused(folder, "check unknown.toml", 2, "unknown.toml:20");
        folder.write("s.toml", free_scene());
        for (const char* change : {"wire.radius_m=0", "wire.length_m=-0.1", "wire.density=nan", "scene.duration_s=0",
                                   "scene.dt_s=-0.001", "wire.bend_nm2=inf"}) {
            const std::string key = std::string(change).substr(0, std::string(change).find('='));
            refused(folder, fmt::format("run s.toml -o D --set {}", change), 2, key);
        }
    }

    TEST_CASE("property: a missing or unusable file is exit 3")
    {
        const ScratchFolder folder;
        refused(folder, "run none.toml -o D", 3, "none.toml");
        refused(folder, "vessel none.stl", 3, "none.stl");
        refused(folder, "render none", 3, "none");
        folder.write("missing.toml", mesh_scene("none.stl"));
        refused(folder, "run missing.toml -o D", 3, "vessel.mesh");
        const auto mesh_refused = [&](const std::string& name, const std::string& content) {
            folder.write(name, content);
            folder.write("m.toml", mesh_scene(name));
            refused(folder, "run m.toml -o D", 3, name);
            refused(folder, fmt::format("vessel {} --units mm", name), 3, name);
        };
        mesh_refused("garbage.stl", "this is no mesh at all");
        mesh_refused("empty.stl", "");
        mesh_refused("blank.obj", "# nothing\n");
        mesh_refused("nan.obj", "v nan nan nan\nv nan nan nan\nv nan nan nan\nf 1 2 3\n");
        mesh_refused("one.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n");
        mesh_refused("mesh.xyz", "0 0 0\n");
    }

    TEST_CASE("property: a vessel that cannot be in that unit, or a wire that starts outside it, is exit 2")
    {
        const ScratchFolder folder{{"tube.obj", tube_obj()}, {"m.toml", mesh_scene("tube.obj", "m")}};
        refused(folder, "run m.toml -o D", 2, "units = \"mm\" would fit");
        folder.write("um.toml", mesh_scene("tube.obj", "um"));
        refused(folder, "run um.toml -o D", 2, "vessel.units");
        // 2 mm beyond the wall of 5 mm radius, whose facets lie inside by at most 5 (1 - cos(pi/16)) = 0.1 mm
        folder.write("outside.toml", mesh_scene("tube.obj", "mm", "point = [0.02, 0.007, 0.0]\ndirection = [1.0, 0.0, 0.0]"));
        refused(folder, "run outside.toml -o D", 2, "feed.point: [0.02, 0.007, 0] is 2 mm outside the lumen");
        folder.write("before.toml", mesh_scene("tube.obj", "mm", "point = [-0.004, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]"));
        refused(folder, "check before.toml", 2, "feed.point");
        // a plane has no inlet
        std::string plane = mesh_scene("tube.obj");
        const std::size_t at = plane.find("mesh ="), end = plane.find("[feed]");
        folder.write("plane.toml", plane.replace(at, end - at, "shape = \"plane\"\nsize_m = 1.0\n"));
        refused(folder, "run plane.toml -o D", 2, "feed.inlet");
        folder.write("fits.toml", mesh_scene("tube.obj"));
        run_ok(folder, "check fits.toml");
    }

    TEST_CASE("property: a wall that cannot be elastic is one line and exit 2 or 3")
    {
        const ScratchFolder folder;
        const auto elastic = [&](const std::string& name, const std::string& mesh) {
            std::string text = mesh_scene(mesh);
            folder.write(name, text.insert(text.find("[feed]"), "wall = \"elastic\"\n"));
        };
        folder.write("tube.obj", tube_obj());
        elastic("good.toml", "tube.obj");
        run_ok(folder, "run good.toml -o good");
        for (const char* change : {"youngs_pa=0", "youngs_pa=-1e6", "poisson=0.5", "poisson=-0.01", "thickness_m=0",
                                   "support_pa_m=-1", "wall_edge_m=-1", "wall_edge_m=1e-6"}) {
            const std::string key = std::string(change).substr(0, std::string(change).find('='));
            refused(folder, fmt::format("run good.toml -o D --set vessel.{}", change), 2, "vessel." + key);
        }
        refused(folder, "run good.toml -o D --set vessel.rims=free --set vessel.support_pa_m=0", 2, "vessel.support_pa_m");
        refused(folder, "run good.toml -o D --set vessel.thickness_m=0.006", 2, "expected at most the lumen's radius");
        // a second sheet that hangs on an edge of the first: three triangles meet there; two are a crumb and go with a note
        const std::string crumb = tube_obj() + "v 15 0 12\nv 20 0 12\nf 53 69 145\nf 69 146 145\n";
        folder.write("crumb.obj", crumb);
        elastic("crumb.toml", "crumb.obj");
        const std::string told = run_app(folder, "check crumb.toml").out;
        CHECK(told.find("1 triangle hung on the wall by a corner and was removed.") != std::string::npos);
        CHECK(told.find("without area") == std::string::npos);
        folder.write("flap.obj", tube_obj() + "v 15 0 12\nf 53 69 145\n");
        folder.write("flap.toml", mesh_scene("flap.obj"));
        CHECK(run_app(folder, "check flap.toml").out.find("1 triangle hung on the wall as a flap and was removed.") !=
              std::string::npos);
        folder.write("fin.obj", crumb + "v 15 0 20\nv 20 0 20\nf 145 146 148\nf 145 148 147\n");
        elastic("fin.toml", "fin.obj");
        refused(folder, "run fin.toml -o D", 3, "one sheet");
    }

    TEST_CASE("property: a folder that holds a run is left alone without --resume or --overwrite")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        run_ok(folder, "run s.toml -o E");
        const std::string before = slurp(folder.path / "E" / "summary.json");
        refused(folder, "run s.toml -o E", 2, "--overwrite");
        refused(folder, "run s.toml -o E --resume --set wire.nodes=31", 2, "E/scene.toml");
        CHECK(slurp(folder.path / "E" / "summary.json") == before);
        refused(folder, "run E/scene.toml -o E", 2, "--overwrite");
        // a bad scene does not cost the old run, even with --overwrite
        refused(folder, "run s.toml -o E --overwrite --set wire.radius_m=0", 2, "wire.radius_m");
        CHECK(slurp(folder.path / "E" / "summary.json") == before);
        // the scene itself is not overwritten by its resolved form
        fs::create_directory(folder.path / "own");
        fs::copy_file(folder.path / "s.toml", folder.path / "own" / "scene.toml");
        refused(folder, "run own/scene.toml -o own --overwrite", 2, "own");
        CHECK(slurp(folder.path / "own" / "scene.toml") == free_scene());
    }

    TEST_CASE("property: a folder that cannot be written is exit 3")
    {
        const ScratchFolder folder;
        folder.write("s.toml", free_scene());
        folder.write("file", "not a folder");
        refused(folder, "run s.toml -o file/D", 3, "file/D");
        CHECK(slurp(folder.path / "file") == "not a folder");
        refused(folder, "run s.toml -o /dev/null/D", 3, "/dev/null/D");
    }

    TEST_CASE("property: a disk that fills up in mid-run is exit 3, and what was written stays whole")
    {
        const ScratchFolder folder{{"s.toml", free_scene(2.0, 1)}};
        // no file may grow beyond 128 KiB: 2000 rows of some 700 bytes do, a frame of 21 nodes and the checkpoint do not
        check_refused(folder, "run s.toml -o D --quiet", 3, "trace.csv", "ulimit -f 128 &&");
        const auto rows = csv_rows(folder.path / "D" / "trace.csv");
        REQUIRE(rows.size() > 100);
        for (const auto& row : rows) REQUIRE(row.size() == rows[0].size());
        // with room again, the run continues and ends with the same bits
        run_ok(folder, "run s.toml -o D --resume");
        run_ok(folder, "run s.toml -o whole");
        CHECK(summary_of(folder.path / "D")["state_hash"] == summary_of(folder.path / "whole")["state_hash"]);
    }

    TEST_CASE("property: results that stdout cannot take are exit 3")
    {
        if (!fs::exists("/dev/full")) {
            skip("no /dev/full");
            return;
        }
        const ScratchFolder folder{{"s.toml", free_scene()}};
        const std::string command =
            fmt::format("cd '{}' && '{}' run s.toml -o D --json >/dev/full 2>err", folder.path.string(), app_path());
        const int status = std::system(command.c_str());
        CHECK(WEXITSTATUS(status) == 3);
        CHECK(has(slurp(folder.path / "err"), "stdout"));
        CHECK(fs::exists(folder.path / "D" / "summary.json"));
    }

    TEST_CASE("property: no usable device is exit 5, and a wire without a vessel needs none")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.01)}, {"s.toml", free_scene()}};
        const std::string none = "OCL_ICD_VENDORS=/nonexistent";
        refused(folder, "run t.toml -o D", 5, "OpenCL", none);
        refused(folder, "devices", 5, "OpenCL", none);
        refused(folder, "run t.toml -o D --device 99", 5, "device");
        refused(folder, "run t.toml -o D", 5, "SEL_KERNEL_DIR", "SEL_KERNEL_DIR=/nonexistent");
        run_ok(folder, "run s.toml -o E", none);
    }

    TEST_CASE("property: a kernel that does not compile is exit 5 and names the kernel")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.01)}};
        fs::copy(fs::path(SEL_SOURCE_DIR) / "kernels", folder.path / "kernels", fs::copy_options::recursive);
        std::ofstream(folder.path / "kernels/contact/evaluation.cl", std::ios::app) << "\nthis is not OpenCL\n";
        const AppResult result =
            run_app(folder, "run t.toml -o D", fmt::format("SEL_KERNEL_DIR='{}'", (folder.path / "kernels").string()));
        CAPTURE(result.err);
        CHECK(result.code == 5);
        // the OpenCL compiler itself may write "2 errors generated." before; the last line is ours
        const std::string text = result.err.substr(0, result.err.size() - 1);
        const std::string last = text.substr(text.rfind('\n') + 1);
        CHECK(last.starts_with("seldinger: "));
        CHECK(has(last, "contact/evaluation.cl"));
        CHECK_FALSE(fs::exists(folder.path / "D"));
    }
}

}  // namespace seldinger::test::test_bad_input
