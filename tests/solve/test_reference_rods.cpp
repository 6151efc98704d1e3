// Rods that twist and bend in space against independent solutions (elliptic integrals, shooting of the Kirchhoff equations).
// Tolerances are those of the reference suite: second-order errors at the stated number of edges, with room.
#include "solve/wire_fixture.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>

using namespace seldinger;
using namespace seldinger::testing;

namespace {

WireSpec uniform(double length, double bend, double twist, double stretch)
{
    WireSpec spec = nitinol(length);
    spec.shaft.bend_stiffness = bend;
    spec.shaft.twist_stiffness = twist;
    spec.shaft.stretch_stiffness = stretch;
    spec.shaft.radius = 1e-3 * length;  // of no account in statics
    return spec;
}

HoldSpec clamp_tip()
{
    HoldSpec hold = clamp_base();
    hold.at.kind = WirePoint::Kind::Tip;
    return hold;
}

/// Straight for `straight`, then an arc towards +y; tangent +x at the base.
Curve hook(double straight_part, double radius)
{
    return [=](double s) {
        const double phi = std::max(0.0, s - straight_part) / radius;
        return Vec3(std::min(s, straight_part) + radius * std::sin(phi), radius * (1 - std::cos(phi)), 0);
    };
}

struct Clamped {
    double theta, moment, tension, extra_slack;
};

/// Clamped at both ends, turned by `rotation`, then brought together by `slack`. Nothing breaks the symmetry but equilibrium().
Clamped helical(const WireSpec& spec, int edges, double rotation, double slack)
{
    Rig rig(spec, edges + 1);
    HoldSpec base = clamp_base(), tip = clamp_tip();
    base.turn = {{0, 0}, {1, rotation}};
    tip.move = {{1, 0, 0, 0}, {2, -slack, 0, 0}};
    rig.hold({base, tip});
    rig.integrate_with({});
    const int turns = 20, approach = 40;
    for (int k = 1; k <= turns + approach; ++k) {
        rig.fill(k <= turns ? k / double(turns) : 1 + (k - turns) / double(approach));
        rig.solver->equilibrium(rig.constraints, nullptr, rig.active, rig.reports);
        CAPTURE(k);
        REQUIRE(rig.reports[0].converged);
    }
    Clamped result{};
    for (int j = 0; j < edges; ++j) result.theta = std::max(result.theta, std::acos(std::min(1.0, -rig.rod().tx[j])));
    result.moment = clamp_torque(rig.rod(), rig.constraints[0].clamps, rig.solver->frames(0), 0);
    result.tension = rig.solver->reaction(0, 0);
    result.extra_slack = result.tension * spec.length / spec.shaft.stretch_stiffness;
    return result;
}

/// Farthest node from the plane that fits best [m].
double out_of_plane(const RodView& rod)
{
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < rod.n; ++i) centre += rod.pos(i) / rod.n;
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (int i = 0; i < rod.n; ++i) second += (rod.pos(i) - centre) * (rod.pos(i) - centre).transpose();
    const Vec3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvectors().col(0);
    double off = 0;
    for (int i = 0; i < rod.n; ++i) off = std::max(off, std::abs(normal.dot(rod.pos(i) - centre)));
    return off;
}

/// A frictionless tube of no clearance round the arc of radius R in the xz plane that begins at the origin along +x.
class ArcGuide : public ContactTerm {
public:
    ArcGuide(RodArrays& rods, double radius, double stiffness) : rods_(rods), radius_(radius), stiffness_(stiffness) {}
    void evaluate(const TrialState& trial, double, std::span<const std::uint8_t>) override { state_ = trial; }
    bool admissible(int) const override { return true; }
    bool unsymmetric(int) const override { return false; }
    double largest_force(int) const override { return 0; }
    double move_limit(int) const override { return INFINITY; }
    void add(int wire, std::span<double> gradient, BandMatrix* jacobian, bool) const override
    {
        for (int i = 0; i < rods_.node_count(wire); ++i) {
            const int at = rods_.node_begin(wire) + i;
            const Vec3 from_centre(state_.x[at], 0, state_.z[at] - radius_);
            const double rho = from_centre.norm();
            const Vec3 outward = from_centre / rho;
            const Vec3 off = (rho - radius_) * outward + Vec3(0, state_.y[at], 0);
            for (int c = 0; c < 3; ++c) gradient[4 * i + c] += stiffness_ * off[c];
            if (!jacobian) continue;
            const Vec3 along = outward.cross(Vec3::UnitY());
            for (int c = 0; c < 3; ++c)
                for (int d = 0; d < 3; ++d)
                    jacobian->add(4 * i + c, 4 * i + d, stiffness_ * ((c == d) - radius_ / rho * along[c] * along[d]));
        }
    }

private:
    RodArrays& rods_;
    double radius_, stiffness_;
    TrialState state_;
};

struct Lag {
    double proximal, distal, torque;  // [deg], [deg], [N m]
};

/// Turns the base of a naturally curved wire in a curved tube by 5 degrees at a time; distal angles where asked.
void check_whip(double natural, double length, const std::vector<Lag>& expected)
{
    WireSpec spec = uniform(length, 5.5e-5, 4.23e-5, 5000);
    spec.shaft.rest_curvature = {natural, 0};
    Rig rig(spec, 121, 1, arc_towards_z(0.05));
    HoldSpec base = clamp_base();
    base.turn = {{0, 0}, {360, 2 * pi}};
    rig.hold({base});
    rig.integrate_with({});
    ArcGuide guide(rig.rods, 0.05, 1e4);
    std::size_t next = 0;
    for (int degrees = 0; degrees <= 320 && next < expected.size(); degrees += 5) {
        CAPTURE(degrees);
        rig.fill(degrees);
        rig.solver->equilibrium(rig.constraints, &guide, rig.active, rig.reports);
        REQUIRE(rig.reports[0].converged);
        if (degrees != static_cast<int>(expected[next].proximal)) continue;
        const double distal = rig.rod().theta[0] * 180 / pi;
        CHECK(std::abs(distal - expected[next].distal) < 3);
        const double torque = clamp_torque(rig.rod(), rig.constraints[0].clamps, rig.solver->frames(0), 0);
        CHECK(torque == doctest::Approx(expected[next].torque).epsilon(0.02));
        ++next;
    }
    CHECK(next == expected.size());
}

}  // namespace

TEST_SUITE("solve/reference_rods") {

// Bathe & Bolourchi, IJNME 14 (1979) 961; numbers from shooting the Kirchhoff equations
TEST_CASE("analytic: a 45 degree bend loaded out of its plane, second order in the edge length") {
    const Vec3 expected(47.15129440030414, 15.685078162156607, 53.468598442324165);
    double error[2];
    for (int k : {0, 1}) {
        Rig rig(uniform(78.53981633974483, 833333.3333333334, 833333.3333333334, 1e10), k == 0 ? 26 : 51, 1, hook(0, 100), true);
        rig.hold({clamp_base()}, {tip_load({0, 0, 600})});
        rig.integrate_with({});
        REQUIRE(rig.settle());
        error[k] = (rig.tip() - expected).norm();
        MESSAGE((k == 0 ? 25 : 50) << " edges: error " << error[k] << " m in " << rig.reports[0].iterations << " iterations");
    }
    CHECK(error[1] < 0.005 * 78.5);
    CHECK(std::log2(error[0] / error[1]) == doctest::Approx(2).epsilon(0.15));
}

struct Hook {
    const char* name;
    double straight_part, radius, angle, bend, twist, compliance;
    std::vector<std::array<double, 4>> loads;  // Fx, Fy -> tip x, y
};

TEST_CASE("analytic: shaped tips straightened by a load at the tip, and their compliance out of plane") {
    const Hook hooks[] = {
        {"180 degrees, 3 mm", 0.01, 0.003, pi, 5e-6, 3.85e-6, 0.20170338305743357,
         {{0.05555555555555557, 0, 0.01401795921388227, 0.003265302584839671},
          {0.5555555555555556, 0, 0.018534376650973308, 9.866757298111183e-05},
          {2.7777777777777777, 0, 0.019324165797374702, 3.480842921330581e-07}}},
        {"45 degrees, 5 mm", 0.02, 0.005, pi / 4, 2e-6, 1.54e-6, 2.2033384689142577,
         {{0, -0.0016, 0.023549173668334256, -0.0020413654756784735}, {0, -0.016, 0.01557026305233775, -0.01638417868982854}}},
        {"90 degrees, 10 mm", 0, 0.01, pi / 2, 1e-5, 7.7e-6, 0.12479884104004937,
         {{0.02, 0, 0.01136976480683764, 0.008985698492587792}, {0.3, 0, 0.015244490161202655, 0.0028874933195521453}}},
    };
    for (const Hook& h : hooks) {
        CAPTURE(h.name);
        const double length = h.straight_part + h.radius * h.angle;
        // EA/P > 1e4, so that stretching stays below the tolerance
        const WireSpec spec = uniform(length, h.bend, h.twist, 1e5);
        for (const auto& [fx, fy, x, y] : h.loads) {
            CAPTURE(fx);
            Rig rig(spec, 101, 1, hook(h.straight_part, h.radius), true);
            rig.hold({clamp_base()}, {tip_load({fx, fy, 0})});
            rig.integrate_with({});
            REQUIRE(rig.settle());
            CHECK(std::hypot(rig.tip().x() - x, rig.tip().y() - y) < 0.005 * length);
        }
        Rig rig(spec, 101, 1, hook(h.straight_part, h.radius), true);
        const double small = 1e-3 * length / h.compliance;
        rig.hold({clamp_base()}, {tip_load({0, 0, small})});
        rig.integrate_with({});
        REQUIRE(rig.settle());
        CHECK(rig.tip().z() / small == doctest::Approx(h.compliance).epsilon(0.03));
    }
}

// Greenhill: torque of a clamped straight wire with one end free to slide, M L/B = 8.98682; 100 edges, 3 %
TEST_CASE("analytic: Greenhill's torque, clamped ends, no tension") {
    const WireSpec spec = uniform(0.2, 5.5e-5, 4.23e-5, 1e4);
    for (const double part : {0.97, 1.03}) {
        CAPTURE(part);
        Rig rig(spec, 101);
        const double angle = part * 11.684989134042485;
        HoldSpec base = clamp_base(), tip = clamp_tip();
        base.turn = {{0, 0}, {1, angle}};
        tip.position = false;
        rig.hold({base, tip});
        rig.integrate_with({});
        for (int k = 1; k <= 4; ++k) {
            rig.fill(0.25 * k);
            // the far end slides along the axis and is held sideways
            rig.constraints[0].prescribed.emplace_back(1, 0.0);
            rig.constraints[0].prescribed.emplace_back(2, 0.0);
            rig.solver->equilibrium(rig.constraints, nullptr, rig.active, rig.reports);
            REQUIRE(rig.reports[0].converged);
        }
        // below it stays straight; above it throws a loop, which passes through itself (wires do not touch each other here)
        // and takes two turns with it: the torque left is that of the angle less 4 pi
        const double torque = clamp_torque(rig.rod(), rig.constraints[0].clamps, rig.solver->frames(0), 0);
        const double left = part < 1 ? angle : angle - 4 * pi;
        CHECK(torque == doctest::Approx(spec.shaft.twist_stiffness * left / 0.2).epsilon(1e-3));
    }
}

// Michell, Zajac: Theta = 2 pi sqrt(3) B/C; 100 edges move it by 0.3 %. A ring cut and clamped at one section is the ring.
TEST_CASE("analytic: Michell's ring leaves its plane at the critical twist") {
    for (const double ratio : {0.5, 1.3}) {
        for (const double part : {0.97, 1.03}) {
            CAPTURE(ratio);
            CAPTURE(part);
            const double radius = 0.05, bend = 5.5e-5;
            const WireSpec spec = uniform(2 * pi * radius, bend, bend / ratio, 1e4);
            Rig rig(spec, 101, 1, arc_towards_z(radius));
            HoldSpec base = clamp_base();
            base.turn = {{0, 0}, {1, part * 2 * pi * std::sqrt(3.0) * ratio}};
            rig.hold({base, clamp_tip()});
            rig.integrate_with({});
            for (int k = 1; k <= 5; ++k) {
                rig.fill(0.2 * k);
                rig.solver->equilibrium(rig.constraints, nullptr, rig.active, rig.reports);
                REQUIRE(rig.reports[0].converged);
            }
            // above it the ring bends out of its plane; past B/C = 1.25 that does not end before it has passed through itself
            // and lost two turns (wires do not touch each other here): flat again, with less torque
            const double torque = clamp_torque(rig.rod(), rig.constraints[0].clamps, rig.solver->frames(0), 0);
            const double flat = spec.shaft.twist_stiffness * base.turn[1][1] / spec.length;
            const double off = out_of_plane(rig.rod());
            if (part < 1) {
                CHECK(off < 1e-3 * radius);  // the cut ring is not quite the whole one: chords of an arc with its rest lengths
                CHECK(torque == doctest::Approx(flat).epsilon(1e-3));
            } else {
                CHECK((off > 0.05 * radius || torque < 0.5 * flat));
            }
        }
    }
}

// van der Heijden & Thompson 2000; Bergou 2008: 27 turns. Stretch adds T L/EA to the slack, here below 1e-3 of it. With 200
// edges the wire turns by kappa l = 0.24 an edge at the crest, and 2 tan(phi/2) is stiffer than phi there: 6 % in theta, four
// times less with 400.
TEST_CASE("analytic: localised helical buckling of a clamped, twisted wire brought together") {
    const WireSpec spec = uniform(9.29, 1.345, 0.789, 2e6);
    const Clamped coarse = helical(spec, 200, 169.64600329384882, 0.3), c = helical(spec, 400, 169.64600329384882, 0.3);
    const double theta = 0.9185498494452109;
    CHECK(c.extra_slack < 0.001 * 0.3);
    CHECK(c.theta == doctest::Approx(theta).epsilon(0.02));
    CHECK(std::abs(c.moment) == doctest::Approx(14.252015654526478).epsilon(0.002));
    CHECK(c.tension == doctest::Approx(46.98850028536553).epsilon(0.03));
    CHECK(std::log2((coarse.theta - theta) / (c.theta - theta)) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("analytic: the same for a 0.014 inch guidewire, 15 turns, 200 edges") {
    const Clamped c = helical(uniform(0.3, 0.00011, 8.5e-5, 1e4), 200, 94.24777960769379, 0.012);
    CHECK(c.theta == doctest::Approx(0.798023905594933).epsilon(0.03));
    CHECK(std::abs(c.moment) == doctest::Approx(0.02625134747365281).epsilon(0.02));
    CHECK(c.tension == doctest::Approx(1.8446146352757284).epsilon(0.03));
}

// C psi'' = B kappa kappa0 sin psi in a frictionless bend; elliptic closed form
TEST_CASE("analytic: a curved wire turned in a curved tube lags, and whips past the critical length") {
    check_whip(5, 0.1, {{30, 17.566068715751218, 0.0002015967250812158}, {60, 36.1611342302977, 0.00037817318712058496},
                        {90, 57.169899833968415, 0.0005022571720563817}, {120, 83.05572830723817, 0.0005375003084609049},
                        {150, 119.61329235635102, 0.00041597670161065627}, {170, 156.7023652865001, 0.00017569959804561135}});
    check_whip(20, 0.12, {{45, 5.89142947216473, 0.0007316435876713627}, {90, 12.33513652359464, 0.0013484189753868129},
                          {135, 20.14243636942776, 0.0017502671644237168}, {180, 31.028545592204473, 0.001859054060308135},
                          {225, 51.32951361474465, 0.0015744905216453667}, {270, 347.66486347640546, -0.0013484189753868187},
                          {315, 354.1085705278353, -0.0007316435876713342}});
}
}
