// Spin angles left out in whole runs, contact and friction included: same results, and the summary says so.

#include "support/world_fixture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

using namespace seldinger;
using namespace seldinger::test;

namespace {

/// The published first experiment in small: fed level into a cylinder, the wire droops to the floor and slides along it.
WorldSetup tube_setup(Spins spins, FrictionLaw friction)
{
    WorldSetup setup;
    add_tube(setup, tube(0.018, 0.16, 3000));
    WireSpec wire = steel_wire(0.16, 41);
    wire.shaft.radius = 1e-3;
    wire.shaft.stretch_stiffness = 5e4;
    WireSetup fed = fed_wire(wire, {0.0005, 0, -0.014548}, 0.1, 0, 1);
    fed.contact.friction = friction;
    setup.wires = {fed};
    setup.integrator.spins = spins;
    return setup;
}

std::string model_of(const World& world, const std::string& name)
{
    for (const auto& [key, value] : world.model())
        if (key == name) return value;
    return {};
}

struct Difference {
    double position = 0, hand_force = 0, friction = 0;  // [m], [N], [N]
    double share = 0;                                   // of solves without spins
    int touching = 0;                                   // steps with contact
};

Difference compare(FrictionLaw friction)
{
    World kept(tube_setup(Spins::Kept, friction)), left(tube_setup(Spins::Auto, friction));
    Difference d;
    for (int k = 0; k < 1000; ++k) {
        for (World* world : {&kept, &left}) REQUIRE_FALSE(step(*world, 1e-3).failed());
        const RodView a = kept.rod(0), b = left.rod(0);
        REQUIRE(a.n == b.n);
        for (int i = 0; i < a.n; ++i) d.position = std::max(d.position, (a.pos(i) - b.pos(i)).norm());
        const WireReadings now = kept.readings(0), other = left.readings(0);
        d.hand_force = std::max(d.hand_force, std::abs(now.hand_force - other.hand_force));
        d.friction = std::max(d.friction, std::abs(now.friction - other.friction));
        d.touching += now.contacts > 0;
    }
    const Solver::SpinRecord& record = left.impl().solver->spin_record(0);
    d.share = static_cast<double>(record.without) / static_cast<double>(record.steps);
    CHECK(kept.impl().solver->spin_record(0).without == 0);
    CHECK(model_of(kept, "spins") == "solved for (asked for)");
    CHECK(model_of(left, "spins").starts_with("left out of " + std::to_string(record.without)));
    MESSAGE("positions within " << d.position << " m, hand force " << d.hand_force << " N, friction " << d.friction << " N; spins left out of "
                                << 100 * d.share << " % of the solves, contact in " << d.touching << " steps");
    return d;
}

}  // namespace

TEST_SUITE("step/spins_run")
{
    // Residuals at the tolerance, 1e-6 of the wire's weight of 0.04 N, move a node on the wall, 1e5 N/m a metre, by 1e-9 m at most
    TEST_CASE("property: a wire fed into a cylinder, with friction and without, is the same with its spins left out")
    {
        const Difference smooth = compare(FrictionLaw::None);
        REQUIRE(smooth.touching > 500);
        CHECK(smooth.share > 0.99);  // nothing can turn the wire
        CHECK(smooth.position < 1e-9);
        CHECK(smooth.hand_force < 4e-7);
        const Difference rough = compare(FrictionLaw::StickSlip);
        REQUIRE(rough.touching > 500);
        CHECK(rough.share > 0.2);  // not where facets push it sideways and friction rolls it
        CHECK(rough.position < 1e-9);
        CHECK(rough.hand_force < 4e-7);
        CHECK(rough.friction < 4e-7);
    }

    TEST_CASE("property: a run that is saved and restored leaves the same solves out")
    {
        World through(tube_setup(Spins::Auto, FrictionLaw::StickSlip)), resumed(tube_setup(Spins::Auto, FrictionLaw::StickSlip));
        for (int k = 0; k < 450; ++k) REQUIRE_FALSE(step(through, 1e-3).failed());
        REQUIRE(through.readings(0).contacts > 0);
        resumed.restore_state(through.save_state());
        for (int k = 0; k < 100; ++k)
            for (World* world : {&through, &resumed}) REQUIRE_FALSE(step(*world, 1e-3).failed());
        CHECK(through.state_hash() == resumed.state_hash());
    }
}
