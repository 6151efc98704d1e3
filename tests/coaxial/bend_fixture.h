#pragma once
// A catheter and a wire in one centreline, fed round a bend.

#include "support/steps.h"
#include "support/world_fixture.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test {

/// A stiffer, thicker catheter over a wire, round a bend of 40 mm in a tube of 8 mm.
/// @param edge  of even nodes, 0: adaptive [m]     @param youngs  of its wall, 0: rigid [Pa]
inline WorldSetup in_a_bend(double catheter, double wire, double edge, double youngs = 0)
{
    TestSetup made;
    made.gravity = Vec3::Zero();
    add_bend(made, 4e-3, 0.04);
    const int nodes = edge > 0 ? static_cast<int>(std::lround(0.3 / edge)) + 1 : 0;
    WireSpec outer = steel_wire(0.3, nodes), inner = steel_wire(0.3, nodes);
    outer.shaft.radius = 0.9e-3;
    outer.shaft.bend_stiffness = 3e-5;
    outer.shaft.twist_stiffness = 2.3e-5;
    for (const auto& [spec, advance] : {std::pair(outer, catheter), std::pair(inner, wire)}) {
        made.wires.push_back(fed_wire(spec, {0, 0, 0}, 0));
        made.wires.back().feed.keys = {{0, advance, 0}};
    }
    made.systems = {2};
    made.integrator.damping_mass = 5;
    made.vessel.elastic = youngs > 0;
    if (youngs > 0) made.vessel.youngs = youngs;
    made.vessel.thickness = 0.8e-3;
    WorldSetup setup = made;
    setup.coaxial.push_back({.order = {0, 1}, .model = CoaxialSpec::Model::Merged});
    return setup;
}

/// Of both hubs.
struct Place {
    double catheter, wire, turn = 0;  // [m], [m], of the wire [rad]
};

/// Steps `first` to `last` of `all` from one place to the other. @return how many changed the nodes
inline int go(World& world, const Place& from, const Place& to, int all, int first, int last)
{
    int changes = 0;
    for (int k = first; k <= last; ++k) {
        const double share = static_cast<double>(k) / all;
        const int before = std::max(world.rod(0).n, world.rod(1).n);
        step_to(world, 1e-3, {{from.catheter + share * (to.catheter - from.catheter)},
                              {from.wire + share * (to.wire - from.wire), from.turn + share * (to.turn - from.turn)}});
        changes += std::max(world.rod(0).n, world.rod(1).n) != before;
    }
    return changes;
}
inline int go(World& world, const Place& from, const Place& to, int steps) { return go(world, from, to, steps, 1, steps); }

inline double turned_over(const EnergyLedger& ledger)
{
    return std::max({std::abs(ledger.hand), std::abs(ledger.wire), ledger.friction, ledger.scheme, ledger.damping});
}

}  // namespace seldinger::test
