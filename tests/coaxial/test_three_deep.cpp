// A sheath, a catheter in it and a wire in that, each fed through the other and drawn back, in both models.

#include "coaxial/merged_fixture.h"
#include "support/world_fixture.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_three_deep {

namespace {

WireSpec tube_of_polymer(double length, double radius, double lumen, double bend)
{
    WireSpec made = steel_wire(length, 0);
    made.shaft.radius = radius;
    made.lumen_radius = lumen;
    made.shaft.bend_stiffness = bend;
    made.shaft.twist_stiffness = 0.77 * bend;
    made.shaft.density = 1500;
    made.shaft.youngs = 1e8;
    return made;
}

/// Round a bend of 90 degrees: wire first, catheter over it, sheath over both, the wire back into the catheter.
TestSetup three_deep()
{
    TestSetup made = in_bend(0.005, 0.04, 3000);
    const auto points = made.centreline.main_points();
    made.wires = {fed_wire(tube_of_polymer(0.12, 1.33e-3, 1.1e-3, 8e-5), points.front(), 0),
                  fed_wire(tube_of_polymer(0.15, 0.83e-3, 0.55e-3, 3e-5), points.front(), 0),
                  fed_wire(steel_wire(0.18, 0), points.front(), 0)};
    made.wires[0].feed.keys = {{0, 0.02, 0}, {0.8, 0.02, 0}, {1.6, 0.05, 0}};
    made.wires[1].feed.keys = {{0, 0.025, 0}, {0.4, 0.025, 0}, {1.2, 0.08, 0.5}, {1.6, 0.08, 0.5}};
    made.wires[2].feed.keys = {{0, 0.03, 0}, {0.8, 0.1, 0}, {1.2, 0.1, 0}, {1.6, 0.07, 0.5}};
    for (TestWire& one : made.wires) one.feed.direction = (points[1] - points[0]).normalized();
    return made;
}

WorldSetup nested(const TestSetup& made, CoaxialSpec::Model model)
{
    WorldSetup setup = made;
    setup.systems = {3};
    CoaxialSpec group;
    group.model = model;
    group.order = {0, 1, 2};
    if (model == CoaxialSpec::Model::Merged)
        for (WireSetup& wire : setup.wires) wire.wire.nodes = static_cast<int>(std::lround(wire.wire.length / 0.005)) + 1;
    setup.coaxial.push_back(group);
    return setup;
}

/// Farthest that an inner axis is from the outer one where it is inside, beside what clearance allows [m].
double out_of_lumen(const ConstRodView& inner, const ConstRodView& outer, double clearance)
{
    double worst = -INFINITY;
    for (int i = 1; i + 2 < inner.n; ++i) {
        double nearest = INFINITY;
        bool at_end = false;
        for (int j = 0; j + 1 < outer.n; ++j) {
            const Vec3 edge = outer.pos(j + 1) - outer.pos(j);
            const double t = std::clamp((inner.pos(i) - outer.pos(j)).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
            const double distance = (inner.pos(i) - outer.pos(j) - t * edge).norm();
            if (distance >= nearest) continue;
            nearest = distance;
            at_end = (j == 0 && t == 0) || (j + 2 == outer.n && t == 1);
        }
        if (!at_end) worst = std::max(worst, nearest - clearance);
    }
    return worst;
}

}  // namespace

TEST_SUITE("coaxial/three_deep")
{
    TEST_CASE("property: sheath, catheter and wire go round a bend over each other; nothing gives up, nothing leaves its lumen")
    {
        const TestSetup made = three_deep();
        for (const auto model : {CoaxialSpec::Model::Merged, CoaxialSpec::Model::Separate}) {
            const bool separate = model == CoaxialSpec::Model::Separate;
            CAPTURE(separate);
            World world(nested(made, model));
            KeyFrames keys(made.keys());
            double worst = -INFINITY;
            for (int k = 0; k < 800; ++k) {
                REQUIRE_FALSE(step(world, keys.control(), 2e-3).failed());
                if (k % 10 || !separate) continue;
                worst = std::max(worst, out_of_lumen(world.rod(1), world.rod(0), 1.1e-3 - 0.83e-3));
                worst = std::max(worst, out_of_lumen(world.rod(2), world.rod(1), 0.55e-3 - 0.4445e-3));
            }
            // overlaps are at most half a wall (instrument_law.h); polygons of edges up to 10 mm replace curves of 40 mm radius
            if (separate) CHECK(worst < 0.5 * (1.33e-3 - 1.1e-3) + 0.01 * 0.01 / 8 / 0.04);
            for (int w = 0; w < 3; ++w) {
                CAPTURE(w);
                const ConstRodView rod = world.rod(w);
                CHECK(world.readings(w).outside == 0);
                CHECK(rod.material_s[rod.n - 1] == about(made.wires[w].feed.keys.back().advance).epsilon(1e-3));
            }
            const EnergyLedger& ledger = world.readings(0).energy;
            MESSAGE(std::string(separate ? "separate" : "merged")
                    << ": open " << ledger.open() << " J, friction " << ledger.friction << " J, " << worst << " m");
            CHECK(std::abs(ledger.open()) < 0.01 * (std::abs(ledger.hand) + ledger.friction));
        }
    }
}

}  // namespace seldinger::test::test_three_deep
