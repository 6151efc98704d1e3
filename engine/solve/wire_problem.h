#pragma once
// The equations of motion of one wire during one step, as a root-finding problem in q = (x_i, y_i, z_i, theta_i) per node:
//
//   R(q) = M a+ + dE/dq + c_m M v+ + c_k K_0 v+ - f_weight - f_loads - f_springs - f_contact = 0 on free unknowns
//
// with v+ = velocity_rate (q - q_0) + v_base and a+ = acceleration_rate (q - q_0) + a_base, which covers backward Euler,
// Newmark (D4) and statics (rates 0, bases 0). K_0 is the safe elastic Hessian at the start of the step. On a prescribed
// unknown R is the force that the hold exerts on the wire.
//
// An energy-momentum step (IntegratorSpec::conserve) takes the means over the step: a+ is (v+ - v_0)/h with v+ + v_0 = 2 (q -
// q_0)/h, dE/dq the discrete gradient between q_0 and q (rod/discrete_gradient.h), the velocity that damping sees (q - q_0)/h.
// Springs are taken at the mean position, contact at the end of the step. Its tangent is half the Hessian at q; only stretching,
// whose stiffness makes that too coarse where edges turn within a step, is differentiated exactly, and that is not symmetric.

#include "solve/newton.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

// Motion::Explicit: R is minus the force at the start of the step (rates 0, v_base = v, a_base = 0).

class WireProblem {
public:
    /// What one thread works with on one wire after the other. Of 1,000 wires the matrices alone would be more than any cache
    /// holds.
    struct Workspace {
        explicit Workspace(int capacity)
            : matrix(4 * capacity), contact_tangent(4 * capacity), numbers(numbers_per_node * capacity)
        {
        }
        BandMatrix::Storage matrix, contact_tangent;
        std::vector<double> numbers;
        static constexpr int numbers_per_node = 5 * 4;
    };

    WireProblem(int capacity, const IntegratorSpec& spec);

    /// Takes over the start of the step and the constraints at its end. No allocation once clamps have been seen.
    /// @param spins  whether spin angles may be left out of this step
    void begin(const RodView& view, const WireConstraints& constraints, const IntegratorSpec& spec, const Vec3& gravity,
               Motion motion, double h, SpinAngles spins = SpinAngles::SolvedFor);
    /// Whether spin angles are left out: they stay what they were, and neither their equations nor twist are looked at.
    [[nodiscard]] bool without_spins() const { return !frames.spins; }
    /// Takes spin angles in again, as they were at the start of the step.
    void take_spins_in();
    /// The same at the trial, which a solve without them has found, evaluates all of R there and tells whether the
    /// equations of the spins hold too, to the tolerance: then the trial solves the whole. Without contact the angles first
    /// follow the shape so that the wire is not twisted, which is where torsion, far faster than bending, would take them.
    [[nodiscard]] bool spins_hold(const ForceTerms& terms, int wire);

    /// Works in `workspace` until the next call: to be called before anything else, by whatever thread. Entries of the matrix
    /// outlive that in a static solve only, which goes back to them, and its factors unless `once`, where it is solved with as
    /// soon as it is factorised and never again. @return memory [4 capacity] for the caller
    std::span<double> work_in(Workspace& workspace, bool once);

    /// Its arrays will be needed soon.
    void prefetch(SolveStage next) const;

    /// Frames at `trial`. @return false if anything is not finite
    [[nodiscard]] bool update();
    /// R at `trial` into `residual`; update() must have run there, and contact been evaluated. @return false if not finite
    [[nodiscard]] bool evaluate_residual(const ForceTerms& terms, int wire);
    /// Whether dR/dq is not symmetric even without contact: energy-momentum steps, dead moments.
    [[nodiscard]] bool unsymmetric() const;
    [[nodiscard]] bool conserving() const { return conserving_; }
    /// The same with contact taken as linear from where assemble_tangent last ran, `base`: costs no evaluation of contact.
    [[nodiscard]] bool evaluate_linear_contact(const ForceTerms& terms, std::span<const double> base);
    /// dR/dq at `trial` into `matrix`, prescribed unknowns not yet fixed, with the geometric stiffness of the
    /// predicted tension. @param symmetric  its symmetric part, as far as it is not symmetric
    void assemble_tangent(HessianMode mode, bool symmetric, const ForceTerms& terms, int wire);

    /// Largest free residual [N]; moments divided by length_scale.
    [[nodiscard]] double residual_norm() const;
    /// sqrt(sum d^2) over all unknowns [m]; angles times length_scale.
    [[nodiscard]] double norm(std::span<const double> d) const;
    /// Largest move of a node in d [m].
    [[nodiscard]] double largest_move(std::span<const double> d) const;
    /// Largest change of an edge vector by d, relative to the edge's rest length.
    [[nodiscard]] double largest_turn(std::span<const double> d) const;
    // Tensions of the mixed equations, see newton_wire.h. `base` is where the present direction starts from.
    /// `trial` becomes the base, with the tension that was predicted for it.
    void set_base();
    /// Tension at base + alpha d, as the linear equations have it.
    void predict_tension(std::span<const double> d, double alpha);
    /// The same after a further `correction` from `trial`, where frames are.
    void correct_tension(std::span<const double> correction);
    /// Residual of the mixed equations at `trial`, tensions condensed: R with the tension that was not predicted taken along
    /// the base's tangents. Equal to R where prediction and trial agree, so at the solution.
    void mixed_residual(std::span<double> out) const;

    /// Move of unknown i in a step by the velocity that it has at the start; the node at the hub of a fed wire stands still while
    /// material moves through it.
    [[nodiscard]] double known_move(int i) const { return fed() && is_hub(i) ? 0.0 : h * start_velocity_[i]; }
    /// After one linearised step: its own tensions into the residual, in place of those of the trial's shape, which turning by phi
    /// has raised by EA phi^2/2. Reactions are then forces of the equations that have been solved.
    void take_linear_tensions();
    /// Tension of the base edge at the trial beyond that of the equations solved: 0 but for one linearised step [N].
    [[nodiscard]] double base_tension_excess() const { return base_excess_; }
    /// Velocity and acceleration of unknown i at `trial`; of the material, where it passes through the hub.
    [[nodiscard]] double velocity(int i) const;
    [[nodiscard]] double acceleration(int i) const;
    /// Static solves that turn far: frames at `trial` become the reference for the next trials (wire_problem.cpp).
    [[nodiscard]] bool far_from_reference() const;
    void move_reference();
    void keep_reference();  // as it is now, for restore_reference after a failure
    void restore_reference();

    /// Makes `trial` the accepted state in the wire's arrays (velocities zero when static).
    void commit(bool newmark);
    /// Symplectic Euler: a prescribed unknown goes to its value, and its residual, the hold's force, takes in its inertia.
    void move_prescribed(int i);
    /// The same for symplectic Euler, where v+ = (q - q_0)/h.
    void commit_explicit();
    /// M a = -R, 0 where prescribed, into the wire's arrays.
    void set_acceleration_from_residual();

    /// Dead forces, springs and damping by mass on the whole wire, as R has taken them [N].
    [[nodiscard]] Vec3 load_force() const;
    [[nodiscard]] int size() const { return 4 * rod.n; }
    [[nodiscard]] bool fed() const { return !constraints_->hub_flow.isZero(0); }
    [[nodiscard]] RodTrial trial_view() const;

    RodView rod;
    std::vector<RodClamp> clamps;
    RodFrames frames;
    BandMatrix matrix;

    // [4 capacity], node by node
    std::vector<double> start, trial;  // q_0, q
    std::vector<double> residual;      // R at trial
    std::vector<double> inertia;       // mass [kg] or spin inertia [kg m^2]
    std::vector<double> prescribed_value;
    std::vector<std::uint8_t> prescribed;  // 1: fixed at prescribed_value (and the unused last theta)

    Motion motion = Motion::Implicit;
    double h = 0;                           // [s]
    double length_scale = 0;                // mean rest length of an edge [m]: turns angles into lengths and moments into forces
    double force_scale = 0, tolerance = 0;  // [N], see set_scales

private:
    void write_velocity(int i, const double* v);
    void write_acceleration(int i, const double* a);
    void velocities(double* out) const;
    void accelerations(double* out) const;
    [[nodiscard]] double actual_tension(int j) const;
    [[nodiscard]] bool is_hub(int i) const { return i >= 4 * (rod.n - 1) && i < 4 * rod.n - 1; }
    [[nodiscard]] double flow(int i) const;
    [[nodiscard]] double tension_before(int j) const;
    void set_kinematics(const IntegratorSpec& spec);
    void set_external(const Vec3& gravity);
    void set_scales(const IntegratorSpec& spec, const Vec3& gravity);
    void set_damping(const IntegratorSpec& spec);
    [[nodiscard]] bool may_leave(SpinAngles spins) const;
    void untwist();
    void evaluate_host_residual();
    [[nodiscard]] bool finish_residual();
    [[nodiscard]] Vec3 spring_pull(const WireConstraints::Spring& spring) const;
    void add_loads();
    void add_springs_to(BandMatrix& target) const;
    void add_moments_to(BandMatrix& target, bool symmetric) const;
    void replace_tension(HessianMode mode, bool symmetric);
    void restore_positions();
    [[nodiscard]] double mean_velocity(int i) const;
    [[nodiscard]] double velocity_base(int i) const { return euler_ ? 0.0 : velocity_base_[i]; }
    [[nodiscard]] double acceleration_base(int i) const { return euler_ ? -start_velocity_[i] / h : acceleration_base_[i]; }
    [[nodiscard]] double stretched_length(int j) const;
    [[nodiscard]] double strained_length(int j) const;
    [[nodiscard]] Vec3 tension_direction(int j) const;

    static constexpr int reference_count = 9;
    [[nodiscard]] std::array<std::span<double>, reference_count> reference_arrays() const;

    const WireConstraints* constraints_ = nullptr;
    bool conserving_ = false, euler_ = false, start_usable_ = true;
    double base_excess_ = 0;  // [N]
    double end_share_ = 1;    // of the end of the step in what the elastic force is taken from: 1/2 conserving
    RodFrames start_frames_;  // conserving: of q_0
    double velocity_rate_ = 0, acceleration_rate_ = 0, damping_rate_ = 0, damping_mass_ = 0, damping_stiffness_ = 0;
    // the first two not for backward Euler, where they are 0 and -start_velocity_/h
    std::vector<double> velocity_base_, acceleration_base_, start_velocity_, external_;
    // [4 capacity] in the workspace; the third is the trial as separate x, y, z, theta for the rod's functions, the last
    // contact's gradient at its last evaluation
    std::span<double> scratch_, damped_velocity_, split_, contact_gradient_;
    std::vector<double> kept_reference_;  // [reference_count * capacity]
    // [capacity] per edge: tension at the base and predicted for the trial [N], the base's elongation [m], its tangents and the
    // directions of its tensions (conserving, the mean of start and trial; else the tangents)
    std::vector<double> base_tension_, tension_, base_longer_;
    std::vector<Vec3> base_tangent_, base_direction_;
    std::vector<double> turned_;  // [capacity] conserving: turn of each edge's frame over the step [rad]
    BandMatrix contact_tangent_;  // at the last assemble_tangent
    BandMatrix damping_;
};

}  // namespace seldinger
