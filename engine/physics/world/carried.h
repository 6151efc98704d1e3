#pragma once
// Forces that a step cut short has left unbalanced (World::cut_when), carried into the next step.
//
// A step that ends before its equations hold has M a = F + R with a residual R: a force that nobody exerts. Its impulse R h is
// taken back in the next step, as a load of -R h over that step's length, so what the wire has of momentum is late by one step
// and not lost. Held nodes and spin angles carry nothing: there is no momentum that the next step does not set anew. Places are
// material, because nodes may be split and merged in between.

#include "rod/rod_arrays.h"
#include "solve/wire_constraints.h"

#include <cstdint>
#include <vector>

namespace seldinger {

class Solver;
class StateWalk;
struct WireState;  // world/world.h

struct CarriedImpulse {
    double s = 0;                    // rest length from the tip [m]
    Vec3 impulse = Vec3::Zero();     // [N s]
};

/// What a wire's step of h [s] has left, added to `left`.
void add_left(const ConstRodView& rod, const Solver& solver, int wire, double h, std::vector<CarriedImpulse>& left);
/// As loads over a step of dt [s].
void carry(const ConstRodView& rod, const std::vector<CarriedImpulse>& left, double dt, WireConstraints& constraints);

/// Rows of the state, its last ones: none where no wire carries anything. @throws Error BadFile: impossible values
void walk_carried(StateWalk& walk, std::span<WireState> states, std::span<const int> wires);

}  // namespace seldinger
