#pragma once
// Two straight instruments that share one centreline, what tests of loads, holds and schemes do with them, and where their
// material is.

#include "coaxial/merged_fixture.h"
#include "support/steps.h"

namespace seldinger::test {

/// @param outer, inner  how far each is in     @param edge  of the line [m]
inline WorldSetup straight_pair(double outer, double inner, Scheme scheme = Scheme::Static, double edge = 2e-3)
{
    WorldSetup setup =
        merged_setup({instrument_of({{0.4, bend, 0}}, twist / bend), instrument_of({{0.6, 0.5 * bend, 0}}, twist / bend)},
                     {outer, inner}, edge, scheme);
    setup.integrator.tolerance = 1e-9;
    return setup;
}

/// One step of dt [s], to whose end both are so far in and turned.
inline void advance(World& world, double outer, double inner, double dt = 1e-3, double outer_turn = 0, double inner_turn = 0)
{
    step_to(world, dt, {{outer, outer_turn}, {inner, inner_turn}});
}

/// Where an instrument's material is, so far from its own tip.
inline Vec3 material_at(const World& world, int wire, double s)
{
    const ConstRodView rod = world.rod(wire);
    int j = 0;
    while (j + 2 < rod.n && rod.material_s[j + 1] <= s) ++j;
    const double w = (s - rod.material_s[j]) / (rod.material_s[j + 1] - rod.material_s[j]);
    return (1 - w) * rod.pos(j) + w * rod.pos(j + 1);
}

}  // namespace seldinger::test
