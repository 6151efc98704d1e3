// A real nitinol wire, 60 GPa and 0.2 mm radius: the easy case at any step, with nothing set but the wire.

#include "support/world_fixture.h"

#include <doctest/doctest.h>

#include <algorithm>

using namespace seldinger;
using namespace seldinger::test;

namespace {

constexpr double youngs = 60e9, radius = 0.2e-3;
constexpr double steps_s[] = {1e-3, 5e-3, 1.0 / 60};

WireSpec nitinol_wire(double length, int nodes)
{
    WireSpec spec;
    const double area = std::numbers::pi * radius * radius;
    spec.length = length;
    spec.nodes = nodes;
    spec.shaft.radius = radius;
    spec.shaft.density = 6450;
    spec.shaft.bend_stiffness = youngs * area * radius * radius / 4;
    spec.shaft.twist_stiffness = spec.shaft.bend_stiffness / 1.3;
    spec.shaft.stretch_stiffness = youngs * area;
    return spec;
}

struct Count {
    int halved = 0, newton = 0;
    double newton_mean = 0;
};

/// @param count  adds up over the run
void take(World& world, double dt, int steps, Count& count)
{
    for (int k = 0; k < steps; ++k) {
        const StepReport report = step(world, dt);
        REQUIRE_FALSE(report.failed());
        CHECK((report.flags & (StepBestEffort | StepWallPenetration)) == 0u);
        count.halved += (report.flags & StepHalved) != 0;
        count.newton = std::max(count.newton, report.newton_iterations);
        count.newton_mean += report.newton_iterations / static_cast<double>(steps);
    }
}

}  // namespace

TEST_SUITE("step/real_wire")
{
    // w L^4/(8 B) = 0.58 mm of sag; backward Euler has damped the first mode, 27 Hz, to nothing after 2 s at 1 ms: exp(-w^2 h t/2)
    TEST_CASE("analytic: a cantilever let go comes to rest in its static shape and stays there, at 1, 5 and 16.7 ms")
    {
        const WireSpec spec = nitinol_wire(0.08, 41);
        const double weight = spec.shaft.density * std::numbers::pi * radius * radius * 9.81;
        const double sag = weight * std::pow(spec.length, 4) / (8 * spec.shaft.bend_stiffness);
        for (const double dt : steps_s) {
            CAPTURE(dt);
            WorldSetup setup;
            WireSetup wire = placed_wire(spec, {0, 0, 0});
            HoldSpec base;
            base.position = base.direction = base.spin = true;
            wire.holds = {base};
            setup.wires = {wire};
            setup.dt = dt;
            World world(std::move(setup));
            Count count;
            take(world, dt, static_cast<int>(2 / dt), count);
            const Vec3 tip = world.rod(0).pos(0);
            // chain of 40 edges: (1/2)(h/L)^2 of the deflection; large deflection: (sag/L)^2
            CHECK(-tip.z() == about(sag).epsilon(1e-3));
            CHECK(world.readings(0).base_force.z() == about(weight * spec.length).epsilon(1e-6));
            take(world, dt, static_cast<int>(2 / dt), count);
            const double drift = (world.rod(0).pos(0) - tip).norm();
            MESSAGE("dt " << dt << " s: drift " << drift << " m, Newton at most " << count.newton << ", steps halved " << count.halved);
            CHECK(drift < 1e-9);  // what a residual at the tolerance moves the tip by: 1e-6 of the sag
            CHECK(count.halved == 0);
            CHECK(count.newton <= 4);
        }
    }

    TEST_CASE("property: fed round a bend of 40 mm in a lumen of 5 mm, stopped, it stays put; all steps agree on the hand's force")
    {
        double force[3];
        for (int c = 0; c < 3; ++c) {
            const double dt = steps_s[c];
            CAPTURE(dt);
            WorldSetup setup;
            add_bend(setup, 0.005, 0.04);
            WireSetup wire = fed_wire(nitinol_wire(0.12, 49), {0.0005, 0, 0}, 0.05, 0, 2);  // 0.1 m in 2 s, then nothing
            wire.wire.shaft.mu_static = 0.12;
            wire.wire.shaft.mu_sliding = 0.1;
            setup.wires = {wire};
            setup.dt = dt;
            World world(std::move(setup));
            Count count;
            take(world, dt, static_cast<int>(std::lround(2.5 / dt)), count);
            const Vec3 tip = world.rod(0).pos(0);
            const double before = world.readings(0).hand_force;
            take(world, dt, static_cast<int>(std::lround(1 / dt)), count);
            force[c] = world.readings(0).hand_force;
            MESSAGE("dt " << dt << " s: hand " << force[c] << " N, changed by " << force[c] - before << " N, tip by "
                          << (world.rod(0).pos(0) - tip).norm() << " m in the last second; Newton at most " << count.newton
                          << ", steps halved " << count.halved);
            CHECK((world.rod(0).pos(0) - tip).norm() < 1e-7);
            CHECK(std::abs(force[c] - before) < 1e-3 * std::abs(force[c]));
            CHECK(world.readings(0).outside == 0);
        }
        CHECK(force[1] == about(force[0]).epsilon(0.05));
        CHECK(force[2] == about(force[0]).epsilon(0.05));
    }
}
