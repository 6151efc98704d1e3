// The stability study: what its maps cover, how cells are judged and cut short, and the default method at their far corners.

#include "lab/stability.h"

#include "core/error.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace seldinger::test::test_stability {

namespace {

const StabilityMap& map_named(const std::string& name)
{
    const auto& maps = stability_maps();
    const auto at = std::find_if(maps.begin(), maps.end(), [&](const StabilityMap& map) { return map.name == name; });
    REQUIRE(at != maps.end());
    return *at;
}

const Model& method_named(const std::string& name)
{
    const auto& methods = stability_methods();
    const auto at = std::find_if(methods.begin(), methods.end(), [&](const Model& model) { return model.name == name; });
    REQUIRE(at != methods.end());
    return *at;
}

CellResult cell(const StabilityMap& map, const char* method, double dt, double value, const std::filesystem::path& folder)
{
    return run_stability_cell({map, method_named(method), dt, value, folder}, cell_reference(map, value, folder), 60);
}

const std::string free_wire =
    scene_text(0.05, 1e-3, "name = \"free\"\n") + wire_text(0.05, 1e-4, 7.7e-5, 11) + placed_along_x + held_base;

}  // namespace

TEST_SUITE("lab/stability")
{
    TEST_CASE("property: every failure row has a map, every cell of it is a scene, names are unique")
    {
        std::string rows;
        std::vector<std::string> names;
        for (const StabilityMap& map : stability_maps()) {
            CAPTURE(map.name);
            rows += " " + map.rows + " ";
            names.push_back(map.name);
            REQUIRE(map.values.size() >= 5);
            CHECK(std::is_sorted(map.values.begin(), map.values.end()));
            for (const double value : map.quick_values) CHECK(std::count(map.values.begin(), map.values.end(), value) == 1);
            if (map.write_meshes) continue;  // needs its files
            for (const double value : map.values)
                for (const double dt : stability_steps(false)) {
                    const Scene scene = stability_scene(map, value, dt, 1, ".");
                    CHECK(scene.dt == about(dt).epsilon(1e-12));
                    CHECK(scene.duration > 0);
                }
        }
        for (int row = 1; row <= 21; ++row) CHECK(rows.find(" F" + std::to_string(row) + " ") != std::string::npos);
        std::sort(names.begin(), names.end());
        CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
        CHECK(default_method().name == "default");
    }

    TEST_CASE("property: the ranges that the default method answers for are swept in full")
    {
        const auto covers = [](const char* name, double from, double to) {
            const auto& values = map_named(name).values;
            CHECK(values.front() <= from * (1 + 1e-9));
            CHECK(values.back() >= to * (1 - 1e-9));
        };
        covers("stiffness", 0.1, 1e3);
        covers("speed", 1e-3, 1);
        covers("triangles", 0.1, 20);
        covers("bending", 1e-7, 1e-2);
        covers("friction", 0, 1);
        covers("soft-wall", 1e-2, 1e2);
        covers("snug", 1, 100);
        CHECK(stability_steps(false).front() <= 1e-4);
        CHECK(stability_steps(false).back() >= 0.033);
        // the scene that a cell runs says so itself
        CHECK(stability_scene(map_named("bending"), 1e-7, 1e-3, 1, ".").wire.shaft.bend_stiffness == about(1e-7));
        CHECK(stability_scene(map_named("stiffness"), 1e3, 1e-3, 1, ".").vessel.youngs == about(1e9));
        CHECK(stability_scene(map_named("friction"), 1, 1e-3, 1, ".").contact.mu_sliding == about(1.0));
        const VesselSpec soft = stability_scene(map_named("soft-wall"), 1, 1e-3, 1, ".").vessel;  // a thoracic aorta's wall
        CHECK(soft.elastic);
        CHECK(soft.youngs == about(0.4e6));
        CHECK(soft.thickness == about(0.82e-3));
        const Scene snug = stability_scene(map_named("snug"), 100, 1e-3, 1, ".");
        CHECK(snug.vessel.elastic);
        CHECK(snug.vessel.youngs == about(1e5));
        CHECK(snug.wire.shaft.bend_stiffness == about(1e-2));
        CHECK(snug.vessel.radius == about(1.2 * snug.wire.shaft.radius));
    }

    // at 20 the facets of the inner wall meet at 30 degrees; with samples a radius apart the hand's force ripples by 1/3 there
    TEST_CASE("regression: over ridges of 30 degrees the hand's force does not ripple from sample to sample")
    {
        const CellResult result = cell(map_named("triangles"), "default", 1e-3, 20, ".");
        CHECK(std::string(result.outcome()) == "hold");
        CHECK(result.jitter_limit == about(0.1).epsilon(1e-12));
        CHECK(result.verdict.readings.jitter < 0.05);
        CHECK(result.verdict.readings.touching > 500);
    }

    // 0.01 N m^2 over 1 cm: B/L^2 is 100 N, and a millionth of it is 10 % of the least force that counts
    TEST_CASE("regression: a short stiff piece in the guide pushes no harder than the tolerance of a wire")
    {
        const CellResult result = cell(map_named("bending"), "default", 1e-4, 1e-2, ".");
        CHECK(std::string(result.outcome()) == "hold");
        CHECK(result.verdict.readings.jitter < 0.05);
    }

    TEST_CASE("property: at the far corner of step and stiffness the default holds and the published method does not")
    {
        const StabilityMap& map = map_named("stiffness");
        const CellReference reference = cell_reference(map, 1e3, ".");
        CHECK(reference.indentation > 0);
        CHECK(reference.indentation < 1e-5);  // a thousand times as stiff
        const auto run = [&](const char* method) {
            return run_stability_cell({map, method_named(method), 1.0 / 30, 1e3, "."}, reference, 60);
        };
        CHECK(std::string(run("default").outcome()) == "hold");
        const CellResult published = run("published");
        CHECK(published.verdict.outcome > Outcome::Overlap);  // it passes the wall
        CHECK(published.verdict.readings.outside > 0);
    }

    TEST_CASE("property: beside an aorta's elastic wall the default holds at steps of a display, and presses no deeper")
    {
        const StabilityMap& map = map_named("soft-wall");
        const CellReference reference = cell_reference(map, 1, ".");
        CHECK(reference.indentation > 0);
        CHECK(reference.indentation < 4.4e-4);  // where the wall has moved to, not where it was: below the wire's radius
        for (const double dt : {1.0 / 60, 1.0 / 30}) {
            CAPTURE(dt);
            const CellResult result = run_stability_cell({map, default_method(), dt, 1, "."}, reference, 60);
            CHECK(std::string(result.outcome()) == "hold");
            CHECK(result.verdict.readings.touching > 10);
            CHECK(result.verdict.readings.outside == 0);
        }
    }

    // When its tip has come into the catheter, the catheter leads. The stiff wire points at the wall. The length that the
    // catheter gained in a step of 3 ms and more was put straight before the wire's tip, and went into the wall
    TEST_CASE(
        "regression: a wire a hundred times as stiff as its catheter is drawn back into it in a bend, at steps of a display")
    {
        for (const double dt : {1e-2, 1.0 / 60, 1.0 / 30}) {
            CAPTURE(dt);
            const CellResult result = run_stability_cell({map_named("coaxial-merged"), default_method(), dt, 100, "."}, {}, 60);
            CHECK(std::string(result.outcome()) == "hold");
            CHECK(result.verdict.readings.touching > 10);
        }
    }

    TEST_CASE("property: two wires held at their tips in a channel push hard and stay apart")
    {
        const CellResult result = run_stability_cell({map_named("channel"), default_method(), 1.0 / 30, 4, "."}, {}, 60);
        CHECK(std::string(result.outcome()) == "hold");
        // clamped and held, a wire of L = 30 mm alone buckles at 2 pi^2 B/L^2 = 0.22 N; here it has to go on into the wall
        CHECK(result.verdict.readings.hand_force > 2 * 0.22);
        CHECK(result.verdict.readings.touching > 10);
    }

    TEST_CASE("property: a cell that runs out of its budget is unfinished, never hold; one that is stopped says nothing")
    {
        const StabilityMap& map = map_named("axial");
        const CellResult cut = run_stability_cell({map, default_method(), 1e-3, 1e4, "."}, {}, 0);
        CHECK(cut.over_limit);
        CHECK(cut.verdict.held());
        CHECK(std::string(cut.outcome()) == "unfinished");
        CHECK(cut.simulated < 0.01);
        const CellResult stopped = run_stability_cell({map, default_method(), 1e-3, 1e4, "."}, {}, 60, [] { return true; });
        CHECK(stopped.stopped);
        CHECK(stopped.simulated < 0.01);
        CellResult failed;
        failed.over_limit = true;
        failed.verdict.outcome = Outcome::Escape;
        CHECK(std::string(failed.outcome()) == "escape");  // seen before the budget ended
        CHECK(std::string(run_stability_cell({map, default_method(), 1e-3, 1e4, "."}, {}, 60).outcome()) == "hold");
        // one step of 1 ms is beyond the axial wave of 1e4 N, 1e-2 N is not
        CHECK(std::string(run_stability_cell({map, method_named("explicit"), 1e-3, 1e4, "."}, {}, 60).outcome()) == "blow-up");
    }

    // a saw of 4 ms, from 1 to 2 N: read every 2 ms it goes up and down by half its height or more, every step
    TEST_CASE("analytic: jitter that a force shows for being looked at rarely is none of the method's")
    {
        CellReference saw;
        for (int k = 1; k <= 600; ++k) saw.hand_force.push_back(1 + (k % 4) / 4.0);
        CHECK(saw.honest_jitter(2e-3) == about(0.5 / 1.25).epsilon(1e-9));  // 1.5, 1, 1.5 ...
        CHECK(saw.honest_jitter(1e-3) == 0);                                // resolved: judged as it is
        CHECK(saw.honest_jitter(4e-3) == 0);                                // always the same tooth
        CHECK(CellReference{}.honest_jitter(0.01) == 0);
    }

    TEST_CASE("property: a user's scene is a map of its own, and one that cannot be swept is refused")
    {
        const TemporaryFolder folder;
        const auto file = folder.path() / "free.toml";
        std::ofstream(file) << free_wire;
        const StabilityMap map = map_of_scene(file, "wire.bend_nm2", {1e-6, 1e-4});
        CHECK_FALSE(map.touches);
        CHECK(map.name == "free");
        CHECK(stability_scene(map, 1e-6, 0.01, 1, {}).wire.shaft.bend_stiffness == about(1e-6));
        CHECK(why_not_in(map, default_method(), {}).empty());
        CHECK_FALSE(why_not_in(map, method_named("linearised, swept"), {}).empty());
        CHECK(std::string(run_stability_cell({map, default_method(), 1e-3, 1e-4, {}}, {}, 60).outcome()) == "hold");
        CHECK_THROWS_AS((void)map_of_scene(file, "wire.bendd_nm2", {1.0}), Error);
        CHECK_THROWS_AS((void)map_of_scene(file, "wire.bend_nm2", {-1.0}), Error);
        CHECK_THROWS_AS((void)map_of_scene(file, "integrator.tolerance", {0.0}), Error);
        CHECK_THROWS_AS((void)map_of_scene(folder.path() / "none.toml", "wire.bend_nm2", {1.0}), Error);
    }
}

}  // namespace seldinger::test::test_stability
