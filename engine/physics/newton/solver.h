#pragma once
// Time integration and equilibrium of all systems (D4, D5): Newton's method on the banded equations of each. Systems iterate in
// lockstep, so that one set of launches evaluates the force terms (contact) of all. A system is one wire, or several that can
// touch each other. It is solved, converges or fails as one, and its result does not depend on the other systems.

#include "newton/momentum.h"
#include "newton/newton_trial.h"
#include "rod/elastic.h"
#include "solve/coaxial_group.h"
#include "solve/force_term.h"
#include "solve/solve_report.h"
#include "solve/solve_spec.h"
#include "solve/step_kind.h"
#include "solve/wire_constraints.h"

#include <cstdint>
#include <functional>
#include <memory>

namespace seldinger {

struct NewtonOptions;  // newton/options.h
class NewtonSystem;
class WireProblem;

/// Workspace and options for a fixed set of wires. Masks, constraints and reports are per wire of the world.
class Solver {
public:
    /// @param partition  wires of each system, which are consecutive; none: every wire is its own system
    Solver(RodArrays& rods, const IntegratorSpec& spec, const Vec3& gravity, std::span<const int> partition = {});
    ~Solver();
    /// Instruments of a system that share a centreline (solve/coaxial_group.h); before the first step. The group outlives this.
    void join(CoaxialGroup& group);

    /// One step of length h [s] of wires with active[w] != 0; those of a system are solved together. Constraints are those at the
    /// end of the step. On success the wires' positions, velocities, spins and frames are the new ones; on failure (converged ==
    /// false, for the whole system) they are untouched.
    /// @param terms  forces on the wires beside weight, loads and links
    void step(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
              std::span<const std::uint8_t> active, std::span<SolveReport> reports);

    /// Record of steps without spin angles (solve/spins.cpp): steps taken and left out since the start. After a step that needed
    /// them, twice as many as the last time are solved with them before the next attempt.
    struct SpinRecord {
        std::int64_t steps = 0, without = 0;
        std::int32_t wait = 0, last_wait = 0;
    };
    /// Spin record of the wire's system.
    [[nodiscard]] SpinRecord& spin_record(int wire) { return spin_records_[system_of_[wire]]; }

    /// Last resort of the caller when even the shortest step fails: step() then ends at the last trial that was taken.
    void set_best_effort(bool on) { best_effort_ = on; }

    /// `asked` is called between trials; when it returns true, a step ends as one that has failed, with the spin record that it
    /// had.
    void stop_when(std::function<bool()> asked) { stop_asked_ = std::move(asked); }
    /// The spin record from before the last step, which did not stand; only where a step may be stopped.
    void take_back_spins()
    {
        if (!spins_before_.empty()) spin_records_ = spins_before_;
    }
    /// Whether the last step was ended so.
    [[nodiscard]] bool stopped() const { return stopped_; }

    /// `due` is called between trials. Once it returns true, a step ends at the next trial that can be a state: contact admits
    /// it, its holds are met, and its residual moves no node by more than its radius. Instruments that share a centreline are
    /// always solved to the end.
    void cut_when(std::function<bool()> due) { due_ = std::move(due); }
    /// Residual at the end of the last step on a node of a wire [N]; 0 on one that is held.
    [[nodiscard]] Vec3 force_left(int wire, int node) const;

    /// Calls `seen` for each trial of each system, in no order of the systems, from any thread. Changes no result.
    void watch(std::function<void(const NewtonTrial&)> seen) { seen_ = std::move(seen); }

    /// Stable static equilibrium: Newton with an adaptive shift, falling back to pseudo-transient continuation; an unstable
    /// equilibrium (a straight column above its load) is left along its softest mode. Velocities become 0.
    void equilibrium(std::span<const WireConstraints> constraints, const ForceTerms& terms, std::span<const std::uint8_t> active,
                     std::span<SolveReport> reports);

    /// Accelerations at the start of a run, M a = F(x, v): what Newmark needs before its first step. Backward Euler does not.
    void initialise_acceleration(std::span<const WireConstraints> constraints, const ForceTerms& terms,
                                 std::span<const std::uint8_t> active);

    // results of the last step or equilibrium, per wire
    [[nodiscard]] const RodFrames& frames(int wire) const;
    [[nodiscard]] const TrialState& trial() const;  // = the accepted state after success
    /// Reaction at prescribed unknown i of the wire [N or N m]: the force that the hold exerts on it.
    [[nodiscard]] double reaction(int wire, int unknown) const;
    /// Move of a node of a wire along `direction` per force on it in that direction, by the equations of the last step [m/N].
    /// It is 0 if nothing was factorised or factors are not kept (linearised, explicit).
    [[nodiscard]] double compliance(int wire, int node, const Vec3& direction);
    /// Tension of the base edge that the state has beyond the one that was solved for: 0 but for linearised steps [N].
    [[nodiscard]] double base_tension_excess(int wire) const;
    /// Dead loads, links and damping by mass, on the whole wire [N].
    [[nodiscard]] Vec3 load_force(int wire) const;
    /// Balance of momentum of a wire after a sub-step of h [s]; 0 for an equilibrium (newton/momentum.h). @param contact_force 
    /// [n] on its nodes [N]
    [[nodiscard]] MomentumBalance momentum_balance(int wire, const WireConstraints& constraints,
                                                   std::span<const Vec3> contact_force, const MomentumStart& start,
                                                   double h) const;
    /// How far unknown i went in the last step [m or rad].
    [[nodiscard]] double displacement(int wire, int unknown) const;
    /// Work of the residual on the free unknowns, within the tolerance, on the wire in the last step [J].
    [[nodiscard]] double residual_work(int wire) const;
    /// What backward Euler and damping have taken in the last step, see WireProblem.
    [[nodiscard]] StepLosses losses(int wire) const;
    /// What the hands do at instruments that share a centreline, in the last step. @param line  the first of them
    [[nodiscard]] CoaxialHands coaxial_hands(int line) const;
    [[nodiscard]] double elastic_energy(int wire) const;
    [[nodiscard]] double kinetic_energy(int wire) const;
    [[nodiscard]] double potential_energy(int wire) const;  // gravity; loads not included

private:
    struct Work;
    struct Workspaces;
    [[nodiscard]] int system_count() const { return static_cast<int>(work_.size()); }
    [[nodiscard]] NewtonSystem& newton_of(int system);
    [[nodiscard]] const WireProblem& problem_of(int wire) const;
    [[nodiscard]] bool any_active(int system, std::span<const std::uint8_t> active) const;
    void for_each_system(SolveStage stage, const auto& body);

    void begin(Motion motion, double h, std::span<const WireConstraints> constraints, std::span<const std::uint8_t> active);
    void begin_system(int system, Motion motion, double h, std::span<const WireConstraints> constraints,
                      std::span<const std::uint8_t> active, SpinAngles spins);
    void show_accepted(int wire);
    void check_spins(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                     std::span<const std::uint8_t> active, const NewtonOptions& options);
    void prefetch_after(int system, int end, SolveStage stage) const;
    void prepare_trial(int system);
    void prepare_trials(std::span<const std::uint8_t> systems);
    void set_evaluated(int system, bool evaluate);
    void iterate(double h, const ForceTerms& terms);
    void abandon();
    void iterate_with_multipliers(double h, const ForceTerms& terms, std::span<const std::uint8_t> systems);
    void finish(std::span<SolveReport> reports);
    void step_explicit(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                       std::span<const std::uint8_t> active, std::span<SolveReport> reports);
    void accept_explicit(const ForceTerms& terms, std::span<SolveReport> reports);
    void evaluate_forces(double h, const ForceTerms& terms);
    void write_trial(int system);
    void evaluate_start(double h, bool linearised, const ForceTerms& terms);
    void restore(int system);

    RodArrays& rods_;
    IntegratorSpec spec_;
    Vec3 gravity_;
    std::vector<int> first_wire_, system_of_;  // [systems + 1], [wires]
    std::vector<std::unique_ptr<Work>> work_;  // [systems]
    std::unique_ptr<Workspaces> workspaces_;
    TrialState trial_, before_;  // before_: where known velocities come from, see TermTrial
    bool best_effort_ = false;
    std::vector<std::uint8_t> asked_;           // [systems] with an active wire, in the present call
    std::vector<std::uint8_t> running_;         // [systems] not finished
    std::vector<std::uint8_t> with_spins_;      // [systems] solved a second time in this step, with spin angles
    std::vector<std::uint8_t> resumed_;         // [systems] solved on after a round of multipliers
    std::vector<std::uint8_t> evaluate_;        // [wires] takes part in the present evaluation of force terms
    std::vector<std::uint8_t> solved_, again_;  // [wires] between two rounds of multipliers
    std::vector<SolveReport> first_;            // [wires] what the first solve took
    std::vector<SpinRecord> spin_records_, spins_before_;  // [systems]; at the start of a step that may be stopped
    std::function<bool()> stop_asked_, due_;
    std::function<void(const NewtonTrial&)> seen_;
    bool stopped_ = false;
    std::vector<double> response_;              // of compliance()
};

}  // namespace seldinger
