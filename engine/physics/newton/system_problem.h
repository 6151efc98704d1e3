#pragma once
// The equations of one system, the wires that are solved together: their unknowns in one vector, their tangents in one band with
// entries far from it for the coupling (math/banded_solver.h). A wire that takes no part in a step (still in its introducer) has
// no unknowns in it. Convergence: each wire meets its own tolerance, so that a system whose wires do not touch solves none of
// them less far than it would be alone.

#include "math/banded_solver.h"
#include "solve/coaxial_problem.h"
#include "solve/force_term.h"
#include "solve/wire_problem.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace seldinger {

class SystemProblem {
public:
    /// Buffers of one thread for one system after the other. For 1,000 wires the matrices alone would exceed any cache.
    struct Workspace {
        /// @param nodes  of all wires of the largest system
        explicit Workspace(int nodes)
            : matrix(RodDofs::count(nodes)), term_tangent(RodDofs::count(nodes)), numbers(vectors * RodDofs::count(nodes))
        {
        }
        BandMatrix::Storage matrix, term_tangent;
        std::vector<double> numbers;
        static constexpr int vectors = 5;
    };

    /// @param first_wire  of the world; the others of the system follow       @param capacities  nodes of each
    SystemProblem(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec);

    /// Instruments of the system that share a centreline; to be called before the first step. The group outlives this.
    void join(CoaxialGroup& group);
    /// Takes over the start of the step and the constraints at its end, of the wires with active[w] != 0. No allocation once
    /// clamps have been seen. @param constraints  [wires of the world]
    void begin(RodArrays& rods, std::span<const WireConstraints> constraints, std::span<const std::uint8_t> active,
               const StepEquations& step);
    /// Wires that take part in the step.
    [[nodiscard]] std::span<WireProblem* const> solved() const { return solved_; }
    /// A wire of the system, by its number in the world.
    [[nodiscard]] const WireProblem& wire(int wire) const { return *wires_[wire - first_wire_]; }

    /// Works in `workspace` until the next call: to be called before anything else, by whatever thread. Entries of the matrix
    /// outlive that in a static solve only, which goes back to them, and its factors unless `once`, where it is solved with as
    /// soon as it is factorised and never again. @return memory [unknowns] for the caller
    std::span<double> work_in(Workspace& workspace, bool once);
    /// Its arrays will be needed soon.
    void prefetch(SolveStage next) const;

    /// Whether spin angles are left out: they keep their values, and their equations and twist are ignored.
    [[nodiscard]] bool without_spins() const { return !solved_.empty() && !solved_.front()->frames.spins; }
    /// Takes spin angles in again, as they were at the start of the step.
    void take_spins_in();
    /// The same at a trial that a solve without them has found. It evaluates all of R there and reports whether the equations of
    /// the spins hold too, to the tolerance: then the trial solves the whole. Where no force follows the spins these
    /// first follow the shape so that no wire is twisted, which is where torsion, far faster than bending, would take them.
    [[nodiscard]] bool spins_hold(const ForceTerms& terms);

    /// Takes dependent unknowns of the trial (passengers' positions) from those that they follow.
    void mirror();
    /// Frames at the trial. @return false if anything is not finite
    [[nodiscard]] bool update();
    /// What terms say of each wire at the trial that they were evaluated at: WireProblem::terms.
    void ask(const ForceTerms& terms);
    /// Answer for all wires together, see TermAnswer.
    [[nodiscard]] bool admissible() const;
    [[nodiscard]] double open() const;
    [[nodiscard]] double largest_force() const;
    /// R at the trial into `residual`; update() and ask() must have run there. @return false if not finite
    [[nodiscard]] bool evaluate_residual(const ForceTerms& terms);
    /// Kinks that terms have passed since the base (Ask::Kinks).
    [[nodiscard]] KinksPassed crossed(const ForceTerms& terms) const;
    /// The trial is the base from now on. @param kinks  what leads the next direction to those goes into R and the terms' share
    /// of it
    void take(const ForceTerms& terms, bool kinks);
    /// The same with force terms taken as linear from where assemble_tangent last ran, `base`: evaluates none of them.
    [[nodiscard]] bool evaluate_linear_terms(const ForceTerms& terms, std::span<const double> base);
    /// dR/dq at the trial into `linear`, prescribed unknowns not yet fixed. @param symmetric  its symmetric part, as far as it is
    /// not symmetric
    void assemble_tangent(HessianMode mode, bool symmetric, const ForceTerms& terms);
    /// Whether the tangent last assembled is still there for evaluate_linear_terms() after other systems have been worked on:
    /// that of instruments that touch is.
    [[nodiscard]] bool keeps_tangent() const { return several_rods() && !linear.far.empty() && linear.condensed.empty(); }
    /// Whether dR/dq is not symmetric even without force terms.
    [[nodiscard]] bool unsymmetric() const;
    /// Whether it is made of instruments that are a rod each, which may touch.
    [[nodiscard]] bool several_rods() const { return wires_.size() > 1 && coaxial_.empty(); }
    [[nodiscard]] bool shares_centrelines() const { return !solved_coaxial_.empty(); }
    [[nodiscard]] bool conserving() const { return !solved_.empty() && solved_.front()->time.conserving(); }

    /// Notes each wire's residual at the trial and what rounding adds to its tolerance.
    void note_residuals();
    /// Whether all that were noted are within their tolerances.
    [[nodiscard]] bool balanced() const;
    /// Whether one that is balanced may be further from balance than rounding explains: see NewtonSystem::improves().
    [[nodiscard]] bool may_improve() const;
    /// The largest of those that were noted, of its tolerance [-].
    [[nodiscard]] double residual_share() const;
    /// Whether all at the trial are below `share` of them.
    [[nodiscard]] bool residual_below(double share) const;
    /// sqrt(sum d^2) over all unknowns [m]; angles times the edge length.
    [[nodiscard]] double norm(std::span<const double> d) const;
    [[nodiscard]] double largest_move(std::span<const double> d) const;
    [[nodiscard]] double largest_surface_move(std::span<const double> d) const;
    [[nodiscard]] double largest_turn(std::span<const double> d) const;
    [[nodiscard]] double smallest_radius() const;
    /// Length scale of an edge, on average; the shortest wire edges' [m].
    [[nodiscard]] double length_scale() const;
    /// R.d over the free unknowns [J]
    [[nodiscard]] double residual_along(std::span<const double> d) const;
    [[nodiscard]] bool at_prescribed() const;
    void set_prescribed();

    // Tensions of the mixed equations, see mixed_tension.h.
    void set_base();
    void predict_tension(std::span<const double> d, double alpha);
    void correct_tension(std::span<const double> correction);
    void mixed_residual(std::span<double> out) const;
    void take_linear_tensions();

    [[nodiscard]] bool far_from_reference() const;
    void move_reference();
    void keep_reference();
    void restore_reference();
    void return_to_start();
    /// Makes the trial the accepted state in the wires' arrays (velocities zero when static).
    void commit(bool newmark);
    /// Elastic energy at the trial; instruments that share a centreline have it on the first of them [J].
    [[nodiscard]] double elastic_energy(const WireProblem& wire) const;
    [[nodiscard]] StepLosses losses(const WireProblem& wire) const;
    /// Hand forces and torques of the group led by wire `line`.
    [[nodiscard]] CoaxialHands coaxial_hands(int line) const;

    [[nodiscard]] int size() const { return map.size(); }
    [[nodiscard]] int capacity() const { return static_cast<int>(start.size()); }  // unknowns
    /// First unknown of a wire among the system's.
    [[nodiscard]] int first_of(const WireProblem& wire) const { return static_cast<int>(wire.q.start.data() - start.data()); }
    [[nodiscard]] std::span<const double> of_wire(const WireProblem& wire, std::span<const double> d) const
    {
        return d.subspan(static_cast<std::size_t>(first_of(wire)), static_cast<std::size_t>(wire.size()));
    }

    DofMap map;  // of the wires that take part
    BandedSolver linear;
    Motion motion = Motion::Implicit;
    std::vector<double> start, trial;  // [capacity] q_0, q
    std::vector<double> residual;      // R at trial
    std::vector<double> inertia;       // mass [kg] or spin inertia [kg m^2]
    std::vector<double> prescribed_value;
    std::vector<std::uint8_t> prescribed;  // 1: fixed at prescribed_value

private:
    void share_out();
    void share_scratch();
    void order_nodes();
    void add_coaxial_tangents(HessianMode mode, bool symmetric, bool terms);
    [[nodiscard]] SystemUnknowns unknowns() const { return {map, solved_wires_}; }
    [[nodiscard]] bool finish_residual();
    [[nodiscard]] bool acted_on(const ForceTerms& terms) const;

    int first_wire_ = 0;
    std::vector<std::unique_ptr<WireProblem>> wires_;
    std::vector<std::unique_ptr<CoaxialProblem>> coaxial_;         // groups of the system
    std::vector<CoaxialProblem*> solved_coaxial_;                  // that take part
    FarEntries far_of_terms_;                                      // where there are groups: linear.far without what is theirs
    std::vector<WireProblem*> solved_;
    std::vector<int> solved_wires_, solved_nodes_;
    std::vector<int> order_;  // [nodes] in which they are eliminated where wires couple all along; empty: not asked for yet
    std::vector<double> from_hub_;   // [nodes] scratch of it
    // [capacity] in the workspace; the last is the terms' residual at their last evaluation
    std::span<double> scratch_, velocities_, split_, term_residual_;
    BandMatrix term_tangent_;  // at the last assemble_tangent
    bool terms_act_ = false;   // in it; else it has not been filled
};

}  // namespace seldinger
