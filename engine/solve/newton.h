#pragma once
// Time integration and equilibrium of all wires (D4, D5): Newton on the banded system of each wire, in lockstep over
// wires so that contact is evaluated for all of them in one set of launches. A wire's result does not depend on the others.

#include "rod/elastic.h"
#include "solve/force_term.h"
#include "solve/solve_spec.h"

#include <cstdint>
#include <memory>

namespace seldinger {

struct NewtonOptions;  // solve/newton_wire.h
class NewtonWire;

/// What holds and loads a wire during one step, resolved to nodes and times (solve/constraints.h builds it).
struct WireConstraints {
    std::vector<std::pair<int, double>> prescribed;  // unknown index in [0, 4n), its value at the end of the step
    std::vector<RodClamp> clamps;                    // at the end of the step
    struct PointLoad {
        int edge;
        double bary;
        Vec3 force, moment;
    };  // position = (1-bary) x_edge + bary x_{edge+1}
    std::vector<PointLoad> loads;
    struct Spring {
        int edge;
        double bary;
        Vec3 anchor;
        double stiffness;
    };
    std::vector<Spring> springs;
    Vec3 hub_flow = Vec3::Zero();  // of material through the last node of a fed wire, which itself stands still [m/s]
    double base_grown = 0;         // rest length that the base edge of a fed wire has gained over the step [m]
};

struct SolveReport {
    bool converged = true;
    bool non_finite = false;
    bool best_effort = false;  // the tolerance was not met: this is the last trial that was taken (see set_best_effort)
    int iterations = 0;        // Newton iterations
    int evaluations = 0;       // residual evaluations, line search included
    double residual = 0;       // largest force residual left on a free unknown [N]; moments over the mean edge length
    double tolerance = 0;      // that it was compared with [N]: IntegratorSpec::tolerance * force_scale + rounding noise
    double force_scale = 0;    // largest of weight, loads, stretched springs, B/L^2 (wire_problem.cpp, set_scales) [N]
};

enum class Motion { Static, Implicit, Explicit };  // which equations: see wire_problem.h

/// Whether a step may leave spin angles out (solve/spins.cpp): if no torque acts; and, in contact, if they do not move either.
enum class SpinAngles { SolvedFor, LeftIfFree, LeftIfStill };

/// What a loop over the wires does to each: begins its step, takes in an evaluation and prepares the next, ends its step.
enum class SolveStage { Begin, Advance, Commit };

/// Workspace and options for a fixed set of wires.
class Solver {
public:
    Solver(RodArrays& rods, const IntegratorSpec& spec, const Vec3& gravity);
    ~Solver();

    /// One step of length h [s] for wires with active[w] != 0. Constraints are those at the end of the step. On success the
    /// wire's positions, velocities, spins and frames are the new ones; on failure (converged == false) they are untouched.
    /// @param terms  what acts on the wires beside weight, loads and links
    void step(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms, std::span<const std::uint8_t> active,
              std::span<SolveReport> reports);

    /// How steps without spin angles have gone (solve/spins.cpp): steps taken and left out since the start; after a step in which
    /// they were wanted, twice as many as the last time are solved with them before it is tried again.
    struct SpinRecord {
        std::int64_t steps = 0, without = 0;
        std::int32_t wait = 0, last_wait = 0;
    };
    [[nodiscard]] SpinRecord& spin_record(int wire) { return spin_records_[wire]; }

    /// Last resort of the caller when even the shortest step fails: step() then ends at the last trial that was taken.
    void set_best_effort(bool on) { best_effort_ = on; }

    /// Stable static equilibrium: Newton with an adaptive shift, falling back to damped pseudo-time continuation; an unstable
    /// equilibrium (a straight column above its load) is left along its softest mode. Velocities become 0.
    void equilibrium(std::span<const WireConstraints> constraints, const ForceTerms& terms, std::span<const std::uint8_t> active,
                     std::span<SolveReport> reports);

    /// Accelerations at the start of a run, M a = F(x, v): what Newmark needs before its first step. Backward Euler does not.
    void initialise_acceleration(std::span<const WireConstraints> constraints, const ForceTerms& terms,
                                 std::span<const std::uint8_t> active);

    // results of the last step or equilibrium, per wire
    [[nodiscard]] const RodFrames& frames(int wire) const;
    [[nodiscard]] const TrialState& trial() const;  // = the accepted state after success
    /// Reaction at prescribed unknown i [N or N m]: the force that the hold exerts on the wire.
    [[nodiscard]] double reaction(int wire, int unknown) const;
    /// Tension of the base edge that the state has beyond the one that was solved for: 0 but for linearised steps [N].
    [[nodiscard]] double base_tension_excess(int wire) const;
    /// Dead loads, links and damping by mass, on the whole wire [N].
    [[nodiscard]] Vec3 load_force(int wire) const;
    /// How far unknown i went in the last step [m or rad].
    [[nodiscard]] double displacement(int wire, int unknown) const;
    /// Work that what is left on the free unknowns, within the tolerance, did on the wire in the last step [J].
    [[nodiscard]] double residual_work(int wire) const;
    [[nodiscard]] double elastic_energy(int wire) const;
    [[nodiscard]] double kinetic_energy(int wire) const;
    [[nodiscard]] double potential_energy(int wire) const;  // gravity; loads not included

private:
    struct Work;
    struct Workspaces;
    void begin(Motion motion, double h, std::span<const WireConstraints> constraints, std::span<const std::uint8_t> active);
    void begin_wire(int wire, Motion motion, double h, const WireConstraints& constraints, SpinAngles spins);
    void show_accepted(int wire);
    void check_spins(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                     std::span<const std::uint8_t> active, const NewtonOptions& options);
    [[nodiscard]] NewtonWire& newton_of(int wire);
    void prefetch_after(int wire, SolveStage stage) const;
    void prepare_trial(int wire);
    void prepare_trials(std::span<const std::uint8_t> active);
    void iterate(double h, const ForceTerms& terms);
    void iterate_with_multipliers(double h, const ForceTerms& terms, std::span<const std::uint8_t> active);
    void finish(std::span<const std::uint8_t> active, std::span<SolveReport> reports);
    void step_explicit(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                       std::span<const std::uint8_t> active, std::span<SolveReport> reports);
    void evaluate_forces(double h, const ForceTerms& terms, std::span<const std::uint8_t> active);
    void write_trial(int wire);
    void evaluate_start(double h, bool linearised, const ForceTerms& terms);
    void restore(int wire);

    RodArrays& rods_;
    IntegratorSpec spec_;
    Vec3 gravity_;
    std::vector<std::unique_ptr<Work>> work_;
    std::unique_ptr<Workspaces> workspaces_;
    TrialState trial_, before_;  // before_: where known velocities come from, see ForceTerm::evaluate_start
    bool best_effort_ = false;
    std::vector<std::uint8_t> solved_, again_;      // [wires] between two rounds of multipliers
    std::vector<std::uint8_t> running_, evaluate_;  // [wires] not finished; takes part in the present evaluation of contact
    std::vector<std::uint8_t> with_spins_;          // [wires] solved a second time in this step, with spin angles
    std::vector<SolveReport> first_;                // [wires] what the first solve took
    std::vector<SpinRecord> spin_records_;
};

}  // namespace seldinger
