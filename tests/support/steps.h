#pragma once
// Steps that have to be taken.

#include "engine.h"

#include <doctest/doctest.h>

#include <initializer_list>

namespace seldinger::test {

/// How far in an instrument's hub is, and how far turned. [m], [rad]
struct HubAt {
    double advance, turn = 0;
};

/// One step of dt [s], at whose end the hubs of instruments 0, 1, ... are there.
inline void step_to(World& world, double dt, std::initializer_list<HubAt> hubs)
{
    Control control;
    int wire = 0;
    for (const HubAt& hub : hubs) control.move_to(wire++, hub.advance, hub.turn);
    REQUIRE_FALSE(step(world, control, dt).failed());
}

}  // namespace seldinger::test
