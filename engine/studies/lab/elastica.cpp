// Finds the clamp's moment of the extensible elastica by bisection and integrates the shape from there.
#include "lab/elastica.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace seldinger {
namespace {

constexpr int steps = 4000;  // RK4: (1/4000)^4 is far below what is asked for

/// In the plane of direction (u) and force (w).
struct Elastica {
    double bend, stretch, length, force_u, force_w;

    using State = std::array<double, 4>;  // u, w, theta, moment
    [[nodiscard]] State slope(const State& y) const
    {
        const double c = std::cos(y[2]), s = std::sin(y[2]);
        const double stretched = 1 + (force_u * c + force_w * s) / stretch;
        return {stretched * c, stretched * s, y[3] / bend, -stretched * (c * force_w - s * force_u)};
    }
    [[nodiscard]] State next(const State& y, double h) const
    {
        const auto moved = [](const State& a, double t, const State& d) {
            return State{a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2], a[3] + t * d[3]};
        };
        const State k1 = slope(y), k2 = slope(moved(y, h / 2, k1)), k3 = slope(moved(y, h / 2, k2)), k4 = slope(moved(y, h, k3));
        State sum = y;
        for (int i = 0; i < 4; ++i) sum[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
        return sum;
    }
    [[nodiscard]] double moment_at_tip(double at_clamp) const
    {
        State y{0, 0, 0, at_clamp};
        for (int k = 0; k < steps; ++k) y = next(y, length / steps);
        return y[3];
    }
};

/// Moment at the clamp for which the tip's is zero: between none and the whole lever's.
double clamp_moment(const Elastica& wire)
{
    double low = 0, high = wire.force_w * wire.length * (1 + std::abs(wire.force_w) / wire.stretch);
    for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (wire.moment_at_tip(middle) < 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

}  // namespace

std::vector<Vec3> elastica_shape(const WireSection& section, double length, const Vec3& base, const Vec3& direction,
                                 const Vec3& force, int points)
{
    const Vec3 u = direction.normalized(), across = force - force.dot(u) * u;
    const Vec3 w = across.norm() > 0 ? Vec3(across.normalized()) : u.unitOrthogonal();
    const Elastica wire{section.bend_stiffness, section.stretch_stiffness, length, force.dot(u), across.norm()};
    const int per_point = (steps + points - 2) / (points - 1);
    const double h = length / (static_cast<double>(per_point) * (points - 1));
    Elastica::State y{0, 0, 0, clamp_moment(wire)};
    std::vector<Vec3> shape = {base};
    for (int k = 1; k < points; ++k) {
        for (int i = 0; i < per_point; ++i) y = wire.next(y, h);
        shape.push_back(base + y[0] * u + y[1] * w);
    }
    std::reverse(shape.begin(), shape.end());
    return shape;
}

}  // namespace seldinger
