// Coulomb friction of a whole wire against textbook mechanics: incline, sliding distance, spring-driven stick-slip, creep.
// Numbers of the closed forms are those of any text on mechanics; tolerances are the project's (docs/validation.md).

#include "contact/wall_law.h"
#include "support/world_fixture.h"

#include <algorithm>

namespace seldinger::test::test_sliding {

namespace {

constexpr double radius = 0.4445e-3, gravity = 9.81;

/// How deep the wire's own weight sinks into the default wall [m].
double own_depth(double density, double g)
{
    const VesselSpec wall;
    const double load = density * std::numbers::pi * radius * radius * g;
    return depth_under(load, line_stiffness(rod_side(radius, 0), wall_side(INFINITY, radius, foundation_modulus(wall))), 1.5);
}

/// A wire along x on a plane that falls towards +x by `angle`: gravity is tilted instead of the plane.
TestSetup on_incline(double length, int nodes, double angle, double mu_static, double mu_sliding)
{
    TestSetup setup;
    setup.start_settled = true;
    setup.gravity = gravity * Vec3(std::sin(angle), 0, -std::cos(angle));
    add_plane(setup, 2, 5000);
    WireSpec wire = steel_wire(length, nodes);
    wire.shaft.mu_static = mu_static;
    wire.shaft.mu_sliding = mu_sliding;
    setup.wires = {placed_wire(wire, {0, 0, radius - own_depth(7900, gravity)})};
    return setup;
}

/// Steps that must not fail. @return the move of the wire's middle [m]
Vec3 run_for(FedWorld& world, double time, double dt)
{
    const int middle = world.rod(0).n / 2;
    const Vec3 start = world.rod(0).pos(middle);
    for (int k = 0; k < std::lround(time / dt); ++k) REQUIRE_FALSE(step(world, dt).failed());
    return world.rod(0).pos(middle) - start;
}

}  // namespace

TEST_SUITE("contact/sliding")
{
    // half a metre of wire: the tip's own law and the free ends eat less than the 2 % of margin
    TEST_CASE("analytic: on an incline a settled wire sticks at 0.98 of the critical angle and slides at 1.02")
    {
        for (const double mu : {0.05, 0.1, 0.2, 0.3, 0.48})
            for (const double share : {0.98, 1.02}) {
                CAPTURE(mu);
                CAPTURE(share);
                const double angle = share * std::atan(mu), mu_sliding = 0.9 * mu, dt = 1e-3;
                FedWorld world(on_incline(0.5, 51, angle, mu, mu_sliding));
                REQUIRE_FALSE(settle(world).failed());
                const Vec3 move = run_for(world, 0.1, dt);
                if (share < 1) {
                    CHECK(move.norm() <= 1e-9);
                    CHECK(world.readings(0).sliding == 0);
                    continue;
                }
                // from rest; the wire's ends let go a few milliseconds before its middle
                const double acceleration = gravity * (std::sin(angle) - mu_sliding * std::cos(angle));
                CHECK(move.x() == about(0.5 * acceleration * 0.1 * 0.1).epsilon(0.1));
                CHECK(world.readings(0).sticking == 0);
            }
    }

    TEST_CASE("property: a wire that sticks does not creep in ten minutes, neither on an incline nor in a tilted tube")
    {
        const double angle = 0.95 * std::atan(0.3), dt = 0.1;
        for (const bool in_tube : {false, true}) {
            CAPTURE(in_tube);
            TestSetup setup = on_incline(0.1, 11, angle, 0.3, 0.25);
            if (in_tube) {
                VesselSpec spec = tube(0.003, 0.3);
                spec.origin = {-0.1, 0, 0};
                add_tube(setup, spec);
                setup.wires[0].wire.place.base = {0, 0, -0.003 + radius - 4e-7};
            }
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            const Vec3 move = run_for(world, 600, dt);
            MESSAGE(std::string(in_tube ? "tube" : "incline") << ": " << 1e9 * move.norm() << " nm in ten minutes");
            CHECK(move.norm() <= 1e-6);
            CHECK(world.readings(0).sliding == 0);
            CHECK(world.readings(0).sticking == about(0.0481 * 0.1 * std::sin(angle)).epsilon(0.01));
        }
    }

    // v0^2 / (2 g (mu cos - sin))
    TEST_CASE("analytic: a sliding wire stops where friction has eaten its energy, and stays there")
    {
        struct Slide {
            double speed, angle, distance;
        };
        const double down = 5 * std::numbers::pi / 180;
        for (const Slide& slide : {Slide{0.1, 0, 0.0020387360}, Slide{0.1, down, 0.0031482782}, Slide{0.5, 0, 0.0509683996},
                                   Slide{0.5, down, 0.0787069562}}) {
            CAPTURE(slide.speed);
            CAPTURE(slide.angle);
            const double dt = 2e-4;
            TestSetup setup = on_incline(0.05, 6, slide.angle, 0.3, 0.25);
            setup.wires[0].wire.place.velocity = {slide.speed, 0, 0};
            FedWorld world(std::move(setup));
            const double time = slide.distance / (slide.speed / 2);
            const Vec3 move = run_for(world, 1.1 * time, dt);
            CHECK(move.x() == about(slide.distance).epsilon(0.01));
            CHECK(world.readings(0).sliding == 0);
            CHECK(std::abs(world.rod(0).vx[0]) <= 1e-3 * slide.speed);
        }
    }

    // A wire of 1 g, pressed on by 20 mN, pulled by a spring of 10 N/m whose end moves at 5 mm/s: A = (mu_s - mu_d) N / k,
    // slip lasts (2/w)(pi - atan(A w/V)), w^2 = k/m, stick 2A/V; force falls from mu_s N to (2 mu_d - mu_s) N.
    // The steady cycle is that of the formula; the first stroke begins from anchors as settled. Backward Euler damps a slip by
    // pi w dt/2 = 0.4 %. The tip's own law (D6c), which a block has not, lets parts slip before others. So does friction's
    // moment: pulled on its axis and held at its surface, the wire presses 6 mu r/L more on its front end than in the middle,
    // less on the other, which slips first. Therefore a thin wire: 0.6 %.
    TEST_CASE("analytic: pulled by a spring it sticks and slips with the period and stroke of the mass-spring model")
    {
        constexpr double dt = 2.5e-5, length = 0.05, k = 10, mass = 1e-3, load = 0.02, speed = 0.005, mu_static = 0.48,
                         mu_sliding = 0.3, thin = 1e-4;
        const double amplitude = (mu_static - mu_sliding) * load / k, w = std::sqrt(k / mass);
        const double period = 2 / w * (std::numbers::pi - std::atan(amplitude * w / speed)) + 2 * amplitude / speed;
        const double stroke = period * speed;
        TestSetup setup = on_incline(length, 6, 0, mu_static, mu_sliding);
        setup.gravity = {0, 0, -load / mass};
        WireSpec& wire = setup.wires[0].wire;
        wire.shaft.radius = thin;
        wire.shaft.density = mass / (length * std::numbers::pi * thin * thin);
        wire.place.base.z() =
            thin -
            depth_under(load / length, line_stiffness(rod_side(thin, 0), wall_side(INFINITY, thin, foundation_modulus({}))), 1.5);
        setup.wires[0].contact.samples_per_edge = 20;
        LinkSpec spring;
        spring.at = {WirePoint::Kind::Distance, length / 2};
        const double anchor = length / 2;
        spring.anchor = {anchor, 0, wire.place.base.z()};
        spring.stiffness = k;
        spring.move = {{0, 0, 0, 0}, {1, speed, 0, 0}};
        setup.wires[0].links = {spring};
        FedWorld world(std::move(setup));
        REQUIRE_FALSE(settle(world).failed());
        std::vector<double> starts, at;  // of slips; where the wire stood
        bool slipping = false;
        double largest = 0, least = 1;
        for (int n = 1; n <= 32000; ++n) {
            REQUIRE_FALSE(step(world, dt).failed());
            const ConstRodView rod = world.rod(0);
            const double x = (rod.x[2] + rod.x[3]) / 2, pull = k * (anchor + speed * n * dt - x);
            const bool moving = rod.vx[2] > 0.5 * speed;
            if (moving && !slipping) {
                starts.push_back(n * dt);
                at.push_back(x);
            }
            slipping = moving;
            if (!starts.empty()) {
                largest = std::max(largest, pull);
                least = std::min(least, pull);
            }
        }
        REQUIRE(starts.size() >= 4);
        CHECK(starts[0] == about(mu_static * load / (k * speed)).epsilon(0.02));
        for (std::size_t n = 2; n < starts.size(); ++n) {
            CHECK(starts[n] - starts[n - 1] == about(period).epsilon(0.02));
            CHECK(at[n] - at[n - 1] == about(stroke).epsilon(0.02));
        }
        CHECK(largest == about(mu_static * load).epsilon(0.02));
        CHECK(least == about((2 * mu_sliding - mu_static) * load).epsilon(0.02));
        MESSAGE("period " << starts[2] - starts[1] << " s of " << period << ", stroke " << at[2] - at[1] << " m of " << stroke
                          << ", force " << least << " to " << largest << " N");
    }
}

}  // namespace seldinger::test::test_sliding
