// The balance of momentum, from the readings of each term.
#include "newton/momentum.h"

#include "newton/solver.h"

namespace seldinger {
namespace {

Vec3 rate_of_change(const RodView& rod, const IntegratorSpec& spec, const MomentumStart& start, double h)
{
    if (h == 0) return Vec3::Zero();
    if (!spec.newmark || spec.scheme == Scheme::Explicit) return (momentum(rod) - start.momentum) / h;
    Vec3 rate = start.fed / h;
    for (int i = 0; i < rod.n; ++i) rate += rod.mass[i] * Vec3(rod.ax[i], rod.ay[i], rod.az[i]);
    return rate;
}

}  // namespace

Vec3 momentum(const RodView& rod)
{
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i] * rod.vel(i);
    return sum;
}

MomentumBalance Solver::momentum_balance(int wire, const WireConstraints& constraints, std::span<const Vec3> contact_force,
                                         const MomentumStart& start, double h) const
{
    const RodView rod = rods_.view(wire);
    MomentumBalance balance;
    for (const auto& [unknown, value] : constraints.prescribed)
        if (!RodDofs::is_spin(unknown)) balance.held[RodDofs::place(unknown)] += reaction(wire, unknown);
    for (int i = 0; i < rod.n; ++i) {
        balance.weight += rod.mass[i] * gravity_;
        balance.contact += contact_force[i];
    }
    balance.loads = load_force(wire);
    if (h > 0) balance.fed = start.fed / h;
    balance.rate = rate_of_change(rod, spec_, start, h);
    return balance;
}

}  // namespace seldinger
