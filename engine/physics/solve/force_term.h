#pragma once
// Forces on the wires that have to find what they act on, that jump, or that couple wires (contact, friction, holds of a group):
// one interface for what they add to residual and tangent. Weight, damping and springs of one wire: solve/external_loads.h.
//
// A term contributes f(q) to M a = f_elastic + f_external + sum of terms. In a step and in each sub-step:
//
//   begin_step, prepare                     start of the step is remembered, possible contacts are found
//     evaluate                              at each trial
//       answer, add, couple                 what Newton's method needs to know of it; residual and tangent
//     take                                  the trial becomes the base of the next ones
//   refine                                  outer update, once Newton has converged (multipliers); Newton's method continues where asked
//   commit                                  the last trial is the accepted state
//
// What but one law needs stays with that law. Optional functions have an empty default.

#include "core/stage_times.h"
#include "math/band_matrix.h"
#include "rod/rod_arrays.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

class BandedSolver;  // math/banded_solver.h
class StateWalk;     // core/state_walk.h

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

/// Friction during the search for an equilibrium. Stuck: every contact keeps its first point of touch, and its force for the
/// steps that follow. Sliding: a contact slips during the search and holds where it comes to rest.
enum class Settling { Off, Stuck, Sliding };

/// What of a term stays as it is from its construction on.
struct TermTraits {
    // forces depend on the spin angles (friction): a solve without these must leave them where they were
    bool follows_spins = true;
    bool may_jump = true;         // forces may jump within a hair's breadth (facets of a wall)
    bool never_overlaps = false;  // the law allows no overlap at all, and so no change of nodes that makes one
    std::vector<double>
        most_move;  // [wires] of any node in one Newton update, for which no wall can be jumped [m]; empty: no limit
};

/// A trial to be evaluated.
struct TermTrial {
    const TrialState& at;
    double h = 0;                          // step [s]; 0: static (no damping, friction anchored at the accepted positions)
    std::span<const std::uint8_t> active;  // [wires] these
    // at the accepted state, from the velocities known there: which have taken the wire from `before` to it within h
    const TrialState* before = nullptr;
    bool linearised = false;  // for one Newton step: force and tangent are those of a function linear in the move
                              // (kernels/shared/friction_law.h)
};

/// Work of contact on a wire in a step, relative to the touched body, by its laws [J].
struct ContactWork {
    double normal = 0, friction = 0, rolling = 0;
    ContactWork& operator+=(const ContactWork& other);
};

/// Energies of the step that was evaluated last.
struct TermEnergies {
    ContactWork work;
    double from_outside = 0;  // work done on the wire by moving contact partners, such as a wall; not in stored [J]
    double stored = 0;        // the most that can be given back [J]
    // of a term that is no contact, such as holds: its work on the wire, its force on the wire as a whole
    double applied = 0;                 // [J]
    Vec3 applied_force = Vec3::Zero();  // [N]
    // of forces that the program gives
    double given = 0;                 // [J]
    Vec3 given_force = Vec3::Zero();  // [N]
    TermEnergies& operator+=(const TermEnergies& other);
};

/// What contacts have done on the way from the base to a trial that the tangent did not foresee (contact/valleys.h): the balance
/// may be in a kink of the wall.
struct KinksPassed {
    double share = 1;      // of the way at which one has gone over a kink; 1: none has
    double width = 0;      // of the kink, on that way
    bool entered = false;  // one has come to lie in a kink that it did not lie in before
    KinksPassed& operator+=(const KinksPassed& other);
};

/// A kink that a contact has gone over, as the base sees it (newton/kinks.h).
struct Kink {
    int node;            // of the wire: the contact is between it and the next one
    double bary;         // at (1 - bary) of the first and bary of the second
    Vec3 across;         // w [-]
    double force;        // f, at the base [N]
    double rest, width;  // of z [m]
};

/// What a term is asked of a wire; what costs more is asked for alone.
enum class Ask { Trial, Kinks, Energies };

/// A term's answer about the trial that was evaluated last.
struct TermAnswer {
    // Ask::Trial
    bool admissible = true;  // false where the force would be infinite or is not known: too deep, moved farther than was searched
    bool acts = true;          // false: nothing is added to residual or tangent of the wire's system
    bool unsymmetric = false;  // the tangent (sliding friction)
    double open = 1;           // share of the straight path from the base to the trial; a law that never overlaps asks for all
    double largest_force = 0;  // on one edge [N]: the scale of a jump that a kink of the wall can make
    double rounding = 0;       // of the force on a node [N]: no smaller residual is looked for. 0: nothing that counts
    // that bound of it which always holds [N]: a residual below it is left where Newton's method does not lower it
    double rounding_most = 0;
    KinksPassed kinks;      // Ask::Kinks
    TermEnergies energies;  // Ask::Energies
    /// Answer of two terms together.
    TermAnswer& operator+=(const TermAnswer& other);
};

class ForceTerm {
public:
    virtual ~ForceTerm() = default;
    [[nodiscard]] const TermTraits& traits() const { return traits_; }

    // ---- start of a step ----
    /// Remembers the start of the step.
    virtual void begin_step(RodArrays& /*rods*/, Settling /*how*/) {}
    /// Takes the present node set (after feeding); nothing acts on wires with live[w] == 0 (still in the introducer,
    /// or not in this sub-step).
    virtual void prepare(RodArrays& /*rods*/, std::span<const std::uint8_t> /*live*/) {}

    // ---- at a trial ----
    virtual void evaluate(const TermTrial& trial) = 0;
    [[nodiscard]] virtual TermAnswer answer(int /*wire*/, Ask /*what*/) { return {}; }
    /// Adds -force to `residual` (laid out as RodDofs says) and -d(force)/dq to `tangent` if not null. `symmetric`: leave out the
    /// unsymmetric (sliding friction) part of the tangent.
    virtual void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const = 0;
    /// Coupling of unknowns of the system outside a wire's stencils (two wires, distant nodes of one). Adds -force to `residual`,
    /// in the system's unknowns, and -d(force)/dq to `tangent` if not null, beside its band. `symmetric`: as in add().
    virtual void couple(const SystemUnknowns& /*system*/, std::span<double> /*residual*/, BandedSolver* /*tangent*/,
                        bool /*symmetric*/) const
    {
    }
    /// Until the next evaluation, add() gives a symmetric part of the tangent that is positive semidefinite, where the term can
    /// make one.
    virtual void make_positive(int /*wire*/) {}
    /// Kinks that Ask::Kinks has found to be passed; valid until the next call.
    [[nodiscard]] virtual std::span<const Kink> kinks(int /*wire*/) { return {}; }
    enum class Base { Trial, Start };
    /// The next trials start from the wire's last evaluated one, or again from the start of the step.
    /// @param kinks  not empty: a residual, to which is added what leads the direction from the trial to the kinks that
    /// Ask::Kinks has found; the tangent of add() takes in what belongs to it
    virtual void take(int /*wire*/, Base /*base*/, std::span<double> /*kinks*/) {}
    /// Wires with solved[w] have converged at the trial that was evaluated last. Where the law has multipliers that have not
    /// settled there (D8), renews them and sets again[w] = 1: these wires are to be solved on from there. @return whether any
    virtual bool refine(std::span<const std::uint8_t> /*solved*/, std::span<std::uint8_t> /*again*/) { return false; }

    // ---- the accepted state ----
    /// The last evaluated trial becomes the accepted state of wires with active[w] != 0.
    virtual void commit(std::span<const std::uint8_t> /*active*/) {}
    /// Its rows of the state, for one wire (core/state_walk.h): the same whatever else is in the world.
    virtual void walk_state(StateWalk& /*walk*/, int /*wire*/) {}

    StageTimes times;  // where the time has gone, for whoever reads and clears it

protected:
    TermTraits traits_;  // set by the constructor
};

/// The terms that act on a set of wires, asked as one. Without any, nothing acts and nothing limits a trial. Terms are not owned.
class ForceTerms {
public:
    ForceTerms() = default;
    ForceTerms(ForceTerm& term) { add(term); }
    void add(ForceTerm& term);
    /// Whether there is nothing to evaluate or to add.
    [[nodiscard]] bool empty() const { return list_.empty(); }
    [[nodiscard]] int count() const { return static_cast<int>(list_.size()); }
    /// Traits of all terms together.
    [[nodiscard]] const TermTraits& traits() const { return traits_; }
    /// TermTraits::most_move; infinity: no limit.
    [[nodiscard]] double most_move(int wire) const;
    /// The sum of all since clear_times().
    [[nodiscard]] StageTimes times() const;
    void clear_times() const;

    void begin_step(RodArrays& rods, Settling how = Settling::Off) const;
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) const;
    void evaluate(const TermTrial& trial) const;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) const;
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const;
    void couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const;
    void make_positive(int wire) const;
    void take(int wire, ForceTerm::Base base, std::span<double> kinks = {}) const;
    /// f(kink) of each that Ask::Kinks has found.
    template <class F>
    void for_each_kink(int wire, const F& f) const
    {
        for (ForceTerm* term : list_)
            for (const Kink& kink : term->kinks(wire)) f(kink);
    }
    /// Each term renews its own data. @param again  [wires] overwritten: those to be solved on
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) const;
    void commit(std::span<const std::uint8_t> active) const;
    void walk_state(StateWalk& walk, int wire) const;

private:
    std::vector<ForceTerm*> list_;
    TermTraits traits_{false, false, false, {}};
};

}  // namespace seldinger
