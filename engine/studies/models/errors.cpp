// Compares a trajectory with a reference sample by sample: tip, shape, hand force, friction, spread of the contact force.
#include "models/errors.h"

#include "models/frechet.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// (1/L) ∫ |a - b| ds of two piecewise linear functions on the contact grid. Trapezoid: a cell in which they cross counts a
/// little more than it should, by less than a cell's share.
double mean_difference(const std::vector<double>& a, const std::vector<double>& b)
{
    if (a.size() != b.size() || a.size() < 2) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (k == 0 || k + 1 == a.size() ? 0.5 : 1.0) * std::abs(a[k] - b[k]);
    return sum / static_cast<double>(a.size() - 1);
}

const Sample* sample_at(const Trajectory& trajectory, double t)
{
    const auto near = [t](const Sample& sample) { return std::abs(sample.t - t) <= 1e-9 * std::max(1.0, std::abs(t)); };
    const auto found = std::find_if(trajectory.samples.begin(), trajectory.samples.end(), near);
    return found == trajectory.samples.end() ? nullptr : &*found;
}

}  // namespace

PerObservable sample_errors(const Sample& sample, const Sample& reference)
{
    PerObservable errors;
    at(errors, Observable::Tip) = (sample.shape.front() - reference.shape.front()).norm();
    at(errors, Observable::Shape) = frechet_distance(sample.shape, reference.shape);
    at(errors, Observable::HandForce) = std::abs(sample.hand_force - reference.hand_force);
    at(errors, Observable::Friction) = std::abs(sample.friction - reference.friction);
    at(errors, Observable::Contact) = mean_difference(sample.contact_up_to, reference.contact_up_to);
    return errors;
}

Errors trajectory_errors(const Trajectory& run, const Trajectory& reference, const Window& window)
{
    std::array<std::vector<double>, observable_count> all;
    Errors errors;
    for (const Sample& wanted : reference.samples) {
        const Sample* sample = window.holds(wanted.t) ? sample_at(run, wanted.t) : nullptr;
        if (!sample) continue;
        ++errors.samples;
        const PerObservable now = sample_errors(*sample, wanted);
        for (int k = 0; k < observable_count; ++k) all[k].push_back(now[k]);
    }
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    for (int k = 0; k < observable_count; ++k) {
        std::vector<double>& values = all[k];
        double squares = 0;
        for (const double value : values) squares += value * value;
        std::sort(values.begin(), values.end());
        errors.rms[k] = values.empty() ? none : std::sqrt(squares / errors.samples);
        errors.median[k] = values.empty() ? none : values[values.size() / 2];
        errors.worst[k] = values.empty() ? none : values.back();
    }
    return errors;
}

}  // namespace seldinger
