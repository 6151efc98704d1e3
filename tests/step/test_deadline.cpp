// Steps that end at a deadline (World::cut_when): inside the wall, with nothing lost that the next step does not return.

#include "support/approx.h"
#include "support/world_fixture.h"

#include <algorithm>

namespace seldinger::test::test_deadline {

namespace {

constexpr double dt = 1e-3;
constexpr int fed = 350, rest = 400;  // steps

/// A wire that is pushed 7 cm through a bend, and stays.
TestSetup pushed()
{
    TestSetup setup = in_bend(2e-3, 0.03);
    TestWire wire = fed_wire(steel_wire(0.2, 81), {0.0001, 0, 0}, 0.2);
    wire.feed.keys = {{0, 0, 0}, {fed * dt, 0.2 * fed * dt, 0}, {1e3, 0.2 * fed * dt, 0}};
    setup.wires.push_back(wire);
    return setup;
}

struct Seen {
    int cut = 0, outside = 0, most_iterations = 0;
    double overlap = 0;  // of the radius
};

Seen run(FedWorld& world, int steps)
{
    Seen seen;
    for (int k = 0; k < steps; ++k) {
        const StepReport report = step(world, dt);
        REQUIRE_FALSE(report.failed());
        seen.cut += (report.flags & StepCutShort) != 0;
        seen.outside += (report.flags & StepWallPenetration) != 0 || world.readings(0).outside > 0;
        seen.most_iterations = std::max(seen.most_iterations, report.newton_iterations);
        seen.overlap = std::max(seen.overlap, world.readings(0).overlap_share);
    }
    return seen;
}

double farthest(const World& a, const World& b)
{
    double most = 0;
    REQUIRE(a.rod(0).n == b.rod(0).n);
    for (int i = 0; i < a.rod(0).n; ++i) most = std::max(most, (a.rod(0).pos(i) - b.rod(0).pos(i)).norm());
    return most;
}

}  // namespace

TEST_SUITE("step/deadline")
{
    // The law hardens towards r/2 of overlap, which no admitted trial goes beyond. Once both wires rest, they differ by where
    // friction let them stop: less than 2 % of the radius, which is what the smallest readings of a run are good for.
    TEST_CASE(
        "property: with no time at all the wire stays inside the wall, and comes to the converged answer once there is time")
    {
        FedWorld plain(pushed()), hurried(pushed());
        hurried.cut_when([] { return true; });
        const Seen slow = run(plain, fed), quick = run(hurried, fed);
        CHECK(slow.cut == 0);
        CHECK(quick.cut > fed / 4);
        CHECK(quick.most_iterations < slow.most_iterations);
        CHECK(quick.outside == 0);
        CHECK(quick.overlap < 0.5);
        CAPTURE(farthest(plain, hurried));
        hurried.cut_when({});
        CHECK(run(plain, rest).cut == 0);
        CHECK(run(hurried, rest).cut == 0);
        CHECK(plain.readings(0).kinetic < 1e-9);
        CHECK(hurried.readings(0).kinetic < 1e-9);
        const double left = farthest(plain, hurried);
        CHECK(left < 0.02 * 0.4445e-3);
        CHECK(hurried.readings(0).hand_force == about(plain.readings(0).hand_force).epsilon(0.05));
    }

    // P+ - P- = h (held + weight + contact + fed + R_k - R_{k-1}): summed over the steps, only the last residual is left.
    TEST_CASE("property: what a step leaves is returned by the next one: momentum and energy add up over the run")
    {
        FedWorld world(pushed());
        world.cut_when([] { return true; });
        Vec3 open = Vec3::Zero();
        double returned = 0, last = 0;
        for (int k = 0; k < fed; ++k) {
            REQUIRE_FALSE(step(world, dt).failed());
            const WireReadings r = world.readings(0);
            if (world.report(0).sub_steps > 1) continue;  // the balance is of the last sub-step
            open += dt * (r.momentum.error() - r.momentum.loads);
            returned += dt * r.momentum.loads.norm();
            last = dt * std::sqrt(3.0) * world.rod(0).n * r.force_residual;
        }
        CAPTURE(returned);
        CHECK(open.norm() <= last + 1e-3 * returned);
        CHECK(returned > 0);
        const EnergyLedger& ledger = world.readings(0).energy;
        CHECK(std::abs(ledger.open()) <= 1e-3 * std::abs(ledger.hand));
    }

    TEST_CASE(
        "property: a run resumes from a saved state with what was carried, bit for bit, and a state without it says nothing of "
        "it")
    {
        FedWorld world(pushed()), again(pushed()), plain(pushed());
        for (FedWorld* each : {&world, &again}) each->cut_when([] { return true; });
        bool carried = false;
        for (int k = 0; k < fed && !carried; ++k) {
            REQUIRE_FALSE(step(plain, dt).failed());
            const StepReport report = step(world, dt);
            carried = (report.flags & StepCutShort) != 0 && k > 100;
        }
        REQUIRE(carried);
        const std::vector<std::uint8_t> bytes = world.save_state();
        again.restore_state(bytes);
        CHECK(again.state_hash() == world.state_hash());
        for (int k = 0; k < 5; ++k) {
            REQUIRE_FALSE(step(world, dt).failed());
            REQUIRE_FALSE(step(again, dt).failed());
            CHECK(again.state_hash() == world.state_hash());
        }
        const std::vector<std::uint8_t> without = plain.save_state();
        again.restore_state(without);  // forgets what it carried
        CHECK(again.save_state() == without);
    }
}

}  // namespace seldinger::test::test_deadline
