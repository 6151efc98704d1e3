#pragma once
// The balance of momentum of a whole wire, for reports (newton/momentum.h).

#include "math/vec3.h"

namespace seldinger {

/// Balance of the last sub-step; all in newtons.
struct MomentumBalance {
    Vec3 held = Vec3::Zero();  // by all holds, and by the inlet of a fed wire
    Vec3 weight = Vec3::Zero();
    Vec3 contact = Vec3::Zero();
    Vec3 loads = Vec3::Zero();  // dead loads, links, damping against the surroundings
    Vec3 fed = Vec3::Zero();    // brought in by material
    Vec3 rate = Vec3::Zero();   // of change of momentum
    [[nodiscard]] Vec3 error() const { return held + weight + contact + loads + fed - rate; }
};

}  // namespace seldinger
