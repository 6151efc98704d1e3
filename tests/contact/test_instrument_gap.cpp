// Geometry of contact between instruments (D13): the spline of a rod, and the gap to it with its derivatives.

#include "contact/spline_rod.h"
#include "shared/instrument_near.h"
#include "support/approx.h"

#include <array>
#include <functional>
#include <random>
#include <vector>

namespace seldinger::test::test_instrument_gap {

namespace {

/// Nodes of one rod.
struct Nodes : test::SplineRod {
    void add(vec3 x)
    {
        double s = 0;
        if (!material.empty()) {
            const vec3 d = x - node_at(view(), static_cast<uint>(material.size() - 1));
            s = material.back() + std::sqrt(dot3(d, d));
        }
        for (const double c : {x.x, x.y, x.z}) position.push_back(c);
        material.push_back(s);
        theta.push_back(0);
    }
};

/// A wavy rod about along x, edges of unequal length.
Nodes wavy(int count, double edge, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> some(-1, 1);
    Nodes nodes;
    double x = 0;
    for (int i = 0; i < count; ++i) {
        const double z = 0.2 * edge * some(random), y = 0.2 * edge * some(random);  // in this order by any compiler
        nodes.add(make_vec3(x, y, z));
        x += edge * (1 + 0.3 * some(random));
    }
    return nodes;
}

/// Gap of a fixed material point of a to b, as a function of all coordinates of both.
struct TwoEdges {
    Nodes a, b;
    double s = 0;
    GapPart part{};
    double start = 0;
    [[nodiscard]] InstrumentGap gap() const { return instrument_gap(b.view(), point_of_material_of_a(), start, part); }
    [[nodiscard]] vec3 point_of_material_of_a() const { return test::point_of_material(a.view(), s); }
    [[nodiscard]] double& coordinate(std::size_t k)
    {
        return k < a.position.size() ? a.position[k] : b.position[k - a.position.size()];
    }
    [[nodiscard]] std::size_t size() const { return a.position.size() + b.position.size(); }
};

/// d gap over all coordinates.
std::vector<double> gradient(const TwoEdges& pair)
{
    const InstrumentGap g = pair.gap();
    const SplinePlace a = spline_place(spline_at(pair.a.view(), pair.s), pair.a.view().count);
    const double n[3] = {g.n.x, g.n.y, g.n.z}, turn[3] = {g.turn.x, g.turn.y, g.turn.z};
    std::vector<double> all(pair.size());
    for (uint k = 0; k < 3; ++k)
        for (uint c = 0; c < 3; ++c) {
            if (a.w[k] != 0) all[3 * (a.node + k) + c] += a.w[k] * n[c];
            if (g.b.w[k] != 0 || g.b.d[k] != 0)
                all[pair.a.position.size() + 3 * (g.b.node + k) + c] += -g.b.w[k] * n[c] + g.b.d[k] * turn[c];
        }
    return all;
}

/// Second derivative of the gap along a direction v: v^T H v.
double curvature_along(const TwoEdges& pair, const std::vector<double>& v)
{
    const InstrumentGap g = pair.gap();
    const SplinePlace a = spline_place(spline_at(pair.a.view(), pair.s), pair.a.view().count);
    vec3 delta = make_vec3(0, 0, 0), slope = make_vec3(0, 0, 0);
    const auto at = [&](std::size_t node) { return make_vec3(v[3 * node], v[3 * node + 1], v[3 * node + 2]); };
    const std::size_t b_first = pair.a.material.size();
    for (uint k = 0; k < 3; ++k) {
        if (a.w[k] != 0) delta = delta + a.w[k] * at(a.node + k);
        if (g.b.w[k] == 0 && g.b.d[k] == 0) continue;
        delta = delta - g.b.w[k] * at(b_first + g.b.node + k);
        slope = slope + g.b.d[k] * at(b_first + g.b.node + k);
    }
    const double along = dot3(g.p, delta) + dot3(g.q, slope);
    const double quad = g.m[0] * delta.x * delta.x + g.m[3] * delta.y * delta.y + g.m[5] * delta.z * delta.z +
                        2 * (g.m[1] * delta.x * delta.y + g.m[2] * delta.x * delta.z + g.m[4] * delta.y * delta.z);
    return quad + g.bend * along * along;
}

constexpr double edge = 1e-3, nudge = 1e-8;

std::vector<double> differences(TwoEdges pair)
{
    std::vector<double> all(pair.size());
    for (std::size_t k = 0; k < pair.size(); ++k) {
        const double was = pair.coordinate(k);
        pair.coordinate(k) = was + nudge;
        const double up = pair.gap().gap;
        pair.coordinate(k) = was - nudge;
        const double down = pair.gap().gap;
        pair.coordinate(k) = was;
        all[k] = (up - down) / (2 * nudge);
    }
    return all;
}

/// Change of the gradient along v, times v.
double curvature_difference(TwoEdges pair, const std::vector<double>& v)
{
    const auto slope_at = [&](double t) {
        TwoEdges moved = pair;
        for (std::size_t k = 0; k < moved.size(); ++k) moved.coordinate(k) += t * v[k];
        const std::vector<double> g = gradient(moved);
        double sum = 0;
        for (std::size_t k = 0; k < v.size(); ++k) sum += g[k] * v[k];
        return sum;
    };
    return (slope_at(nudge) - slope_at(-nudge)) / (2 * nudge);
}

GapPart outside_part(const Nodes& b)
{
    GapPart part{};
    part.touch = SEL_TOUCH_OUTSIDE;
    part.high = static_cast<double>(b.material.size() - 1);
    part.reach_a = 0.2e-3;
    part.reach_b = 0.3e-3;
    part.low_ends = part.high_ends = 1;
    return part;
}

/// b along x; a nearby, a little askew.
TwoEdges near_pair(unsigned seed, uint touch)
{
    TwoEdges pair;
    pair.b = wavy(12, edge, seed);
    pair.a = wavy(8, edge, seed + 100);
    const bool inside = touch == SEL_TOUCH_INSIDE;
    for (std::size_t i = 0; i < pair.a.material.size(); ++i) {
        pair.a.position[3 * i] += 2e-3;
        pair.a.position[3 * i + 1] += inside ? 0.25e-3 : 0.6e-3;
        pair.a.position[3 * i + 2] += 0.1 * (pair.a.position[3 * i] - 4e-3);
    }
    pair.part = outside_part(pair.b);
    if (inside) {
        pair.part.touch = touch;
        pair.part.reach_b = 1e-3;
        pair.part.rim = 0.1e-3;
        pair.part.low = pair.part.rim / pair.b.material[1];
    }
    pair.s = 0.37 * pair.a.material.back();
    pair.start = 5;
    return pair;
}

void check_gradient(const TwoEdges& pair)
{
    const std::vector<double> exact = gradient(pair), found = differences(pair);
    // gap of 1e-3 m to 1e-16 of it over 2e-8 m, and the third derivative, 1/(0.3 mm)^2, times nudge^2
    for (std::size_t k = 0; k < exact.size(); ++k) CHECK(exact[k] == test::about(found[k]).epsilon(1e-7).scale(1));
}

void check_hessian(const TwoEdges& pair, unsigned seed, double within = 1e-6)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> some(-1, 1);
    for (int trial = 0; trial < 8; ++trial) {
        std::vector<double> v(pair.size());
        for (double& x : v) x = some(random);
        // in 1/(0.3 mm), the scale of curvature of a tube
        CHECK(curvature_along(pair, v) == test::about(curvature_difference(pair, v)).epsilon(within).scale(3e3));
    }
}

}  // namespace

TEST_SUITE("contact/instrument_gap")
{
    TEST_CASE("property: the spline is continuous with its tangent, and its material coordinate is found back")
    {
        const Nodes nodes = wavy(9, edge, 3);
        const SplineView rod = nodes.view();
        for (const double at : {0.5, 1.5, 2.5, 6.5, 7.5}) {
            const SplinePlace left = spline_place(at - 1e-12, rod.count), right = spline_place(at + 1e-12, rod.count);
            const vec3 jump = spline_sum(rod, left.node, left.w) - spline_sum(rod, right.node, right.w);
            const vec3 kink = spline_sum(rod, left.node, left.d) - spline_sum(rod, right.node, right.d);
            CHECK(std::sqrt(dot3(jump, jump)) < 1e-14);
            CHECK(std::sqrt(dot3(kink, kink)) < 1e-13);
        }
        for (double at = 0; at <= 8; at += 0.05)
            CHECK(spline_at(rod, spline_material(rod, at)) == test::about(at).epsilon(1e-9));
    }

    TEST_CASE("analytic: a straight rod's spline is the rod, with its material where it is")
    {
        Nodes nodes;
        for (const double x : {0.0, 1.0, 1.3, 2.9, 3.4, 5.0}) nodes.add(make_vec3(1e-3 * x, 0, 0));
        for (double s = 0; s <= 5e-3; s += 1e-4)
            CHECK(test::point_of_material(nodes.view(), s).x == test::about(s).epsilon(1e-12));
    }

    TEST_CASE("property: the nearest point is the nearest")
    {
        for (unsigned seed = 1; seed <= 20; ++seed) {
            const TwoEdges pair = near_pair(seed, SEL_TOUCH_OUTSIDE);
            const vec3 x = pair.point_of_material_of_a();
            const InstrumentGap g = pair.gap();
            double least = 1;
            for (double at = 0; at <= 11; at += 1e-3) {
                const SplinePlace p = spline_place(at, 12);
                const vec3 d = x - spline_sum(pair.b.view(), p.node, p.w);
                least = std::min(least, std::sqrt(dot3(d, d)));
            }
            CHECK(g.gap + 0.5e-3 <= least);
            // half a step of the search is 0.5 um on the edge, 0.75 where the spline is stretched: (0.75 um)^2 / 2 farther off
            CHECK(g.gap + 0.5e-3 > least - 0.5 * 0.75e-6 * 0.75e-6 / least);
        }
    }

    TEST_CASE("derivative: gaps outside and inside, gradient and Hessian over the nodes of both")
    {
        for (const uint touch : {SEL_TOUCH_OUTSIDE, SEL_TOUCH_INSIDE})
            for (unsigned seed = 1; seed <= 10; ++seed) {
                const TwoEdges pair = near_pair(seed, touch);
                REQUIRE(pair.gap().gap < 1e-3);
                REQUIRE(pair.gap().bend != 0);
                check_gradient(pair);
                check_hessian(pair, seed);
            }
    }

    TEST_CASE("derivative: gap to the ball at a rod's end")
    {
        for (unsigned seed = 1; seed <= 5; ++seed) {
            TwoEdges pair = near_pair(seed, SEL_TOUCH_OUTSIDE);
            for (std::size_t i = 0; i < pair.a.material.size(); ++i) pair.a.position[3 * i] -= 5e-3;
            pair.start = 0.2;
            REQUIRE(pair.gap().bend == 0);
            check_gradient(pair);
            check_hessian(pair, seed);
        }
    }

    TEST_CASE("derivative: gap at the mouth; the turning of its plane counts in the gradient")
    {
        for (unsigned seed = 1; seed <= 5; ++seed) {
            TwoEdges pair = near_pair(seed, SEL_TOUCH_INSIDE);
            const double shift = pair.point_of_material_of_a().x + 0.15e-3;
            for (std::size_t i = 0; i < pair.a.material.size(); ++i) pair.a.position[3 * i] -= shift;
            pair.start = 0.2;
            REQUIRE(pair.gap().gap < 1e-3);
            REQUIRE(dot3(pair.gap().turn, pair.gap().turn) > 0);
            check_gradient(pair);
        }
    }

    TEST_CASE("derivative: gap at the mouth of a catheter that does not turn, Hessian")
    {
        // directions that translate the catheter's first edge: its plane does not turn
        for (unsigned seed = 1; seed <= 5; ++seed) {
            TwoEdges pair = near_pair(seed, SEL_TOUCH_INSIDE);
            const double shift = pair.point_of_material_of_a().x + 0.15e-3;
            for (std::size_t i = 0; i < pair.a.material.size(); ++i) pair.a.position[3 * i] -= shift;
            std::mt19937 random(seed);
            std::uniform_real_distribution<double> some(-1, 1);
            std::vector<double> v(pair.size());
            for (double& x : v) x = some(random);
            for (std::size_t k = pair.a.position.size(); k < v.size(); ++k) v[k] = v[pair.a.position.size() + k % 3];
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t i = 0; i < 12; ++i) v[pair.a.position.size() + 3 * i + k] = v[k];
            CHECK(curvature_along(pair, v) == test::about(curvature_difference(pair, v)).epsilon(1e-6).scale(3e3));
        }
    }

    TEST_CASE("property: lumen and mouth meet with the same gap and gradient")
    {
        TwoEdges pair;
        for (int i = 0; i < 8; ++i) pair.b.add(make_vec3(edge * i, 0, 0));
        for (int i = 0; i < 4; ++i) pair.a.add(make_vec3(edge * (i - 1), 0.4e-3, 0));
        pair.part = near_pair(1, SEL_TOUCH_INSIDE).part;
        pair.part.low = 0.1;
        const double plane = 0.1 * edge + edge;  // along a
        pair.s = plane - 1e-9;
        const InstrumentGap beyond = pair.gap();
        pair.s = plane + 1e-9;
        const InstrumentGap within = pair.gap();
        CHECK(std::abs(beyond.gap - within.gap) < 1e-14);  // (1 nm)^2 over a circle of 0.7 mm
        CHECK(within.n.y == test::about(beyond.n.y).epsilon(1e-9));
        CHECK(std::abs(beyond.n.x) < 1e-5);
        CHECK(within.gap == test::about(1e-3 - 0.2e-3 - 0.4e-3));
    }
}

}  // namespace seldinger::test::test_instrument_gap
