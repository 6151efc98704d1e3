#pragma once
// One contact as a user reads it.

#include "math/vec3.h"

namespace seldinger {

enum class BodyKind { Rod, Wall };

/// One of the two bodies of a contact, and where on it.
struct ContactSide {
    BodyKind kind = BodyKind::Rod;
    int body = 0;     // which rod of the world; 0 of the wall
    int element = 0;  // edge of the rod, counted from the tip; triangle of WorldSetup::mesh
};

/// One contact of the accepted state, sorted by the bodies and elements of its sides, `a` before `b`.
struct ContactRow {
    ContactSide a, b{BodyKind::Wall};  // against the wall: `a` is the rod
    Vec3 point = Vec3::Zero();         // on side b [m]
    Vec3 normal = Vec3::Zero();        // unit, from b to a: into the lumen
    double gap = 0;                    // [m], < 0 when overlapping
    double normal_force = 0;           // [N] >= 0
    Vec3 friction = Vec3::Zero();      // on a [N]
    double rolling_moment = 0;         // about the wire's tangent [N m]
    bool stuck = false;
    double along_a = 0;        // where on a: arc length from its tip along the unstressed wire [m]
    double along_b = 0;        // likewise on b; 0 on the wall [m]
    double length = 0;    // metres of wire this contact stands for (0 for a pair of `layer`)
    double area = 0;  // that the wire lies on the other body with [m^2], contact/loads/contact_patch.h (0 for a pair of `layer`)
    double pressure = 0;  // load over area, both of one window: force_per_length.h [Pa]
    // contact/force_per_length.h
    double per_length = 0;  // load on the wire here, over a window [N/m]
    int region = 0;         // which of the places that a lies on, from 1
};

}  // namespace seldinger
