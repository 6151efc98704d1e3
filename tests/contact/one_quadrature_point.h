#pragma once
// One edge with one quadrature point in it over small walls: what contact exerts there, and its tangent against central
// differences.

#include "contact/wall_fixture.h"

#include <algorithm>

namespace seldinger::test {

/// One edge of 2 mm over walls, with one quadrature point in it. Everything a trial changes is in q = (x, y, z, theta).
struct OneQuadraturePoint {
    Soup soup;
    ContactParams par{};
    QuadratureModel model{};
    QuadraturePlace place{0, 0, 0.3, 0.3, 5, 0, 0};
    ContactState states[2] = {};
    MultiplierState multiplier[2] = {};            // of the laws that read it
    vec3 start = {0, 0, 0}, along = {2e-3, 0, 0};  // of the quadrature point at the start of the step; of the edge
    double theta0 = 0.4;

    explicit OneQuadraturePoint(const QuadratureModel& m) : model(m)
    {
        par.item_count = 1;
        par.friction = SEL_FRICTION_STICK_SLIP;
        par.inv_dt = 1e3;
        par.smoothing = 0.002;
        par.smooth_speed = 1e-3;
        model.reach = 0.1 * m.radius;
    }
    void nodes(vec3 at, std::array<float, 6>& hi, std::array<double, 6>& lo) const
    {
        const vec3 a = at - place.bary * along, b = a + along;
        const double p[6] = {a.x, a.y, a.z, b.x, b.y, b.z};
        for (int k = 0; k < 6; ++k) {
            hi[k] = static_cast<float>(p[k]);
            lo[k] = p[k] - hi[k];
        }
    }
    ContactForce at(std::array<double, 4> q, ContactState* out = nullptr) const
    {
        std::array<float, 6> hi, hi_t0;
        std::array<double, 6> lo, lo_t0;
        nodes(v3(q[0], q[1], q[2]), hi, lo);
        nodes(start, hi_t0, lo_t0);
        const double theta[2] = {q[3], 0}, theta_t0[2] = {theta0, 0};
        ContactState scratch[2];
        const PointView point = point_view(0, model, place, all_of(soup));
        return evaluate_point(point, par, node_view(hi.data(), lo.data(), theta), node_view(hi_t0.data(), lo_t0.data(), theta_t0),
                              state_view(states, out ? out : scratch, multiplier), nullptr, nullptr);
    }
    /// Accepts q as the start of the next step.
    void accept(std::array<double, 4> q)
    {
        ContactState now[2];
        (void)at(q, now);
        std::copy(now, now + 2, states);
        start = v3(q[0], q[1], q[2]);
        theta0 = q[3];
        place.epoch++;
    }
};

inline void add_floor(Soup& soup) { soup.add_patch(v3(-0.01, -0.01, 0), v3(0.02, 0, 0), v3(0, 0.02, 0)); }

// -dF/dq as evaluate_point says it is
inline double tangent(const ContactForce& f, int row, int column)
{
    static constexpr int place[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    return f.sym[place[row][column]] + (column < 3 ? f.skew[3 * row + column] : 0);
}

/// Largest difference between the tangent and central differences, each row and column scaled so that a unit of q moves the
/// surface by a metre; relative to the largest entry.
inline double tangent_error(const OneQuadraturePoint& s, std::array<double, 4> q)
{
    // [m] of some 1e-6 of overlap: truncation 1e-8 of the third derivative, rounding 1e-16 / 1e-10 * 1e-3
    const double step = 1e-10;
    const ContactForce f = s.at(q);
    double worst = 0, largest = 0;
    for (int c = 0; c < 4; ++c) {
        const double scale_c = c == 3 ? 1 / s.model.radius : 1;
        std::array<double, 4> up = q, down = q;
        up[c] += step * scale_c;
        down[c] -= step * scale_c;
        const ContactForce fu = s.at(up), fd = s.at(down);
        for (int k = 0; k < 4; ++k) {
            const double scale_k = k == 3 ? 1 / s.model.radius : 1;
            const double difference = -(fu.force[k] - fd.force[k]) / (up[c] - down[c]) * scale_c;
            worst = std::max(worst, scale_k * std::abs(scale_c * tangent(f, k, c) - difference));
            largest = std::max(largest, std::abs(scale_k * scale_c * tangent(f, k, c)));
        }
    }
    return worst / largest;
}

}  // namespace seldinger::test
