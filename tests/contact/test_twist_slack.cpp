// A clamped rod with slack whose ends are turned against each other: twisting moment, and the turn at which it jumps into contact
// with itself.
//
// The experiment is that of [vdHeijden03] (van der Heijden, Neukirch, Goss, Thompson, Instability and self-contact phenomena in
// the writhing of clamped rods, Int. J. Mech. Sci. 45, 2003; nitinol wires). The reference here is made independently of it and
// of the engine. With B = L = 1 the equations of Kirchhoff for an inextensible isotropic rod are
//
//     r' = t,   m' = n x t,   n' = 0,   t' = (t x (m x t)) x t = m x t,   M = m . t constant,   d' = (t x t' + M/C t) x d,
//
// d: a director. A half turn about an axis e across the rod through its middle maps the rod onto itself: there r is on e, and t,
// n and m have no part along e. Left are six unknowns (direction of t, two of n, M, m across t, height r . e), and five
// conditions at the clamp: t along x, r on the axis at half of the distance of the clamps. A shooting method follows the curve of
// solutions. The turn of the ends is twice that of d from the middle to the clamp. Where the turn is largest, no equilibrium
// without contact is beside the curve: the rod jumps.
#include "contact/instrument_fixture.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace seldinger::test::test_twist_slack {

namespace {

constexpr double bend = 1e-6, twist = 7e-7, length = 0.3, radius = 1e-3;

// ---- the reference ---------------------------------------------------------------------------------------------------------------

using Unknowns = Eigen::Matrix<double, 6, 1>;  // angle of t, n_x, n_y, M, m across t, height
using Conditions = Eigen::Matrix<double, 5, 1>;
using Slopes = Eigen::Matrix<double, 5, 6>;
using Vector = Eigen::Vector3d;
using State = Eigen::Matrix<double, 12, 1>;  // r, t, m, d

State at_clamp(const Unknowns& u)
{
    const Vector t0(std::cos(u[0]), std::sin(u[0]), 0), across(-t0.y(), t0.x(), 0), n(u[1], u[2], 0);
    const auto slope = [&](const State& y) {
        const Vector t = y.segment<3>(3), m = y.segment<3>(6), d = y.segment<3>(9), turn = m - m.dot(t) * t,
                     spun = turn + u[3] / (twist / bend) * t;
        State s;
        s << t, turn.cross(t), n.cross(t), spun.cross(d);
        return s;
    };
    State y;
    y << 0, 0, u[5], t0, u[3] * t0 + u[4] * across, Vector::UnitZ();
    constexpr int steps = 100;  // RK4: 1e-8 of the state
    constexpr double h = 0.5 / steps;
    for (int k = 0; k < steps; ++k) {
        const State a = slope(y), b = slope(y + h / 2 * a), c = slope(y + h / 2 * b), d = slope(y + h * c);
        y += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return y;
}

Conditions misses(const Unknowns& u, double slack)
{
    const State y = at_clamp(u);
    return Conditions(y[4], y[5], y[1], y[2], y[0] - (1 - slack) / 2);
}

Slopes slopes(const Unknowns& u, double slack)
{
    Slopes s;
    for (int k = 0; k < 6; ++k) {
        Unknowns more = u, less = u;
        const double e = 1e-6 * std::max(1.0, std::abs(u[k]));
        more[k] += e, less[k] -= e;
        s.col(k) = (misses(more, slack) - misses(less, slack)) / (2 * e);
    }
    return s;
}

/// Newton's method with what holds one unknown, or a sum of them, as the last equation: along . (u - at) = ahead.
bool solve(Unknowns& u, double slack, const Unknowns& along, const Unknowns& at, double ahead)
{
    for (int k = 0; k < 30; ++k) {
        Eigen::Matrix<double, 6, 6> a;
        a << slopes(u, slack), along.transpose();
        Unknowns b;
        b << misses(u, slack), along.dot(u - at) - ahead;
        const Unknowns change = a.fullPivLu().solve(b);
        u -= change;
        if (change.lpNorm<Eigen::Infinity>() < 1e-9) return true;
    }
    return false;
}

struct Point {
    double turn, moment;  // [rad], M L/B
};

/// Solutions from no turn on, until the turn falls.
std::vector<Point> branch(double slack)
{
    // the planar elastica, from that of small slack: z = a (1 + cos 2 pi x)/2, slack = (pi a/2)^2
    constexpr double pi = std::numbers::pi, small = 0.01;
    const double a = 2 * std::sqrt(small) / pi;
    Unknowns u, flat = Unknowns::Zero();
    u << 0, -4 * pi * pi, 0, 0, 2 * pi * pi * a, a;
    flat[3] = 1;  // without moment
    for (double s = small; s < slack + 0.005; s += 0.01) REQUIRE(solve(u, std::min(s, slack), flat, Unknowns::Zero(), 0));
    Unknowns along = flat;
    std::vector<Point> points = {{0, 0}};
    for (int k = 0; k < 1000; ++k) {
        const Unknowns before = u;
        const double ahead = k < 10 ? 0.05 : 0.25 + 0.005 * std::abs(u[1]);  // between two points 1e-3 of the moment is lost
        u += ahead * along;
        REQUIRE(solve(u, slack, along, before, ahead));
        const Unknowns next = slopes(u, slack).fullPivLu().kernel().col(0).normalized();
        along = next.dot(along) > 0 ? next : Unknowns(-next);
        const State y = at_clamp(u);
        double turn = 2 * std::atan2(-y[10], y[11]);
        turn += 4 * pi * std::round((points.back().turn - turn) / (4 * pi));
        points.push_back({turn, u[3]});
        if (turn < points[points.size() - 2].turn) return points;
    }
    FAIL("no largest turn");
    return points;
}

double moment_at(const std::vector<Point>& points, double turn)
{
    const auto after = std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.turn > turn; });
    REQUIRE(after != points.end());
    const Point &b = *after, &a = *(after - 1);
    return a.moment + (turn - a.turn) / (b.turn - a.turn) * (b.moment - a.moment);
}

// ---- the rod ---------------------------------------------------------------------------------------------------------------------

constexpr double turned = 2.0;  // [rad/s]

/// Its clamps are brought together in the first second, and turned from the second one on; equilibria.
WorldSetup clamped(double slack, int nodes)
{
    WireSetup rod = straight_wire(bend, 200, length, radius, nodes);
    rod.wire.shaft.twist_stiffness = twist;
    rod.contact.stiffness_from_wall = true;
    put(rod, Vec3::Zero(), Vec3::UnitX());
    HoldSpec tip = hold_of(WirePoint::Kind::Tip, true, true);
    tip.move = {{0, 0, 0, 0}, {1, -slack * length, 0, 0}};
    tip.turn = {{0, 0}, {2, 0}, {22, 20 * turned}};
    rod.holds = {hold_of(WirePoint::Kind::Base, true, true), tip};
    rod.loads = {{.at = {WirePoint::Kind::Distance, length / 2}, .force = {0, 5e-4, 3e-4}, .until = 1}};
    return touching({rod});
}

}  // namespace

TEST_SUITE("contact/twist_slack")
{
    TEST_CASE("analytic: a clamped rod with slack twists as Kirchhoff's equations say, and jumps into contact where they end")
    {
        double slack = 0;  // at 0.4 and more the branch begins with a turn the other way: another solution
        SUBCASE("0.2") { slack = 0.2; }
        SUBCASE("0.25") { slack = 0.25; }
        SUBCASE("0.3") { slack = 0.3; }
        CAPTURE(slack);
        const std::vector<Point> points = branch(slack);
        const double largest = points[points.size() - 2].turn;
        World world(clamped(slack, 121));
        double jumped = 0, worst = 0;
        for (int k = 1; k <= 900 && jumped == 0; ++k) {
            const double dt = 0.02, t = k * dt, turn = std::max(t - 2, 0.0) * turned;
            const StepReport report = step(world, dt);
            CAPTURE(turn);
            REQUIRE_FALSE(report.failed());
            if (!world.contacts().empty()) jumped = turn;
            else if (turn > 1 && turn < 0.98 * largest) {
                const double moment = std::abs(world.readings(0).hand_torque) * length / bend;
                worst = std::max(worst, std::abs(moment / moment_at(points, turn) - 1));
            }
        }
        MESSAGE("largest turn " << largest << ", jumped at " << jumped << "; moments to " << worst);
        // edges of L/120 turn by up to 0.1 rad from one to the next: 0.1^2/12 of the bending moment
        CHECK(worst < 0.002);
        // that of the turn, and steps of 0.04 rad
        CHECK(jumped == about(largest).epsilon(0.004));
    }
}

}  // namespace seldinger::test::test_twist_slack
