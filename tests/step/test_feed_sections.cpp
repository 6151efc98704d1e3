// A preformed tip that leaves the inlet: what the hand feels, against beam theory.
#include "coaxial/straight_pair.h"
#include "support/steps.h"

#include <cmath>

namespace seldinger::test::test_feed_sections {

namespace {

constexpr double bent = 0.03, natural = 2;             // preformed, from the tip [m], its curvature [1/m]
constexpr double force = 0.06 * bend / (0.05 * 0.05);  // across the tip [N]: at 5 cm the wire bends to 0.03 rad by it

/// A wire with a preformed tip in edges of h, that far out of the inlet, with a force across the tip that bends it on (+1) or
/// back (-1).
World bent_tip(double h, double inside, int sense)
{
    WorldSetup setup = straight_pair(inside, inside + 0.01);
    setup.coaxial.clear();
    setup.wires.resize(1);
    setup.systems = {1};
    WireSpec& wire = setup.wires[0].wire;
    wire.nodes = static_cast<int>(std::lround(wire.length / h)) + 1;
    WireSection tip = wire.shaft;
    tip.rest_curvature = {natural, 0};
    wire.sections = {{0, bent, tip}};
    setup.wires[0].loads = {{.at = {WirePoint::Kind::Tip}, .force = {0, 0, sense * force}}};
    return World(setup);
}

void feed(World& world, double inside) { step_to(world, 1e-3, {{inside}}); }

}  // namespace

TEST_SUITE("step/feed_sections")
{
    // Of small deflections the load P does the work P (y_natural + P L^3/(3 B)) at a tip L out of the inlet, half of it stored.
    // y_natural is k L^2/2 until the preformed part a is out, and k a^2/2 from then on. The hand's force is the change of the
    // rest with L:
    //
    //     F = -(M^2/(2 B) + M k),   M = P L,   without M k from L = a on
    //
    // Angles of up to 0.09 rad turn load and lever by their half square, 0.4 %. Edges err by (h/L)^2/12 of F, 1 % where h = 8 of
    // 25 mm.
    TEST_CASE("analytic: the hand stops feeding a preformed tip where that ends, whatever the nodes")
    {
        for (const int sense : {1, -1})
            for (const double h : {0.008, 0.007, 0.004}) {
                CAPTURE(sense);
                CAPTURE(h);
                const double begin = 0.025, move = 2e-4;
                World world = bent_tip(h, begin, sense);
                for (int k = 0; k < 3; ++k) feed(world, begin);
                double work = 0, exact_work = 0;
                for (int k = 1; k <= 100; ++k) {
                    const double inside = begin + move * k;
                    feed(world, inside);
                    const double moment = sense * force * inside, by_load = moment * moment / (2 * bend);
                    const double exact = -by_load - (inside < bent ? moment * natural : 0), now = world.readings(0).hand_force;
                    work += now * move, exact_work += exact * move;
                    if (std::abs(inside - bent) < 1.5 * move) continue;  // where the node is born
                    CAPTURE(inside);
                    CHECK(std::abs(now - exact) < 0.014 * (by_load + std::abs(moment) * natural));
                }
                CAPTURE(work);
                CAPTURE(exact_work);
                CHECK(std::abs(work - exact_work) <
                      0.014 * std::abs(exact_work) + force * bent * natural * move);  // a step's jump
            }
    }
}

}  // namespace seldinger::test::test_feed_sections
