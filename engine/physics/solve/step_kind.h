#pragma once
// Kinds of equations of a step, and the arrays of a wire that a loop needs next.

#include "math/vec3.h"

namespace seldinger {

struct IntegratorSpec;

/// Which equations: see wire_problem.h. Explicit: R is minus the force at the start of the step.
enum class Motion { Static, Implicit, Explicit };

/// Whether a step may leave spin angles out (solve/spins.cpp): if no torque acts; and, where forces follow the spins, if these do
/// not move either.
enum class SpinAngles { SolvedFor, LeftIfFree, LeftIfStill };

/// Equations of one step of all wires.
struct StepEquations {
    const IntegratorSpec& spec;
    const Vec3& gravity;
    Motion motion;
    double h;  // [s]
    SpinAngles spins = SpinAngles::SolvedFor;  // whether spin angles may be left out
};

/// What a loop over the wires does to each: begins its step, takes in an evaluation and prepares the next, ends its step.
enum class SolveStage { Begin, Advance, Commit };

}  // namespace seldinger
