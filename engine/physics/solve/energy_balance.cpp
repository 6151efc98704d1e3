// The sums from which generated energy is found.
#include "solve/energy_balance.h"

namespace seldinger {
namespace {

constexpr double rounding_share = 1e-9;

}  // namespace

void EnergyBalance::begin(const WireEnergy& now)
{
    *this = {};
    turned_over_ = now.kinetic;
    most_stored_ = now.stored;
    least_ = now.kinetic + now.stored + now.contact;
}

void EnergyBalance::account(const WireEnergy& now, const EnergyInput& input)
{
    unseen_ += input.unseen;
    work_ += input.work;
    carried_ += input.carried;
    turned_over_ += std::abs(input.work);
    most_stored_ = std::max(most_stored_, own(now));
    most_released_ = std::max(most_released_, most_stored_ - own(now));
    least_ = std::min(least_, now.kinetic + own(now) - work_ + now.contact);
}

void EnergyBalance::begin_after(const WireEnergy& now, const EnergyInput& input)
{
    account(now, input);
    least_ = now.kinetic + own(now) - work_ + now.contact;
    most_stored_ = own(now);
    most_released_ = 0;
}

bool EnergyBalance::take_in(const WireEnergy& now, const EnergyInput& input, const EnergyLimits& limits)
{
    const double turned_over = turned_over_, least = least_;
    account(now, input);
    const double made = now.kinetic + own(now) - work_ - least;
    most_made_ = std::max(most_made_, made);
    const double rounding = rounding_share * (std::abs(now.kinetic) + std::abs(now.stored) + std::abs(work_));
    // what this step itself released counts: a bent wire that is let go turns it over in its first step
    return std::min(made, now.kinetic) <= limits.fraction * (turned_over + most_released_) + limits.floor + unseen_ + rounding;
}

}  // namespace seldinger
