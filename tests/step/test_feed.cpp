// engine/physics/solve/feed.cpp through step(): inserted length, hand force, and no jumps.

#include "support/world_fixture.h"

#include <algorithm>
#include <memory>
#include <numeric>

namespace seldinger::test::test_feed {

namespace {

struct Sample {
    double force = 0, inside = 0, momentum = 0;
    int nodes = 0;
};

double length_inside(const ConstRodView& rod)
{
    return std::accumulate(rod.rest_length.begin(), rod.rest_length.begin() + rod.n - 1, 0.0);
}

double mean_force(const std::vector<Sample>& trace, std::size_t from, std::size_t to)
{
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += trace[k].force;
    return sum / static_cast<double>(to - from);
}

TestSetup bend_setup(double speed, int nodes)
{
    TestSetup setup = in_bend(0.003, 0.03);
    setup.wires = {fed_wire(steel_wire(0.12, nodes), {0.0005, 0, -0.0024}, speed)};
    return setup;
}

}  // namespace

TEST_SUITE("step/feed")
{
    TEST_CASE("analytic: what is inside is what was fed, up to the surplus; the hub stays where it is")
    {
        FedWorld world(bend_setup(0.1, 25));
        const double edge = data_of(world).feed(0).edge;
        double worst = 0, surplus = 0;
        for (int k = 1; k <= 700; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            CHECK(world.readings(0).inserted == about(1e-4 * k).epsilon(1e-12));
            const FeedState& feed = data_of(world).feed(0);
            if (!feed.inside) {
                CHECK(feed.advance < edge / 2);
                continue;
            }
            const ConstRodView rod = world.rod(0);
            worst = std::max(worst, std::abs(length_inside(rod) - feed.advance - feed.surplus));
            surplus = std::max(surplus, std::abs(feed.surplus));
            for (int c = 0; c < 3; ++c) CHECK((rod.pos(rod.n - 1) - feed.point)[c] == 0);  // to the last bit
            CHECK(rod.material_s[rod.n - 1] == about(length_inside(rod)).epsilon(1e-12));
            const double base = rod.rest_length[rod.n - 2];
            CHECK(base < edge + 2.1e-4);  // of 0.1 mm a step
            CHECK(base > 0);
        }
        CHECK(worst <= 1e-12);  // sums of 700 additions of 1e-4
        // a birth slows the feed by phi^2/2, phi = kappa h/2, for some 25 ms; curvature stays below 1 / (bend radius)
        CHECK(surplus <= 0.1 * 0.025 * std::pow(edge / 0.03, 2) / 8);
        REQUIRE(world.rod(0).n > 12);
    }

    TEST_CASE("property: neither hand force nor momentum jumps where the base edge is split")
    {
        FedWorld world(bend_setup(0.05, 25));
        std::vector<Sample> trace;
        for (int k = 0; k < 1500; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            const ConstRodView rod = world.rod(0);
            Vec3 momentum = Vec3::Zero();
            for (int i = 0; i < rod.n; ++i) momentum += rod.mass[i] * rod.vel(i);
            trace.push_back({world.readings(0).hand_force, length_inside(rod), momentum.norm(), rod.n});
        }
        int splits = 0;
        double largest = 0;
        for (std::size_t k = 40; k + 25 < trace.size(); ++k) {
            if (trace[k].nodes == trace[k - 1].nodes || trace[k - 1].nodes < 3) continue;
            ++splits;
            const double before = mean_force(trace, k - 20, k), after = mean_force(trace, k, k + 20);
            CAPTURE(k);
            CHECK(std::abs(after - before) <= std::max(0.01 * std::abs(before), 1e-3));  // 1 % of the force, at least 1 mN
            largest = std::max(largest, std::abs(before));
            // momentum: mass of 0.05 mm of wire times the feed's speed comes with every step; a split adds none
            const double mass_rate = 7900 * std::numbers::pi * 0.4445e-3 * 0.4445e-3;
            CHECK(std::abs(trace[k].momentum - trace[k - 1].momentum) <=
                  0.05 * mass_rate * trace[k].inside * 0.05 + mass_rate * 5e-5 * 0.1);
        }
        REQUIRE(splits >= 10);
        MESSAGE(splits << " splits, hand force up to " << largest << " N");
    }

    // Experiment 1: 2.0 cm/s, first touch at 3 cm. Away from births the force changes by less than 0.1 mN in a step, which
    // hands feel. Splits of a base edge of 3h/2 jolted it by 1.4 mN at 1 ms, 4.6 mN at 0.25 ms.
    TEST_CASE("property: a hand does not feel where a node is born, whatever the step, and no energy is lost there")
    {
        for (const double dt : {1e-3, 2.5e-4}) {
            CAPTURE(dt);
            TestSetup setup = in_tube(0.018, 0.1);
            WireSpec spec = steel_wire(0.1, 21);
            spec.shaft.radius = 0.001;
            spec.shaft.bend_stiffness = 1e-5;
            spec.shaft.stretch_stiffness = 5e4;
            spec.shaft.density = 7900;
            setup.wires = {fed_wire(spec, {0.0005, 0, -0.014548}, 0.02)};
            FedWorld world(std::move(setup));
            double last = 0, step_before = 0, worst = 0, work = 0, inserted = 0;
            int births = 0, since = 1000;
            for (int k = 0; k < std::lround((dt < 5e-4 ? 1.6 : 3.6) / dt); ++k) {
                const int nodes = world.rod(0).n;
                REQUIRE_FALSE(step(world, dt).failed());
                const WireReadings now = world.readings(0);
                const double change = now.hand_force - last;
                // the jump from the step before a birth to the one after
                if (since < 4) worst = std::max(worst, std::abs(change - step_before));
                if (since >= 4) step_before = change;
                work += std::abs(now.hand_force * (now.inserted - inserted));
                inserted = now.inserted;
                last = now.hand_force;
                ++since;
                if (world.rod(0).n == nodes || world.rod(0).n < 4) continue;
                ++births;
                since = 0;
            }
            REQUIRE(births >= (dt < 5e-4 ? 4 : 12));
            CHECK(worst <= 1e-4);
            CHECK(std::abs(world.readings(0).remesh_energy) <= 0.002 * work);
            MESSAGE(births << " births, " << worst << " N, remesh " << world.readings(0).remesh_energy << " of " << work << " J");
        }
    }

    TEST_CASE("property: pulled back below half an edge the wire is in its guide again, and comes out again")
    {
        TestSetup setup = in_tube(0.003, 0.12);
        TestWire wire = fed_wire(steel_wire(0.1, 21), {0.0005, 0, -0.0024}, 0);
        wire.feed.keys = {{0, 0, 0}, {0.3, 0.03, 0}, {0.6, 0, 0}, {0.9, 0.03, 0}, {1.0, 0.03, 0}};
        setup.wires = {wire};
        FedWorld world(std::move(setup));
        bool was_inside = false, went_back = false;
        for (int k = 1; k <= 1000; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            const FeedState& feed = data_of(world).feed(0);
            if (k == 300) was_inside = feed.inside;
            if (k == 600) {
                went_back = !feed.inside;
                CHECK(world.rod(0).n == 2);
                CHECK(world.readings(0).hand_force == 0);
                CHECK(world.readings(0).contacts == 0);
            }
            // the tip is never where the wire cannot reach
            CHECK((world.rod(0).pos(0) - feed.point).norm() <= std::abs(feed.advance) + 0.005);
        }
        CHECK(was_inside);
        CHECK(went_back);
        CHECK(data_of(world).feed(0).inside);
        CHECK(length_inside(world.rod(0)) == about(0.03).epsilon(1e-6));
    }

    // A step of 20 ms moves 4 edges in and 3 out. The edges stay whole, the base edge within its limits, and the wire is where
    // one with steps of a millisecond is. Both are quasi-static, so the rest is the order of friction's path and Euler's
    // damping.
    TEST_CASE("property: more than an edge can be fed or pulled back in one step")
    {
        const auto end_of = [](double dt) {
            TestSetup setup = bend_setup(0, 49);
            setup.wires[0].feed.keys = {{0, 0, 0}, {0.1, 0.05, 0}, {0.16, 0.0275, 0}, {0.24, 0.0675, 0}, {1, 0.0675, 0}};
            FedWorld world(std::move(setup));
            const double edge = data_of(world).feed(0).edge;
            for (int k = 0; k < std::lround(0.6 / dt); ++k) {
                REQUIRE_FALSE(step(world, dt).failed());
                const ConstRodView rod = world.rod(0);
                if (!data_of(world).feed(0).inside) continue;
                for (int j = 0; j + 1 < rod.n; ++j) REQUIRE(rod.rest_length[j] > 0);
                // where a part of a step feeds an edge, one is split when half a one more is inside
                CHECK(rod.rest_length[rod.n - 2] < (1.5 + 1e-6) * edge);
                CHECK(length_inside(rod) == about(world.readings(0).inserted).epsilon(1e-4));
            }
            CHECK(world.readings(0).outside == 0);
            return Vec3(world.rod(0).pos(0));
        };
        const Vec3 coarse = end_of(0.02), fine = end_of(0.001);
        CHECK((coarse - fine).norm() <= 1e-4);
    }

    // A straight wire without friction, load or weight turns as a rigid shaft does: every section by the hub's angle.
    TEST_CASE("analytic: turning the hub of a free straight wire turns its tip by the same angle, and the torque dies away")
    {
        TestSetup setup;
        setup.gravity = Vec3::Zero();
        TestWire wire = fed_wire(steel_wire(0.1, 21), Vec3::Zero(), 0);
        wire.feed.keys = {{0, 0.08, 0}, {0.2, 0.08, 7.5}, {1, 0.08, 7.5}};  // more than a turn
        setup.wires = {wire};
        FedWorld world(std::move(setup));
        double largest = 0;
        for (int k = 1; k <= 400; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            largest = std::max(largest, std::abs(world.readings(0).hand_torque));
        }
        const ConstRodView rod = world.rod(0);
        for (int j = 0; j < rod.n - 1; ++j) CHECK(rod.theta[j] == about(-7.5).epsilon(1e-6));  // about the tangent tip -> hub
        CHECK(world.readings(0).turned == about(7.5));
        // while it starts and stops the hand feels the wire's inertia; the rest is the residual that the solver leaves on an
        // edge, 1e-6 of B/L^2 times the edge, on 20 edges
        const double left = 20 * 1e-6 * 1e-5 / (0.08 * 0.08) * 0.004;
        REQUIRE(largest > 1000 * left);
        CHECK(std::abs(world.readings(0).hand_torque) <= left);
        for (int i = 0; i < rod.n; ++i) CHECK(std::hypot(rod.y[i], rod.z[i]) <= 1e-12);  // straight all the time
    }

    // A round wire that is straight by nature and turns freely hangs as it does when it is not turned: nodes are born where they
    // are born then. A base edge that is seen twisted by the hub's turn while its new node is put in place is bent double.
    TEST_CASE("property: nodes are born alike whether the hub turns or not")
    {
        const auto fed = [](double turn_rate) {
            TestSetup setup;
            setup.wires = {fed_wire(steel_wire(0.1, 21), Vec3::Zero(), 0.2, turn_rate)};
            auto world = std::make_unique<FedWorld>(std::move(setup));
            for (int k = 1; k <= 400; ++k) REQUIRE_FALSE(step(*world, 1e-3).failed());
            return world;
        };
        const auto still = fed(0), turned = fed(60);
        const ConstRodView a = still->rod(0), b = turned->rod(0);
        REQUIRE(a.n == b.n);
        REQUIRE(a.n > 10);
        REQUIRE(a.pos(0).z() < -1e-3);  // bent, so that a new node has to be put beside the chord
        // both to what the solver leaves, 1e-6 of B/L^2 on an edge, over the stiffness 3 B/L^3 of the whole, on 16 edges
        const double left = 16 * 1e-6 * 0.08 / 3;
        for (int i = 0; i < a.n; ++i) CHECK((a.pos(i) - b.pos(i)).norm() <= left);
        const double bent = still->readings(0).energy.wire;
        CHECK(std::abs(turned->readings(0).remesh_energy - still->readings(0).remesh_energy) <= 1e-4 * std::abs(bent));
    }
}

}  // namespace seldinger::test::test_feed
