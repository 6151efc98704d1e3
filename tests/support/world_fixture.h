#pragma once
// Worlds for tests: wires in a tube or over a plane, fed or placed.

#include "shapes/shapes.h"
#include "support/approx.h"
#include "support/fed_world.h"
#include "world/world.h"

#include <cmath>
#include <numbers>

namespace seldinger::test {

/// A steel wire of 0.035 inch with a soft bend, so that steps of a millisecond show dynamics. No rest curvature.
inline WireSpec steel_wire(double length, int nodes)
{
    WireSpec spec;
    spec.length = length;
    spec.nodes = nodes;
    spec.shaft.radius = 0.4445e-3;
    spec.shaft.density = 7900;
    spec.shaft.bend_stiffness = 1e-5;
    spec.shaft.twist_stiffness = 7.7e-6;
    spec.shaft.stretch_stiffness = 1e4;
    spec.shaft.mu_static = 0.25;
    spec.shaft.mu_sliding = 0.2;
    return spec;
}

inline void add_vessel(TestSetup& setup, const GeneratedVessel& vessel, const VesselSpec& spec)
{
    setup.vessel = spec;
    setup.mesh = vessel.mesh;
    setup.centreline = vessel.centreline;
}

inline VesselSpec tube(double radius, double length, int triangles = 4000)
{
    return {.shape = VesselShape::Tube, .radius = radius, .length = length, .triangles = triangles};
}

inline void add_tube(TestSetup& setup, const VesselSpec& spec) { add_vessel(setup, make_tube(spec), spec); }

/// A tube that turns through 90 degrees, upwards: contact with sliding, and moments at the base.
inline void add_bend(TestSetup& setup, double radius, double bend_radius, int triangles = 6000)
{
    VesselSpec spec{.shape = VesselShape::Arc,
                    .radius = radius,
                    .bend_radius = bend_radius,
                    .angle = std::numbers::pi / 2,
                    .lead_in = 0.02,
                    .lead_out = 0.05,
                    .triangles = triangles};
    add_vessel(setup, make_arc(spec), spec);
}

inline TestSetup in_tube(double radius, double length, int triangles = 4000)
{
    TestSetup setup;
    add_tube(setup, tube(radius, length, triangles));
    return setup;
}

inline TestSetup in_bend(double radius, double bend_radius, int triangles = 6000)
{
    TestSetup setup;
    add_bend(setup, radius, bend_radius, triangles);
    return setup;
}

/// A plane across z, at 0.
inline void add_plane(TestSetup& setup, double size, int triangles)
{
    const VesselSpec plane{.shape = VesselShape::Plane, .size = size, .triangles = triangles};
    add_vessel(setup, make_plane(plane), plane);
}

/// Fed from `point` along x at `speed`; turned at `turn_rate`.
inline TestWire fed_wire(const WireSpec& spec, const Vec3& point, double speed, double turn_rate = 0, double time = 10)
{
    TestWire wire;
    wire.wire = spec;
    wire.feed.on = true;
    wire.feed.point = point;
    wire.feed.keys = {{0, 0, 0}, {time, speed * time, turn_rate * time}};
    return wire;
}

/// Straight along +x from `base`, free.
inline TestWire placed_wire(const WireSpec& spec, const Vec3& base)
{
    TestWire wire;
    wire.wire = spec;
    wire.wire.place.base = base;
    return wire;
}

}  // namespace seldinger::test
