// Scales for the residual of a wire, and the measures of residuals and moves.
#include "solve/wire_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double most_bending_force = 10;  // of the scale of forces [N]

}  // namespace

// The largest of total weight, loads (moments over the wire's length), stretched links, and B/L^2, the force that bends the wire
// to its own length, up to 10 N. Without this limit a short stiff piece in the introducer (0.01 N m^2, 1 cm: 100 N) would have
// residuals that show in the hand force. The floor is what rounding of positions far from the origin does to the stretching and
// inertia forces.
void WireProblem::set_scales(const IntegratorSpec& spec, const Vec3& gravity)
{
    const int n = rod.n;
    double length = 0, mass = 0, bend = 0, twist = 0, reach = 0, stiffness = 0, spin = 0, heaviest = 0;
    for (int j = 0; j < n - 1; ++j) {
        length += rod.rest_length[j];
        stiffness = std::max(stiffness, rod.stretch_stiffness[j] / rod.rest_length[j]);
        twist = std::max(twist, rod.twist_stiffness[j] / rod.rest_length[j] * std::abs(rod.theta[j]));
        spin = std::max(spin, q.inertia[RodDofs::spin(j)] * std::abs(rod.theta[j]));
    }
    for (int i = 0; i < n; ++i) {
        mass += rod.mass[i];
        heaviest = std::max(heaviest, rod.mass[i]);
        bend = std::max(bend, rod.bend_stiffness[i]);
        reach = std::max({reach, std::abs(rod.x[i]), std::abs(rod.y[i]), std::abs(rod.z[i])});
    }
    length_scale = length / (n - 1);
    force_scale = std::max(mass * gravity.norm(), std::min(bend / (length * length), most_bending_force));
    force_scale = std::max({force_scale, dead_loads_.scale(length), links_.scale(rod)});
    const double force_noise = (stiffness + heaviest * time.acceleration_rate()) * reach;
    const double moment_noise = (twist + spin * time.acceleration_rate()) / length_scale;
    tolerance = spec.tolerance * force_scale + 8 * epsilon * std::max(force_noise, moment_noise);
}

double WireProblem::residual_norm() const
{
    double largest = 0;
    for (int i = 0; i < size(); ++i) {
        if (q.prescribed[i]) continue;
        const double r = std::abs(q.residual[i]);
        largest = std::max(largest, RodDofs::is_spin(i) ? r / length_scale : r);
    }
    return largest;
}

double WireProblem::squared_norm(std::span<const double> d) const
{
    double squares = 0;
    for (int i = 0; i < size(); ++i) {
        const double value = RodDofs::is_spin(i) ? d[i] * length_scale : d[i];
        squares += value * value;
    }
    return squares;
}

double WireProblem::largest_move(std::span<const double> d) const
{
    double largest = 0;
    for (int i = 0; i < rod.n; ++i) largest = std::max(largest, node_of(d, i).squaredNorm());
    return std::sqrt(largest);
}

double WireProblem::largest_surface_move(std::span<const double> d) const
{
    double largest = largest_move(d);
    for (int j = 0; j < rod.n - 1; ++j) largest = std::max(largest, std::abs(d[RodDofs::spin(j)]) * rod.radius[j]);
    return largest;
}

double WireProblem::largest_turn(std::span<const double> d) const
{
    double largest = 0;
    for (int j = 0; j < rod.n - 1; ++j)
        largest = std::max(largest, (node_of(d, j + 1) - node_of(d, j)).norm() / rod.rest_length[j]);
    return largest;
}

double WireProblem::smallest_radius() const { return *std::min_element(rod.radius.begin(), rod.radius.begin() + rod.n - 1); }

}  // namespace seldinger
