// Worlds whose contact kernels compute in float: their distance from those in double, and methods without float32.

#include "contact/device_records.h"
#include "core/error.h"
#include "support/approx.h"
#include "support/world_fixture.h"

#include <doctest/doctest.h>

using namespace seldinger;
using namespace seldinger::test;

namespace {

TestSetup sliding_wire(Precision precision)
{
    TestSetup setup = in_tube(0.003, 0.12);
    setup.wires = {fed_wire(steel_wire(0.1, 41), {0.0005, 0, -0.0025}, 0.1, 2)};
    setup.wires[0].contact.precision = precision;
    return setup;
}

}  // namespace

TEST_SUITE("step/float32")
{
    TEST_CASE("twin: records go to a float32 device and come back, word by word")
    {
        std::vector<ContactState> states(3);
        for (std::size_t k = 0; k < states.size(); ++k) {
            ContactState& t = states[k];
            t = {};
            t.slip[0] = 1.5 + static_cast<double>(k);
            t.moment = -0.25;
            t.triangle = 4000000000u;  // not a real: must not be rounded
            t.epoch = 16777217u + static_cast<uint>(k);
        }
        std::vector<std::uint32_t> words;
        narrow_words(record_words<ContactState>, states.data(), states.size(), words);
        CHECK(words.size() == 3 * (18 + 4));
        std::vector<ContactState> back(3);
        widen_words(record_words<ContactState>, words.data(), back.size(), back.data());
        for (std::size_t k = 0; k < states.size(); ++k) {
            CHECK(back[k].slip[0] == states[k].slip[0]);
            CHECK(back[k].moment == -0.25);
            CHECK(back[k].triangle == 4000000000u);
            CHECK(back[k].epoch == states[k].epoch);
        }
    }

    // A gap is off by some 6e-8 of the vectors that it is made of, a wire's radius and an edge: 0.03 to 0.3 nm. Depths are some
    // um: forces are off by 0.1 % at most, and each quadrature point's in its own way.
    TEST_CASE("property: a wire fed along a tube is within 0.01 um of the one in double, and forces within a thousandth")
    {
        FedWorld exact(sliding_wire(Precision::Float64)), single(sliding_wire(Precision::Float32));
        for (int k = 0; k < 400; ++k) {
            REQUIRE_FALSE(step(exact, 1e-3).failed());
            REQUIRE_FALSE(step(single, 1e-3).failed());
        }
        const WireReadings a = exact.readings(0), b = single.readings(0);
        REQUIRE(a.contacts > 10);
        REQUIRE(a.nodes == b.nodes);
        double apart = 0;
        for (int i = 0; i < a.nodes; ++i) apart = std::max(apart, (exact.rod(0).pos(i) - single.rod(0).pos(i)).norm());
        MESSAGE("apart " << apart << " m, normal " << a.normal << " and " << b.normal << " N, overlap " << a.overlap << " and "
                         << b.overlap << " m");
        CHECK(apart > 0);     // another arithmetic it is
        CHECK(apart < 1e-8);  // what a gap must be right to (portable.h)
        CHECK(b.normal == about(a.normal).epsilon(1e-3));
        CHECK(b.friction == about(a.friction).epsilon(1e-3));
        CHECK(std::abs(a.overlap - b.overlap) < 1e-8);  // 0.01 um
    }

    // Without a word on rounding (ForceTerm::rounding) Newton looks for a residual of a millionth among forces that are rounded
    // to more than that: forty iterations, halved steps.
    TEST_CASE("property: rounded forces cost no iterations")
    {
        long iterations[2] = {0, 0};
        for (const Precision precision : {Precision::Float64, Precision::Float32}) {
            FedWorld world(sliding_wire(precision));
            for (int k = 0; k < 400; ++k) {
                const StepReport report = step(world, 1e-3);
                REQUIRE(report.flags == StepOk);
                iterations[precision == Precision::Float32] += report.newton_iterations;
            }
        }
        CHECK(iterations[1] <= iterations[0]);  // its tolerance is the wider one, where it differs
    }

    TEST_CASE("property: the same bits twice, and after save and restore")
    {
        const auto after = [](FedWorld& world, int steps) {
            for (int k = 0; k < steps; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            return world.state_hash();
        };
        FedWorld first(sliding_wire(Precision::Float32)), second(sliding_wire(Precision::Float32));
        (void)after(first, 150);
        second.restore_state(first.save_state());
        CHECK(first.state_hash() == second.state_hash());
        CHECK(after(first, 50) == after(second, 50));
    }

    TEST_CASE("property: laws and detections without float32 are refused")
    {
        for (const bool layer : {false, true}) {
            TestSetup setup = sliding_wire(Precision::Float32);
            if (layer) setup.wires[0].contact.detection = Detection::Layer;
            else setup.wires[0].contact.normal = NormalLaw::Augmented;
            CHECK_THROWS_AS(World(std::move(setup)), const Error&);
        }
    }
}
