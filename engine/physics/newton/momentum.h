#pragma once
// Balance of momentum of a whole wire, read off an accepted step (Solver::momentum_balance):
//
//   held + weight + contact + loads + fed = d/dt sum_i m_i v_i
//
// Every term is taken from the place that reports it: reactions of the solver, contact forces of the device's sums, velocities
// of the state. So `error` tells whether the numbers that a user reads belong together. The solver's residual on the free nodes
// bounds the error: |error| <= sqrt(3) n force_residual and rounding.
//
// A fed wire's last node stands still at the inlet while material passes through it: its velocity is the material's, and its half
// cell's momentum counts. Entering material brings its own momentum, `fed` = sum_i (m_i+ - m_i-) v_i- / h, rho A v^2 for a steady
// feed.
//
// Backward Euler and energy-momentum steps: the rate is (P+ - P-)/h, and forces are those that the step took. Newmark: M a+ at
// the end of the step, where the equations hold, and `fed`. `explicit` takes its forces at the start of the step, and its
// readings are of the end: there the balance closes to O(h).

#include "rod/rod_arrays.h"
#include "solve/momentum_balance.h"

namespace seldinger {

/// What the balance needs of the time before a sub-step.
struct MomentumStart {
    Vec3 momentum = Vec3::Zero();  // before feeding [kg m/s]
    Vec3 fed = Vec3::Zero();       // that feeding added [kg m/s]
};

/// sum m v [kg m/s]
[[nodiscard]] Vec3 momentum(const RodView& rod);

}  // namespace seldinger
