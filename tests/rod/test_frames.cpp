// Frames: transport, continuity of reference twist, and configurations that do not exist.

#include "math/eigen.h"
#include "rod/rod_fixture.h"

#include <Eigen/Geometry>
#include <numbers>

namespace seldinger::test::test_frames {

namespace {

constexpr double pi = std::numbers::pi;

OneWire helix(int n)
{
    std::vector<Vec3> nodes;
    for (int i = 0; i < n; ++i) nodes.push_back({std::cos(0.4 * i), std::sin(0.4 * i), 0.2 * i});
    OneWire wire(n);
    wire.place(nodes);
    set_rest_shape(wire.rod, uniform_spec(wire.rod.material_s[n - 1], 1, 0.7, 10), false);
    return wire;
}

OwnedTrial rotated(const RodView& rod, const Mat3& rotation)
{
    OwnedTrial trial(rod);
    for (int i = 0; i < rod.n; ++i) {
        const Vec3 p = rotation * rod.pos(i);
        for (int c = 0; c < 3; ++c) trial[RodDofs::position(i, c)] = p[c];
    }
    return trial;
}

}  // namespace

TEST_SUITE("rod/frames")
{
    TEST_CASE("property: initial frames follow the wire without twist, hub director as asked")
    {
        OneWire wire = helix(20);
        REQUIRE(wire.update());
        const RodView& rod = wire.rod;
        for (int j = 0; j < rod.n - 1; ++j) {
            CHECK(std::abs(rod.tangent(j).dot(rod.ref_d1(j))) < 1e-15);
            CHECK(rod.ref_d1(j).norm() == about(1).epsilon(1e-15));
            CHECK(std::abs(wire.frames.twist[j]) < 1e-14);
        }
        const Vec3 t = rod.tangent(rod.n - 2);
        CHECK((rod.ref_d1(rod.n - 2) - unit_normal(Vec3::UnitZ(), t)).norm() < 1e-15);
    }

    // Transport does not follow the part of a rotation that spins an edge about its tangent: theta does. With material frames
    // turned like the wire, nothing is stored, however often and whichever way it is turned.
    TEST_CASE("property: rigid rotations along any path change neither energy nor twist")
    {
        OneWire wire = helix(12);
        for (int j = 0; j < 11; ++j) wire.rod.theta[j] = 0.3 * j;
        REQUIRE(wire.update());
        const double energy = wire.energy();
        std::vector<double> twist = wire.frames.twist;
        const Vec3 axes[3] = {Vec3::UnitX(), Vec3(0, 1, 0.3).normalized(), Vec3(1, -1, 1).normalized()};
        for (int k = 0; k < 300; ++k) {
            const Mat3 step = to_mat3(Eigen::AngleAxisd(0.21, eigen(axes[k % 3])).toRotationMatrix());
            REQUIRE(wire.update());
            std::vector<Vec3> wanted;
            for (int j = 0; j < 11; ++j) wanted.push_back(step * wire.frames.m1[j]);
            OwnedTrial trial = rotated(wire.rod, step);
            REQUIRE(wire.update(trial));
            for (int j = 0; j < 11; ++j) trial.theta[j] += signed_angle(wire.frames.m1[j], wanted[j], wire.frames.tangent[j]);
            REQUIRE(wire.accept(trial));
        }
        REQUIRE(wire.update());
        CHECK(wire.energy() == about(energy).epsilon(1e-10));  // rounding of 300 steps
        for (int i = 1; i < 11; ++i) CHECK(wire.frames.twist[i] == about(twist[i]).epsilon(1e-10));
    }

    TEST_CASE("regression: no such configuration gives false and leaves the accepted state alone")
    {
        OneWire wire = helix(6);
        const OwnedTrial good(wire.rod);
        REQUIRE(wire.update(good));
        const double energy = wire.energy();

        OwnedTrial zero = good;
        for (int c = 0; c < 3; ++c) zero[RodDofs::position(3, c)] = zero[RodDofs::position(2, c)];
        CHECK_FALSE(wire.update(zero));

        OwnedTrial folded = good;  // node 4 put back onto the line from 3 to 2
        for (int c = 0; c < 3; ++c)
            folded[RodDofs::position(4, c)] =
                folded[RodDofs::position(3, c)] + 0.7 * (folded[RodDofs::position(2, c)] - folded[RodDofs::position(3, c)]);
        CHECK_FALSE(wire.update(folded));

        for (const int unknown : {4 * 2, 4 * 2 + 3}) {
            OwnedTrial bad = good;
            bad[unknown] = std::nan("");
            CHECK_FALSE(wire.update(bad));
            bad[unknown] = INFINITY;
            CHECK_FALSE(wire.update(bad));
        }

        OwnedTrial reversed = good;  // each edge turned by pi at once: transport does not say which way
        for (int q = 0; q < 4 * 6; ++q)
            if (!RodDofs::is_spin(q)) reversed[q] = -reversed[q];
        CHECK_FALSE(wire.update(reversed));

        wire.clamps = {RodClamp{}};
        wire.clamps[0].node = 5;
        wire.clamps[0].tangent = -wire.rod.tangent(4);
        CHECK_FALSE(wire.update(good));
        wire.clamps.clear();

        REQUIRE(wire.update());
        CHECK(wire.energy() == energy);
    }

    // Near a fold the energy rises as 1/(pi - phi)^2 and stays finite
    TEST_CASE("analytic: energy near a fold")
    {
        for (const double rest : {1e-1, 1e-2, 1e-3})
            for (const CurvatureMeasure measure : {CurvatureMeasure::Angle, CurvatureMeasure::Tangent}) {
                OneWire wire(3);
                wire.rod.curvature = measure;
                wire.place({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1 - std::cos(rest), std::sin(rest), 0)});
                set_rest_shape(wire.rod, uniform_spec(2, 1, 1, 1), false);
                REQUIRE(wire.update());
                // the angle's has a third of the tangent's barrier
                const double kb2 = 4 / std::pow(std::tan(rest / 2), 2), s2 = std::pow(std::cos(rest / 2), 2);
                const double square = measure == CurvatureMeasure::Tangent ? kb2 : kb2 * (1 - 2 * s2 / 3);
                CHECK(wire.energy() == about(square / 2).epsilon(1e-9));
            }
    }

    // The reference twist follows a slow loop of the shape past pi, and returns to its start
    TEST_CASE("property: reference twist is continuous over many turns")
    {
        // three edges; the last swings around a cone about the middle one while the first swings the other way
        OneWire wire(4);
        const auto shape = [&](double a) {
            const double s = std::sin(0.5), c = std::cos(0.5);
            return std::vector<Vec3>{Vec3(-c, s * std::cos(-a), s * std::sin(-a)), Vec3(0, 0, 0), Vec3(1, 0, 0),
                                     Vec3(1 + c, s * std::cos(a), s * std::sin(a))};
        };
        wire.place(shape(0));
        set_rest_shape(wire.rod, uniform_spec(3, 1, 1, 1), false);
        const int steps = 4000;
        double largest_jump = 0, last = 0;
        for (int k = 1; k <= steps; ++k) {
            OwnedTrial trial(wire.rod);
            const auto nodes = shape(8 * pi * k / steps);
            for (int i = 0; i < 4; ++i)
                for (int c = 0; c < 3; ++c) trial[RodDofs::position(i, c)] = nodes[i][c];
            REQUIRE(wire.accept(trial));
            largest_jump = std::max(largest_jump, std::abs(wire.rod.ref_twist[2] - last));
            last = wire.rod.ref_twist[2];
        }
        CHECK(largest_jump < 0.01);
        // Each turn of the cone of half angle 0.5 winds by its solid angle, 2 pi (1 - cos 0.5). Transport is that of the
        // 1000-sided cone, an area smaller by the order of (2 pi/1000)^2
        CHECK(std::abs(last) == about(4 * 2 * pi * (1 - std::cos(0.5))).epsilon(1e-4));
    }

    TEST_CASE("property: a clamp's full turns are remembered across pi")
    {
        OneWire wire(5);
        wire.place(straight_nodes(5, 1));
        set_rest_shape(wire.rod, uniform_spec(1, 1, 1, 1), false);
        RodClamp clamp{.node = 4, .spin = true};
        // the wire's shape turns its reference frame by pi and more against the clamp: swing all edges around a cone
        wire.clamps = {clamp};
        double last = 0;
        for (int k = 1; k <= 3000; ++k) {
            const double a = 0.01 * k;
            const Vec3 t = Vec3(std::cos(0.6), std::sin(0.6) * std::cos(a), std::sin(0.6) * std::sin(a));
            OwnedTrial trial(wire.rod);
            for (int i = 0; i < 5; ++i)
                for (int c = 0; c < 3; ++c) trial[RodDofs::position(i, c)] = 0.25 * (i - 4) * t[c];
            REQUIRE(wire.accept(trial));
            CHECK(std::abs(wire.rod.clamp_twist_a[4] - last) < 0.02);
            last = wire.rod.clamp_twist_a[4];
        }
        CHECK(std::abs(last) > 5);  // 30 rad of cone times 1 - cos 0.6 = 0.175
    }
}

}  // namespace seldinger::test::test_frames
