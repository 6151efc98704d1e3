// Wires moved along a wall for a while: total normal force of a dragged wire, capstan, the loop of push and pull, an elastica on
// a rough floor. Tolerances are the project's (docs/validation.md).

#include "support/world_fixture.h"

#include <algorithm>

namespace seldinger::test::test_drag_and_loop {

namespace {

HoldSpec base_at_speed(const Vec3& velocity) { return {.position = true, .velocity = velocity}; }

}  // namespace

TEST_SUITE("step/drag_and_loop")
{
    TEST_CASE("property: dragged along a straight tube of 35,000 triangles at 2 cm/s, the normal force hardly changes")
    {
        for (const bool beside : {false, true}) {  // along the line of vertices at the bottom, or over the facets beside it
            CAPTURE(beside);
            TestSetup setup;
            VesselSpec spec = tube(0.003, 0.3, 35000);
            if (beside) spec.normal = Vec3(0, 0.05, 1).normalized();
            add_tube(setup, spec);
            CHECK(setup.mesh.triangles.size() == about(35000).epsilon(0.02));
            TestWire wire = placed_wire(steel_wire(0.15, 31), {0.05, 0, -0.003 + 0.4445e-3});
            LinkSpec rope;  // pulls along the tube, and leaves the wire to lie as it will
            rope.anchor = {0.05, 0, -0.003 + 0.4445e-3};
            rope.stiffness = 20;
            rope.move = {{0, 0, 0, 0}, {1, -0.02, 0, 0}};
            wire.links = {rope};
            setup.wires = {wire};
            setup.start_settled = true;
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            double least = 1, largest = 0, sum = 0;
            int count = 0;
            for (int k = 1; k <= 1000; ++k) {
                REQUIRE_FALSE(step(world, 1e-3).failed());
                if (k <= 500) continue;
                const double normal = world.readings(0).normal;
                least = std::min(least, normal);
                largest = std::max(largest, normal);
                sum += normal;
                ++count;
            }
            MESSAGE("normal force " << least << " to " << largest << " N, (max - min)/mean "
                                    << (largest - least) / (sum / count));
            CHECK((largest - least) / (sum / count) <= 0.02);
            // the facets beside the line of vertices lie up to 9 um higher than the rope's end is held: 20 N/m times that
            CHECK(sum / count == about(0.0481049 * 0.15).epsilon(beside ? 0.04 : 0.01));
            CHECK(world.readings(0).friction == about(0.2 * world.readings(0).normal).epsilon(0.02));
        }
    }

    // F_2 (cos t_2 - mu sin t_2) = F_1 (cos t_1 + mu sin t_1) e^{mu (wrap - t_1 - t_2)}, cos t_i = 1 - B / (2 R^2 F_i), R to the
    // axis; wrap between the two forces, of which one is read. bench/validate_contact.py does the same for the whole table.
    TEST_CASE("analytic: capstan")
    {
        constexpr double mu = 0.3, back = 0.05, bend = 1e-7, radius = 0.000178;
        TestSetup setup;
        setup.gravity = Vec3::Zero();
        VesselSpec spec{.shape = VesselShape::Arc,
                        .radius = 0.002,
                        .bend_radius = 0.04,
                        .angle = std::numbers::pi / 2,
                        .lead_in = 0.03,
                        .lead_out = 0.06,
                        .normal = Vec3::UnitY(),
                        .triangles = 30000};
        add_vessel(setup, make_arc(spec), spec);
        WireSpec wire = steel_wire(0.1328, 110);
        wire.shaft.radius = radius;
        wire.shaft.bend_stiffness = wire.shaft.twist_stiffness = bend;
        wire.shaft.mu_static = wire.shaft.mu_sliding = mu;
        wire.place.shape = PlaceShape::Centreline;
        wire.place.from = 0.005;
        TestWire placed;
        placed.wire = wire;
        placed.contact.samples_per_edge = 2;
        placed.holds = {base_at_speed({-0.02, 0, 0})};
        placed.loads = {{.at = {WirePoint::Kind::Tip}, .force = {0, back, 0}, .ramp = 0.1}};
        setup.wires = {placed};
        FedWorld world(std::move(setup));
        Vec3 pull = Vec3::Zero();
        for (int k = 1; k <= 500; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            if (k > 300) pull += world.readings(0).base_force / 200;
        }
        const double wrap = std::acos(-pull.y() / pull.norm());
        const double lift = bend / (2 * std::pow(0.04 - 0.002 + radius, 2));
        const double t1 = std::acos(1 - lift / back), t2 = std::acos(1 - lift / pull.norm());
        const double exponent =
            std::log(pull.norm() * (std::cos(t2) - mu * std::sin(t2)) / (back * (std::cos(t1) + mu * std::sin(t1))));
        CHECK(exponent / (mu * (wrap - t1 - t2)) == about(1).epsilon(0.03));
        CHECK(wrap == about(std::numbers::pi / 2).epsilon(0.05));
        MESSAGE("pull " << pull.norm() << " N over " << wrap << " rad: exponent " << exponent / (mu * (wrap - t1 - t2))
                        << " of mu wrap");
    }

    TEST_CASE("property: push, pull, push: every cycle dissipates, and the force returns along its loop")
    {
        TestSetup setup = in_bend(0.003, 0.03);
        TestWire wire = fed_wire(steel_wire(0.12, 49), {0.0005, 0, -0.0024}, 0);
        // 7 cm in, then three times 8 mm back and forth
        constexpr double speed = 0.05, inside = 0.07, stroke = 0.008, half = stroke / speed, start = inside / speed;
        wire.feed.keys = {{0, 0, 0}, {start, inside, 0}};
        for (int k = 1; k <= 6; ++k) wire.feed.keys.push_back({start + k * half, inside - (k % 2 ? stroke : 0), 0});
        setup.wires = {wire};
        FedWorld world(std::move(setup));
        constexpr double dt = 1e-3;
        for (int k = 0; k < std::lround(start / dt); ++k) REQUIRE_FALSE(step(world, dt).failed());
        const int steps = static_cast<int>(std::lround(2 * half / dt));
        std::vector<double> force[3];
        double stored[4], work[3] = {};
        const auto energy = [&] {
            const WireReadings now = world.readings(0);
            return now.kinetic + now.elastic + now.gravitational;
        };
        stored[0] = energy();
        double before = world.readings(0).hand_force, advance = world.readings(0).inserted;
        for (int cycle = 0; cycle < 3; ++cycle) {
            for (int k = 0; k < steps; ++k) {
                REQUIRE_FALSE(step(world, dt).failed());
                const WireReadings now = world.readings(0);
                work[cycle] += 0.5 * (now.hand_force + before) * (now.inserted - advance);
                before = now.hand_force;
                advance = now.inserted;
                force[cycle].push_back(now.hand_force);
            }
            stored[cycle + 1] = energy();
            const double lost = work[cycle] - (stored[cycle + 1] - stored[cycle]);
            MESSAGE("cycle " << cycle << ": work " << work[cycle] << " J, stored " << stored[cycle + 1] - stored[cycle]
                             << " J, lost " << lost << " J");
            CHECK(lost > 0);
        }
        const auto [low, high] = std::minmax_element(force[1].begin(), force[1].end());
        double worst = 0;
        for (int k = 0; k < steps; ++k) worst = std::max(worst, std::abs(force[2][k] - force[1][k]));
        MESSAGE("force " << *low << " to " << *high << " N; third cycle off the second by at most " << worst);
        CHECK(worst <= 0.02 * (*high - *low));
    }

    // Reference 10, elastica_floor: clamped upright at its top, its foot on a rough floor; lowered until the foot slips.
    TEST_CASE("analytic: an elastica pressed on a rough floor slips at the strain of the references, and not at all at mu 0.5")
    {
        struct Case {
            double mu, strain;
        };
        for (const Case& at : {Case{0.05, 0.0123804938}, Case{0.1, 0.0468741782}, Case{0.2, 0.1548673547},
                               Case{0.3, 0.2715634261}, Case{0.35, 0.3239935114}, Case{0.5, -1}}) {
            CAPTURE(at.mu);
            // The references' tip is a point. A ball rolls by r times its turn, 5.6 mu, before it slips, which raises the strain
            // for small mu by some 13 r/L of it: a thin wire
            constexpr double length = 0.1, dt = 1e-3, radius = 1e-4;
            TestSetup setup;
            setup.gravity = Vec3::Zero();
            VesselSpec plane{.shape = VesselShape::Plane, .size = 0.2, .triangles = 200};
            // the foot sinks in by a hundredth of the radius: what lies behind it is clear of the floor until flat
            plane.youngs = 4e11;
            add_vessel(setup, make_plane(plane), plane);
            WireSpec wire = steel_wire(length, 41);
            wire.shaft.radius = radius;
            wire.shaft.bend_stiffness = 5.5e-5;
            wire.shaft.twist_stiffness = 4.2e-5;
            wire.shaft.mu_static = wire.shaft.mu_sliding = at.mu;
            wire.place.base = {0, 0, length + radius};
            wire.place.direction = -Vec3::UnitZ();
            wire.place.normal = Vec3::UnitX();
            TestWire placed;
            placed.wire = wire;
            // slowly at first, so that the wire buckles gently, and in some air for what still swings
            const double lowered = (at.strain > 0 ? 1.1 * at.strain : 0.32) * length, gently = 2e-4;
            placed.holds = {{.position = true,
                             .direction = true,
                             .spin = true,
                             .move = {{0, 0, 0, 0}, {0.2, 0, 0, -gently}, {0.7, 0, 0, -lowered}}}};
            setup.integrator.damping_mass = 50;
            LoadSpec lean;  // which way it buckles: a thousandth of what it carries then
            lean.at = {WirePoint::Kind::Distance, 0.05};
            lean.force = {1e-4, 0, 0};
            lean.ramp = 0.1;
            placed.loads = {lean};
            setup.wires = {placed};
            FedWorld world(std::move(setup));
            double slipped = -1, since = 0;  // strain
            for (int k = 1, sliding = 0; k <= 700 && slipped < 0; ++k) {
                REQUIRE_FALSE(step(world, dt).failed());
                sliding = world.readings(0).sliding > 0 ? sliding + 1 : 0;
                if (sliding == 1) since = (length + radius - world.rod(0).z[40]) / length;
                if (sliding == 10) slipped = since;
            }
            MESSAGE("mu " << at.mu << ": slips at strain " << slipped << " of " << at.strain << ", normal "
                          << world.readings(0).normal);
            if (at.strain < 0) CHECK(slipped < 0);
            else CHECK(slipped == about(at.strain).epsilon(0.05));
        }
    }
}

}  // namespace seldinger::test::test_drag_and_loop
