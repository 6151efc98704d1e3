#pragma once
// Forces on the wires as the solver sees them: one interface for all that adds to residual and tangent (contact with the wall or
// with another instrument), and the list of them in Newton's method.
//
// A term contributes f(q) to M a = f_elastic + f_external + sum of terms. In a step and in each sub-step:
//
//   begin_step, prepare                     start of the step is remembered, possible contacts are found
//     evaluate                              at each trial; the questions below are about that trial
//       admissible, add, feasible_step ...  residual and tangent, limits of the next trial
//     take                                  the trial becomes the base of the next ones
//   refine                                  outer update, once Newton has converged (multipliers); Newton's method continues where asked
//   commit                                  the last trial is the accepted state
//
// Optional functions have an empty default.

#include "core/stage_times.h"
#include "math/band_matrix.h"
#include "rod/rod_arrays.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace seldinger {

class BandedSolver;  // math/banded_solver.h

/// Trial configuration of all wires, in the concatenated layout of RodArrays.
struct TrialState {
    std::vector<double> x, y, z, theta;
};

/// A system as force terms see it: which wires are solved together, and where their unknowns are.
struct SystemUnknowns {
    const DofMap& map;
    std::span<const int> wires;  // [rods of the map] of the world
    /// Place of a wire in the map, -1: not among these.
    [[nodiscard]] int rod_of(int wire) const
    {
        for (int k = 0; k < static_cast<int>(wires.size()); ++k)
            if (wires[k] == wire) return k;
        return -1;
    }
};

/// Friction during the search for an equilibrium. Stuck: every contact keeps its first point of touch, and its force for the steps
/// that follow. Sliding: a contact slips during the search and holds where it comes to rest.
enum class Settling { Off, Stuck, Sliding };

/// Work of contact on a wire in a step, relative to the touched body, by its laws [J].
struct ContactWork {
    double normal = 0, friction = 0, rolling = 0;
};

/// What contacts have done on the way to a trial that the tangent did not foresee.
struct KinksPassed {
    double share = 1;      // of the way to the trial at which one has gone over a kink of the wall; 1: none has
    bool entered = false;  // one has come to lie in a kink that it did not lie in before
};

class ForceTerm {
public:
    virtual ~ForceTerm() = default;

    // ---- start of a step ----
    /// Remembers the start of the step.
    virtual void begin_step(RodArrays& /*rods*/) {}
    /// Takes the present node set (after feeding); nothing acts on wires with live[w] == 0 (still in the introducer).
    virtual void prepare(RodArrays& /*rods*/, std::span<const std::uint8_t> /*live*/) {}

    virtual void set_settling(Settling /*how*/) {}

    // ---- at a trial ----
    /// Evaluates the term on every wire with active[w] != 0 at the trial; h is the step [s]. Static: h = 0 (no damping, friction
    /// anchored at the accepted positions).
    virtual void evaluate(const TrialState& trial, double h, std::span<const std::uint8_t> active) = 0;
    /// The same at the accepted state, from the velocities known there, which have taken the wire from `before` to it within h.
    /// @param linearised  for one Newton step: force and tangent of add() are those of a function linear in the move from here
    /// (contact_law.h); else the force alone
    virtual void evaluate_start(const TrialState& start, const TrialState& /*before*/, double h, bool /*linearised*/,
                                std::span<const std::uint8_t> active)
    {
        evaluate(start, h, active);
    }
    /// False where the force would be infinite, or cannot be told: a trial that overlaps the wall beyond what the law allows, or
    /// moved farther than was searched.
    [[nodiscard]] virtual bool admissible(int /*wire*/) const { return true; }
    /// Adds -force to `residual` (laid out as RodDofs says) and -d(force)/dq to `tangent` if not null. `symmetric`: leave out the
    /// unsymmetric (sliding friction) part of the tangent.
    virtual void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const = 0;
    /// Coupling of unknowns of the system outside a wire's stencils (two wires, distant nodes of one). Adds -force to `residual`,
    /// in the system's unknowns, and -d(force)/dq to `tangent` if not null, beside its band. `symmetric`: as in add().
    virtual void couple(const SystemUnknowns& /*system*/, std::span<double> /*residual*/, BandedSolver* /*tangent*/,
                        bool /*symmetric*/) const
    {
    }
    /// Whether the tangent at the trial is unsymmetric (sliding friction).
    [[nodiscard]] virtual bool unsymmetric(int /*wire*/) const { return false; }
    /// Largest force on one edge of the wire at the trial [N]; the scale of a jump that a kink of the wall can make.
    [[nodiscard]] virtual double largest_force(int /*wire*/) const { return 0; }
    /// What rounding does to the force on a node at the trial [N], at most: no residual is smaller. 0: nothing that counts.
    [[nodiscard]] virtual double rounding(int /*wire*/) const { return 0; }
    /// Feasible step length: how much of the straight path from the last state taken to the trial is open, 1: all. A law that
    /// never overlaps refuses a trial whose path is not.
    [[nodiscard]] virtual double feasible_step(int /*wire*/) const { return 1; }
    /// Largest move [m] of any node in one Newton update for which no wall can be jumped (infinity: no limit).
    [[nodiscard]] virtual double move_limit(int /*wire*/) const { return std::numeric_limits<double>::infinity(); }
    /// The wire's last evaluated trial has been taken: the next ones start from there.
    virtual void take(int /*wire*/) {}
    /// Kinks of the wall, where the balance may be and of which the tangent knows nothing, that contacts have passed since the last
    /// trial that was taken (contact/valleys.h).
    [[nodiscard]] virtual KinksPassed crossed(int /*wire*/) { return {}; }
    /// The trial will be taken: adds to `residual` what leads the direction from it to the kinks that crossed() has found, and to
    /// the tangent of add() what belongs to it.
    virtual void admit_crossings(int /*wire*/, std::span<double> /*residual*/) {}
    /// The next trial is the start of the step again: an accepted trial is no base of it.
    virtual void start_again(int /*wire*/) {}
    /// Wires with solved[w] have converged at the trial that was evaluated last. Where the law has multipliers that have not
    /// settled there (D8), renews them and sets again[w] = 1: these wires are to be solved on from there. @return whether any
    virtual bool refine(std::span<const std::uint8_t> /*solved*/, std::span<std::uint8_t> /*again*/) { return false; }

    // ---- questions that decide how Newton works ----
    /// Whether its forces depend on the spin angles (by friction on the surface that they turn): then a solve without them must
    /// leave them where they were.
    [[nodiscard]] virtual bool follows_spins() const { return true; }
    /// Whether it exerts anything on a wire's system in the trial that was evaluated last: else it adds nothing to residual or tangent.
    [[nodiscard]] virtual bool acts(int /*wire*/) const { return true; }
    /// Whether its forces may jump within a hair's breadth (facets of a wall).
    [[nodiscard]] virtual bool may_jump() const { return true; }

    // ---- the accepted state ----
    /// The last evaluated trial becomes the accepted state of wires with active[w] != 0.
    virtual void commit(std::span<const std::uint8_t> /*active*/) {}
    /// Work done on the wire by moving contact partners, such as a wall, in the step that was evaluated last; stored_energy() does
    /// not include it [J].
    [[nodiscard]] virtual double work_from_outside(int /*wire*/) const { return 0; }
    /// In the step that was evaluated last.
    [[nodiscard]] virtual ContactWork contact_work(int /*wire*/) const { return {}; }
    /// The most energy that it can give back from where it was evaluated last [J].
    [[nodiscard]] virtual double stored_energy(int /*wire*/) const { return 0; }
    /// Whether the law allows no overlap at all, and so no change of nodes that makes one.
    [[nodiscard]] virtual bool never_overlaps() const { return false; }
    /// Whether a wire on its present nodes is clear of the wall; asked of laws that never overlap.
    [[nodiscard]] virtual bool is_clear(RodArrays& /*rods*/, int /*wire*/) { return true; }
    /// Where the time has gone since clear_times().
    [[nodiscard]] virtual StageTimes times() const { return {}; }
    virtual void clear_times() {}
    /// State from step to step, of all wires; save_wire: the bytes of save() in a world of this wire alone.
    virtual void save(std::vector<std::uint8_t>& /*bytes*/) {}
    virtual void save_wire(std::vector<std::uint8_t>& /*bytes*/, int /*wire*/) {}
    virtual void restore(const std::uint8_t*& /*bytes*/, const std::uint8_t* /*end*/) {}
    /// What save_wire() wrote, of a wire of the same model, becomes this wire's; the others stay as they are.
    virtual void restore_wire(const std::uint8_t*& /*bytes*/, const std::uint8_t* /*end*/, int /*wire*/) {}
};

/// The terms that act on a set of wires, asked as one. Without any, nothing acts and nothing limits a trial. Terms are not owned.
class ForceTerms {
public:
    ForceTerms() = default;
    ForceTerms(ForceTerm& term) : list_{&term} {}
    void add(ForceTerm& term) { list_.push_back(&term); }
    /// Whether there is nothing to evaluate or to add.
    [[nodiscard]] bool empty() const { return list_.empty(); }

    void begin_step(RodArrays& rods) const;
    void set_settling(Settling how) const;
    /// The sum of all.
    [[nodiscard]] StageTimes times() const;
    void clear_times() const;
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) const;
    void evaluate(const TrialState& trial, double h, std::span<const std::uint8_t> active) const;
    void evaluate_start(const TrialState& start, const TrialState& before, double h, bool linearised,
                        std::span<const std::uint8_t> active) const;
    /// Whether all terms admit the trial.
    [[nodiscard]] bool admissible(int wire) const;
    /// The sum of all.
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const;
    void couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const;
    /// Whether any term acts.
    [[nodiscard]] bool act(int wire) const;
    /// Whether any term's tangent is unsymmetric.
    [[nodiscard]] bool unsymmetric(int wire) const;
    [[nodiscard]] bool follows_spins() const;
    [[nodiscard]] bool may_jump() const;
    [[nodiscard]] bool never_overlaps() const;
    /// The largest.
    [[nodiscard]] double largest_force(int wire) const;
    /// The sum.
    [[nodiscard]] double rounding(int wire) const;
    [[nodiscard]] double stored_energy(int wire) const;
    [[nodiscard]] double work_from_outside(int wire) const;
    [[nodiscard]] ContactWork contact_work(int wire) const;
    /// The least.
    [[nodiscard]] double feasible_step(int wire) const;
    [[nodiscard]] double move_limit(int wire) const;
    void take(int wire) const;
    /// The least share.
    [[nodiscard]] KinksPassed crossed(int wire) const;
    void admit_crossings(int wire, std::span<double> residual) const;
    void start_again(int wire) const;
    /// Each term renews its own data. @param again  [wires] overwritten: those to be solved on
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) const;
    void commit(std::span<const std::uint8_t> active) const;
    /// Whether all terms are clear.
    [[nodiscard]] bool is_clear(RodArrays& rods, int wire) const;
    void save(std::vector<std::uint8_t>& bytes) const;
    void save_wire(std::vector<std::uint8_t>& bytes, int wire) const;
    void restore(const std::uint8_t*& bytes, const std::uint8_t* end) const;
    void restore_wire(const std::uint8_t*& bytes, const std::uint8_t* end, int wire) const;

private:
    std::vector<ForceTerm*> list_;
};

}  // namespace seldinger
