// Decides whether a Newton trial is accepted, and otherwise which fraction of the direction is tried next.

#include "newton/kink_balance.h"
#include "newton/newton_system.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr double smallest_alpha = 1e-6;
constexpr int most_jumps = 8;
constexpr int most_grown = 3;  // trials whose correction grows that are taken for their derivative along d: more go round in a circle
constexpr double most_descending = 2;  // correction against the direction, up to which a trial is taken for its energy: 5 does no better
constexpr double contact_power = 2.5;  // of the depth, in the force of contacts that begin
constexpr double same_growth = 0.05;  // of correction and derivative per share, at two trials [-]; 0.1 also ends directions that lead on
constexpr double located = 1e-6;  // of the wire's radius: a position known to within this is known [-]

}  // namespace

/// The trial cannot be: nearer to the last state that could. @param open  share of the path from there that is, as far as the force
/// terms know
void NewtonSystem::backtrack(double open)
{
    if (phase_ == Phase::Search) return shorten((open < 1 ? std::clamp(0.9 * open, 0.05, 0.5) : 0.3) * along_.alpha);
    if (course_.guess_fraction == 0) {
        give_up();
        return;
    }
    set_guess(++course_.backtracks < 6 ? 0.5 * course_.guess_fraction : 0.0);
}

/// @param into_valley  that contact went over
void NewtonSystem::shorten(double alpha, bool into_valley)
{
    along_.into_valley = into_valley;
    if (options_.shifted && alpha < 0.05 * along_.first_alpha) return raise_shift();
    if (alpha < smallest_alpha) {
        give_up();
        return;
    }
    set_trial(alpha);
}

/// The tests at the top of newton_system.h; a shorter trial, or one of a larger shift, is set when they fail.
bool NewtonSystem::acceptable(const ForceTerms& terms)
{
    if (along_.redirected) {
        if (problem.residual_share() <= at_base_.residual_share) return true;
        take_redirection_back();
        return false;
    }
    const double slope = problem.residual_along(direction_);
    const bool slope_falls = std::abs(slope) <= std::max(0.9, 1 - along_.alpha / 2) * std::abs(along_.slope);
    if (!options_.pseudo_transient) return natural_test(slope_falls, slope, terms);
    if (slope_falls || slope <= 0) return true;
    raise_shift();
    return false;
}

// |correction at alpha| <= (1 - alpha/4) |d|. Else from what the linear equations did not foresee of the correction, which grows
// with alpha^2: omega = 2 |correction - (1 - alpha) d|/(alpha^2 |d|^2) gives the next alpha = 1/(omega |d|). A correction of more than
// 2 |d| mostly comes from contacts that begin on the way, and goes with their force: a power of the depth, Hertz's 3/2, more where the law
// hardens. (Seldom it comes from a large static move.) By 5/2 the next alpha is where it is |d|. (Powers from 2 to 3 make little
// difference: docs/performance.md.)
bool NewtonSystem::natural_test(bool slope_falls, double slope, const ForceTerms& terms)
{
    correct();
    const double contraction = problem.norm(correction_) / along_.norm;
    at_trial_.contraction = contraction;
    const bool grows = contraction > 1;
    // the derivative of a direction of the projected Hessian need not fall: while it is negative, energy does
    const bool descends = slope_falls || (model_.projected_steps() > 0 && slope <= 0 && contraction < most_descending);
    if (contraction <= 1 - along_.alpha / 4 || (descends && !(grows && course_.times_grown >= most_grown))) {
        course_.times_grown += grows;
        return true;
    }
    // in a valley, or on a plane that the factors do not know, the correction is that of a wall too soft: the residual is asked
    if ((along_.into_valley || along_.admits || at_trial_.crossed.entered) && problem.residual_share() <= at_base_.residual_share) return true;
    if (redirect(terms)) return false;
    if (at_trial_.crossed.share < 1 && along_.alpha == along_.first_alpha) {  // into the valley, whose tangent is the next direction's
        shorten(std::max(at_trial_.crossed.share, 0.1) * along_.alpha, at_trial_.crossed.width > 0);
        return false;
    }
    if (!options_.shifted && at_trial_.crossed.share == 1 && fails_however_short(contraction, slope)) {
        give_up();
        return false;
    }
    for (int i = 0; i < problem.size(); ++i) scratch_[i] = correction_[i] - (1 - along_.alpha) * direction_[i];
    const double natural = 0.5 * along_.norm * along_.alpha * along_.alpha / problem.norm(scratch_);
    const double secant = slope * along_.slope < 0 ? along_.alpha * along_.slope / (along_.slope - slope) : 0.0;
    const double onset = contraction > 2 ? along_.alpha * std::pow(contraction, -1 / contact_power) : 0.0;
    shorten(std::clamp(std::max({natural, secant, onset}), 0.1 * along_.alpha, 0.5 * along_.alpha));
    return false;
}

/// Whether two trials in a row on a direction, both of which fail both tests, lie where correction and derivative are linear in the
/// share. Then every shorter one fails too: the factors are not those of the derivative (symmetric or made positive) and the
/// direction does not lead down. The step is better divided than searched to the smallest share.
bool NewtonSystem::fails_however_short(double contraction, double slope)
{
    const double growth = (contraction - 1) / along_.alpha, slope_growth = (slope / along_.slope - 1) / along_.alpha;
    const auto same = [](const std::optional<double>& before, double now) {
        return before && std::abs(now - *before) <= same_growth * std::max(1.0, std::abs(now));
    };
    const bool linear = same(along_.growth, growth) && same(along_.slope_growth, slope_growth);
    along_.growth = growth;
    along_.slope_growth = slope_growth;
    return linear && slope_growth > -0.5;  // else a derivative that was overshot passes at some shorter trial
}

/// Sets a trial where all kinks are balanced that the step's first one has gone over. In later iterations of a step, where balances
/// of kinks lead from one to the next, it would go round in a circle. @return whether it has
bool NewtonSystem::redirect(const ForceTerms& terms)
{
    if (at_trial_.crossed.share == 1 || along_.alpha != 1 || course_.iterations - course_.first_iteration > 1) return false;
    KinkBalance balance;
    int found = 0;
    for (const WireProblem* wire : problem.solved()) {
        const int first = problem.first_of(*wire);
        terms.for_each_kink(wire->wire, [&](const Kink& kink) {
            if (found++ < KinkBalance::most) balance.met[balance.count++] = {kink, first, 0, 0};
        });
    }
    if (found == 0 || found > KinkBalance::most) return false;
    const auto solve = [&](std::span<double> x) {
        for (int i = 0; i < problem.size(); ++i)
            if (problem.prescribed[i]) x[i] = 0;
        model_.solve(x);
    };
    const std::span<double> column = part(scratch_), change = part(correction_);
    for (int k = 0; k < found; ++k) {
        std::fill(column.begin(), column.end(), 0.0);
        KinkBalance::add(balance.met[k], 1, column);
        solve(column);
        for (int l = 0; l < found; ++l) balance.compliance[KinkBalance::most * l + k] = KinkBalance::along(balance.met[l], column);
        balance.met[k].free_move = KinkBalance::along(balance.met[k], direction_);
    }
    balance.solve();
    std::fill(change.begin(), change.end(), 0.0);
    for (int k = 0; k < found; ++k) KinkBalance::add(balance.met[k], -balance.met[k].force, change);
    solve(change);
    for (int i = 0; i < problem.size(); ++i) {
        direction_[i] += change[i];
        problem.trial[i] += change[i];
    }
    problem.correct_tension(correction_);
    along_.before_redirection = at_trial_.crossed;
    return along_.redirected = true;
}

/// The balance of the kinks leaves more than the base: into the valley of the largest turn, on the direction as it was.
void NewtonSystem::take_redirection_back()
{
    for (int i = 0; i < problem.size(); ++i) direction_[i] -= correction_[i];
    along_.redirected = false;
    shorten(std::max(along_.before_redirection.share, 0.1), along_.before_redirection.width > 0);
}

/// The simplified Newton correction at the trial into correction_. With a shift, that of the shifted problem, a pseudo-time step
/// R(q) + shift (q - base) = 0: leaving a saddle must not look like a failure because R grows.
void NewtonSystem::correct()
{
    problem.mixed_residual(part(scratch_));
    if (model_.shift > 0)
        for (int i = 0; i < problem.size(); ++i)
            scratch_[i] += model_.shift * model_.shift_weight(i) * (problem.trial[i] - base_[i]);
    model_.correction(scratch_, part(correction_), 1 - along_.alpha);
}

/// No point of a wire's surface is farther than 1e-6 radii (half a nanometre) from its position in the base. Yet the residual is not
/// (1 - alpha) of the base's, as the linear equations have it, by more than half of it and a thousandth of the largest contact
/// force. Then the nearest facets of the wall have changed, and the force with them (in a neck as narrow as the wire, at the corner
/// of three walls). No elastic or contact stiffness does that, and no friction that begins to slip. Where the jump turns the force
/// round, the equilibrium is there, to that half nanometre, and no position has a smaller residual. Else it lies beyond, and the
/// trial is as good a base as any.
NewtonSystem::Jump NewtonSystem::jump_of_force(const ForceTerms& terms)
{
    if (!terms.traits().may_jump || options_.shifted || along_.alpha == along_.first_alpha) return Jump::None;
    if (along_.alpha * problem.largest_surface_move(direction_) > located * problem.smallest_radius()) return Jump::None;
    double change = 0, base = 0;
    for (const WireProblem* wire : problem.solved()) {
        const double* before = problem.of_wire(*wire, base_residual_).data();
        // the base edge of a fed wire may be so short that half a nanometre is newtons of EA/l: its ends are not asked
        const int asked = wire->fed() ? RodDofs::count(wire->rod.n - 2) : wire->size();
        for (int i = 0; i < asked; ++i) {
            if (wire->q.prescribed[i] || RodDofs::is_spin(i)) continue;
            change = std::max(change, std::abs(wire->q.residual[i] - (1 - along_.alpha) * before[i]));
            base = std::max(base, std::abs(before[i]));
        }
    }
    if (change <= std::max(0.5 * base, 1e-3 * problem.largest_force())) return Jump::None;
    if (problem.residual_along(direction_) * along_.slope < 0) return Jump::Turns;
    return ++course_.jumps_passed <= most_jumps ? Jump::Passed : Jump::None;
}

/// The correction is below 1e-6 of the wire's radius (half a nanometre). The remaining force is rounding (of a single-precision
/// gap, say) or the jump of a contact force at a kink of the faceted wall, where three facets blend. The position is known to that
/// half nanometre, and no position has a smaller residual.
bool NewtonSystem::at_kink() const
{
    if (course_.iterations < 4 || options_.shifted) return false;
    const double jump = 1e-3 * problem.largest_force();
    const auto small = [&](const WireProblem* wire) { return wire->norm <= std::max(100 * wire->tolerance, jump); };
    return std::all_of(problem.solved().begin(), problem.solved().end(), small) &&
           problem.largest_move(direction_) <= located * problem.smallest_radius() && problem.at_prescribed();
}

}  // namespace seldinger
