// The lockstep: trials of all systems, their evaluation, their decisions, until all have ended (one solve's begin and end:
// solver_step.cpp).
#include "newton/solver.h"

#include "core/error.h"
#include "core/prefetch.h"
#include "newton/solver_work.h"

#include <algorithm>
#include <numeric>

namespace seldinger {
namespace {

// of multipliers: misses shrink to a quarter and better in a round, stiffnesses seen to
constexpr int most_multiplier_rounds = 40;

}  // namespace

Solver::Solver(RodArrays& rods, const IntegratorSpec& spec, const Vec3& gravity, std::span<const int> partition)
    : rods_(rods), spec_(spec), gravity_(gravity)
{
    const int wires = rods.wire_count();
    std::vector<int> sizes(partition.begin(), partition.end());
    if (sizes.empty()) sizes.assign(wires, 1);
    SEL_ASSERT(std::accumulate(sizes.begin(), sizes.end(), 0) == wires);
    std::vector<int> capacities(wires);
    for (int w = 0; w < wires; ++w) capacities[w] = rods.capacity(w);
    first_wire_.push_back(0);
    int most_nodes = 0;
    for (const int size : sizes) {
        const std::span<const int> of_system = std::span(capacities).subspan(first_wire_.back(), size);
        system_of_.insert(system_of_.end(), size, system_count());
        work_.push_back(std::make_unique<Work>(first_wire_.back(), of_system, spec));
        work_.back()->newton.watch(seen_);
        most_nodes = std::max(most_nodes, std::accumulate(of_system.begin(), of_system.end(), 0));
        first_wire_.push_back(first_wire_.back() + size);
    }
    workspaces_ = std::make_unique<Workspaces>(most_nodes);
    for (TrialState* state : {&trial_, &before_})
        for (auto* array : {&state->x, &state->y, &state->z, &state->theta}) array->resize(rods.total_capacity());
    for (auto* mask : {&asked_, &running_, &with_spins_, &resumed_}) mask->resize(system_count());
    for (auto* mask : {&evaluate_, &solved_, &again_}) mask->resize(wires);
    first_.resize(wires);
    spin_records_.resize(system_count());
}

Solver::~Solver() = default;

void Solver::join(CoaxialGroup& group) { work_[system_of_[group.line()]]->newton.problem.join(group); }

// ---- the lockstep ---------------------------------------------------------------------------------------------------------

/// The system's solve, in the memory of this thread.
NewtonSystem& Solver::newton_of(int system)
{
    NewtonSystem& newton = work_[system]->newton;
    newton.work_in(workspaces_->here(), spec_.scheme == Scheme::Linearised);
    return newton;
}

/// Result of a loop over the systems below `end`, and the start of the next one.
void Solver::prefetch_after(int system, int end, SolveStage stage) const
{
    if (system + 2 < end) prefetch(work_[system + 2].get(), sizeof(Work));
    if (system + 1 < end) work_[system + 1]->newton.prefetch(stage);
}

bool Solver::any_active(int system, std::span<const std::uint8_t> active) const
{
    for (int w = first_wire_[system]; w < first_wire_[system + 1]; ++w)
        if (active[w]) return true;
    return false;
}

void Solver::set_evaluated(int system, bool evaluate)
{
    for (const WireProblem* wire : work_[system]->newton.problem.solved()) evaluate_[wire->wire] = evaluate;
}

void Solver::write_trial(int system)
{
    work_[system]->newton.problem.mirror();
    for (const WireProblem* wire : work_[system]->newton.problem.solved()) {
        const int begin = rods_.node_begin(wire->wire);
        const std::span<const double> q = wire->q.trial;
        for (int i = 0; i < wire->rod.n; ++i) {
            trial_.x[begin + i] = q[RodDofs::position(i, 0)];
            trial_.y[begin + i] = q[RodDofs::position(i, 1)];
            trial_.z[begin + i] = q[RodDofs::position(i, 2)];
            trial_.theta[begin + i] = q[RodDofs::spin(i)];
        }
    }
}

/// The next trial of a system that continues, for force terms to evaluate.
void Solver::prepare_trial(int system)
{
    NewtonSystem& newton = newton_of(system);
    set_evaluated(system, false);
    running_[system] = newton.running();
    if (!running_[system]) return;
    write_trial(system);
    set_evaluated(system, newton.problem.update());
}

void Solver::prepare_trials(std::span<const std::uint8_t> systems)
{
    std::fill(evaluate_.begin(), evaluate_.end(), std::uint8_t{0});
    for_each_item(system_count(), wire_grain, [&](int s) {
        running_[s] = 0;
        if (systems[s]) prepare_trial(s);
    });
}

/// Force terms where the wires that take part in their evaluation start from, with the velocities that they have there.
void Solver::evaluate_start(double h, bool linearised, const ForceTerms& terms)
{
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!evaluate_[w]) continue;
        const WireProblem& wire = problem_of(w);
        const int begin = rods_.node_begin(w);
        for (int i = 0; i < wire.rod.n; ++i) {
            const auto before = [&](int unknown) { return wire.q.start[unknown] - wire.time.known_move(unknown); };
            before_.x[begin + i] = before(RodDofs::position(i, 0));
            before_.y[begin + i] = before(RodDofs::position(i, 1));
            before_.z[begin + i] = before(RodDofs::position(i, 2));
            before_.theta[begin + i] = before(RodDofs::spin(i));
        }
    }
    terms.evaluate({trial_, h, evaluate_, &before_, linearised});
}

/// Until none is running. A system takes its decision and sets up its next trial in one go, while its arrays are in the cache.
void Solver::iterate(double h, const ForceTerms& terms)
{
    const auto any = [](const std::vector<std::uint8_t>& flags) {
        return std::find(flags.begin(), flags.end(), 1) != flags.end();
    };
    bool at_start = spec_.scheme == Scheme::Linearised;
    for (; any(running_); at_start = false) {
        stopped_ = stopped_ || (stop_asked_ && stop_asked_());
        if (stopped_) return abandon();
        const bool due = due_ && due_();
        if (any(evaluate_)) {
            if (at_start) evaluate_start(h, true, terms);
            else terms.evaluate({trial_, h, evaluate_});
        }
        for_each_system(SolveStage::Advance, [&](int s) {
            if (!running_[s]) return;
            NewtonSystem& newton = newton_of(s);
            newton.hurry(due);
            newton.advance(evaluate_[newton.problem.solved().front()->wire], terms);
            prepare_trial(s);
        });
    }
}

/// Ends the solves of all systems without a result: those that have converged may still lack their spin angles.
void Solver::abandon()
{
    for (int s = 0; s < system_count(); ++s) {
        if (asked_[s]) work_[s]->newton.abandon();
        running_[s] = 0;
    }
}

/// Newton from trials that have been prepared, and again each time that force terms renew their multipliers (D8).
void Solver::iterate_with_multipliers(double h, const ForceTerms& terms, std::span<const std::uint8_t> systems)
{
    iterate(h, terms);
    for (int round = 0; round <= most_multiplier_rounds; ++round) {
        std::fill(solved_.begin(), solved_.end(), std::uint8_t{0});
        for (int s = 0; s < system_count(); ++s) {
            const NewtonSystem& newton = work_[s]->newton;
            if (!systems[s] || !newton.converged() || newton.cut_short()) continue;
            for (const WireProblem* wire : newton.problem.solved()) solved_[wire->wire] = 1;
        }
        if (!terms.refine(solved_, again_)) return;
        for (int s = 0; s < system_count(); ++s) {
            resumed_[s] = any_active(s, again_);
            if (!resumed_[s]) continue;
            if (round < most_multiplier_rounds) newton_of(s).resume();
            else newton_of(s).stop_short();
        }
        prepare_trials(resumed_);
        iterate(h, terms);
    }
}

}  // namespace seldinger
