#pragma once
// Two straight instruments in one centreline that rub on each other.

#include "coaxial/merged_fixture.h"

#include <doctest/doctest.h>

namespace seldinger::test {

inline constexpr double radius = 0.5e-3;            // of the fixture's instruments [m]

/// Straight by nature, along +x.
inline WorldSetup straight_pair(double outer, double inner, double drag, double viscous, Scheme scheme = Scheme::Newton)
{
    WorldSetup setup =
        merged_setup({instrument_of({{0.4, bend, 0}}, 10 * twist / bend), instrument_of({{0.6, bend, 0}}, twist / bend)},
                     {outer, inner}, 2e-3, scheme);
    setup.integrator.tolerance = 1e-9;
    setup.coaxial[0].drag = drag;
    setup.coaxial[0].viscous = viscous;
    return setup;
}

/// Steps of dt with hub `wire` moved at these rates, the others at rest. @return its readings at the end
inline WireReadings move(World& world, int wire, double push, double turn, int steps, double dt)
{
    for (int k = 0; k < steps; ++k) {
        const WireReadings at = world.readings(wire);
        const FeedSpec& from = world.setup().wires[static_cast<std::size_t>(wire)].feed;
        Control control;
        control.move_to(wire, from.advance + at.inserted + push * dt, from.turn + at.turned + turn * dt);
        REQUIRE_FALSE(step(world, control, dt).failed());
    }
    return world.readings(wire);
}

}  // namespace seldinger::test
