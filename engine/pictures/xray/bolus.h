#pragma once
// Iodine that is injected into a vessel, carried along its branches by the blood and washed out.
//
// Blood comes in at one place of the centreline's tree and leaves at all its other ends. Flow Q divides at a branching in
// proportion to the cubes of the radii [Murray26, doi:10.1073/pnas.12.3.207]; speed is Q/(pi r^2), so that travel from the
// injection takes tau = int ds pi r^2/Q. Arrival spreads by dispersion: its standard deviation is a share of tau,
//   c(tau, t) = int c_in(t - tau - x) N(x; 0, spread tau) dx,
// closed for the piecewise linear c_in: each key k changes the slope by m_k and adds m_k (x Phi(x/s) + s phi(x/s)), x = t - tau -
// t_k.

#include "vessel/centreline.h"

#include <algorithm>
#include <span>
#include <vector>

namespace seldinger {

struct BolusKey {
    double t = 0, iodine = 0;  // [s], [kg/m^3]; linear between, constant before the first and after the last
};

struct BolusSpec {
    Vec3 at = Vec3::Zero(), inflow = Vec3::Zero();  // the centreline's points nearest to these
    double speed = 0.3;                             // where it is injected [m/s]
    double spread = 0.15;
    std::vector<BolusKey> keys;
};

/// No blood comes here from the injection [s].
inline constexpr float never = 1e9f;

class Bolus {
public:
    Bolus() = default;
    /// @throws Error BadFile: no centreline
    Bolus(const Centreline& centreline, const BolusSpec& spec);

    /// Time of travel from the injection to these places, each carried to the point of the centreline whose inscribed sphere is
    /// nearest [s]; `never` upstream.
    [[nodiscard]] std::vector<float> travel_times(std::span<const Vec3> places) const;

    /// Concentration after that travel at time t [kg/m^3].
    [[nodiscard]] double concentration(double tau, double t) const;

    /// The longest time of travel of the tree [s].
    [[nodiscard]] double longest() const { return longest_; }

private:
    [[nodiscard]] float travel_time(const Vec3& place) const;
    Centreline centreline_;
    BolusSpec spec_;
    std::vector<double> tau_;                  // per point of the centreline
    std::vector<std::vector<int>> neighbour_;  // of each point
    double longest_ = 0;
};

/// Concentration at one moment as a table over tau, with its integral: means along stretches in O(1).
class BolusMoment {
public:
    BolusMoment(const Bolus& bolus, double t);
    /// Mean concentration where the time of travel goes evenly from one value to the other [kg/m^3].
    [[nodiscard]] double mean(double tau_a, double tau_b) const
    {
        const bool a = tau_a < never, b = tau_b < never;
        if (!a && !b) return 0;
        // half of a stretch that ends upstream is filled
        if (!a || !b) return 0.5 * mean(a ? tau_a : tau_b, a ? tau_a : tau_b);
        const double low = std::min(tau_a, tau_b), high = std::max(low + 1e-3 * step_, std::max(tau_a, tau_b));
        return (integral(high) - integral(low)) / (high - low);
    }
    [[nodiscard]] bool empty() const { return empty_; }

private:
    struct Entry {
        double value, integral;
    };
    // here and not in the source, since each ray asks for it
    [[nodiscard]] double integral(double tau) const
    {
        const double at = std::min(std::max(tau * per_step_, 0.0), static_cast<double>(table_.size() - 1));
        const auto k = std::min(static_cast<int>(at), static_cast<int>(table_.size()) - 2);
        const Entry *e = table_.data() + k;
        const double s = at - k, here = e[0].value + s * (e[1].value - e[0].value);
        return e[0].integral + 0.5 * s * step_ * (e[0].value + here);
    }
    double step_ = 1, per_step_ = 1;
    std::vector<Entry> table_;
    bool empty_ = true;
};

}  // namespace seldinger
