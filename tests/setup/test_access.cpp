// Which inlet `seldinger init` takes, in which unit, and its message for a mesh that is no vessel.
#include "core/error.h"
#include "io/mesh_file.h"
#include "repair/repair.h"
#include "scene/scene.h"
#include "setup/access.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "vessel/mesh_fixtures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace seldinger::test::test_access {

namespace fs = std::filesystem;

namespace {

struct Folder : TemporaryFolder {
    [[nodiscard]] fs::path tube(const char* name, double radius, double length, double factor) const
    {
        WallMesh mesh = make_tube(tube_spec(radius, length, 3000)).mesh;
        for (Vec3& v : mesh.vertices) v *= factor;  // in a file of metres
        std::string text = "# a tube\n";
        for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
        for (const auto& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
        return write(name, text);
    }
};

/// A line through these points, of these radii; appended to a tree behind one of its points.
void grow(Centreline& line, int from, const std::vector<Vec3>& points, double radius)
{
    for (const Vec3& end : points) {
        const Vec3 start = from >= 0 ? line.points[static_cast<std::size_t>(from)] : end;
        const int steps = from >= 0 ? std::max(1, static_cast<int>((end - start).norm() / 2e-3)) : 1;
        for (int k = 1; k <= steps; ++k) {
            line.points.push_back(start + (end - start) * (static_cast<double>(k) / steps));
            line.radius.push_back(radius);
            line.parent.push_back(from);
            from = static_cast<int>(line.points.size()) - 1;
        }
    }
}

Inlet opening(const Vec3& point, const Vec3& direction, double radius, int number)
{
    return {point, direction.normalized(), radius, number};
}

const Vec3 head = Vec3::UnitZ(), back = Vec3::UnitY();

}  // namespace

TEST_SUITE("setup/access")
{
    TEST_CASE("property: an aorta with its legs is entered from a femoral end, an arch from the descending end")
    {
        Centreline aorta;  // root at the heart, down to a fork, two legs
        grow(aorta, -1, {{0, 0, 0.3}}, 12e-3);
        grow(aorta, 0, {{0, 0, 0}}, 12e-3);
        const int fork = static_cast<int>(aorta.points.size()) - 1;
        grow(aorta, fork, {{0.06, -0.01, -0.12}}, 3.5e-3);
        grow(aorta, fork, {{-0.06, -0.01, -0.12}}, 4.5e-3);
        const std::vector<Inlet> ends = {opening({0, 0, 0.3}, {0, 0, -1}, 12e-3, 0),
                                         opening({0.06, -0.01, -0.12}, {-0.06, 0.01, 0.12}, 3.5e-3, 1),
                                         opening({-0.06, -0.01, -0.12}, {0.06, 0.01, 0.12}, 4.5e-3, 2)};
        const Access legs = choose_access(ends, {0, 0, 0}, aorta, head, back);
        CHECK(legs.inlet == 3);  // both are as low: the wider one
        CHECK(has(legs.reason[2], "femoral access"));
        CHECK(has(legs.reason[0], "nearer to the head"));
        CHECK(has(legs.reason[1], "narrower"));
        CHECK(choose_access(ends, {0, 0, 0}, aorta, -head, back).inlet == 1);  // a patient upside down

        Centreline arch;  // ascending at the front, descending at the back, cut at one height
        grow(arch, -1, {{0, -0.03, 0}}, 14e-3);
        grow(arch, 0, {{0, -0.03, 0.06}, {0, 0, 0.09}, {0, 0.03, 0.06}, {0, 0.03, 0}}, 12e-3);
        const std::vector<Inlet> two = {opening({0, -0.03, 0}, {0, 0, 1}, 14e-3, 0), opening({0, 0.03, 0}, {0, 0, 1}, 12e-3, 1)};
        const Access descending = choose_access(two, {0, 0}, arch, head, back);
        CHECK(descending.inlet == 2);
        CHECK(has(descending.reason[0], "nearer to the front"));
        CHECK(choose_access(two, {0, 0}, arch, head, -back).inlet == 1);  // SPACE=RAS
        // lying across the head's direction, an aorta has no lower end that is known
        const Access across = choose_access(ends, {0, 0, 0}, aorta, Vec3::UnitY(), Vec3::UnitZ());
        CHECK(across.inlet == 1);
        CHECK(has(across.reason[0], "does not lie along the head's direction"));
    }

    TEST_CASE("property: another vessel is entered by its widest end, not by a sac, a stub or a crumb")
    {
        Centreline carotid;  // closed: common, internal, external
        grow(carotid, -1, {{0, 0, 0}}, 3.3e-3);
        grow(carotid, 0, {{0, 0, 0.05}}, 3.3e-3);
        const int fork = static_cast<int>(carotid.points.size()) - 1;
        grow(carotid, fork, {{0.02, 0, 0.12}}, 2.3e-3);
        grow(carotid, fork, {{-0.02, 0, 0.1}}, 1.7e-3);
        // narrower ends first, as they may stand in a list
        const std::vector<Inlet> ends = {opening({0.0193, 0, 0.1177}, {-0.02, 0, -0.07}, 2.3e-3, -1),
                                         opening({0, 0, 0.003}, {0, 0, 1}, 3.3e-3, -1),
                                         opening({-0.0193, 0, 0.0983}, {0.02, 0, -0.05}, 1.7e-3, -1)};
        const Access common = choose_access(ends, {0, 0, 0}, carotid, head, back);
        CHECK(common.inlet == 2);
        CHECK(has(common.reason[1], "widest end"));
        CHECK(has(common.reason[0], "narrower"));
        const Access part = choose_access(ends, {0, 1, 0}, carotid, head, back);
        CHECK(part.inlet == 1);
        CHECK(has(part.reason[1], "smaller part"));
        // a dome of 5 mm radius behind a neck of 1.5 mm
        grow(carotid, fork, {{0, 0.004, 0.05}}, 1.5e-3);
        grow(carotid, static_cast<int>(carotid.points.size()) - 1, {{0, 0.012, 0.05}}, 5e-3);
        std::vector<Inlet> with_sac = ends;
        with_sac.push_back(opening({0, 0.012, 0.05}, {0, -1, 0}, 5e-3, -1));
        const Access sac = choose_access(with_sac, {0, 0, 0, 0}, carotid, head, back);
        CHECK(sac.inlet == 2);
        CHECK(has(sac.reason[3], "pocket"));
    }

    TEST_CASE("property: units by lumen and size; the doubt is said")
    {
        const Folder folder;
        struct Row {
            const char* name;
            double radius, length, factor;
            const char* unit;
        };
        // a carotid artery of 1.4 mm in a box of 19.8 mm was taken for centimetres
        for (const Row& row : {Row{"carotid", 1.4e-3, 19.5e-3, 1e3, "mm"}, Row{"cerebral", 1e-3, 15e-3, 1e3, "mm"},
                               Row{"coronary", 1.5e-3, 0.1, 1e3, "mm"}, Row{"aorta", 12e-3, 0.4, 1e3, "mm"},
                               Row{"iliac-cm", 4e-3, 0.15, 1e2, "cm"}, Row{"aorta-m", 11e-3, 0.3, 1, "m"},
                               Row{"micro", 1.5e-3, 20e-3, 1e6, "um"}}) {
            CAPTURE(row.name);
            LoadedVessel vessel;
            const std::vector<UnitGuess> guesses =
                guess_units(folder.tube(fmt::format("{}.obj", row.name).c_str(), row.radius, row.length, row.factor), vessel);
            CHECK(guesses[0].unit == row.unit);
            CHECK(guesses[0].plausible);
            CHECK(guesses[0].lumen == about(row.radius).epsilon(0.05));
        }
        LoadedVessel vessel;
        const std::vector<UnitGuess> guesses = guess_units(folder.tube("c.obj", 1.4e-3, 19.5e-3, 1e3), vessel);
        const std::string words = describe_unit(guesses, guesses[0], "guessed from its size");
        CHECK(has(words, "a lumen of 1."));
        CHECK(has(words, "in doubt: in cm it would be 1"));
        CHECK_FALSE(has(words, "in in "));
        // an aorta with its legs in cm (half of its axis is wider than 6 mm) is no vessel of 0.6 mm
        CHECK(guess_units(folder.tube("l.obj", 6.2e-3, 0.38, 1e2), vessel)[0].unit == "cm");
        // a drum of 150 mm radius is a vessel in no unit
        CHECK_FALSE(guess_units(folder.tube("d.obj", 0.15, 0.4, 1e3), vessel)[0].plausible);
    }

    TEST_CASE("property: a body with holes, and a ball, are no vessel; a short piece of vessel is one")
    {
        LoadedVessel tube;
        tube.mesh = make_tube(tube_spec(3e-3, 0.03, 3000)).mesh;
        tube.report = describe(tube.mesh);
        tube.centreline.points = {{0, 0, 0}, {0.03, 0, 0}}, tube.centreline.radius = {3e-3, 3e-3},
        tube.centreline.parent = {-1, 0};
        CHECK(describe_no_vessel(tube).empty());
        LoadedVessel body;
        WallMesh whole = sphere(0.05, Vec3::Zero(), 4);
        (void)repair(whole);  // one vertex for each corner, normals inwards
        body.mesh = whole;
        // 17 small holes, each the triangles round a vertex
        body.mesh.triangles.clear();
        std::vector<Vec3> middles;
        for (std::size_t k = 0; k < 17; ++k)
            middles.push_back(whole.vertices[static_cast<std::size_t>(whole.triangles[k * whole.triangles.size() / 17][0])]);
        for (const auto& t : whole.triangles) {
            const bool hole = std::any_of(middles.begin(), middles.end(), [&](const Vec3& m) {
                return std::any_of(t.begin(), t.end(), [&](std::int32_t v) {
                    return (whole.vertices[static_cast<std::size_t>(v)] - m).norm() < 1e-9;
                });
            });
            if (!hole) body.mesh.triangles.push_back(t);
        }
        body.report = describe(body.mesh);
        CHECK(has(describe_no_vessel(body), "are holes in the side"));
        LoadedVessel ball;
        ball.centreline.points = {{0, 0, 0}, {0.05, 0, 0}}, ball.centreline.radius = {0.03, 0.04},
        ball.centreline.parent = {-1, 0};
        CHECK(has(describe_no_vessel(ball), "its axis is only"));
    }

    TEST_CASE("property: a scene takes axes and unit from the mesh's header, where it says nothing of them")
    {
        const Folder folder;
        const fs::path obj = folder.tube("t.obj", 3e-3, 0.1, 1e2);
        std::ifstream in(obj);
        const std::string body((std::istreambuf_iterator<char>(in)), {});
        std::ofstream(folder.path() / "t.obj") << "# SPACE=RAS UNITS=cm\n" << body;
        const auto scene_with = [&](const std::string& vessel, const std::string& arm) {
            return read_scene_text("[scene]\nduration_s = 0.1\ndt_s = 0.001\n[vessel]\nmesh = \"t.obj\"\n" + vessel +
                                       "[wire]\npreset = \"terumo-angled-035\"\nlength_m = 0.2\n[feed]\ninlet = 1\nkeys = [{t_s "
                                       "= 0.0, advance_m = 0.0}]\n" +
                                       arm,
                                   folder.path() / "s.toml");
        };
        const Scene plain = scene_with("", "");
        CHECK(plain.vessel.units == "cm");
        CHECK(plain.carm.on);
        CHECK(plain.carm.back == Vec3(0, -1, 0));
        CHECK(plain.notes.size() >= 2);
        const Scene again = read_scene_text(write_scene(plain, folder.path()), folder.path() / "s.toml");
        CHECK(again.carm.back == plain.carm.back);
        CHECK(again.vessel.units == "cm");
        const Scene given = scene_with("units = \"mm\"\n", "[carm]\nback = [0.0, 1.0, 0.0]\n");
        CHECK(given.vessel.units == "mm");
        CHECK(given.carm.back == Vec3(0, 1, 0));
        REQUIRE(given.warnings.size() == 1);
        CHECK(has(given.warnings[0], "vessel.units"));
    }

    TEST_CASE("regression: what is inside at the first key and would lie through the wall is refused with the length that fits")
    {
        const Folder folder;
        const auto setup_with = [&](const char* advance) {
            const std::string text = fmt::format(
                "[scene]\nduration_s = 0.1\ndt_s = 0.001\n[vessel]\nshape = \"arc\"\nradius_m = 0.004\n"
                "bend_radius_m = 0.02\nangle_deg = 90.0\ntriangles = 4000\n[wire]\nradius_m = 0.00045\n"
                "density = 6450.0\nyoungs_pa = 1e9\nlength_m = 0.2\nnodes = \"adaptive\"\n[feed]\ninlet = \"auto\"\n"
                "keys = [{{t_s = 0.0, advance_m = {}}}, {{t_s = 1.0, advance_m = 0.1}}]\n",
                advance);
            return make_setup(read_scene_text(text, folder.path() / "s.toml"));
        };
        CHECK(setup_with("0.005").wires.size() == 1);
        check_refused([&] { return setup_with("0.05"); }, {"feed.keys.advance_m: got 50 mm at t = 0", "Fix: start with 0"});
    }

    TEST_CASE("regression: a wire whose first length would begin behind a plane is refused, and one beside it is not")
    {
        const auto message_of = [](const char* point) {
            const std::string text = fmt::format(
                "[scene]\nduration_s = 0.1\ndt_s = 0.001\n[vessel]\nshape = \"plane\"\nsize_m = 0.4\n[wire]\n"
                "radius_m = 0.00045\ndensity = 6450.0\nyoungs_pa = 1e9\nlength_m = 0.2\nnodes = 21\n[feed]\n"
                "point = {}\ndirection = [3.0, 0.0, -4.0]\nkeys = [{{t_s = 0.0, advance_m = 0.05}}]\n",
                point);
            return refusal([&] { return make_setup(read_scene_text(text, "s.toml")); });
        };
        const std::string through = message_of("[0.0, 0.0, 0.02]");  // 20 mm above, at 4 in 5: the plane is 25 mm away
        CHECK_MESSAGE(through.find("in front of the wall, which is in the way after 25") != std::string::npos, through);
        CHECK(message_of("[0.0, 0.0, 0.041]").empty());  // ends 1 mm above it
        CHECK(message_of("[0.19, 0.0, 0.02]").empty());  // is past the border, at 0.2 m, when it gets there
    }

    TEST_CASE("regression: a wire along points of its own length is laid, however its edges cut the corners")
    {
        const auto scene_of = [](const char* length) {
            return fmt::format(
                "scene = {{ gravity = [0.0, 0.0, 0.0] }}\nwire = {{ length_m = {}, radius_m = 0.01, density = 1000.0, youngs_pa "
                "= 1e6, "
                "nodes = 4, place = {{ shape = \"points\", points = [[0,0,0],[1,0,0],[1,1,0]] }} }}\nintegrator = {{ scheme = "
                "\"static\" }}\n"
                "hold = [ {{ at = \"base\", position = true, direction = true, spin = true }} ]\n",
                length);
        };
        const WorldSetup setup = make_setup(read_scene_text(scene_of("2.0"), "s.toml"));
        CHECK(setup.wires.size() == 1);
        CHECK_THROWS_AS((void)make_setup(read_scene_text(scene_of("2.2"), "s.toml")), Error);  // longer than its points
    }
}

}  // namespace seldinger::test::test_access
