// kernels/shared/contact_law.h and engine/physics/contact/wall_law.h: normal law, friction and rolling of one quadrature point.

#include "contact/one_quadrature_point.h"

#include "contact/wall_law.h"
#include "support/approx.h"

#include <algorithm>
#include <numbers>

namespace seldinger::test::test_law {

namespace {

constexpr double r = 0.4445e-3;  // 0.035 inch wire [m]
constexpr double pi = std::numbers::pi;

VesselSpec wall() { return {}; }  // the defaults: 1 MPa, 0.45, 1 mm

WireSection steel() { return {.radius = r, .density = 7900, .mu_static = 0.25, .mu_sliding = 0.2}; }

struct Bounce {
    double restitution, deepest;
};

// m d'' = -f(d, d'), backward Euler as the engine's own step, from a contact point at v0
Bounce bounce(double mass, double v0, QuadratureModel m, double dt)
{
    double d = 0, v = v0, deepest = 0;
    const double approach = std::max(v0, m.speed_floor);
    for (int k = 0; k < 1000000 && (d > 0 || v > 0); ++k) {
        double next = d + dt * v;
        for (int i = 0; i < 60; ++i) {
            double slope = 0;
            const double f = next > 0 ? normal_law(next, (next - d) / dt, approach, 1 / dt, m, &slope) : 0;
            const double change = (mass * ((next - d) / dt - v) / dt + f) / (mass / dt / dt + slope);
            next -= change;
            if (std::abs(change) <= 1e-14 * (std::abs(next) + v0 * dt)) break;
        }
        v = (next - d) / dt;
        d = next;
        deepest = std::max(deepest, d);
    }
    return {-v / v0, deepest};
}

// v of a Hunt-Crossley contact: 0.05 m/s, 0.014 inch wire's node (reference case 09)
constexpr double mass = 6.4e-7, v0 = 0.05;

QuadratureModel point_law(double exponent, double beta)
{
    QuadratureModel m{};
    m.weight = 1;
    m.exponent = exponent;
    m.stiffness = exponent == 1 ? 500 : 20000;
    m.damping = beta;
    m.speed_floor = 1e-12;
    return m;
}

double contact_time(const QuadratureModel& m) { return 3.2 * std::pow(mass * v0 * v0 / m.stiffness, 1 / (m.exponent + 1)) / v0; }

}  // namespace

TEST_SUITE("contact/law")
{
    // ln((1+beta)/(1-beta e)) = beta (1+e)  [Gonthier04, doi:10.1023/B:MUBO.0000029392.21648.bc]
    TEST_CASE("analytic: beta that returns the restitution asked for")
    {
        const double table[][2] = {{0.1, 9.998}, {0.3, 3.087}, {0.5, 1.4328}, {0.7, 0.63483}, {0.9, 0.16648}};
        for (const auto& [e, beta] : table) {
            const double asked = e;
            CAPTURE(asked);
            CHECK(exact_damping(e) == about(beta).epsilon(2e-4));  // the table's digits
            const double b = exact_damping(e);
            // near 1 / e the logarithm's slope is e / (1 - beta e): the root is good to that times an eps
            CHECK(std::log((1 + b) / (1 - b * e)) - b * (1 + e) == about(0).scale(1).epsilon(1e-9 / (1 - b * e)));
        }
        CHECK(exact_damping(1) == 0);
        CHECK(exact_damping(1 - 1e-6) == about(1.5e-6).epsilon(1e-2));  // beta -> 3/2 (1 - e)
    }

    TEST_CASE("analytic: restitution asked for is restitution got, whatever the exponent")
    {
        for (double n : {1.0, 1.5})
            for (double e : {0.1, 0.3, 0.5, 0.7, 0.9}) {
                const QuadratureModel m = point_law(n, exact_damping(e));
                CAPTURE(n);
                CAPTURE(e);
                // first-order damping of backward Euler: dt / t_c of the momentum or so, well below 0.01 at t_c / 500
                CHECK(std::abs(bounce(mass, v0, m, contact_time(m) / 500).restitution - e) <= 0.01);
                CHECK(std::abs(bounce(mass, v0, m, contact_time(m) / 5000).restitution - e) <= 0.001);
            }
    }

    // beta - ln(1+beta) = -beta e_eff - ln(1 - beta e_eff), and max depth from its first integral [Hunt75; Lankarani90]
    TEST_CASE("analytic: the published damping returns 0.665 to 0.913, with the depths of its first integral")
    {
        const double table[][2] = {{0.1, 0.6652654}, {0.3, 0.6842246}, {0.5, 0.7252411}, {0.7, 0.7959726}, {0.9, 0.9131767}};
        for (double n : {1.0, 1.5})
            for (const auto& [e, expected] : table) {
                const double beta = published_damping(e);
                const QuadratureModel m = point_law(n, beta);
                const Bounce b = bounce(mass, v0, m, contact_time(m) / 4000);
                CAPTURE(n);
                const double asked = e;
                CAPTURE(asked);
                CHECK(std::abs(b.restitution - expected) <= 0.002);  // first order in dt / t_c, some 5 of them
                const double deepest =
                    std::pow((n + 1) * mass * v0 * v0 / m.stiffness * (1 / beta - std::log1p(beta) / (beta * beta)), 1 / (n + 1));
                CHECK(b.deepest == about(deepest).epsilon(1e-3));
            }
    }

    TEST_CASE("analytic: the bed's modulus, and what own weight and 1 N/m sink in")
    {
        const double kf = foundation_modulus(wall());
        CHECK(kf == about(1e6 * 0.55 / (1.45 * 0.1 * 1e-3)).epsilon(1e-12));
        const double k = line_stiffness(rod_side(r, 0), wall_side(INFINITY, r, kf));
        CHECK(k == about(4.0 / 3 * kf * std::sqrt(2 * r)).epsilon(1e-12));
        const double weight = 7900 * pi * r * r * 9.81;
        CHECK(std::abs(depth_under(weight, k, 1.5) - 0.5e-6) <= 0.05e-6);  // 0.5 um: docs/validation.md
        CHECK(std::abs(depth_under(1.0, k, 1.5) - 3.5e-6) <= 0.05e-6);     // "3.5 um"
        CHECK(line_stiffness(rod_side(r, 0), wall_side(2 * r, r, kf)) ==
              about(k * std::sqrt(2.0)).epsilon(1e-12));  // 1/r* = 1/r - 1/R
    }

    TEST_CASE("derivative: the normal law's slope, hardening and its linear continuation included")
    {
        QuadratureModel m = line_model(steel(), {}, wall(), INFINITY, 1e-3);
        REQUIRE(m.depth_limit == about(r / 2));
        for (double exponent : {1.0, 1.3, 1.5, 2.0}) {
            m.exponent = exponent;
            for (double fraction : {0.001, 0.1, 0.5, 0.89, 0.91, 1.2, 3.0})
                for (double inv_dt : {0.0, 1e3}) {
                    const double depth = fraction * m.depth_limit, d0 = depth - 1e-6, h = 1e-6 * depth;
                    const auto f = [&](double d) {
                        double ignored;
                        return normal_law(d, (d - d0) * inv_dt, 0.01, inv_dt, m, &ignored);
                    };
                    double slope;
                    (void)normal_law(depth, (depth - d0) * inv_dt, 0.01, inv_dt, m, &slope);
                    CAPTURE(exponent);
                    CAPTURE(fraction);
                    // truncation 1e-12 of the third derivative's scale, rounding 1e-16 / 1e-6
                    CHECK((f(depth + h) - f(depth - h)) / (2 * h) == about(slope).epsilon(1e-8));
                }
            // value and slope are continuous where the law goes over into its tangent
            double below, above;
            const double end = 0.9 * m.depth_limit;
            const double fb = elastic_normal(end * (1 - 1e-9), m, &below), fa = elastic_normal(end * (1 + 1e-9), m, &above);
            CHECK(fb == about(fa).epsilon(1e-7));
            CHECK(below == about(above).epsilon(1e-6));
            // f = k d^n / (1 - d / d_max)
            CHECK(fb == about(m.stiffness * std::pow(end, exponent) * 10).epsilon(1e-6));
        }
    }

    // force per metre = stiffness |depth|^n. The pole behind it lies at half the radius, as the wall's own
    // does.
    TEST_CASE("analytic: a stiffness given by the user is k depth^n to 0.4 radii, and a barrier at half the radius")
    {
        for (const double n : {1.0, 1.3, 1.5, 2.0}) {
            CAPTURE(n);
            ContactSpec contact{.stiffness_from_wall = false, .stiffness = 3e6, .exponent = n};
            const QuadratureModel line = line_model(steel(), contact, wall(), INFINITY, 1e-3),
                                  tip = tip_model(steel(), contact, wall(), INFINITY);
            for (const QuadratureModel& m : {line, tip}) {
                CHECK(m.depth_limit == about(r / 2).epsilon(1e-15));
                double slope;
                for (const double part : {1e-4, 0.01, 0.1, 0.2, 0.39, 0.4}) {
                    CAPTURE(part);
                    const double depth = part * r * (1 - 1e-15), law = m.stiffness * std::pow(depth, m.exponent);
                    CHECK(elastic_normal(depth, m, &slope) == about(law).epsilon(1e-14));
                    CHECK(slope == about(m.exponent * law / depth).epsilon(1e-14));
                }
                CHECK(line.stiffness == 3e6);
                CHECK(line.exponent == n);
                double before_force = 0, before_slope = 0;
                for (double depth = 0.38 * r; depth < 0.51 * r; depth += 1e-4 * r) {
                    CAPTURE(depth / r);
                    const double h = 1e-7 * r, force = elastic_normal(depth, m, &slope);
                    double ignored;
                    const double difference =
                        (elastic_normal(depth + h, m, &ignored) - elastic_normal(depth - h, m, &ignored)) / (2 * h);
                    // truncation h / rest to the second power, rest >= 5e-4 r to the pole; where the second derivative jumps (at
                    // 0.4 r and 0.4995 r) to the first
                    CHECK(difference == about(slope).epsilon(1e-3));
                    CHECK(force > before_force);
                    CHECK(slope >= before_slope * (1 - 1e-12));  // convex: a step minimises
                    before_force = force;
                    before_slope = slope;
                }
                // as strong a pole as the wall's own: depth_max/(depth_max - depth) to first order
                const double near = 0.998 * m.depth_limit, power = m.stiffness * std::pow(near, m.exponent);
                CHECK(elastic_normal(near, m, &slope) == about(power / 0.002).epsilon(0.03));
            }
        }
    }

    // A sphere without contact is drawn over a corner by more than its radius in a step. It is then deep in the corner's far
    // side, and along the normal there the move leads away. Taken as such it had no force, and no step after it a state.
    TEST_CASE("analytic: a sphere that a move brings deep into a corner is refused, one that was as deep before is not")
    {
        LawContext c{};
        c.m = line_model(steel(), {}, wall(), INFINITY, 1e-3);
        c.m.weight = 1e-3;
        c.mv.epoch = 5;
        c.par.inv_dt = 1000;
        const ContactState none{};
        const double d = 0.1 * r;  // from the corner: r/2 is the limit
        ContactPoint contact = no_contact_point(r);
        contact.found = 1;
        contact.normal = v3(0.6, 0, 0.8);
        contact.to_wall = -d * contact.normal;
        contact.depth = r - d;
        const auto refused = [&](const vec3& move) {
            c.mv.move = move;
            ContactState now{};
            ContactForce out{};
            add_contact_point(contact, v3(0, 0, 0), none, MultiplierState{}, &c, &now, &out);
            return (out.flags & SEL_FORCE_BLOCKED) != 0;
        };
        CHECK(refused(v3(r, 0, 0)));                      // it was on the other side, 0.94 r from the corner
        CHECK(refused(-0.5 * r * contact.normal));        // it comes straight on
        CHECK_FALSE(refused(0.05 * r * contact.normal));  // it was deeper, and leaves
        CHECK_FALSE(refused(v3(0, 0, 0)));                // it lies there
    }

    // A fold of a segmented mesh that is sharper than a point of the axis moves in a step. The point arrives behind the nearest
    // facet, which it has not touched and which therefore does not push.
    TEST_CASE(
        "analytic: a point that a step brings into a sharp fold of the wall is refused, one that comes out of it or never was in "
        "front is not")
    {
        OneQuadraturePoint point(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        const double half = 0.2 * r, high = 20 * r;  // a ridge across the wire's way, from z = -high to its edge at z = 0
        point.soup.add_patch(v3(-half, -0.01, -high), v3(half, 0, high), v3(0, 0.02, 0));
        point.soup.add_patch(v3(0, -0.01, 0), v3(half, 0, -high), v3(0, 0.02, 0));
        for (uint t = 0; t < 4; ++t) REQUIRE(triangle_normal(load_triangle(point.soup.vertices.data(), t, v3(0, 0, 0))).z > 0);
        const auto refused = [&](const vec3& from, const vec3& to) {
            point.start = from;
            return (point.at({to.x, to.y, to.z, point.theta0}).flags & SEL_FORCE_BLOCKED) != 0;
        };
        const vec3 before = v3(-1.2 * r, 0, -2 * r), inside = v3(0, 0, -2 * r), beyond = v3(1.2 * r, 0, -2 * r);
        CHECK(refused(before, inside));
        CHECK(refused(v3(0, 0, 1.2 * r), inside));         // over the edge, where neither facet is met alone
        CHECK_FALSE(refused(inside, v3(0, 0, -2.1 * r)));  // it was there: where a run begins, or beyond an opening
        CHECK_FALSE(refused(inside, beyond));
        CHECK_FALSE(refused(before, v3(-1.1 * r, 0, -2 * r)));
    }

    TEST_CASE("property: the damped force never pulls, and grows with depth")
    {
        const QuadratureModel m = line_model(steel(), {}, wall(), INFINITY, 1e-3);
        const double dt = 1e-3, d0 = 2e-6, approach = 0.01;
        double last = -1;
        for (int k = 1; k <= 4000; ++k) {
            const double d = 2e-8 * k;
            double slope;
            const double f = normal_law(d, (d - d0) / dt, approach, 1 / dt, m, &slope);
            CHECK(f >= 0);
            CHECK(slope >= 0);
            CHECK(f >= last);
            last = f;
        }
    }

    TEST_CASE("analytic: stick has the spring's stiffness, slip stays on the cone and against the motion")
    {
        OneQuadraturePoint s(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        add_floor(s.soup);
        const double depth = 2e-6, z = r - depth;
        s.par.inv_dt = 0;
        s.states[0].epoch = s.place.epoch - 1;  // touched in the last step, at the same depth, without slip
        s.states[0].flags = SEL_CONTACT_ACTIVE | SEL_CONTACT_STUCK;
        s.states[0].normal[2] = 1;
        s.states[0].gap = -depth;
        s.start = v3(0, 0, z);
        const double kt = s.model.friction_stiffness * s.model.weight;
        // 2/3 of the normal stiffness under own weight (D9)
        const double own = 7900 * pi * r * r * 9.81, own_depth = depth_under(own, s.model.stiffness, 1.5);
        CHECK(s.model.friction_stiffness == about(2.0 / 3 * 1.5 * own / own_depth).epsilon(1e-12));
        const double fn = s.at({0, 0, z, s.theta0}).force[2];
        CHECK(fn ==
              about(s.model.weight * s.model.stiffness * std::pow(depth, 1.5) / (1 - depth / s.model.depth_limit)).epsilon(1e-6));
        const double yield = 0.25 * fn / kt;
        std::mt19937 rng(1);
        std::uniform_real_distribution<double> draw(-1, 1);
        int stuck = 0, sliding = 0;
        for (int k = 0; k < 400; ++k) {
            const double ux = 2 * yield * draw(rng), uy = 2 * yield * draw(rng), spin = 2 * yield / r * draw(rng);
            ContactState now[2];
            const ContactForce f = s.at({ux, uy, z, s.theta0 + spin}, now);
            // slip of the surface: the axis point's move and, with t = x and n = z, t x n = -y: u_y = y + r spin
            const double sx = ux, sy = uy + r * spin, size = std::hypot(sx, sy), ff = std::hypot(f.force[0], f.force[1]);
            if (size < 0.999 * yield) {
                ++stuck;
                CHECK((now[0].flags & SEL_CONTACT_STUCK) != 0);
                CHECK(ff == about(kt * size).epsilon(1e-6));
            } else if (size > 1.001 * yield) {
                ++sliding;
                CHECK((now[0].flags & SEL_CONTACT_STUCK) == 0);
                CHECK(ff == about(0.25 * fn).epsilon(1e-6));
                CHECK(f.sliding_sum == about(ff).epsilon(1e-9));
                // the anchor is dragged after the wire: the rest of the slip is the cone's
                CHECK(kt * std::hypot(now[0].slip[0], now[0].slip[1]) == about(0.25 * fn).epsilon(1e-6));
            }
            CHECK(ff <= 0.25 * fn * (1 + 1e-9));
            CHECK((f.force[0] * sx + f.force[1] * sy) == about(-ff * size).epsilon(1e-6));  // straight against the slip
            CHECK(f.force[3] ==
                  about(r * f.force[1]).epsilon(1e-9));  // force at the surface, -r n from the axis: torque r f_y about x
        }
        REQUIRE(stuck > 40);
        REQUIRE(sliding > 100);
    }

    TEST_CASE("analytic: a sliding touch yields at mu_sliding and sticks again inside that cone")
    {
        OneQuadraturePoint s(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        add_floor(s.soup);
        const double z = r - 2e-6;
        s.par.inv_dt = 0;
        s.start = v3(0, 0, z);
        const double kt = s.model.friction_stiffness * s.model.weight, fn = s.at({0, 0, z, 0.4}).force[2], yield = 0.25 * fn / kt;
        s.accept({0, 0, z, 0.4});
        s.accept({0, 0, z, 0.4});
        double x = 1.5 * yield;
        CHECK(-s.at({x, 0, z, 0.4}).force[0] == about(0.25 * fn).epsilon(1e-6));  // breaks loose at mu_static
        s.accept({x, 0, z, 0.4});
        x += 0.5 * yield;
        CHECK(-s.at({x, 0, z, 0.4}).force[0] == about(0.20 * fn).epsilon(1e-6));  // slides at mu_sliding
        s.accept({x, 0, z, 0.4});
        x -= 0.3 * yield;  // back: the spring, 0.8 of its yield long now, relaxes to 0.5
        CHECK(-s.at({x, 0, z, 0.4}).force[0] == about(0.25 * fn * 0.5).epsilon(1e-6));
        s.accept({x, 0, z, 0.4});
        x += 0.45 * yield;  // stuck again: holds beyond the sliding cone
        CHECK(-s.at({x, 0, z, 0.4}).force[0] == about(0.25 * fn * 0.95).epsilon(1e-6));
    }

    TEST_CASE("derivative: the tangent of the whole 4-vector, in stick, in slip, and with both walls")
    {
        OneQuadraturePoint s(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        add_floor(s.soup);
        s.along = v3(1.9e-3, 0.4e-3, 0);
        const double z = r - 2e-6;
        // central differences of a force good to 1e-16 relative over 1e-10 m of 2e-6 m: 1e-8; third derivatives: (1e-10 / 2e-6)^2
        const double tolerance = 2e-6;
        const auto check_all = [&](double low_gap_state) {
            s.states[0].gap = low_gap_state;
            for (double inv_dt : {0.0, 1e3}) {
                s.par.inv_dt = inv_dt;
                ContactState now[2];
                (void)s.at({2e-9, 3e-9, z, s.theta0 + 1e-6}, now);
                REQUIRE((now[0].flags & SEL_CONTACT_STUCK) != 0);
                CHECK(tangent_error(s, {2e-9, 3e-9, z, s.theta0 + 1e-6}) <= tolerance);
                (void)s.at({3e-6, -2e-6, z + 1e-7, s.theta0 + 2e-3}, now);
                REQUIRE((now[0].flags & (SEL_CONTACT_STUCK | SEL_CONTACT_ACTIVE)) == SEL_CONTACT_ACTIVE);
                CHECK(tangent_error(s, {3e-6, -2e-6, z + 1e-7, s.theta0 + 2e-3}) <= tolerance);
            }
        };
        s.start = v3(0, 0, r - 1.9e-6);
        s.states[0].epoch = s.place.epoch - 1;
        s.states[0].flags = SEL_CONTACT_ACTIVE | SEL_CONTACT_STUCK;
        s.states[0].normal[2] = 1;
        s.states[0].approach = 0.02;
        check_all(-1.9e-6);

        // a ceiling that leans a little: both touch, with friction on both
        s.states[1] = s.states[0];
        s.states[1].normal[2] = -1;
        s.states[1].gap = -1e-6;
        const double shift = 0.01 * (0.0003 + 0.0002) / 0.02;  // of the ceiling at the origin
        s.soup.add_patch(v3(-0.01, -0.01, 2 * r - 5e-6 - shift), v3(0, 0.02, 0.0003), v3(0.02, 0, 0.0002));
        ContactState now[2];
        const ContactForce both = s.at({2e-9, 3e-9, z, s.theta0}, now);
        REQUIRE(both.contacts == 2);
        check_all(-1.9e-6);
    }

    // Where two facets meet in a blunt valley the blend turns the normal: its own curvature belongs to the tangent.
    TEST_CASE("derivative: the tangent inside the blend of a valley, without friction")
    {
        OneQuadraturePoint s(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        const double rise = 0.1, c = 0.01 * std::cos(rise), h = 0.01 * std::sin(rise);
        s.soup.add_patch(v3(0, -0.01, 0), v3(c, 0, h), v3(0, 0.02, 0));
        s.soup.add_patch(v3(-c, -0.01, h), v3(c, 0, -h), v3(0, 0.02, 0));
        s.along = v3(0, 2e-3, 0);
        s.par.friction = SEL_FRICTION_NONE;
        s.par.inv_dt = 0;
        const double z = (r - 2e-6) / std::cos(rise);
        for (double x : {0.0, 1e-7, -2e-7, 4e-7}) {
            CAPTURE(x);
            const ContactForce f = s.at({x, 1.3e-4, z, 0});
            REQUIRE(f.contacts == 1);
            // far inside its blend (0.9 um wide here) the depth is a quadratic; at a triangle's diagonal two triangles blend
            // alike
            CHECK(tangent_error(s, {x, 1.3e-4, z, 0}) <= 1e-4);
        }
    }

    TEST_CASE("derivative: a wire that has only just met the wall")
    {
        OneQuadraturePoint s(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        add_floor(s.soup);
        s.start = v3(0, 0, r + 1e-4);  // not seen in the last step: v- is the speed of this one
        const ContactForce f = s.at({0, 0, r - 2e-6, s.theta0});
        REQUIRE(f.contacts == 1);
        CHECK(tangent_error(s, {0, 0, r - 2e-6, s.theta0}) <= 2e-6);
    }

    TEST_CASE("derivative: regularised friction laws")
    {
        OneQuadraturePoint s(line_model(steel(), {}, wall(), INFINITY, 1e-3));
        add_floor(s.soup);
        s.start = v3(0, 0, r - 1.9e-6);
        s.states[0].epoch = s.place.epoch - 1;
        s.states[0].flags = SEL_CONTACT_ACTIVE;
        s.states[0].normal[2] = 1;
        s.states[0].approach = 0.02;
        s.states[0].gap = -1.9e-6;
        s.par.friction = SEL_FRICTION_SMOOTH;
        for (double slip : {1e-8, 1e-6, 1e-4}) CHECK(tangent_error(s, {slip, -slip / 3, r - 2e-6, s.theta0}) <= 2e-6);
        const double fn = s.at({0, 0, r - 2e-6, s.theta0}).force[2];
        // |f| = mu_sliding fn v / (v + v_s), v_s = 1 mm/s
        CHECK(-s.at({1e-6, 0, r - 2e-6, s.theta0}).force[0] == about(0.2 * fn / 2).epsilon(1e-6));
    }

    // M = K F, K = [2 alpha/(3 pi) + (sigma_b + sigma_s/2)/(6 H)] sqrt(4 r F/(pi l) ((1-nu1^2)/E1 + (1-nu2^2)/E2))   (D10)
    TEST_CASE("analytic: the rolling moment of the 0.014 inch wire on 1 mm of wall")
    {
        WireSection s{.radius = 0.178e-3, .density = 7900, .youngs = 70e9, .poisson = 0.33};
        VesselSpec bed{.youngs = 1e6, .poisson = 0.49};
        ContactSpec contact{.stiffness_from_wall = false, .stiffness = 1e8, .rolling = true, .rolling_alpha = 0.2};
        const QuadratureModel m = line_model(s, contact, bed, INFINITY, 1e-3);
        const double table[][2] = {{1e-4, 1.7613099e-7}, {1e-3, 5.5697511e-7}, {1e-2, 1.7613099e-6}};  // F [N], K [m]
        for (const auto& [force, k] : table) {
            LawContext c{};
            c.m = m;
            c.mv.tangent = v3(1, 0, 0);
            c.mv.spin = 1;  // [rad] far beyond what the spring holds
            ContactState now{};
            ContactForce out{};
            add_rolling(v3(0, 0, 1), {0, 1}, {force, 0}, CarriedState{}, &c, &now, &out);
            CHECK(out.rolling_sum / force == about(k).epsilon(1e-6));
            CHECK(out.force[3] == about(-k * force).epsilon(1e-6));
            // below yield: a spring
            c.mv.spin = 1e-9;
            ContactForce small{};
            add_rolling(v3(0, 0, 1), {0, 1}, {force, 0}, CarriedState{}, &c, &now, &small);
            CHECK(small.force[3] == about(-small.sym[9] * 1e-9).epsilon(1e-9));
        }
        // stress terms enter as stated
        contact.rolling_sigma_b = 2000;
        contact.rolling_sigma_s = 1000;
        contact.rolling_hardness = 1e5;
        CHECK(line_model(s, contact, bed, INFINITY, 1e-3).roll_arm == about(0.4 / (3 * pi) + 2500 / 6e5).epsilon(1e-12));
    }

    // beyond the yield M = K(a) f_n changes with the normal force and with the half-width: the spin's row against the position
    TEST_CASE("derivative: the rolling moment at its yield, from the wall's law and from a user's stiffness")
    {
        for (const bool from_wall : {true, false})
            for (const double spin : {0.02, -0.02}) {
                CAPTURE(from_wall);
                CAPTURE(spin);
                ContactSpec contact{.stiffness_from_wall = from_wall, .stiffness = 1e8, .rolling = true};
                OneQuadraturePoint s(line_model(steel(), contact, wall(), INFINITY, 1e-3));
                add_floor(s.soup);
                s.start = v3(0, 0, r - 1.9e-6);
                s.states[0].epoch = s.place.epoch - 1;
                s.states[0].flags = SEL_CONTACT_ACTIVE;
                s.states[0].normal[2] = 1;
                s.states[0].approach = 0.02;
                s.states[0].gap = -1.9e-6;
                for (const uint friction : {SEL_FRICTION_NONE, SEL_FRICTION_STICK_SLIP}) {
                    s.par.friction = friction;
                    const std::array<double, 4> q = {3e-6, -2e-6, r - 2e-6, s.theta0 + spin};
                    const ContactForce f = s.at(q);
                    REQUIRE(f.rolling_sum > 0);
                    REQUIRE((f.flags & SEL_FORCE_SLIDING) != 0);
                    CHECK(std::abs(f.skew[11]) > 0.1 * f.rolling_sum / 2e-6);  // M grows like depth^2
                    CHECK(tangent_error(s, q) <= 2e-6);
                }
            }
    }

    TEST_CASE("property: rolling resistance only takes energy, and stops a spinning wire in a bounded time")
    {
        ContactSpec contact;
        contact.rolling = true;
        OneQuadraturePoint s(line_model(steel(), contact, wall(), INFINITY, 1e-3));
        add_floor(s.soup);
        s.par.friction = SEL_FRICTION_NONE;
        const double z = r - 2e-6, dt = 1e-4, inertia = 1e-3 * 7900 * pi * r * r * r * r / 2;
        s.par.inv_dt = 1 / dt;
        s.start = v3(0, 0, z);
        s.theta0 = 0;
        s.accept({0, 0, z, 0});
        double theta = 0, spin = 20, energy = 0.5 * inertia * spin * spin;
        const double start = energy;
        const double moment = s.model.roll_arm * std::sqrt(s.model.roll_depth * 2e-6) * s.at({0, 0, z, 0}).force[2];
        REQUIRE(moment > 0);
        const double stop = inertia * 20 / moment;  // [s] under a constant moment
        const double k_roll = s.model.friction_stiffness * s.model.weight * r * r;
        for (int k = 0; k * dt < 2 * stop + 0.05; ++k) {
            // backward Euler on the one unknown: fixed point by bisection, since the spring is stiff and yields
            double lo = theta - 1, hi = theta + 1;
            for (int i = 0; i < 200; ++i) {
                const double mid = (lo + hi) / 2;
                const double residual = inertia * ((mid - theta) / dt - spin) / dt - s.at({0, 0, z, mid}).force[3];
                (residual < 0 ? lo : hi) = mid;
            }
            const double next = (lo + hi) / 2;
            spin = (next - theta) / dt;
            s.accept({0, 0, z, next});
            theta = next;
            const double stored = 0.5 * k_roll * s.states[0].roll * s.states[0].roll;
            const double now = 0.5 * inertia * spin * spin + stored;
            CHECK(now <= energy * (1 + 1e-9) + 1e-15 * start);
            energy = now;
        }
        CHECK(theta == about(20 * stop / 2).epsilon(0.02));  // the distance of a constant moment
        CHECK(std::abs(spin) <= 0.02 * 20);
    }
}

}  // namespace seldinger::test::test_law
