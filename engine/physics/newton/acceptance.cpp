// How a trial is judged: the two tests of acceptance.h.
#include "newton/acceptance.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

double NewtonAcceptance::after_refusal(double open) const
{
    const double share = open < 1 ? std::clamp(newton_constants.open_share * open, 0.05, 0.5) : newton_constants.refused_share;
    return share * at_.along.alpha;
}

NewtonAcceptance::Verdict NewtonAcceptance::judge(const ForceTerms& terms)
{
    using enum Verdict::What;
    if (at_.along.redirected) {
        if (problem_.residual_share() <= at_.base.residual_share) return {Taken};
        kinks_.take_back();  // into the valley of the largest turn, on the direction as it was
        const KinksPassed& before = at_.along.before_redirection;
        return {Shorter, std::max(before.share, newton_constants.least_into_valley), before.width > 0};
    }
    const double slope = problem_.residual_along(at_.direction);
    const bool slope_falls =
        std::abs(slope) <= std::max(newton_constants.slope_left, 1 - at_.along.alpha / 2) * std::abs(at_.along.slope);
    if (!at_.options.pseudo_transient) return natural_test(slope_falls, slope, terms);
    return {slope_falls || slope <= 0 ? Taken : MoreShift};
}

NewtonAcceptance::Verdict NewtonAcceptance::natural_test(bool slope_falls, double slope, const ForceTerms& terms)
{
    using enum Verdict::What;
    auto& along = at_.along;
    const KinksPassed& crossed = at_.trial.crossed;
    direction_.correct();
    const double contraction = problem_.norm(at_.correction) / along.norm;
    at_.trial.contraction = contraction;
    const bool grows = contraction > 1;
    // the derivative of a direction of the projected Hessian need not fall: while it is negative, energy does
    const bool descends =
        slope_falls || (direction_.projected_steps() > 0 && slope <= 0 && contraction < newton_constants.most_descending);
    if (contraction <= 1 - along.alpha / 4 || (descends && !(grows && at_.course.times_grown >= newton_constants.most_grown))) {
        at_.course.times_grown += grows;
        return {Taken};
    }
    // in a valley, or on a plane that the factors do not know, the correction is that of a wall too soft: the residual is asked
    if ((along.into_valley || along.admits || crossed.entered) && problem_.residual_share() <= at_.base.residual_share)
        return {Taken};
    if (kinks_.balance(terms)) return {Tried};
    if (crossed.share < 1 && along.alpha == along.first_alpha)  // into the valley, whose tangent is the next direction's
        return {Shorter, std::max(crossed.share, newton_constants.least_into_valley) * along.alpha, crossed.width > 0};
    if (!at_.options.shifted && crossed.share == 1 && fails_however_short(contraction, slope)) return {GivenUp};
    return {Shorter, next_share(contraction, slope)};
}

// From what the linear equations did not foresee of the correction, which grows with alpha^2: omega = 2 |correction - (1 - alpha)
// d|/ (alpha^2 |d|^2) gives the next alpha = 1/(omega |d|). A correction of more than 2 |d| mostly comes from contacts that begin
// on the way, and goes with their force, a power of the depth. (Seldom it comes from a large static move.) By 5/2 the next alpha
// is where it is |d|.
double NewtonAcceptance::next_share(double contraction, double slope)
{
    const auto& along = at_.along;
    for (int i = 0; i < problem_.size(); ++i) at_.scratch[i] = at_.correction[i] - (1 - along.alpha) * at_.direction[i];
    const double natural = 0.5 * along.norm * along.alpha * along.alpha / problem_.norm(at_.scratch);
    const double secant = slope * along.slope < 0 ? along.alpha * along.slope / (along.slope - slope) : 0.0;
    const double onset = contraction > 2 ? along.alpha * std::pow(contraction, -1 / newton_constants.contact_power) : 0.0;
    return std::clamp(std::max({natural, secant, onset}), newton_constants.shortest_cut * along.alpha,
                      newton_constants.longest_cut * along.alpha);
}

/// Whether two trials in a row on a direction, both of which fail both tests, lie where correction and derivative are linear in
/// the share. Then every shorter one fails too: the factors are not those of the derivative (symmetric or made positive) and the
/// direction does not lead down. The step is better divided than searched to the smallest share.
bool NewtonAcceptance::fails_however_short(double contraction, double slope)
{
    auto& along = at_.along;
    const double growth = (contraction - 1) / along.alpha, slope_growth = (slope / along.slope - 1) / along.alpha;
    const auto same = [](const std::optional<double>& before, double now) {
        return before && std::abs(now - *before) <= newton_constants.same_growth * std::max(1.0, std::abs(now));
    };
    const bool linear = same(along.growth, growth) && same(along.slope_growth, slope_growth);
    along.growth = growth;
    along.slope_growth = slope_growth;
    return linear && slope_growth > -0.5;  // else a derivative that was overshot passes at some shorter trial
}

}  // namespace seldinger
