#pragma once
// One contact as a user reads it.

#include "math/vec3.h"

namespace seldinger {

/// One contact of the accepted state, sorted by (wire, edge, triangle).
struct ContactRow {
    int wire = 0, edge = 0, triangle = 0;  // triangle: index in WorldSetup::mesh
    Vec3 point = Vec3::Zero();             // on the wall [m]
    Vec3 normal = Vec3::Zero();            // unit, into the lumen
    double gap = 0;                        // [m], < 0 when overlapping
    double normal_force = 0;               // [N] >= 0
    Vec3 friction = Vec3::Zero();          // on the wire [N]
    double rolling_moment = 0;             // about the wire's tangent [N m]
    bool stuck = false;
    double length = 0;  // metres of wire this contact stands for (0 for a pair of `layer`)
};

}  // namespace seldinger
