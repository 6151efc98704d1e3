// Contact as a linearised or an explicit step takes it: from the start of the step and the velocity known there (contact_law.h).
// In OneQuadraturePoint the wire comes from `start` within the step.

#include "contact/one_quadrature_point.h"
#include "contact/wall_law.h"
#include "support/approx.h"

namespace seldinger::test::test_known_velocity {

namespace {

constexpr double r = 0.4445e-3, depth = 2e-6, mu_static = 0.25, mu_sliding = 0.2;  // SI

QuadratureModel model(bool rolling)
{
    WireSection section{.radius = r, .density = 7900, .mu_static = mu_static, .mu_sliding = mu_sliding};
    VesselSpec wall{.youngs = 1e6, .poisson = 0.45, .thickness = 1e-3};
    ContactSpec contact;
    contact.rolling = rolling;
    return line_model(section, contact, wall, INFINITY, 1e-3);
}

/// A contact point that lasts, `depth` deep at the accepted state (0, 0, z, 0).
struct Lasting {
    OneQuadraturePoint point;
    double z = r - depth;

    explicit Lasting(uint friction, bool rolling = false) : point(model(rolling))
    {
        add_floor(point.soup);  // the point is right above its diagonal
        point.par.friction = friction;
        point.theta0 = 0;
        ContactState& state = point.states[0];
        state.epoch = point.place.epoch - 1;
        state.flags = SEL_CONTACT_ACTIVE;
        state.normal[2] = 1;
        state.approach = 0.02;
        state.gap = -depth;
    }

    /// The law at the end of a step of `move` from the accepted state.
    [[nodiscard]] ContactForce at_end(const std::array<double, 4>& move) const
    {
        OneQuadraturePoint s = point;
        s.start = v3(0, 0, z);
        return s.at({move[0], move[1], z + move[2], move[3]});
    }
    /// What the step starts from, the known velocity being move / h.
    [[nodiscard]] ContactForce known(const std::array<double, 4>& move, uint mode) const
    {
        OneQuadraturePoint s = point;
        s.par.known = mode;
        s.start = v3(-move[0], -move[1], z - move[2]);
        s.theta0 = -move[3];
        return s.at({0, 0, z, 0});
    }
};

/// The linear force after `move`.
double after(const ContactForce& f, int row, const std::array<double, 4>& move)
{
    double sum = f.force[row];
    for (int c = 0; c < 4; ++c) sum -= tangent(f, row, c) * move[c];
    return sum;
}

/// Largest difference between two forces on the surface, relative to the larger.
double apart(const std::array<double, 4>& a, const ContactForce& b)
{
    double most = 0, size = 0;
    for (int k = 0; k < 4; ++k) {
        const double unit = k == 3 ? 1 / r : 1;
        most = std::max(most, unit * std::abs(a[k] - b.force[k]));
        size = std::max(size, unit * std::abs(b.force[k]));
    }
    return most / size;
}

}  // namespace

TEST_SUITE("contact/known_velocity")
{
    // Along the wall nothing changes but the slip, about whose predicted value the force is expanded: no truncation is left, only
    // rounding of a gap of 2 um out of positions of a millimetre, 1e-13.
    TEST_CASE("derivative: where the known velocity leads along the wall, the linear force is the law's")
    {
        for (const uint friction : {SEL_FRICTION_STICK_SLIP, SEL_FRICTION_SMOOTH, SEL_FRICTION_NONE})
            for (const double size : {1e-11, 1e-7, 1e-4})  // stuck, and sliding
                for (const bool rolling : {false, true}) {
                    CAPTURE(friction);
                    CAPTURE(size);
                    CAPTURE(rolling);
                    const Lasting state(friction, rolling);
                    const std::array<double, 4> move = {size, -size / 3, 0, 0.2 * size / r};
                    const ContactForce linear = state.known(move, SEL_KNOWN_LINEAR), law = state.at_end(move);
                    REQUIRE(law.contacts == 1);
                    const std::array<double, 4> there = {after(linear, 0, move), after(linear, 1, move), after(linear, 2, move),
                                                         after(linear, 3, move)};
                    CHECK(apart(there, law) <= 1e-9);
                }
    }

    // Towards the wall and away from it: halving the move quarters what a linear function leaves out.
    TEST_CASE("convergence: the linear normal force is off by the square of the move")
    {
        for (const double sign : {-1.0, 1.0}) {
            CAPTURE(sign);
            double last = 0;
            for (const double size : {4e-8, 2e-8, 1e-8}) {
                const Lasting state(SEL_FRICTION_NONE);
                const std::array<double, 4> move = {0, 0, sign * size, 0};
                const ContactForce linear = state.known(move, SEL_KNOWN_LINEAR);
                const double error = std::abs(after(linear, 2, move) - state.at_end(move).force[2]);
                if (last > 0) CHECK(last / error == about(4).epsilon(0.1));
                last = error;
            }
        }
    }

    TEST_CASE("analytic: sgn(v) is mu f_n against the known velocity, without a slope, however fast and long the step")
    {
        for (const uint mode : {SEL_KNOWN_LINEAR, SEL_KNOWN_FORCE})
            for (const double slip : {1e-7, 1e-5, 3e-4}) {
                CAPTURE(mode);
                CAPTURE(slip);
                const Lasting state(SEL_FRICTION_SIGN);
                const ContactForce f = state.known({0.6 * slip, 0.8 * slip, 0, 0}, mode);
                REQUIRE(f.force[2] > 0);
                // regularised at 1 nm/s: short of mu f_n by that over the speed, 1e-9/(1e-7/1e-3) at most
                CHECK(f.force[0] == about(-0.6 * mu_sliding * f.force[2]).epsilon(2e-5));
                CHECK(f.force[1] == about(-0.8 * mu_sliding * f.force[2]).epsilon(2e-5));
                for (int c = 0; c < 3; ++c) CHECK(tangent(f, 0, c) == 0);
                CHECK((f.flags & SEL_FORCE_SLIDING) == 0);
            }
    }

    TEST_CASE("analytic: an explicit step has the damping of the known approach, and pulls stuck springs from where they are")
    {
        Lasting state(SEL_FRICTION_STICK_SLIP);
        const double still = state.known({0, 0, 0, 0}, SEL_KNOWN_FORCE).force[2];
        const double speed = 0.01, h = 1 / state.point.par.inv_dt;
        const ContactForce f = state.known({0, 0, -speed * h, 0}, SEL_KNOWN_FORCE);
        // D7: f (1 + beta v / v-)
        CHECK(f.force[2] == about(still * (1 + state.point.model.damping * speed / 0.02)).epsilon(1e-9));
        state.point.states[0].flags |= SEL_CONTACT_STUCK;
        state.point.states[0].slip[0] = 1e-10;
        const double spring = state.point.model.friction_stiffness * state.point.model.weight;
        REQUIRE(spring * 1e-10 < mu_static * still);
        CHECK(state.known({5e-6, 0, 0, 0}, SEL_KNOWN_FORCE).force[0] == about(-spring * 1e-10).epsilon(1e-9));
    }
}

}  // namespace seldinger::test::test_known_velocity
