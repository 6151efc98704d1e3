#pragma once
// Friction per length between two instruments that share a centreline, and its tangent.
//
// Their surfaces have slipped by u = (along, around) within a step of h. What the inner one feels per length, the outer one the
// opposite of, is
//
//     f = -(k e + c u/h),    e = (e_0 + u) or, where that is longer than y, y (e_0 + u)/|e_0 + u|,    y = q/k         [Simo92]
//
// with e_0 the remembered elastic slip. Dry friction is at most q per length in any direction of slip, after an elastic slip of
// y; c is the resistance of a film. Backward Euler: f holds at the end of the step.
// It takes -f . u = k e.u + c u.u/h, never less than 1/2 k (|e|^2 - |e_0|^2): it returns only stored energy.

#include "math/vec3.h"

#include <algorithm>

namespace seldinger {

/// Friction law at a point of the surface between two instruments.
struct SlipLawPerLength {
    double limit = 0;      // q [N/m]
    double stiffness = 0;  // k [N/m^2], > 0 where q is
    double viscous = 0;    // c [N s/m per m]
};

struct SlipPerLength {
    Vec2 force = Vec2::Zero();    // on the inner one, along and around [N/m]
    Vec2 elastic = Vec2::Zero();  // e [m]
    double slope = 0;                                   // -d(force around)/d(slip around), >= 0 [N/m^2]
    bool slides = false;
};

/// @param start  e_0     @param slip  u, of which the first is known     @param rate  1/h [1/s]; 0: at rest
/// @param stuck  q is ignored
[[nodiscard]] inline SlipPerLength slip_per_length(const SlipLawPerLength& law, const Vec2& start, const Vec2& slip, double rate,
                                                   bool stuck = false)
{
    SlipPerLength out;
    if (law.limit > 0) {
        const Vec2 trial = start + slip;
        const double size = trial.norm(), give = law.limit / law.stiffness;
        out.slides = size > give && !stuck;
        out.elastic = out.slides ? Vec2((give / size) * trial) : trial;
        const double along = out.slides ? trial.x() / size : 1.0;
        out.slope = (out.slides ? law.limit / size : law.stiffness) * along * along;
        out.force = -law.stiffness * out.elastic;
    }
    out.force -= (law.viscous * rate) * slip;
    out.slope += law.viscous * rate;
    return out;
}

}  // namespace seldinger
