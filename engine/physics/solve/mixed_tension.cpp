// Prediction of tensions, and its effect on residual and tangent.
#include "solve/mixed_tension.h"

#include "core/prefetch.h"
#include "rod/discrete_gradient.h"
#include "solve/external_loads.h"

#include <algorithm>
#include <limits>

namespace seldinger {

double EdgeStretch::length(int j) const
{
    return conserving ? 0.5 * (start.edge_length[j] + frames.edge_length[j]) : frames.edge_length[j];
}

double EdgeStretch::strained_length(int j) const
{
    return conserving ? length(j) + feed_stretch(rod, start, j, base_grown) : length(j);
}

double EdgeStretch::tension(int j) const { return rod.stretch_stiffness[j] * (strained_length(j) / rod.rest_length[j] - 1); }

Vec3 EdgeStretch::direction(int j) const { return conserving ? mean_direction(start, frames, j) : frames.tangent[j]; }

MixedTension::MixedTension(int capacity)
    : base_(capacity), predicted_(capacity), base_longer_(capacity), base_tangent_(capacity), base_direction_(capacity)
{
}

void MixedTension::set_base(const EdgeStretch& now)
{
    for (int j = 0; j < now.rod.n - 1; ++j) {
        base_[j] = predicted_[j];
        base_tangent_[j] = now.frames.tangent[j];
        base_direction_[j] = now.direction(j);
        base_longer_[j] = now.strained_length(j) - now.rod.rest_length[j];
    }
}

void MixedTension::predict(const EdgeStretch& now, std::span<const double> d, double alpha)
{
    const RodView& rod = now.rod;
    const double end_share = now.conserving ? 0.5 : 1;
    for (int j = 0; j < rod.n - 1; ++j) {
        const double longer = base_longer_[j] + end_share * base_tangent_[j].dot(node_of(d, j + 1) - node_of(d, j));
        predicted_[j] = (1 - alpha) * base_[j] + alpha * rod.stretch_stiffness[j] / rod.rest_length[j] * longer;
    }
}

void MixedTension::correct(const EdgeStretch& now, std::span<const double> correction)
{
    const RodView& rod = now.rod;
    const double end_share = now.conserving ? 0.5 : 1;
    for (int j = 0; j < rod.n - 1; ++j) {
        const double more = end_share * base_tangent_[j].dot(node_of(correction, j + 1) - node_of(correction, j));
        predicted_[j] = now.tension(j) + rod.stretch_stiffness[j] / rod.rest_length[j] * more;
    }
}

void MixedTension::change_residual(const EdgeStretch& now, std::span<double> r) const
{
    for (int j = 0; j < now.rod.n - 1; ++j) {
        const Vec3 excess = (now.tension(j) - predicted_[j]) * (now.direction(j) - base_direction_[j]);
        add_to_node(r, j, excess);
        add_to_node(r, j + 1, -excess);
    }
}

// The stretching Hessian is EA/l t t^T + N/|e| (I - t t^T), N = EA (|e|/l - 1), and max(N, 0) when projected to be positive
// semidefinite. Puts the predicted tension in place of N. Conserving, the force is N b with N = EA (m/l - 1), m the mean length
// and b the mean direction: half of EA/l b t^T + N/m (I - b t^T) in place of half the Hessian.
void MixedTension::change_tangent(const EdgeStretch& now, HessianMode mode, bool symmetric, BandRows& tangent) const
{
    const RodView& rod = now.rod;
    const double least = mode == HessianMode::Projected ? 0.0 : -std::numeric_limits<double>::infinity();
    for (int j = 0; j < rod.n - 1; ++j) {
        const Vec3& t = now.frames.tangent[j];
        const double tension = std::max(predicted_[j], least), at_end = now.frames.edge_length[j];
        if (!now.conserving) {
            const double change = (tension - std::max(now.tension(j), least)) / at_end;
            add_edge_block(tangent, j, change * (Mat3::Identity() - outer(t, t)));
            continue;
        }
        const double axial = rod.stretch_stiffness[j] / rod.rest_length[j], sideways = tension / now.length(j);
        const double strained = rod.stretch_stiffness[j] * (at_end / rod.rest_length[j] - 1);
        const double there = std::max(strained, least) / at_end;
        Mat3 mean = outer(now.direction(j), t);
        if (symmetric) mean = 0.5 * (mean + mean.transpose());
        add_edge_block(
            tangent, j,
            0.5 * ((axial - sideways) * mean - outer((axial - there) * t, t) + (sideways - there) * Mat3::Identity()));
    }
}

double MixedTension::take_linear(const EdgeStretch& now, std::span<double> residual) const
{
    const auto excess = [&](int j) { return now.tension(j) - predicted_[j]; };
    for (int j = 0; j < now.rod.n - 1; ++j) {
        add_to_node(residual, j, excess(j) * now.frames.tangent[j]);
        add_to_node(residual, j + 1, -excess(j) * now.frames.tangent[j]);
    }
    return excess(now.rod.n - 2);
}

void MixedTension::prefetch(int nodes) const { seldinger::prefetch(predicted_, nodes); }

}  // namespace seldinger
