#pragma once
// The equations of motion of one wire during one step, as a root-finding problem in its part q of the system's unknowns:
//
//   R(q) = M a+ + dE/dq + c_m M v+ + c_k K_0 v+ - f_weight - f_loads - f_links - f_terms = 0 on free unknowns
//
// v+ and a+: solve/time_scheme.h; loads and links: solve/external_loads.h; f_terms, contact among them: solve/force_term.h. K_0
// is the elastic Hessian at the start of the step, projected to be positive semidefinite. On a prescribed unknown R is the force
// that the hold exerts on the wire. Motion::Explicit: R is minus the force at the start of the step.
//
// An energy-momentum step (IntegratorSpec::conserve) takes the means over the step: dE/dq the discrete gradient between q_0 and q
// (rod/discrete_gradient.h), the velocity that damping sees (q - q_0)/h. Links are taken at the mean position, force terms at the
// end of the step. Its tangent is half the Hessian at q; only stretching, whose stiffness makes that too coarse where edges turn
// within a step, is differentiated exactly, and that is not symmetric.

#include "solve/external_loads.h"
#include "solve/force_term.h"
#include "solve/mixed_tension.h"
#include "solve/solve_report.h"
#include "solve/step_kind.h"
#include "solve/time_scheme.h"
#include "solve/wire_constraints.h"
#include "solve/wire_unknowns.h"

#include <array>
#include <vector>

namespace seldinger {

/// Whether a wire's elasticity is its own, or that of instruments that share a centreline (solve/coaxial_group.h), and which of
/// these it is.
enum class WireRole { Alone, Line, Passenger };

class WireProblem {
public:
    WireProblem(int capacity, const IntegratorSpec& spec);

    // ---- start of a step (wire_problem.cpp, wire_scales.cpp) ----
    /// Takes over the start of the step and the constraints at its end, and fills in its part of the unknowns. No allocation once
    /// clamps have been seen.
    void begin(const RodView& view, const WireConstraints& constraints, const StepEquations& step);
    /// Whether nothing turns the spin angles in this step (solve/spins.cpp).
    [[nodiscard]] bool may_leave(SpinAngles spins) const;
    /// The second part: with the spin angles left as they are, or not.
    void begin_frames(const IntegratorSpec& spec, bool leave_spins);
    /// Takes spin angles in again, as they were at the start of the step.
    void take_spins_in();
    /// A passenger, after it has begun: its positions are the line's, and it is measured by the line's scales.
    void follow(const WireProblem& line);
    /// Angles that leave no twist, from a clamp of the spin on or else with the spins' momentum kept, which no torque changes.
    void untwist();
    /// Whether the residual of the spins' equations meets the tolerance.
    [[nodiscard]] bool spins_balanced() const;
    void prefetch(SolveStage next) const;

    // ---- at a trial ----
    /// Frames at the trial. @return false if anything is not finite
    [[nodiscard]] bool update();
    /// All of R but force terms, at the trial; update() must have run there.
    void evaluate_residual();
    /// All of dR/dq but force terms into `tangent`, prescribed unknowns not yet fixed, with the geometric stiffness of the
    /// predicted tension. @param symmetric  its symmetric part, as far as it is not symmetric
    void assemble_elastic(HessianMode mode, bool symmetric, BandRows& tangent) const;
    /// Terms after force terms in the order of summation.
    void add_stiffness_damping(BandRows& tangent) const;
    /// Whether dR/dq is not symmetric even without force terms: energy-momentum steps, dead moments.
    [[nodiscard]] bool unsymmetric() const { return time.conserving() || dead_loads_.unsymmetric(); }
    [[nodiscard]] EdgeStretch stretch() const
    {
        return {rod, frames, start_frames_, time.conserving(), constraints_->base_grown};
    }

    // ---- measures (wire_scales.cpp) ----
    /// Largest free residual [N]; moments divided by length_scale.
    [[nodiscard]] double residual_norm() const;
    /// sum d^2 [m^2]; angles times length_scale.
    [[nodiscard]] double squared_norm(std::span<const double> d) const;
    /// Largest move of a node in d [m].
    [[nodiscard]] double largest_move(std::span<const double> d) const;
    /// Largest move of a node, or of the surface by spin [m].
    [[nodiscard]] double largest_surface_move(std::span<const double> d) const;
    /// Largest change of an edge vector by d, relative to the edge's rest length.
    [[nodiscard]] double largest_turn(std::span<const double> d) const;
    [[nodiscard]] double smallest_radius() const;

    // ---- the reference and the accepted state (wire_accept.cpp) ----
    /// Static solves that turn far: frames at the trial become the reference for the next trials.
    [[nodiscard]] bool far_from_reference() const;
    void move_reference();
    void keep_reference();  // as it is now, for restore_reference after a failure
    void restore_reference();
    /// Makes the trial the accepted state in the wire's arrays (velocities zero when static).
    void commit(bool accelerations);
    /// A passenger, after its line: where that is, and its frames.
    void take_from(const RodView& line);
    /// Symplectic Euler: v+ = v + h F/m, x+ = x + h v+. A prescribed unknown goes to its value, and its residual, the hold's
    /// force, takes in its inertia.
    void move_explicit();
    void commit_explicit();
    /// M a = -R, 0 where prescribed, into the wire's arrays.
    void set_acceleration_from_residual();

    /// Losses of the step from the start to the trial.
    [[nodiscard]] StepLosses losses() const;
    /// Dead forces, links and damping by mass on the whole wire, as R has taken them [N].
    [[nodiscard]] Vec3 load_force() const;
    [[nodiscard]] int size() const { return RodDofs::count(rod.n); }
    [[nodiscard]] const WireConstraints& constraints() const { return *constraints_; }
    [[nodiscard]] bool fed() const { return !constraints_->hub_flow.isZero(); }
    [[nodiscard]] RodTrial trial_view() const;

    int wire = 0;  // of the world
    WireRole role = WireRole::Alone;
    RodView rod;
    std::vector<RodClamp> clamps;
    RodFrames frames;
    WireUnknowns q;  // its part of the system's
    TermAnswer terms;  // of force terms at the trial, see SystemProblem::ask()
    TimeScheme time;
    MixedTension tension;

    double length_scale = 0;                // mean rest length of an edge [m]: turns angles into lengths and moments into forces
    double force_scale = 0, tolerance = 0;  // [N], see set_scales
    double norm = 0;                        // residual at the trial [N]
    double rounding = 0, rounding_most = 0;  // of force terms, which adds to its tolerance (TermAnswer) [N]
    double base_tension_excess = 0;         // of the trial beyond the equations solved: 0 but for one linearised step [N]

private:
    [[nodiscard]] double tension_before_feed(int j, double length) const;
    [[nodiscard]] double tension_before(int j) const;
    void set_scales(const IntegratorSpec& spec, const Vec3& gravity);
    void set_stiffness_damping(const IntegratorSpec& spec);
    void write_velocity(int i, const double* v);
    void write_acceleration(int i, const double* a);
    void restore_positions();
    static constexpr int reference_count = 9;
    [[nodiscard]] std::array<std::span<double>, reference_count> reference_arrays() const;

    const WireConstraints* constraints_ = nullptr;
    DeadLoads dead_loads_;
    Links links_;
    MassDamping mass_damping_;
    double damping_stiffness_ = 0;  // c_k [s]
    BandMatrix damping_;            // K_0
    RodFrames start_frames_;        // conserving: of q_0
    bool start_usable_ = true;
    std::vector<double> turned_;           // [capacity] conserving: turn of each edge's frame over the step [rad]
    std::vector<double> kept_reference_;   // [reference_count * capacity]
    mutable std::vector<double> scratch_;  // of losses()
};

}  // namespace seldinger
