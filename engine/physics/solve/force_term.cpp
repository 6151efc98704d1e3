// Joins the results of a list of force terms.
#include "solve/force_term.h"

#include <algorithm>
#include <limits>

namespace seldinger {

ContactWork& ContactWork::operator+=(const ContactWork& other)
{
    normal += other.normal;
    friction += other.friction;
    rolling += other.rolling;
    return *this;
}

TermEnergies& TermEnergies::operator+=(const TermEnergies& other)
{
    work += other.work;
    from_outside += other.from_outside;
    stored += other.stored;
    applied += other.applied;
    applied_force += other.applied_force;
    given += other.given;
    given_force += other.given_force;
    return *this;
}

KinksPassed& KinksPassed::operator+=(const KinksPassed& other)
{
    if (other.share < share) width = other.width;
    share = std::min(share, other.share);
    entered = entered || other.entered;
    return *this;
}

TermAnswer& TermAnswer::operator+=(const TermAnswer& other)
{
    admissible = admissible && other.admissible;
    acts = acts || other.acts;
    unsymmetric = unsymmetric || other.unsymmetric;
    open = std::min(open, other.open);
    largest_force = std::max(largest_force, other.largest_force);
    rounding += other.rounding;
    rounding_most += other.rounding_most;
    kinks += other.kinks;
    energies += other.energies;
    return *this;
}

void ForceTerms::add(ForceTerm& term)
{
    list_.push_back(&term);
    const TermTraits& own = term.traits();
    traits_.follows_spins = traits_.follows_spins || own.follows_spins;
    traits_.may_jump = traits_.may_jump || own.may_jump;
    traits_.never_overlaps = traits_.never_overlaps || own.never_overlaps;
    if (traits_.most_move.size() < own.most_move.size())
        traits_.most_move.resize(own.most_move.size(), std::numeric_limits<double>::infinity());
    for (std::size_t w = 0; w < own.most_move.size(); ++w)
        traits_.most_move[w] = std::min(traits_.most_move[w], own.most_move[w]);
}

double ForceTerms::most_move(int wire) const
{
    return traits_.most_move.empty() ? std::numeric_limits<double>::infinity()
                                     : traits_.most_move[static_cast<std::size_t>(wire)];
}

StageTimes ForceTerms::times() const
{
    StageTimes sum;
    for (const ForceTerm* term : list_) sum += term->times;
    return sum;
}

void ForceTerms::clear_times() const
{
    for (ForceTerm* term : list_) term->times = {};
}

void ForceTerms::begin_step(RodArrays& rods, Settling how) const
{
    for (ForceTerm* term : list_) term->begin_step(rods, how);
}

void ForceTerms::prepare(RodArrays& rods, std::span<const std::uint8_t> live) const
{
    for (ForceTerm* term : list_) term->prepare(rods, live);
}

void ForceTerms::evaluate(const TermTrial& trial) const
{
    for (ForceTerm* term : list_) term->evaluate(trial);
}

TermAnswer ForceTerms::answer(int wire, Ask what) const
{
    TermAnswer all;
    all.acts = false;
    for (ForceTerm* term : list_) all += term->answer(wire, what);
    return all;
}

void ForceTerms::add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const
{
    for (const ForceTerm* term : list_) term->add(wire, residual, tangent, symmetric);
}

void ForceTerms::couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const
{
    for (const ForceTerm* term : list_) term->couple(system, residual, tangent, symmetric);
}

void ForceTerms::make_positive(int wire) const
{
    for (ForceTerm* term : list_) term->make_positive(wire);
}

void ForceTerms::take(int wire, ForceTerm::Base base, std::span<double> kinks) const
{
    for (ForceTerm* term : list_) term->take(wire, base, kinks);
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

void ForceTerms::walk_state(StateWalk& walk, int wire) const
{
    for (ForceTerm* term : list_) term->walk_state(walk, wire);
}

}  // namespace seldinger
