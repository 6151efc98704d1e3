// Samples of contact against the forces on the nodes: what rounding leaves passes, what belongs to another state does not.

#include "contact/contact_sums.h"
#include "contact/edge_sums.h"
#include "stages/step_stages.h"
#include "support/world_fixture.h"
#include "world/world.h"

#include <random>

namespace seldinger::test::test_contact_sums {

TEST_SUITE("contact/contact_sums")
{
    TEST_CASE("property: sums of the same forces in another order add up, and one force of ten thousand that is off does not")
    {
        std::mt19937 random(7);
        std::lognormal_distribution<double> size(-3, 3);
        for (const std::size_t count : {1u, 7u, 300u, 10000u}) {
            std::vector<double> forces(count);
            for (double& force : forces) force = size(random);
            double up = 0, down = 0;
            for (std::size_t k = 0; k < count; ++k) up += forces[k], down += forces[count - 1 - k];
            ContactTotals totals;
            totals.normal = down, totals.friction = 0.1 * down;
            CHECK(add_up(up, 0.1 * up, count, totals, false));
            // 4 (n + 1) eps is 9e-12 of ten thousand; in float32, whose sums are the device's, 5e-3
            CHECK_FALSE(add_up(up * (1 + 1e-10), 0.1 * up, count, totals, false));
            CHECK_FALSE(add_up(up, 0.1 * up * (1 - 1e-10), count, totals, false));
            CHECK(add_up(up * (1 + 1e-7), 0.1 * up, count, totals, true));
            CHECK_FALSE(add_up(up * 1.01, 0.1 * up, count, totals, true));
        }
        CHECK(add_up(0, 0, 0, {}, false));
        CHECK_FALSE(add_up(1e-300, 0, 1, {}, false));
    }

    TEST_CASE(
        "property: of a wall's contacts and those between wires, depths are the larger ones with their place, forces and counts "
        "add")
    {
        ContactTotals wall, wires;
        wall.contacts = 3, wall.depth = 2e-6, wall.deepest = 7, wall.outside = 4e-6, wall.normal = 0.5, wall.length = 1e-3;
        wires.contacts = 2, wires.depth = 3e-6, wires.deepest = -1, wires.normal = 0.25, wires.length = 2e-3;
        for (const bool wall_first : {false, true}) {
            ContactTotals sum = wall_first ? wall : wires;
            sum += wall_first ? wires : wall;
            CHECK(sum.contacts == 5);
            CHECK(sum.depth == 3e-6);
            CHECK(sum.deepest == -1);  // not on the wall
            CHECK(sum.outside == 4e-6);
            CHECK(sum.normal == 0.75);
            CHECK(sum.length == 3e-3);
        }
        wall.depth = 5e-6;
        ContactTotals sum = wires;
        sum += wall;
        CHECK(sum.depth == 5e-6);
        CHECK(sum.deepest == 7);
    }

    TEST_CASE("property: a wire's totals are the sums over its own edges, the largest depth with its place")
    {
        EdgeSums sums;
        sums.wire_edges = {0, 1, 4};
        double expected[8] = {};
        for (int e = 0; e < 4; ++e) {
            EdgeForce f{};
            f.depth = static_cast<real>(e == 2 ? 8e-6 : 1e-6 * e);
            real* const sum[8] = {&f.normal_sum, &f.friction_sum, &f.sliding_sum,   &f.rolling_sum,
                                  &f.length,     &f.normal_work,  &f.friction_work, &f.rolling_work};
            for (int k = 0; k < 8; ++k) {
                *sum[k] = static_cast<real>(std::pow(2.0, e) * (k + 1));  // exact in either precision
                if (e > 0) expected[k] += *sum[k];
            }
            f.contacts = 1u << e;
            sums.edges.push_back(f);
            sums.edge_node.push_back(static_cast<std::uint32_t>(10 + e));
        }
        const ContactTotals t = sums.totals(1, 1e-3);
        const double read[8] = {t.normal, t.friction,    t.sliding,       t.rolling,
                                t.length, t.work.normal, t.work.friction, t.work.rolling};
        for (int k = 0; k < 8; ++k) CHECK(read[k] == expected[k]);
        CHECK(t.contacts == 2 + 4 + 8);
        CHECK(t.depth == static_cast<real>(8e-6));
        CHECK(t.deepest == 12);
        CHECK(t.outside == 0);
    }

    TEST_CASE("property: what is read of a load is within its sum; of another load it is not")
    {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> some(0, 1);
        for (int trial = 0; trial < 200; ++trial) {
            WireLoads loads;
            const int count = 1 + static_cast<int>(40 * some(random));
            // stretches from a micrometre to millimetres, some points, along half a metre
            for (int k = 0; k < count; ++k)
                loads.add({0.5 * some(random), k % 7 == 0 ? 0 : 1e-6 * std::pow(1e3, some(random)), some(random)}, 0);
            ContactAlong along = greatest_loads(loads.samples, {1e-3, 5e-3, 0});
            CHECK(within_sum(along, loads));
            along.patch_force = loads.normal * (1 + 1e-6);
            CHECK_FALSE(within_sum(along, loads));
            along.patch_force = 0;
            along.per_length_max = loads.normal * (1 + 1e-6) / along.window;
            CHECK_FALSE(within_sum(along, loads));
        }
        CHECK(within_sum({}, {}));
    }

    // the ends of the stretch are rounded to 1e-13 of its length
    TEST_CASE("property: the load of one short stretch far from the tip is within its sum")
    {
        for (int k = 1; k <= 1000; ++k) {
            WireLoads loads;
            loads.add({2.0 * k / 1000, 3.17e-5, 1.25e-3}, 0);
            CAPTURE(k);
            CHECK(within_sum(greatest_loads(loads.samples, {1e-3, 5e-3, 0}), loads));
        }
    }

    TEST_CASE("property: a step whose samples are not those of its forces has a flag")
    {
        TestSetup setup = in_tube(0.003, 0.12);
        setup.wires.push_back(fed_wire(steel_wire(0.1, 41), {0.0005, 0, -0.0025}, 0.1, 2));
        FedWorld world(setup);
        for (int k = 0; k < 300; ++k) CHECK((step(world, 1e-3).flags & StepContactSums) == 0);
        WorldData& data = data_of(world);
        REQUIRE(data.output.results[0].contact.normal > 0);
        StepReport report;
        check_state(data, 1e-3, report);
        CHECK((report.flags & StepContactSums) == 0);
        for (double ContactTotals::*sum : {&ContactTotals::normal, &ContactTotals::friction}) {
            double& value = data.output.results[0].contact.*sum;
            REQUIRE(value > 0);
            const double right = value;
            value *= 1 + 1e-9;
            report = {};
            check_state(data, 1e-3, report);
            CHECK((report.flags & StepContactSums) != 0);
            CHECK((world.report(0).flags & StepContactSums) != 0);
            value = right;
        }
    }
}

}  // namespace seldinger::test::test_contact_sums
