// Balance of the kinks that a direction goes over, jumps of the contact force, and the end at a kink.
#include "newton/kinks.h"

#include "math/dof_map.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

// Shares of the facets that meet in each crossed valley, by complementarity.

namespace {

constexpr int most_sweeps = 200;
constexpr double settled = 1e-9;  // of a kink's force

}  // namespace

double KinkBalance::along(const Met& met, std::span<const double> x)
{
    const double b = met.kink.bary, a = 1 - b;
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const std::size_t at = static_cast<std::size_t>(met.first + RodDofs::position(met.kink.node, i));
        sum += met.kink.across[i] * (a * x[at] + b * x[at + RodDofs::per_node]);
    }
    return sum;
}

void KinkBalance::add(const Met& met, double scale, std::span<double> x)
{
    for (int i = 0; i < 3; ++i) {
        const std::size_t at = static_cast<std::size_t>(met.first + RodDofs::position(met.kink.node, i));
        x[at] += scale * (1 - met.kink.bary) * met.kink.across[i];
        x[at + RodDofs::per_node] += scale * met.kink.bary * met.kink.across[i];
    }
}

// Each p in turn: p = f (rest + y) / width with y = y_of_others - c p.
void KinkBalance::solve()
{
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double change = 0;
        for (int k = 0; k < count; ++k) {
            const double *row = &compliance[static_cast<std::size_t>(most * k)], c = std::max(row[k], 0.0);
            double y = met[k].free_move;
            for (int l = 0; l < count; ++l)
                if (l != k) y -= row[l] * met[l].force;
            const auto& [kink, first, free_move, force] = met[k];
            const double p = std::clamp(kink.force * (kink.rest + y) / (kink.width + kink.force * c), 0.0, kink.force);
            change = std::max(change, std::abs(p - force) / kink.force);
            met[k].force = p;
        }
        if (change < settled) return;
    }
}

bool NewtonKinks::balance(const ForceTerms& terms)
{
    if (at_.trial.crossed.share == 1 || at_.along.alpha != 1 || at_.iterations() > 1) return false;
    KinkBalance balance;
    int found = 0;
    for (const WireProblem* wire : problem_.solved()) {
        const int first = problem_.first_of(*wire);
        terms.for_each_kink(wire->wire, [&](const Kink& kink) {
            if (found++ < KinkBalance::most) balance.met[balance.count++] = {kink, first, 0, 0};
        });
    }
    if (found == 0 || found > KinkBalance::most) return false;
    const std::span<double> column = part(at_.scratch), change = part(at_.correction);
    for (int k = 0; k < found; ++k) {
        std::fill(column.begin(), column.end(), 0.0);
        KinkBalance::add(balance.met[k], 1, column);
        direction_.solve(column);
        for (int l = 0; l < found; ++l)
            balance.compliance[KinkBalance::most * l + k] = KinkBalance::along(balance.met[l], column);
        balance.met[k].free_move = KinkBalance::along(balance.met[k], at_.direction);
    }
    balance.solve();
    std::fill(change.begin(), change.end(), 0.0);
    for (int k = 0; k < found; ++k) KinkBalance::add(balance.met[k], -balance.met[k].force, change);
    direction_.solve(change);
    for (int i = 0; i < problem_.size(); ++i) {
        at_.direction[i] += change[i];
        problem_.trial[i] += change[i];
    }
    problem_.correct_tension(at_.correction);
    at_.along.before_redirection = at_.trial.crossed;
    return at_.along.redirected = true;
}

void NewtonKinks::take_back()
{
    for (int i = 0; i < problem_.size(); ++i) at_.direction[i] -= at_.correction[i];
    at_.along.redirected = false;
}

/// No point of a wire's surface is farther than 1e-6 radii (half a nanometre) from its position in the base. Yet the residual is
/// not (1 - alpha) of the base's, as the linear equations have it, by more than half of it and a thousandth of the largest
/// contact force. Then the nearest facets of the wall have changed, and the force with them (in a neck as narrow as the wire, at
/// the corner of three walls). No elastic or contact stiffness does that, and no friction that begins to slip. Where the jump
/// turns the force round, the equilibrium is there, to that half nanometre, and no position has a smaller residual. Else it lies
/// beyond, and the trial is as good a base as any.
NewtonKinks::Jump NewtonKinks::jump_of_force(const ForceTerms& terms)
{
    const auto& along = at_.along;
    if (!terms.traits().may_jump || at_.options.shifted || along.alpha == along.first_alpha) return Jump::None;
    if (along.alpha * problem_.largest_surface_move(at_.direction) > newton_constants.located * problem_.smallest_radius())
        return Jump::None;
    double change = 0, base = 0;
    for (const WireProblem* wire : problem_.solved()) {
        const double* before = problem_.of_wire(*wire, at_.base_residual).data();
        // the base edge of a fed wire may be so short that half a nanometre is newtons of EA/l: its ends are not asked
        const int asked = wire->fed() ? RodDofs::count(wire->rod.n - 2) : wire->size();
        for (int i = 0; i < asked; ++i) {
            if (wire->q.prescribed[i] || RodDofs::is_spin(i)) continue;
            change = std::max(change, std::abs(wire->q.residual[i] - (1 - along.alpha) * before[i]));
            base = std::max(base, std::abs(before[i]));
        }
    }
    if (change <= std::max(0.5 * base, newton_constants.force_jump * problem_.largest_force())) return Jump::None;
    if (problem_.residual_along(at_.direction) * along.slope < 0) return Jump::Turns;
    return ++at_.course.jumps_passed <= newton_constants.most_jumps ? Jump::Passed : Jump::None;
}

/// The correction is below 1e-6 of the wire's radius. The remaining force is rounding (of a single-precision gap, say) or the
/// jump of a contact force at a kink of the faceted wall, where three facets blend. No position has a smaller residual.
bool NewtonKinks::at_kink() const
{
    if (at_.course.iterations < 4 || at_.options.shifted) return false;
    const double jump = newton_constants.force_jump * problem_.largest_force();
    const auto small = [&](const WireProblem* wire) { return wire->norm <= std::max(100 * wire->tolerance, jump); };
    return std::all_of(problem_.solved().begin(), problem_.solved().end(), small) &&
           problem_.largest_move(at_.direction) <= newton_constants.located * problem_.smallest_radius() &&
           problem_.at_prescribed();
}

}  // namespace seldinger
