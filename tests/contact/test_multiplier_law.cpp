// kernels/shared/multiplier_law.h, multipliers.h, sweep.h and elementary.h: laws with multipliers, the barrier and its
// continuous detection.

#include "contact/one_quadrature_point.h"

#include "contact/wall_law.h"
#include "shared/barrier_path.h"
#include "shared/multipliers.h"
#include "shared/sweep.h"

namespace seldinger::test::test_multiplier_law {

namespace {

constexpr double r = 0.4445e-3;  // 0.035 inch wire [m]

WireSection steel() { return {.radius = r, .density = 7900, .mu_static = 0.25, .mu_sliding = 0.2}; }

ContactSpec asks_for(NormalLaw law)
{
    return {.normal = law,
            .overlap = law == NormalLaw::Constraint ? constraint_overlap * r : augmented_overlap * r,
            .barrier_distance = barrier_distance * r};
}

OneQuadraturePoint on_floor(NormalLaw law, bool rolling = false)
{
    ContactSpec contact = asks_for(law);
    contact.rolling = rolling;
    OneQuadraturePoint s(line_model(steel(), contact, VesselSpec{}, INFINITY, 1e-3));
    add_floor(s.soup);
    s.par.normal_law = kernel_law(law);
    return s;
}

/// As if the quadrature point had touched in the last step, at this gap and rate, pushed by `force` per metre.
void touched_before(OneQuadraturePoint& s, double gap, double force)
{
    ContactState& t = s.states[0];
    t.epoch = s.place.epoch - 1;
    t.flags = SEL_CONTACT_ACTIVE | SEL_CONTACT_STUCK;
    t.normal[2] = 1;
    t.gap = gap;
    t.rate = 0.01;
    t.normal_force = force * s.model.weight;
    t.friction[0] = 0.05 * force * s.model.weight;
    s.start = v3(0, 0, r + gap);
    for (int k = 0; k < 2; ++k) s.multiplier[k] = multiplier_start(s.states[k], s.place.epoch, s.model, s.par);
}

double distance(vec3 p, Triangle tri)
{
    int feature;
    return norm(p - closest_on_triangle(p, tri, &feature));
}

}  // namespace

TEST_SUITE("contact/hard_law")
{
    TEST_CASE("analytic: logarithm and cube root of basic operations")
    {
        std::mt19937 rng(3);
        std::uniform_real_distribution<double> decades(0, 200);
        for (int k = 0; k < 2000; ++k) {
            const double x = std::pow(10, decades(rng)), near_one = 1 + 1 / x;
            CHECK(std::abs(log_r(x) - std::log(x)) <= 4e-16 * std::log(x) + 4e-16);
            CHECK(std::abs(log_r(near_one) - std::log(near_one)) <= 4e-16);
            // the last step of Newton: 5/3 of half an ulp. The reference in 64 bits of mantissa: libm's own is good to some ulps
            // only
            for (const double y : {x, 1 / x})
                CHECK(std::abs(cube_root(y) - std::cbrt((long double)y)) <= 2.2e-16L * std::cbrt((long double)y));
        }
        CHECK(log_r(1) == 0);
        CHECK(cube_root(0) == 0);
    }

    // b(d) = -kappa (d - dh)^2 ln(d / dh)  [Li20, eq. 6]
    TEST_CASE("derivative: the barrier's force and slope, and that both vanish where it begins")
    {
        const double dh = 9e-6, kappa = 3e6;
        const auto energy = [&](double d) { return -kappa * (d - dh) * (d - dh) * std::log(d / dh); };
        for (const double part : {1e-4, 1e-2, 0.1, 0.5, 0.9, 0.999}) {
            CAPTURE(part);
            const double d = part * dh, h = 1e-4 * std::min(d, dh - d);
            double slope, ignored;
            const double f = barrier_law(d, dh, kappa, &slope);
            // truncation (1e-4)^2 of the third derivatives' scale; rounding 1e-16 / 1e-4 of the energy, which near dh is (dh - d)
            // f / 3
            CHECK(-(energy(d + h) - energy(d - h)) / (2 * h) == about(f).epsilon(1e-6));
            CHECK(-(barrier_law(d + h, dh, kappa, &ignored) - barrier_law(d - h, dh, kappa, &ignored)) / (2 * h) ==
                  about(slope).epsilon(1e-6));
        }
        double slope;
        CHECK(barrier_law(dh, dh, kappa, &slope) == 0);
        CHECK(slope == 0);
        const double e = 1e-4;  // f -> 3 kappa dh e^2, slope -> 6 kappa e: twice continuous energy
        CHECK(barrier_law(dh * (1 - e), dh, kappa, &slope) == about(3 * kappa * dh * e * e).epsilon(1e-3));
        CHECK(slope == about(6 * kappa * e).epsilon(1e-3));
        CHECK(barrier_law(1e-9 * dh, dh, kappa, &slope) == about(1e9 * kappa * dh).epsilon(1e-6));
        CHECK(barrier_law(0, dh, kappa, &slope) == 0);  // such a trial is refused
        CHECK(barrier_law(2 * dh, dh, kappa, &slope) == 0);
    }

    TEST_CASE("property: the barrier from the smallest gap there is to the radius: finite, falling, tangent as its derivative")
    {
        const double dh = 9e-6, kappa = 3e6, end = SEL_BARRIER_END * dh;
        double last = INFINITY, slope, last_slope = INFINITY;
        for (double gap = 1e-320; gap < r; gap *= 1.3) {
            const double f = barrier_law(gap, dh, kappa, &slope);
            REQUIRE(std::isfinite(f));
            REQUIRE(std::isfinite(slope));
            CHECK(f >= 0);
            CHECK(f <= last);
            CHECK(slope >= 0);
            CHECK(slope <= last_slope);
            last = f, last_slope = slope;
        }
        CHECK(last == 0);
        // the switch: the same value and slope from both sides, and the tangent's own slope below
        double below, above;
        const double h = 1e-6 * end;
        const double fb = barrier_law(end - h, dh, kappa, &below), fa = barrier_law(end + h, dh, kappa, &above);
        CHECK(fb == about(fa).epsilon(3e-6));  // f ~ 1 / gap: 2 h / end
        CHECK(below == about(above).epsilon(3e-6));
        CHECK((fb - fa) / (2 * h) == about(below).epsilon(3e-6));
        CHECK(barrier_law(1e-320, dh, kappa, &slope) == about(2e12 * kappa * dh).epsilon(1e-9));
    }

    TEST_CASE("analytic: scales follow the wall: k at a hundredth of the radius, the barrier at a tenth of its distance")
    {
        const QuadratureModel soft = line_model(steel(), asks_for(NormalLaw::HuntCrossley), VesselSpec{}, INFINITY, 1e-3);
        const QuadratureModel m = line_model(steel(), asks_for(NormalLaw::Augmented), VesselSpec{}, INFINITY, 1e-3);
        CHECK(m.penalty_stiffness == about(1.5 * soft.stiffness * std::sqrt(r / 100)).epsilon(1e-12));
        const QuadratureModel b = line_model(steel(), asks_for(NormalLaw::Barrier), VesselSpec{}, INFINITY, 1e-3);
        double slope;
        CHECK(barrier_law(b.law_length / 10, b.law_length, b.penalty_stiffness, &slope) ==
              about(soft.stiffness * std::pow(r / 4, 1.5) * 2).epsilon(1e-12));
        // in a short step inertia sets the scale: k h^2 / (rho A) = 10
        ContactParams par{};
        par.inv_dt = 1e6;
        CHECK(multiplier_start(ContactState{}, 5, m, par).stiffness == about(10 * m.line_mass * 1e12).epsilon(1e-12));
        par.inv_dt = 0;
        CHECK(multiplier_start(ContactState{}, 5, m, par).stiffness == m.penalty_stiffness);
    }

    TEST_CASE("derivative: the tangent of the whole 4-vector with multipliers and with the barrier, in stick and in slip")
    {
        for (const NormalLaw law : {NormalLaw::Augmented, NormalLaw::Constraint, NormalLaw::Impulse, NormalLaw::Barrier}) {
            CAPTURE(static_cast<int>(law));
            OneQuadraturePoint s = on_floor(law);
            s.along = v3(1.9e-3, 0.4e-3, 0);
            const double gap = law == NormalLaw::Barrier ? 2e-6 : law == NormalLaw::Impulse ? -2e-6 : -1e-6, z = r + gap;
            touched_before(s, gap, 0.5);
            const double kt =
                (law == NormalLaw::Constraint ? SEL_TANGENTIAL * s.multiplier[0].stiffness : s.model.friction_stiffness) *
                s.model.weight;
            // impulse: at the gap it had, so that it is pushed back with half of the speed at which it came
            const double fn = s.at({0, 0, z, s.theta0}).force[2], yield = 0.25 * fn / kt;
            REQUIRE(fn > 0);
            ContactState now[2];
            const std::array<double, 4> stuck = {0.2 * yield, 0.1 * yield, z, s.theta0 + 0.1 * yield / r};
            (void)s.at(stuck, now);
            REQUIRE((now[0].flags & SEL_CONTACT_STUCK) != 0);
            // as for the damped law (test_law.cpp); the yield may be as short as 1e-8 m, and differences reach over 1e-10
            CHECK(tangent_error(s, stuck) <= 2e-6);
            const std::array<double, 4> slipping = {6 * yield + 3e-6, -4 * yield - 2e-6, z, s.theta0 + 10 * yield / r};
            (void)s.at(slipping, now);
            REQUIRE((now[0].flags & (SEL_CONTACT_STUCK | SEL_CONTACT_ACTIVE)) == SEL_CONTACT_ACTIVE);
            CHECK(tangent_error(s, slipping) <= 2e-6);
        }
    }

    // k_w (z_0 - z) = f(z): a quadrature point on a spring that wants it `wanted` deep
    TEST_CASE("analytic: rounds of multipliers end at no overlap and the spring's own force, however stiff it is")
    {
        for (const double stiff : {1e-3, 1.0, 1e3}) {
            CAPTURE(stiff);
            OneQuadraturePoint s = on_floor(NormalLaw::Constraint);
            s.par.friction = SEL_FRICTION_NONE;
            s.par.inv_dt = 0;
            const double wanted = 2e-6, spring = stiff * s.model.penalty_stiffness * s.model.weight, z0 = r - wanted;
            for (int k = 0; k < 2; ++k) s.multiplier[k] = multiplier_start(s.states[k], s.place.epoch, s.model, s.par);
            double z = z0, ratio = 2;
            int rounds = 0;
            for (; ratio > 1 && rounds < 40; ++rounds) {
                double lo = z0, hi = z0 + 2 * wanted;
                for (int k = 0; k < 200; ++k) {
                    z = (lo + hi) / 2;
                    (spring * (z0 - z) + s.at({0, 0, z, s.theta0}).force[2] > 0 ? lo : hi) = z;
                }
                ContactState now[2];
                (void)s.at({0, 0, z, s.theta0}, now);
                ratio = 0;
                for (int k = 0; k < 2; ++k)
                    s.multiplier[k] =
                        multiplier_update(s.multiplier[k], now[k], s.states[k], s.place.epoch, s.model, s.par, &ratio);
            }
            CAPTURE(rounds);
            CHECK(rounds < 20);
            // ends within the length allowed, 4.4 nm
            CHECK(std::abs(z - r) <= s.model.law_length);
            CHECK(std::abs(s.multiplier[0].force * s.model.weight - spring * wanted) <= 2 * spring * s.model.law_length);
        }
    }

    TEST_CASE("property: a multiplier fades before the wall is out of sight, and is bounded where there is no solution")
    {
        OneQuadraturePoint s = on_floor(NormalLaw::Augmented);
        touched_before(s, -1e-6, 400);  // a tip's load on one quadrature point
        CHECK(s.at({0, 0, r, s.theta0}).force[2] == about(400 * s.model.weight).epsilon(1e-9));
        CHECK(s.at({0, 0, r + 0.5 * s.model.reach * (1 + 1e-9), s.theta0}).force[2] == 0);
        MultiplierState multiplier = s.multiplier[0];
        double slope;
        const double most = elastic_normal(0.95 * s.model.depth_limit, s.model, &slope);
        for (int k = 0; k < 200; ++k) {
            ContactState now[2];
            s.multiplier[0] = multiplier;
            (void)s.at({0, 0, r - 1e-4, s.theta0}, now);  // held a tenth of a millimetre deep
            double ratio = 0;
            multiplier = multiplier_update(multiplier, now[0], s.states[0], s.place.epoch, s.model, s.par, &ratio);
            CHECK(multiplier.force <= most);
        }
        CHECK(multiplier.force == most);
    }

    TEST_CASE("property: what starts in overlap is freed by halves, and a barrier that holds gives nothing away")
    {
        const QuadratureModel m = line_model(steel(), asks_for(NormalLaw::Barrier), VesselSpec{}, INFINITY, 1e-3);
        CHECK(barrier_start(1e-9, 0, m) == 0);  // however near
        const double first = barrier_start(-2e-5, 0, m);
        CHECK(first == about(2e-5 + 1e-3 * m.law_length).epsilon(1e-12));
        CHECK(barrier_start(-2e-5, first, m) < first);  // not moved: still clear, a little thicker
        CHECK(barrier_start(-1e-5, first, m) == about(first - (first - 1e-5) / 2).epsilon(1e-12));
        CHECK(barrier_start(5e-6, 4e-6, m) == 0);
    }

    TEST_CASE("analytic: a ball that meets a face, an edge, a corner")
    {
        const Triangle tri = {v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0)};
        CHECK(sweep_triangle(v3(0.2, 0.2, 1), v3(0, 0, -2), 0.5, tri, 0) == about(0.25).epsilon(1e-14));
        CHECK(sweep_triangle(v3(0.2, 0.2, 1), v3(0, 0, -0.4), 0.5, tri, 0) == 1);
        // the edge y = 0 from the side, 3-4-5: height 0.3 of a ball of 0.5 touches at y = -0.4
        CHECK(sweep_triangle(v3(0.5, -1, 0.3), v3(0, 1, 0), 0.5, tri, 0) == about(0.6).epsilon(1e-14));
        CHECK(sweep_triangle(v3(1 + 0.4, -1, 0.3), v3(0, 1, 0), 0.5, tri, 0) == about(1.0).epsilon(1e-14));  // grazes the corner
        CHECK(sweep_triangle(v3(2, 0, 0), v3(-1, 0, 0), 0.5, tri, 0) == about(0.5).epsilon(1e-14));
        CHECK(sweep_triangle(v3(0.2, 0.2, 0.5 + 1e-9), v3(1e-2, 0, 0), 0.5, tri, 0) == 1);  // slides along, a hair off
        CHECK(sweep_triangle(v3(0.2, 0.2, 0.5), v3(0, 0, 1), 0.5, tri, 0) == 1);            // leaves what it touches
        CHECK(sweep_triangle(v3(0.2, 0.2, -1), v3(0, 0, 2), 0.5, tri, 0) == 1);             // comes from behind
        CHECK(sweep_triangle(v3(0.5, -1, -0.3), v3(0, 1, 0), 0.5, tri, 1) ==
              about(0.6).epsilon(1e-14));  // a boundary feature has no behind
    }

    TEST_CASE("property: up to the way found a ball is clear of the triangle, and there it touches it")
    {
        std::mt19937 rng(5);
        std::uniform_real_distribution<double> draw(-1, 1);
        const auto any = [&] { return v3(draw(rng), draw(rng), draw(rng)); };
        int stopped = 0, free_ways = 0;
        for (int k = 0; k < 16000; ++k) {
            const Triangle tri = {any(), any(), any()};
            const vec3 p = 2.0 * any(), move = 2.0 * any();
            const double radius = 0.3 + 0.2 * draw(rng);
            if (dot3(triangle_normal(tri), p - tri.a) < 0 || distance(p, tri) <= radius) continue;
            const double way = sweep_triangle(p, move, radius, tri, 0);
            double nearest = 10;
            for (int i = 0; i <= 64; ++i) nearest = std::min(nearest, distance(p + (way * i / 64) * move, tri));
            CHECK(nearest >= radius * (1 - 1e-9));
            if (way < 1) {
                ++stopped;
                CHECK(distance(p + way * move, tri) == about(radius).epsilon(1e-9));
            } else {
                ++free_ways;
            }
        }
        REQUIRE(stopped > 200);
        REQUIRE(free_ways > 200);
    }
}

}  // namespace seldinger::test::test_multiplier_law
