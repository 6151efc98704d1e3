// Times of travel over the tree, and the spread of what arrives.
#include "xray/bolus.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace seldinger {
namespace {

constexpr int moments = 2048;

double murray(double radius) { return radius * radius * radius; }

/// x Phi(x/s) + s phi(x/s): the ramp max(0, x) seen through a normal distribution.
double smooth_ramp(double x, double s)
{
    if (!(s > 0)) return std::max(0.0, x);
    const double z = x / s;
    return 0.5 * x * std::erfc(-z / std::numbers::sqrt2) + s * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
}

}  // namespace

Bolus::Bolus(const Centreline& centreline, const BolusSpec& spec) : centreline_(centreline), spec_(spec)
{
    const auto count = static_cast<int>(centreline_.points.size());
    if (count < 2 || spec.keys.empty())
        throw Error(ErrorKind::BadFile, "contrast: no centreline was found in the vessel, so there is no path to flow along");
    neighbour_.resize(count);
    for (int i = 0; i < count; ++i)
        if (const int p = centreline_.parent[i]; p >= 0) neighbour_[i].push_back(p), neighbour_[p].push_back(i);
    const int inflow = centreline_.nearest(spec.inflow), at = centreline_.nearest(spec.at);

    // outwards from the inflow: from where each point gets its blood, and how much of it
    std::vector<int> order{inflow}, from(count, -1);
    std::vector<double> flow(count, 0.0);
    flow[inflow] = 1;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const int i = order[k];
        double sum = 0;
        for (const int j : neighbour_[i]) sum += j == from[i] ? 0 : murray(centreline_.radius[j]);
        for (const int j : neighbour_[i])
            if (j != from[i]) from[j] = i, flow[j] = flow[i] * murray(centreline_.radius[j]) / sum, order.push_back(j);
    }
    const auto area = [&](int i) { return std::numbers::pi * centreline_.radius[i] * centreline_.radius[i]; };
    const double unit = spec.speed * area(at) / flow[at];  // [m^3/s]
    tau_.assign(count, static_cast<double>(never));
    tau_[at] = 0;
    for (const int i : order) {
        const int j = from[i];
        if (i == at || j < 0 || tau_[j] >= never) continue;
        const double volume = 0.5 * (area(i) + area(j)) * (centreline_.points[i] - centreline_.points[j]).norm();
        tau_[i] = tau_[j] + volume / (unit * flow[i]);
        longest_ = std::max(longest_, tau_[i]);
    }
}

float Bolus::travel_time(const Vec3& place) const
{
    // to whose inscribed sphere a place belongs: beside the mouth of a branch it is the vessel's that the branch leaves
    const auto beyond = [&](const Vec3& point, double radius) { return (place - point).squaredNorm() - radius * radius; };
    int i = 0;
    double best = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < tau_.size(); ++k)
        if (const double d = beyond(centreline_.points[k], centreline_.radius[k]); d < best) best = d, i = static_cast<int>(k);
    double tau = tau_[i];
    for (const int j : neighbour_[i]) {
        const Vec3 edge = centreline_.points[j] - centreline_.points[i];
        const double s = std::clamp((place - centreline_.points[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
        const double d = beyond(centreline_.points[i] + s * edge, (1 - s) * centreline_.radius[i] + s * centreline_.radius[j]);
        if (d >= best) continue;
        best = d;
        tau = tau_[i] >= never || tau_[j] >= never ? static_cast<double>(never) : (1 - s) * tau_[i] + s * tau_[j];
    }
    return static_cast<float>(tau);
}

std::vector<float> Bolus::travel_times(std::span<const Vec3> places) const
{
    std::vector<float> times(places.size());
    for_each_item(static_cast<int>(places.size()), 256, [&](int i) { times[i] = travel_time(places[i]); });
    return times;
}

double Bolus::concentration(double tau, double t) const
{
    if (tau >= never || spec_.keys.empty()) return 0;
    const double spread = spec_.spread * tau;
    double sum = spec_.keys.front().iodine, slope = 0;
    for (std::size_t k = 0; k < spec_.keys.size(); ++k) {
        const BolusKey& key = spec_.keys[k];
        const double after =
            k + 1 < spec_.keys.size() ? (spec_.keys[k + 1].iodine - key.iodine) / (spec_.keys[k + 1].t - key.t) : 0.0;
        sum += (after - slope) * smooth_ramp(t - tau - key.t, spread);
        slope = after;
    }
    return std::max(0.0, sum);
}

BolusMoment::BolusMoment(const Bolus& bolus, double t)
    : step_(std::max(bolus.longest(), 1e-9) / (moments - 1)), per_step_(1 / step_), table_(moments)
{
    for (int k = 0; k < moments; ++k) {
        table_[k].value = bolus.concentration(k * step_, t);
        empty_ &= table_[k].value <= 0;
        table_[k].integral = k == 0 ? 0 : table_[k - 1].integral + 0.5 * step_ * (table_[k].value + table_[k - 1].value);
    }
}

}  // namespace seldinger
