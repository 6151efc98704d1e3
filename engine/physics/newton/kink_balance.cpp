// Shares of the facets that meet in each crossed valley, by complementarity.
#include "newton/kink_balance.h"

#include "math/dof_map.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

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

}  // namespace seldinger
