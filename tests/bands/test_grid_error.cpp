// What edges and facets do to forces, as estimated from one state: against beam theory, and against finer nodes and meshes.
#include "bands/grid_error.h"

#include "run/bent_feed.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"
#include "support/approx.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace seldinger::test::test_grid_error {

namespace {

struct Fed {
    double hand, normal;  // means of the last 10 steps [N]
    GridErrors errors;    // largest in these
    Vec3 tip = Vec3::Zero();  // at the end [m]
};

Fed feed(int nodes, int triangles)
{
    const Scene scene = test::fed_round_a_bend(nodes, fmt::format("triangles = {}", triangles));
    World world(make_setup(scene));
    const KeyFrames keys(scene);
    GridErrorGauge gauge;
    Fed fed{};
    for (long k = 0; k < scene.steps(); ++k) {
        REQUIRE(!step(world, keys.control(), scene.step_length(k)).failed());
        if (k < scene.steps() - 10) continue;
        fed.hand += world.readings(0).hand_force / 10;
        fed.normal += world.readings(0).normal / 10;
        fed.errors.widen(gauge.of(world));
    }
    fed.tip = world.rod(0).pos(0);
    return fed;
}

/// Force on a patch at the end of a run, and the errors there.
std::pair<double, GridErrors> patch_at_end(const Scene& scene)
{
    World world(make_setup(scene));
    const KeyFrames keys(scene);
    for (long k = 0; k < scene.steps(); ++k) REQUIRE(!step(world, keys.control(), scene.step_length(k)).failed());
    WireOutput loads;
    world.read_loads(0, loads);
    return {loads.on_wall.patch_force, GridErrorGauge().of(world)};
}

}  // namespace

TEST_SUITE("bands/grid_error")
{
    // With an end load P the nodes of a straight cantilever have the exact moments P x, and their energy sum l M^2/(2 B) is that
    // of the trapezoid rule: P^2 L^3/(6 B) (1 + 1/(2 n^2)). The deflection is P L^3/(3 B) (1 + 1/(2 n^2)), test_statics. With P
    // L^2/B = 0.01 the shape differs from a straight one by 1e-5 of that.
    TEST_CASE("analytic: n edges of a cantilever under an end load err by 1/(2 n^2) of its energy")
    {
        for (const int n : {8, 16}) {
            CAPTURE(n);
            const Scene scene = read_scene_text(
                fmt::format("[scene]\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\ntolerance = 1e-9\n"
                            "[wire]\nlength_m = 0.1\nradius_m = 0.0002\ndensity = 6450.0\nbend_nm2 = 5.0e-5\ntwist_nm2 = 4.0e-5\n"
                            "stretch_n = 7000.0\nnodes = {}\n[[hold]]\nat = \"base\"\nposition = true\ndirection = true\n"
                            "[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, -5e-5]\n",
                            n + 1),
                "cantilever.toml");
            World world(make_setup(scene));
            REQUIRE(!settle(world).failed());
            const BendingError error = world.bending_error(0);
            const double exact = 5e-5 * 5e-5 * 1e-3 / (6 * 5e-5), missed = exact / (2 * n * n);
            CHECK(error.energy == about(exact + missed).epsilon(1e-4));
            CHECK(error.missed == about(missed).epsilon(1e-3));
        }
    }

    // Draw 6 of seed 2 of bench/audit.py, the end of it: edges of 10 mm bear on two places what edges of 2.5 mm bear on one patch
    // of 5 mm. Edges shorter than the patch have no such share, and a wire that lies on the floor is one place of contact.
    TEST_CASE("property: with edges longer than the patch, the force on it is as uncertain as what the next place bears")
    {
        const auto end_of = [](int nodes, double bend, double speed) {
            const Scene scene =
                read_scene_text(fmt::format("[scene]\nduration_s = 0.971\ndt_s = 0.004\n[wire]\npreset = "
                                            "\"amplatz-super-stiff-035\"\nlength_m = 0.4\nmu_sliding = 0.1\nmu_static = 0.12\n"
                                            "nodes = {}\n[feed]\ninlet = \"auto\"\nkeys = [{{t_s = 0, advance_m = 0.042}}, {{t_s "
                                            "= 0.971, advance_m = {}}}]\n[vessel]\nshape = \"arc\"\n"
                                            "radius_m = 0.0055\nbend_radius_m = {}\nangle_deg = 116.0\nlead_in_m = "
                                            "0.03\nlead_out_m = 0.08\ntriangles = 20000\n",
                                            nodes, 0.042 + 0.971 * speed, bend),
                                "arc.toml");
            return patch_at_end(scene);
        };
        const auto [coarse, errors] = end_of(41, 0.0429, 0.0722);
        const auto [fine, none] = end_of(161, 0.0429, 0.0722);
        const double off = std::abs(fine / coarse - 1), by_energy = errors.patch.nodes;
        CAPTURE(off);
        CAPTURE(by_energy);
        CHECK(off > by_energy);
        CHECK(off < by_energy + errors.split);
        CHECK(errors.split < 1);
        CHECK(none.split == 0);
        CHECK(end_of(41, 10.0, 0.0722).second.split == 0);
    }

    // Draw 3 of seed 12 of bench/audit.py with edges of 3 mm, the end of it: a bent tip touches the outer side of a bend. It
    // bears 210 mN at 7.9 mm from the tip, 80 at 5.3 and 10 at the tip, with edges of 1 mm 297 mN at 6.7 mm. The next load is 44
    // mm farther in, so that half an edge is 1.5 (1/7.9 + 1/44) = 22 % of the force.
    TEST_CASE(
        "property: the force on a patch is as uncertain as half an edge over the spans beside its load, which is of first order")
    {
        const auto end_of = [](int nodes) {
            const Scene scene =
                read_scene_text(fmt::format("[scene]\nduration_s = 1.24\ndt_s = 0.004\n[wire]\npreset = "
                                            "\"vertebral-5f\"\nlength_m = 0.4\nmu_sliding = 0.1\nmu_static = 0.12\n"
                                            "nodes = {}\n[feed]\ninlet = \"auto\"\nkeys = [{{t_s = 0, advance_m = 0.04005603}}, "
                                            "{{t_s = 1.24, advance_m = 0.10464638}}]\n[vessel]\nshape = \"arc\"\n"
                                            "radius_m = 0.005751632\nbend_radius_m = 0.034019854\nangle_deg = "
                                            "127.0023\nlead_in_m = 0.03\nlead_out_m = 0.08\ntriangles = 20000\n",
                                            nodes),
                                "tip.toml");
            return patch_at_end(scene);
        };
        const auto [coarse, errors] = end_of(121);
        const auto [fine, fewer] = end_of(401);
        const double off = std::abs(fine / coarse - 1);
        CAPTURE(off);
        CAPTURE(errors.patch.nodes);
        CAPTURE(errors.placed.nodes);
        CAPTURE(fewer.placed.nodes);
        CHECK(off > 2 * errors.patch.nodes);  // the energy's share alone does not hold it
        CHECK(off < errors.placed.nodes);
        CHECK(errors.placed.nodes == about(0.0015 * (1 / 0.0079 + 1 / 0.0442)).epsilon(0.05));
        CHECK(fewer.placed.nodes < errors.placed.nodes / 4);
    }

    // What finer nodes and facets change lies within the estimate. Where the wire's nodes lie changes the error by
    // nodes, its sign too: the largest of three numbers of nodes is compared, and the estimate of none is ten times as large.
    // Both estimates by energy are of second order in the lengths of edges: four times as many have a sixteenth, by a factor of
    // two. The force on a patch has them by themselves. That by the places of loads is of first order: the root of the sum of
    // squares of both lies between a quarter and a sixteenth.
    TEST_CASE(
        "property: what finer nodes and facets do to the normal force lies within the estimate, of second order by energy and of "
        "first by places")
    {
        const int most = 128000;
        const Fed fine = feed(401, most), facets = feed(401, 2000);
        double by_nodes = 0, estimated = 0;
        for (const int nodes : {21, 26, 31}) {
            CAPTURE(nodes);
            const Fed coarse = feed(nodes, most);
            const double off = std::abs(coarse.normal / fine.normal - 1);
            CHECK(off < coarse.errors.pressed.nodes);
            by_nodes = std::max(by_nodes, off);
            estimated = std::max(estimated, coarse.errors.pressed.nodes);
        }
        const double by_facets = std::abs(facets.normal / fine.normal - 1);
        CAPTURE(by_nodes);
        CAPTURE(estimated);
        CAPTURE(by_facets);
        CAPTURE(facets.errors.pressed.facets);
        CHECK(by_nodes > 0.01);
        CHECK(estimated < 10 * by_nodes);
        CHECK(by_facets > 1e-3);
        CHECK(by_facets < facets.errors.pressed.facets);
        CHECK(by_facets < facets.errors.patch.facets);  // by energy alone
        CHECK(facets.errors.pressed.facets < 10 * by_facets);
        const double tip_moved = (facets.tip - fine.tip).norm();
        CAPTURE(tip_moved);
        CAPTURE(facets.errors.tip);
        CHECK(tip_moved > 1e-5);
        CHECK(tip_moved < facets.errors.tip);
        CHECK(facets.errors.tip < 20 * tip_moved);
        const GridErrors few = feed(26, most).errors, many = feed(101, most).errors;
        const double nodes_ratio = few.patch.nodes / many.patch.nodes, with_places = few.pressed.nodes / many.pressed.nodes;
        const double facets_ratio = facets.errors.patch.facets / feed(401, 32000).errors.patch.facets;
        CAPTURE(nodes_ratio);
        CAPTURE(facets_ratio);
        CAPTURE(with_places);
        CHECK(with_places > 4);
        CHECK(with_places < 16);
        CHECK(nodes_ratio > 8);
        CHECK(nodes_ratio < 32);
        CHECK(facets_ratio > 8);
        CHECK(facets_ratio < 32);
    }
}

}  // namespace seldinger::test::test_grid_error
