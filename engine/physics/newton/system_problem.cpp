// One system: its wires' unknowns laid out, their equations joined.
#include "newton/system_problem.h"

#include "core/prefetch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace seldinger {

SystemProblem::SystemProblem(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec)
    : linear(RodDofs::count(std::accumulate(capacities.begin(), capacities.end(), 0))),
      first_wire_(first_wire),
      term_tangent_(RodDofs::count(std::accumulate(capacities.begin(), capacities.end(), 0)))
{
    const int unknowns = RodDofs::count(std::accumulate(capacities.begin(), capacities.end(), 0));
    for (auto* array : {&start, &trial, &residual, &inertia, &prescribed_value}) array->resize(unknowns);
    prescribed.resize(unknowns);
    for (const int capacity : capacities) {
        wires_.push_back(std::make_unique<WireProblem>(capacity, spec));
        wires_.back()->wire = first_wire + static_cast<int>(wires_.size()) - 1;
    }
    solved_.reserve(wires_.size());
    solved_wires_.reserve(wires_.size());
    solved_nodes_.reserve(wires_.size());
}

void SystemProblem::join(CoaxialGroup& group)
{
    std::vector<WireProblem*> members;
    for (const int w : group.wires) members.push_back(wires_[w - first_wire_].get());
    coaxial_.push_back(std::make_unique<CoaxialProblem>(group, std::move(members)));
    solved_coaxial_.reserve(coaxial_.size());
}

// ---- start of a step --------------------------------------------------------------------------------------------------------

void SystemProblem::begin(RodArrays& rods, std::span<const WireConstraints> constraints, std::span<const std::uint8_t> active,
                          const StepEquations& step)
{
    motion = step.motion;
    solved_.clear();
    solved_wires_.clear();
    solved_nodes_.clear();
    order_.clear();
    for (const auto& wire : wires_) {
        if (!active[wire->wire]) continue;
        solved_.push_back(wire.get());
        solved_wires_.push_back(wire->wire);
        solved_nodes_.push_back(rods.node_count(wire->wire));
    }
    map.lay_out(solved_nodes_);
    share_out();
    bool leave = true;
    for (WireProblem* wire : solved_) {
        wire->begin(rods.view(wire->wire), constraints[wire->wire], step);
        leave = leave && wire->may_leave(step.spins);
    }
    linear.set_fourth(!leave);
    for (WireProblem* wire : solved_) wire->begin_frames(step.spec, leave);
    solved_coaxial_.clear();
    for (const auto& group : coaxial_) {
        if (!active[group->line().wire]) continue;
        group->begin();
        solved_coaxial_.push_back(group.get());
    }
}

/// Each wire's part of the vectors.
void SystemProblem::share_out()
{
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        const std::size_t first = map.first(static_cast<int>(k)), count = RodDofs::count(solved_nodes_[k]);
        const auto part = [&](auto& array) { return std::span(array).subspan(first, count); };
        solved_[k]->q = {part(start), part(trial), part(residual), part(inertia), part(prescribed_value), part(prescribed), {},
                         {},          {}};
    }
    share_scratch();
}

void SystemProblem::share_scratch()
{
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        const std::size_t first = map.first(static_cast<int>(k)), count = RodDofs::count(solved_nodes_[k]);
        WireUnknowns& q = solved_[k]->q;
        q.scratch = scratch_.subspan(first, count);
        q.velocities = velocities_.subspan(first, count);
        q.split = split_.subspan(first, count);
    }
}

std::span<double> SystemProblem::work_in(Workspace& workspace, bool once)
{
    const bool lasting = motion == Motion::Static;
    linear.band.use_rows(lasting ? nullptr : &workspace.matrix);
    linear.band.use_factor(lasting || !once ? nullptr : &workspace.matrix);
    term_tangent_.use_rows(lasting || several_rods() ? nullptr : &workspace.term_tangent);
    std::span<double> left = workspace.numbers;
    const std::size_t count = start.size();
    for (auto* part : {&scratch_, &velocities_, &split_, &term_residual_}) {
        *part = left.first(count);
        left = left.subspan(count);
    }
    share_scratch();
    return left.first(count);
}

void SystemProblem::prefetch(SolveStage next) const
{
    seldinger::prefetch(start, size());
    seldinger::prefetch(trial, size());
    if (next != SolveStage::Commit) seldinger::prefetch(inertia, size());
    if (next == SolveStage::Advance) seldinger::prefetch(residual, size());
    for (const WireProblem* wire : solved_) wire->prefetch(next);
}

void SystemProblem::take_spins_in()
{
    linear.set_fourth(true);
    for (WireProblem* wire : solved_) wire->take_spins_in();
}

bool SystemProblem::spins_hold(const ForceTerms& terms)
{
    take_spins_in();
    if (!terms.traits().follows_spins && update())
        for (WireProblem* wire : solved_) wire->untwist();
    if (!update() || !evaluate_residual(terms)) return false;
    return std::all_of(solved_.begin(), solved_.end(), [](const WireProblem* wire) { return wire->spins_balanced(); });
}

// ---- residual and tangent -----------------------------------------------------------------------------------------------------

void SystemProblem::mirror()
{
    for (CoaxialProblem* group : solved_coaxial_) group->mirror();
}

bool SystemProblem::update()
{
    mirror();
    for (WireProblem* wire : solved_)
        if (!wire->update()) return false;
    return true;
}

bool SystemProblem::evaluate_residual(const ForceTerms& terms)
{
    for (WireProblem* wire : solved_) wire->evaluate_residual();
    for (CoaxialProblem* group : solved_coaxial_) group->add_residual();
    const std::size_t count = size();
    if (!terms.empty()) std::fill_n(term_residual_.begin(), count, 0.0);
    if (acted_on(terms)) {
        for (std::size_t k = 0; k < solved_.size(); ++k)
            terms.add(solved_wires_[k], term_residual_.subspan(map.first(static_cast<int>(k)), solved_[k]->size()), nullptr,
                      true);
        terms.couple(unknowns(), term_residual_.first(count), nullptr, true);
        for (std::size_t i = 0; i < count; ++i) residual[i] += term_residual_[i];
    }
    return finish_residual();
}

// Forces on instruments that share a centreline are folded into those of the line: there nothing is admitted.
KinksPassed SystemProblem::crossed(const ForceTerms& terms) const
{
    KinksPassed all;
    for (const int wire : solved_wires_)
        if (solved_coaxial_.empty()) all += terms.answer(wire, Ask::Kinks).kinks;
    return all;
}

void SystemProblem::take(const ForceTerms& terms, bool kinks)
{
    const std::size_t count = size();
    if (kinks) std::fill_n(scratch_.begin(), count, 0.0);
    for (std::size_t k = 0; k < solved_.size(); ++k)
        terms.take(solved_wires_[k], ForceTerm::Base::Trial,
                   kinks ? scratch_.subspan(map.first(static_cast<int>(k)), solved_[k]->size()) : std::span<double>());
    if (!kinks) return;
    for (std::size_t i = 0; i < count; ++i) {
        residual[i] += scratch_[i];
        term_residual_[i] += scratch_[i];
    }
}

bool SystemProblem::evaluate_linear_terms(const ForceTerms& terms, std::span<const double> base)
{
    for (WireProblem* wire : solved_) wire->evaluate_residual();
    for (CoaxialProblem* group : solved_coaxial_) group->add_residual();
    const int count = size();
    if (!terms.empty() && !terms_act_)
        for (int i = 0; i < count; ++i) residual[i] += term_residual_[i];
    if (terms_act_) {
        for (int i = 0; i < count; ++i) velocities_[i] = trial[i] - base[i];
        term_tangent_.multiply(velocities_, scratch_);
        (solved_coaxial_.empty() ? linear.far : far_of_terms_).add_product(velocities_, scratch_);
        linear.condensed.add_product(velocities_, scratch_);
        for (int i = 0; i < count; ++i) residual[i] += term_residual_[i] + scratch_[i];
    }
    return finish_residual();
}

/// Whether a term acts on any of its wires.
bool SystemProblem::acted_on(const ForceTerms& terms) const
{
    return !terms.empty() &&
           std::any_of(solved_.begin(), solved_.end(), [](const WireProblem* wire) { return wire->terms.acts; });
}

/// @return false if not finite
bool SystemProblem::finish_residual()
{
    for (CoaxialProblem* group : solved_coaxial_) group->fold_residual();
    for (const WireProblem* wire : solved_)
        if (wire->q.prescribed[RodDofs::unused(wire->rod.n)]) wire->q.residual[RodDofs::unused(wire->rod.n)] = 0;
    double sum = 0;
    for (int i = 0; i < size(); ++i) sum += std::abs(residual[i]);
    return std::isfinite(sum);
}

void SystemProblem::assemble_tangent(HessianMode mode, bool symmetric, const ForceTerms& terms)
{
    const int count = size();
    linear.reset(count);
    terms_act_ = acted_on(terms);
    if (terms_act_) term_tangent_.reset(count);
    for (WireProblem* wire : solved_) {
        const int first = first_of(*wire);
        BandRows part = linear.band.part(first, wire->size());
        wire->assemble_elastic(mode, symmetric, part);
        if (terms_act_) {
            BandRows of_terms = term_tangent_.part(first, wire->size());
            terms.add(wire->wire, wire->q.scratch, &of_terms, symmetric);
            if (wire->role != WireRole::Passenger) part.add_scaled(of_terms, 1);
        }
        wire->add_stiffness_damping(part);
    }
    if (terms_act_) terms.couple(unknowns(), scratch_.first(static_cast<std::size_t>(count)), &linear, symmetric);
    add_coaxial_tangents(mode, symmetric, terms_act_);
    if (!linear.far.empty() && order_.empty() && wires_.size() > 1) order_nodes();
}

void SystemProblem::add_coaxial_tangents(HessianMode mode, bool symmetric, bool terms)
{
    if (solved_coaxial_.empty()) return;
    far_of_terms_.clear();
    far_of_terms_.add_scaled(linear.far, 1);
    for (CoaxialProblem* group : solved_coaxial_) {
        group->add_tangent(mode, symmetric, start.data(), linear.band, linear.far);
        if (!terms) continue;
        group->fold_tangent(term_tangent_, start.data(), linear.band, linear.far);
        group->fold_condensed(start.data(), linear.condensed);
    }
}

/// Nodes of all wires in turn, the farthest from their hubs first, so that neighbours in space are near each other in the
/// factors.
void SystemProblem::order_nodes()
{
    const int count = size() / RodDofs::per_node;
    from_hub_.resize(count);
    order_.resize(count);
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        const RodView& rod = solved_[k]->rod;
        double* from_hub = from_hub_.data() + RodDofs::node(map.first(static_cast<int>(k)));
        from_hub[rod.n - 1] = 0;
        for (int i = rod.n - 2; i >= 0; --i) from_hub[i] = from_hub[i + 1] + rod.rest_length[i];
    }
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(),
              [&](int a, int b) { return from_hub_[a] != from_hub_[b] ? from_hub_[a] > from_hub_[b] : a < b; });
    linear.set_order(order_);
}

void SystemProblem::commit(bool newmark)
{
    for (WireProblem* wire : solved_) wire->commit(newmark || several_rods());
    for (CoaxialProblem* group : solved_coaxial_) group->commit();
}

double SystemProblem::elastic_energy(const WireProblem& wire) const
{
    if (wire.role == WireRole::Alone) return seldinger::elastic_energy(wire.rod, wire.clamps, wire.frames);
    for (const CoaxialProblem* group : solved_coaxial_)
        if (&group->line() == &wire) return group->energy();
    return 0;
}

StepLosses SystemProblem::losses(const WireProblem& wire) const
{
    StepLosses losses = wire.losses();
    for (CoaxialProblem* group : solved_coaxial_)
        if (&group->line() == &wire) losses.strain_work = group->strain_work();
    return losses;
}

CoaxialHands SystemProblem::coaxial_hands(int line) const
{
    for (const CoaxialProblem* group : solved_coaxial_)
        if (group->line().wire == line) return group->hands();
    return {};
}

bool SystemProblem::unsymmetric() const
{
    return std::any_of(solved_.begin(), solved_.end(), [](const WireProblem* wire) { return wire->unsymmetric(); });
}

}  // namespace seldinger
