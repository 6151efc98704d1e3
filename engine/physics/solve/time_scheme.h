#pragma once
// Velocity and acceleration of one wire's unknowns as functions of q, by the time scheme of the step:
//
//   v+ = velocity_rate (q - q_0) + v_base,   a+ = acceleration_rate (q - q_0) + a_base
//
//   backward Euler     v+ = (q - q_0)/h                           a+ = (v+ - v_0)/h
//   Newmark (D4)       v+ = v_0 + h ((1 - gamma) a_0 + gamma a+)  a+ = (q - q_0 - h v_0 - h^2 (1/2 - beta) a_0)/(beta h^2)
//   energy-momentum    v+ = 2 (q - q_0)/h - v_0                   a+ = (v+ - v_0)/h
//   symplectic Euler   v_base = v_0, all else 0                   statics: all 0
//
// A prescribed unknown has the mean velocity of its step. The node at the hub of a fed wire stands still while material moves
// through it: its velocity is the material's.

#include "rod/rod_arrays.h"
#include "solve/solve_spec.h"
#include "solve/step_kind.h"
#include "solve/wire_unknowns.h"

#include <vector>

namespace seldinger {

class TimeScheme {
public:
    explicit TimeScheme(int capacity);

    /// Takes over velocities and accelerations at the start of the step.
    void begin(const RodView& rod, const IntegratorSpec& spec, Motion motion, double step, const Vec3& hub_flow);
    [[nodiscard]] Motion motion() const { return motion_; }
    [[nodiscard]] double step() const { return h_; }
    [[nodiscard]] bool conserving() const { return conserving_; }
    /// Backward Euler.
    [[nodiscard]] bool euler() const { return euler_; }
    /// Share of the end of the step in what the elastic force is taken from: 1/2 conserving.
    [[nodiscard]] double end_share() const { return conserving_ ? 0.5 : 1.0; }
    [[nodiscard]] double acceleration_rate() const { return acceleration_rate_; }
    /// d(velocity that damping sees)/dq
    [[nodiscard]] double damping_rate() const { return damping_rate_; }

    [[nodiscard]] double start_velocity(int i) const { return start_velocity_[i]; }
    /// Move of unknown i in a step by the velocity that it has at the start; none of the node at the hub of a fed wire.
    [[nodiscard]] double known_move(int i) const { return fed_ && is_hub(i) ? 0.0 : h_ * start_velocity_[i]; }
    /// Velocity of unknown i at the trial; at the hub, that of the material that passes.
    [[nodiscard]] double velocity(const WireUnknowns& q, int i) const;
    [[nodiscard]] double acceleration(const WireUnknowns& q, int i) const;
    /// Over the step when conserving, at its end otherwise: what damping sees.
    [[nodiscard]] double mean_velocity(const WireUnknowns& q, int i) const;
    /// The first two of all unknowns, in loops that vectorise.
    void velocities(const WireUnknowns& q, double* out) const;
    void accelerations(const WireUnknowns& q, double* out) const;
    /// Symplectic Euler: (q - q_0)/h and the flow.
    [[nodiscard]] double explicit_velocity(const WireUnknowns& q, int i) const;

    void prefetch(int unknowns, SolveStage next) const;

private:
    [[nodiscard]] bool is_hub(int i) const { return i >= hub_ && i < hub_ + RodDofs::coordinates; }
    [[nodiscard]] double flow(int i) const { return is_hub(i) ? flow_[i - hub_] : 0.0; }
    void set_conserving(int unknowns);
    void set_newmark(const RodView& rod);

    Motion motion_ = Motion::Implicit;
    bool conserving_ = false, euler_ = false, fed_ = false;
    int unknowns_ = 0, hub_ = 0;  // hub_: its first unknown
    double h_ = 0;                // [s]
    Vec3 flow_ = Vec3::Zero();
    double velocity_rate_ = 0, acceleration_rate_ = 0, damping_rate_ = 0;
    std::vector<double> start_velocity_;                    // [unknowns]
    std::vector<double> velocity_base_, acceleration_base_;  // not for backward Euler: 0 and -start_velocity_/h
};

}  // namespace seldinger
