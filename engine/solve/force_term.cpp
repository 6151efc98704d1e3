// Joins the results of a list of force terms.

#include "solve/force_term.h"

#include <algorithm>

namespace seldinger {

void ForceTerms::begin_step(RodArrays& rods) const
{
    for (ForceTerm* term : list_) term->begin_step(rods);
}

void ForceTerms::set_settling(Settling how) const
{
    for (ForceTerm* term : list_) term->set_settling(how);
}

StageTimes ForceTerms::times() const
{
    StageTimes sum;
    for (const ForceTerm* term : list_) sum += term->times();
    return sum;
}

void ForceTerms::clear_times() const
{
    for (ForceTerm* term : list_) term->clear_times();
}

void ForceTerms::prepare(RodArrays& rods, std::span<const std::uint8_t> live) const
{
    for (ForceTerm* term : list_) term->prepare(rods, live);
}

void ForceTerms::evaluate(const TrialState& trial, double h, std::span<const std::uint8_t> active) const
{
    for (ForceTerm* term : list_) term->evaluate(trial, h, active);
}

void ForceTerms::evaluate_start(const TrialState& start, const TrialState& before, double h, bool linearised,
                                std::span<const std::uint8_t> active) const
{
    for (ForceTerm* term : list_) term->evaluate_start(start, before, h, linearised, active);
}

bool ForceTerms::admissible(int wire) const
{
    return std::all_of(list_.begin(), list_.end(), [&](const ForceTerm* term) { return term->admissible(wire); });
}

void ForceTerms::add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const
{
    for (const ForceTerm* term : list_) term->add(wire, residual, tangent, symmetric);
}

void ForceTerms::couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const
{
    for (const ForceTerm* term : list_) term->couple(system, residual, tangent, symmetric);
}

bool ForceTerms::act(int wire) const
{
    return std::any_of(list_.begin(), list_.end(), [&](const ForceTerm* term) { return term->acts(wire); });
}

bool ForceTerms::unsymmetric(int wire) const
{
    return std::any_of(list_.begin(), list_.end(), [&](const ForceTerm* term) { return term->unsymmetric(wire); });
}

bool ForceTerms::follows_spins() const
{
    return std::any_of(list_.begin(), list_.end(), [](const ForceTerm* term) { return term->follows_spins(); });
}

bool ForceTerms::may_jump() const
{
    return std::any_of(list_.begin(), list_.end(), [](const ForceTerm* term) { return term->may_jump(); });
}

bool ForceTerms::never_overlaps() const
{
    return std::any_of(list_.begin(), list_.end(), [](const ForceTerm* term) { return term->never_overlaps(); });
}

double ForceTerms::largest_force(int wire) const
{
    double most = 0;
    for (const ForceTerm* term : list_) most = std::max(most, term->largest_force(wire));
    return most;
}

double ForceTerms::rounding(int wire) const
{
    double sum = 0;
    for (const ForceTerm* term : list_) sum += term->rounding(wire);
    return sum;
}

double ForceTerms::stored_energy(int wire) const
{
    double sum = 0;
    for (const ForceTerm* term : list_) sum += term->stored_energy(wire);
    return sum;
}

double ForceTerms::work_from_outside(int wire) const
{
    double sum = 0;
    for (const ForceTerm* term : list_) sum += term->work_from_outside(wire);
    return sum;
}

ContactWork ForceTerms::contact_work(int wire) const
{
    ContactWork sum;
    for (const ForceTerm* term : list_) {
        const ContactWork work = term->contact_work(wire);
        sum.normal += work.normal;
        sum.friction += work.friction;
        sum.rolling += work.rolling;
    }
    return sum;
}

double ForceTerms::feasible_step(int wire) const
{
    double least = 1;
    for (const ForceTerm* term : list_) least = std::min(least, term->feasible_step(wire));
    return least;
}

double ForceTerms::move_limit(int wire) const
{
    double least = std::numeric_limits<double>::infinity();
    for (const ForceTerm* term : list_) least = std::min(least, term->move_limit(wire));
    return least;
}

void ForceTerms::take(int wire) const
{
    for (ForceTerm* term : list_) term->take(wire);
}

KinksPassed ForceTerms::crossed(int wire) const
{
    KinksPassed all;
    for (ForceTerm* term : list_) {
        const KinksPassed of = term->crossed(wire);
        all.share = std::min(all.share, of.share);
        all.entered = all.entered || of.entered;
    }
    return all;
}

void ForceTerms::admit_crossings(int wire, std::span<double> residual) const
{
    for (ForceTerm* term : list_) term->admit_crossings(wire, residual);
}

void ForceTerms::start_again(int wire) const
{
    for (ForceTerm* term : list_) term->start_again(wire);
}

bool ForceTerms::refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) const
{
    std::fill(again.begin(), again.end(), std::uint8_t{0});
    bool any = false;
    for (ForceTerm* term : list_)
        if (term->refine(solved, again)) any = true;
    return any;
}

void ForceTerms::commit(std::span<const std::uint8_t> active) const
{
    for (ForceTerm* term : list_) term->commit(active);
}

bool ForceTerms::is_clear(RodArrays& rods, int wire) const
{
    return std::all_of(list_.begin(), list_.end(),
                       [&](ForceTerm* term) { return !term->never_overlaps() || term->is_clear(rods, wire); });
}

void ForceTerms::save(std::vector<std::uint8_t>& bytes) const
{
    for (ForceTerm* term : list_) term->save(bytes);
}

void ForceTerms::save_wire(std::vector<std::uint8_t>& bytes, int wire) const
{
    for (ForceTerm* term : list_) term->save_wire(bytes, wire);
}

void ForceTerms::restore(const std::uint8_t*& bytes, const std::uint8_t* end) const
{
    for (ForceTerm* term : list_) term->restore(bytes, end);
}

void ForceTerms::restore_wire(const std::uint8_t*& bytes, const std::uint8_t* end, int wire) const
{
    for (ForceTerm* term : list_) term->restore_wire(bytes, end, wire);
}

}  // namespace seldinger
