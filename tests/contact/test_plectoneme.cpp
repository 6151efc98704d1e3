// A twisted rod that winds about itself, against the theory of its ply.
//
// In the middle of a plectoneme two strands wind about each other at distance R from the axis, by an angle a to it, and nothing
// acts on the ply as a whole. [Clauvelin08], derived anew by virtual work: with energy e = B kappa^2/2, kappa = sin^2 a/R, per
// length of strand, and the rotation psi' = sin 2a/(2 R) that the ends make for a length of strand,
//
//     M = d e/d psi' at fixed R,     p = d(e - M psi')/dR,     T = M psi' - e
//
//       = 2 B sin^3 a cos a/(R cos 2a),  B sin^4 a/(R^3 cos 2a),  B sin^4 a/R^2 (1/2 + 1/cos 2a):
//
// twisting moment of the rod, contact force per length of strand, tension of the straight tails. A polygon of edges h whose
// spline runs at distance R has its nodes at R/cos(phi/2), phi being the turn about the axis for an edge. That is 5 % more of M
// here; so e and psi are those of a polygon:
//
//     e h = B theta^2/(2 h),  psi = 2 atan(tan(phi/2) cos b),  sin b = 2 R tan(phi/2)/h,  cos theta = cos^2 b + sin^2 b cos phi,
//
// b: angle of the edges, theta: between two of them, psi: turn of a rotation by phi about the axis along the tangent.
#include "contact/instrument_fixture.h"
#include "setup/key_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger::test::test_plectoneme {

namespace {

constexpr double bend = 1e-6, length = 0.3, radius = 1e-3;
constexpr int nodes = 121;

/// Turned by eight turns and brought together by half of its length.
WorldSetup twisted()
{
    WireSetup rod = straight_wire(bend, 200, length, radius, nodes);
    rod.wire.shaft.density = 1500;
    rod.wire.shaft.twist_stiffness = 7e-7;
    rod.contact.stiffness_from_wall = true;
    put(rod, Vec3::Zero(), Vec3::UnitX());
    HoldSpec tip = hold_of(WirePoint::Kind::Tip, true, true);
    tip.move = {{0, 0, 0, 0}, {0.4, 0, 0, 0}, {1.2, -0.15, 0, 0}};
    tip.turn = {{0, 0}, {0.4, 50}};
    rod.holds = {hold_of(WirePoint::Kind::Base, true, true), tip};
    LoadSpec aside;  // to one side, until the loop has formed
    aside.at.kind = WirePoint::Kind::Distance;
    aside.at.from_tip = length / 2;
    aside.force = {0, 5e-4, 3e-4};
    aside.until = 1.2;
    rod.loads = {aside};
    WorldSetup made = touching({rod});
    made.integrator.scheme = Scheme::Newton;
    made.integrator.damping_mass = 20;
    return made;
}

struct Ply {
    double distance = 0;    // of a strand from the axis [m]
    double turn = 0;        // about it for an edge [rad]
    double per_length = 0;  // contact force per length of a strand [N/m]
};

/// The curve at a material coordinate.
Vec3 curve_at(const ConstRodView& rod, double s)
{
    const double at = s / (length / (nodes - 1));
    const int i = std::clamp(static_cast<int>(std::lround(at)), 1, nodes - 2);
    const double u = at - i;
    return 0.5 * (0.5 - u) * (0.5 - u) * rod.pos(i - 1) + (0.75 - u * u) * rod.pos(i) +
           0.5 * (0.5 + u) * (0.5 + u) * rod.pos(i + 1);
}

/// In the middle of where it touches, over 10 cells and 8 edges: the force of a cell goes by how the nodes lie in it, +-10 %, and
/// comes back after 10 mm of both.
Ply measure(const World& world)
{
    double first = length, last = 0, opposite = 0, force = 0, metres = 0;
    int rows = 0;
    const auto& contacts = world.contacts();
    for (const ContactRow& row : contacts) {
        if (row.length < 1.5 * radius) continue;  // touches all along its cell
        first = std::min(first, row.along_a);
        last = std::max(last, row.along_a);
    }
    constexpr double half = 0.01;
    REQUIRE(last - first > 2.5 * half);
    const double middle = 0.5 * (first + last);
    for (const ContactRow& row : contacts) {
        if (std::abs(row.along_a - middle) > half) continue;
        force += row.normal_force;
        metres += row.length;
        opposite += row.along_a + row.along_b;
        ++rows;
    }
    Ply ply;
    REQUIRE(rows == 10);
    ply.per_length = force / metres;
    opposite /= rows;
    constexpr int samples = 200;
    std::vector<Vec3> axis, across;
    for (int k = 0; k <= samples; ++k) {
        const double s = middle + half * (2.0 * k / samples - 1);
        const Vec3 a = curve_at(world.rod(0), s), b = curve_at(world.rod(0), opposite - s);
        axis.push_back(0.5 * (a + b));
        across.push_back(a - b);
        ply.distance += 0.5 * across.back().norm() / (samples + 1);
    }
    for (int k = 0; k < samples; ++k)
        ply.turn +=
            std::atan2(across[k].cross(across[k + 1]).dot((axis[k + 1] - axis[k]).normalized()), across[k].dot(across[k + 1]));
    ply.turn = std::abs(ply.turn) * (length / (nodes - 1)) / (2 * half);
    return ply;
}

struct Theory {
    double moment, per_length, tension;
};

Theory theory(double distance, double turn)
{
    constexpr double h = length / (nodes - 1);
    struct Edge {
        double energy, rotation;
    };
    const auto edge = [](double r, double phi) {
        const double sine = 2 * r * std::tan(phi / 2) / h, cosine = std::sqrt(1 - sine * sine);
        const double theta = std::acos(cosine * cosine + sine * sine * std::cos(phi));
        return Edge{0.5 * bend * theta * theta / h, 2 * std::atan(std::tan(phi / 2) * cosine)};
    };
    constexpr double part = 1e-5;  // central differences: errors of 1e-10
    const Edge more = edge(distance, turn * (1 + part)), less = edge(distance, turn * (1 - part));
    const Edge out = edge(distance * (1 + part), turn), in = edge(distance * (1 - part), turn), here = edge(distance, turn);
    const double moment = (more.energy - less.energy) / (more.rotation - less.rotation);
    return {moment, (out.energy - in.energy - moment * (out.rotation - in.rotation)) / (2 * part * distance * h),
            (moment * here.rotation - here.energy) / h};
}

}  // namespace

TEST_SUITE("contact/plectoneme")
{
    TEST_CASE("analytic: the polygon's ply becomes [Clauvelin08] with short edges")
    {
        // edges turn by phi = 0.01: phi^2/4 of M, the largest part
        const double turn = 0.01, h = length / (nodes - 1), distance = 0.26 * h / turn, angle = std::asin(0.26);
        const Theory now = theory(distance, turn);
        const double s = std::sin(angle), c = std::cos(angle), c2 = std::cos(2 * angle);
        CHECK(now.moment == about(2 * bend * s * s * s * c / (distance * c2)).epsilon(1e-4));
        CHECK(now.per_length == about(bend * std::pow(s, 4) / (std::pow(distance, 3) * c2)).epsilon(1e-4));
        CHECK(now.tension == about(bend * std::pow(s, 4) / (distance * distance) * (0.5 + 1 / c2)).epsilon(1e-4));
    }

    TEST_CASE("analytic: a plectoneme's twisting moment, contact force and tension are those of its ply")
    {
        World world(twisted());
        int halved = 0;
        for (int k = 0; k < 2200; ++k) {
            const StepReport report = step(world, 1e-3);
            REQUIRE_FALSE(report.failed());
            REQUIRE((report.flags & StepBestEffort) == 0);
            halved += (report.flags & StepHalved) != 0;
        }
        CHECK(halved < 44);  // 2 % of the steps
        REQUIRE(world.readings(0).kinetic < 1e-3 * world.readings(0).elastic);
        const Ply ply = measure(world);
        REQUIRE(ply.turn > 0.5);
        const Theory expected = theory(ply.distance, ply.turn);
        MESSAGE((ply.per_length / expected.per_length)
                << " of the force, " << (std::abs(world.readings(0).hand_torque) / expected.moment) << " of the moment, "
                << (-world.readings(0).base_force.x() / expected.tension) << " of the tension");
        // 1 %: forces go as R^3 and more of the shape, which is measured over 0.8 turns to 0.2 %
        CHECK(ply.per_length == about(expected.per_length).epsilon(0.01));
        CHECK(std::abs(world.readings(0).hand_torque) == about(expected.moment).epsilon(0.01));
        // 2 %: a loop may take up to the change of its energy between two places of the nodes to move along the rod
        CHECK(-world.readings(0).base_force.x() == about(expected.tension).epsilon(0.02));
        CHECK(ply.distance > 0.98 * radius);
    }
}

}  // namespace seldinger::test::test_plectoneme
