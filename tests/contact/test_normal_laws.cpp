// Normal laws in whole worlds: what each promises of overlap, restitution, stick, and that state and bits are kept.

#include "support/world_fixture.h"

#include "contact/wall_law.h"
#include "core/error.h"
#include "shapes/shapes.h"
#include "shared/contact_law.h"
#include "support/refusal.h"

#include <cstring>

namespace seldinger::test::test_normal_laws {

namespace {

constexpr NormalLaw hard_laws[] = {NormalLaw::Augmented, NormalLaw::Constraint, NormalLaw::Impulse, NormalLaw::Barrier};

void add_plane(TestSetup& setup, const Vec3& normal, double height = 0)
{
    VesselSpec spec{.shape = VesselShape::Plane, .origin = Vec3(0, 0, height), .normal = normal, .size = 0.4, .triangles = 200};
    add_vessel(setup, make_plane(spec), spec);
}

/// A wire along x, `gap` above a floor; whole numbers of quadrature points per edge, so that a uniform load bends nothing.
TestSetup over_floor(NormalLaw law, double gap, double length = 0.05)
{
    TestSetup setup;
    add_plane(setup, Vec3::UnitZ());
    TestWire wire = placed_wire(steel_wire(length, 11), Vec3(-length / 2, 0, 0));
    wire.wire.place.base.z() = wire.wire.shaft.radius + gap;
    wire.contact.normal = law;
    wire.contact.samples_per_edge = 10;
    setup.wires = {wire};
    return setup;
}

double weight_of(const World& world)
{
    double mass = 0;
    for (const double m : world.rod(0).mass.first(world.rod(0).n)) mass += m;
    return mass * world.setup().gravity.norm();
}

double mean_height(const World& world)
{
    const ConstRodView rod = world.rod(0);
    double sum = 0, mass = 0;
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i] * rod.z[i], mass += rod.mass[i];
    return sum / mass;
}

double mean_speed(const World& world)
{
    const ConstRodView rod = world.rod(0);
    double sum = 0, mass = 0;
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i] * rod.vz[i], mass += rod.mass[i];
    return sum / mass;
}

/// Two wires in a bend: one fed and turned, one along the whole bend and pressed against its outer wall.
TestSetup two_wires(NormalLaw law)
{
    TestSetup setup = in_bend(0.003, 0.05);
    for (int w = 0; w < 2; ++w) {
        const WireSpec spec = steel_wire(0.06 + 0.02 * w, 21 + 7 * w);
        TestWire wire = w == 0 ? fed_wire(spec, {0.0005, 0, -0.0024}, 0.2, 2.0) : placed_wire(spec, Vec3::Zero());
        if (w == 1) {
            wire.wire.place.shape = PlaceShape::Centreline;
            wire.wire.place.from = 0.002;
            wire.wire.place.velocity = {0.05, 0.02, 0};
        }
        wire.contact.normal = law;
        wire.contact.rolling = w == 0;
        setup.wires.push_back(wire);
    }
    return setup;
}

std::string hash_after(FedWorld& world, int steps)
{
    for (int k = 0; k < steps; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
    return world.state_hash();
}

/// Speed after over speed before, of a wire that falls flat on the floor; no gravity.
double restitution(TestSetup setup, double speed, double dt, int most_steps)
{
    setup.gravity = Vec3::Zero();
    setup.wires[0].wire.place.velocity = {0, 0, -speed};
    setup.wires[0].contact.friction = FrictionLaw::None;
    FedWorld world(std::move(setup));
    bool touched = false;
    for (int k = 0; k < most_steps; ++k) {
        REQUIRE_FALSE(step(world, dt).failed());
        const int contacts = world.readings(0).contacts;
        if (touched && contacts == 0) return mean_speed(world) / speed;
        touched = touched || contacts > 0;
    }
    FAIL("still in contact, or never");
    return 0;
}

}  // namespace

TEST_SUITE("contact/normal_laws")
{
    TEST_CASE("analytic: a wire at rest on a floor is carried whole, as deep as its law says")
    {
        for (const NormalLaw law : hard_laws) {
            CAPTURE(static_cast<int>(law));
            TestSetup setup = over_floor(law, 1e-6);
            const double r = setup.wires[0].wire.shaft.radius;
            setup.start_settled = true;
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            for (int k = 0; k < 10; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            const WireReadings now = world.readings(0);
            CHECK(now.normal == about(weight_of(world)).epsilon(1e-4));  // of what still moves
            // its own weight: within what augmented and constraint allow; barrier: where 3 kappa dh (1 - d/dh)^2 carries it
            const double height = mean_height(world) - r;
            if (law == NormalLaw::Augmented) CHECK(std::abs(height) <= augmented_overlap * r);
            if (law == NormalLaw::Constraint) CHECK(std::abs(height) <= constraint_overlap * r);
            if (law == NormalLaw::Barrier) {
                CHECK(now.overlap == 0);
                CHECK(height > 0.9 * barrier_distance * r);
                CHECK(height < barrier_distance * r);
            }
        }
    }

    // e = 0.1 ... 0.9 with a wall's exponent and with a spring's: reference case 09, whose tolerance is 0.01
    TEST_CASE("analytic: restitution asked for is restitution got, of a wire that falls flat, dt = t_c / 500")
    {
        const double speed = 0.05;
        for (const double n : {1.5, 1.0})
            for (const double e : {0.1, 0.3, 0.5, 0.7, 0.9}) {
                CAPTURE(n);
                CAPTURE(e);
                TestSetup setup = over_floor(NormalLaw::HuntCrossley, 5e-6);
                ContactSpec& contact = setup.wires[0].contact;
                contact.restitution = e;
                contact.exponent = n;
                contact.stiffness_from_wall = n == 1.5;
                contact.stiffness = 2e5;  // [N/m^2]: some 5 um deep, as from the wall
                const WireSection& section = setup.wires[0].wire.shaft;
                const double mass = section.density * std::numbers::pi * section.radius * section.radius;  // [kg/m]
                const double k = n == 1.0 ? contact.stiffness : 1.5e8;  // the wall's, to its second digit
                const double contact_time = 3.2 * std::pow(mass * speed * speed / k, 1 / (n + 1)) / speed;
                CHECK(std::abs(restitution(std::move(setup), speed, contact_time / 500, 20000) - e) <= 0.01);
            }
    }

    // Modified equations of the schemes, bench/restitution.py: e misses by c h/t_c, c = 3.203 and 1.601 for e = 0.7 on the wall's
    // law, t_c = 3.373 lengths over speed; the trapezoid's first order is 0. The second order and the tip's own law add to c.
    TEST_CASE("analytic: restitution misses by c h/t_c with backward Euler, by half of it conserving, by h^2 with the trapezoid")
    {
        const double speed = 0.05, e = 0.7;
        const auto error = [&](int scheme, int part) {
            TestSetup setup = over_floor(NormalLaw::HuntCrossley, 2e-6, 0.02);
            setup.wires[0].contact.restitution = e;
            setup.wires[0].wire.shaft.bend_stiffness = 1e-3;
            setup.integrator.conserve = scheme == 1;
            setup.integrator.newmark = scheme == 2;
            const QuadratureModel law = line_model(setup.wires[0].wire.shaft, setup.wires[0].contact, setup.vessel, INFINITY, 1);
            const double duration = 3.373 * std::pow(law.line_mass * speed * speed / law.stiffness, 0.4) / speed;
            return (e - restitution(std::move(setup), speed, duration / part, 1000)) * part;
        };
        const double c[] = {3.203, 1.601};
        for (int scheme = 0; scheme < 2; ++scheme) {
            CAPTURE(scheme);
            const double coarse = error(scheme, 100), fine = error(scheme, 200);
            MESSAGE("c " << coarse << ", " << fine << " of " << c[scheme]);
            CHECK(fine == about(c[scheme]).epsilon(0.05));
            CHECK(coarse == about(fine).epsilon(0.05));
        }
        CHECK(std::abs(error(2, 100)) / 100 <= 1e-3);
    }

    // v- -> 0: floored so that a contact under the wire's own weight is damped just critically, at a rate of sqrt(n g / depth).
    // The law being weaker in shallower contact, a wire laid down still swings over once, by what
    //     d'' = 1 - d^n (1 + 2 sqrt(n) d'),    d in depths, t in sqrt(depth / g)
    // does, solved here by fourth-order steps, and comes to rest
    TEST_CASE("analytic: a wire laid down without speed sinks as the floored law says, and rests at the depth of its weight")
    {
        const double n = 1.5, small = 1e-3;
        double d = 0, v = 0, swing = 0;
        const auto push = [&](double d, double v) { return 1 - std::pow(std::max(d, 0.0), n) * (1 + 2 * std::sqrt(n) * v); };
        for (double t = 0; t < 20; t += small) {
            const double v1 = v, a1 = push(d, v), v2 = v + small / 2 * a1, a2 = push(d + small / 2 * v1, v2);
            const double v3 = v + small / 2 * a2, a3 = push(d + small / 2 * v2, v3), v4 = v + small * a3,
                         a4 = push(d + small * v3, v4);
            d += small / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v += small / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
            swing = std::max(swing, d);
        }
        CHECK(d == about(1).epsilon(1e-6));
        for (const double e : {0.1, 0.5, 0.9}) {
            CAPTURE(e);
            TestSetup setup = over_floor(NormalLaw::HuntCrossley, 1e-10);
            setup.wires[0].contact.restitution = e;
            setup.wires[0].contact.friction = FrictionLaw::None;
            const double r = setup.wires[0].wire.shaft.radius;
            const QuadratureModel law = line_model(setup.wires[0].wire.shaft, setup.wires[0].contact, setup.vessel, INFINITY, 1);
            const double depth = depth_under(law.line_mass * 9.81, law.stiffness, law.exponent);
            const double rate = std::sqrt(law.exponent * 9.81 / depth);
            CHECK(law.speed_floor == about(law.damping / 2 * 9.81 / rate).epsilon(1e-9));
            FedWorld world(std::move(setup));
            double deepest = 0;
            for (int k = 0; k < 1000; ++k) {
                REQUIRE_FALSE(step(world, 0.02 / rate).failed());
                deepest = std::max(deepest, r - mean_height(world));
            }
            CHECK(r - mean_height(world) == about(depth).epsilon(0.01));  // the tip's law and hardening carry some of it
            // the same, and backward Euler's own damping: h omega / 2 of critical
            CHECK(deepest == about(swing * depth).epsilon(0.01));
            CHECK(world.readings(0).normal == about(weight_of(world)).epsilon(0.01));
        }
        CAPTURE(swing);
        CHECK(swing < 1.1);
    }

    TEST_CASE("analytic: an impulse gives the restitution asked for at any step")
    {
        for (const double e : {0.1, 0.5, 0.9, 1.0})
            for (const double dt : {1e-3, 1e-5}) {
                CAPTURE(e);
                CAPTURE(dt);
                TestSetup setup = over_floor(NormalLaw::Impulse, 5e-6);
                setup.wires[0].contact.restitution = e;
                // 0.1 mm/s are left to chance, and the tip's law makes the wire shiver as little
                CHECK(std::abs(restitution(std::move(setup), 0.05, dt, 2000) - e) <= 0.01);
            }
    }

    TEST_CASE("property: what falls on a hard wall stays down: augmented and constraint give nothing back")
    {
        for (const NormalLaw law : {NormalLaw::Augmented, NormalLaw::Constraint})
            for (const double dt : {1e-3, 1e-5}) {
                CAPTURE(static_cast<int>(law));
                CAPTURE(dt);
                TestSetup setup = over_floor(law, 5e-6);
                setup.gravity = Vec3::Zero();
                setup.wires[0].wire.place.velocity = {0, 0, -0.05};
                FedWorld world(std::move(setup));
                double mass = 0, fastest = -1;
                for (const double m : world.rod(0).mass.first(11)) mass += m;
                for (int k = 0; k < 60; ++k) {
                    REQUIRE_FALSE(step(world, dt).failed());
                    fastest = std::max(fastest, mean_speed(world));
                    const WireReadings now = world.readings(0);
                    CHECK(now.kinetic + now.elastic <= 0.5 * mass * 0.05 * 0.05 * (1 + 1e-9));
                }
                MESSAGE("leaves at " << fastest / 0.05 << " of the speed at which it came");
                CHECK(fastest <= 0.1 * 0.05);  // lambda is exact to the length allowed: what is left of it pushes
            }
    }

    // Hunt-Crossley's stick gives way by an elastic slip; a constraint does not give way at all
    TEST_CASE("property: stuck to a constraint means stuck: no elastic slip, no creep")
    {
        const double angle = 0.2;  // tan = 0.203 of mu_static 0.25
        const auto moved = [&](NormalLaw law) {
            TestSetup setup = over_floor(law, -1e-8);
            setup.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
            FedWorld world(std::move(setup));
            for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            const double settled = world.rod(0).x[5];
            for (int k = 0; k < 100; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            return std::abs(world.rod(0).x[5] - settled);
        };
        const double r = 0.4445e-3;
        CHECK(moved(NormalLaw::Constraint) <= constraint_overlap * r);
    }

    TEST_CASE("property: two wires of one world give the bits that each gives alone, and a restored state goes on the same")
    {
        for (const NormalLaw law : hard_laws) {
            CAPTURE(static_cast<int>(law));
            FedWorld together(two_wires(law));
            const int steps = 60;
            (void)hash_after(together, steps / 2);
            const std::vector<std::uint8_t> saved = together.save_state();
            const std::string hash = hash_after(together, steps / 2);
            int contacts = 0;
            for (int w = 0; w < 2; ++w) {
                CAPTURE(w);
                TestSetup setup = two_wires(law);
                setup.wires = {setup.wires[w]};
                FedWorld alone(std::move(setup));
                CHECK(hash_after(alone, steps) == together.state_hash(w));
                contacts += alone.readings(0).contacts;
            }
            REQUIRE(contacts > 0);
            FedWorld other(two_wires(law));
            other.restore_state(saved);
            CHECK(hash_after(other, steps / 2) == hash);
        }
    }

    TEST_CASE("property: a barrier frees what starts in overlap, and never lets it deeper")
    {
        TestSetup setup = over_floor(NormalLaw::Barrier, -2e-5);
        FedWorld world(std::move(setup));
        double last = 2e-5;
        for (int k = 0; k < 60; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            const double overlap = world.readings(0).overlap;
            CHECK(overlap <= last + 1e-9);
            last = overlap;
        }
        CHECK(last == 0);
    }

    // The radii that a barrier frees wires with lie somewhere in the state: a number of 5 m in their place is none.
    TEST_CASE("bad input: a saved state with a radius out of bounds is refused")
    {
        TestSetup setup = over_floor(NormalLaw::Barrier, -2e-5, 0.01);
        FedWorld world(std::move(setup));
        REQUIRE_FALSE(step(world, 1e-3).failed());
        const std::vector<std::uint8_t> good = world.save_state();
        world.restore_state(good);
        int refused = 0;
        const real five = 5;
        for (std::size_t at = 0; at + sizeof(five) <= good.size(); ++at) {
            std::vector<std::uint8_t> damaged = good;
            std::memcpy(damaged.data() + at, &five, sizeof(five));
            refused += has(refusal([&] { world.restore_state(damaged); }), "a radius is out of bounds");
        }
        CHECK(refused >= 10);  // one for each quadrature point of the ten edges, at least
        world.restore_state(good);
        CHECK(world.save_state() == good);
    }

    // F12: no solution without overlap. The wire's radius is 0.44 mm, the tube's 0.40
    TEST_CASE("property: in a lumen narrower than the wire the force of a hard law stays bounded")
    {
        for (const NormalLaw law : {NormalLaw::Augmented, NormalLaw::Constraint}) {
            CAPTURE(static_cast<int>(law));
            TestSetup setup = in_tube(0.40e-3, 0.05, 2000);
            TestWire wire = placed_wire(steel_wire(0.02, 5), {0.01, 0, 0});
            wire.contact.normal = law;
            setup.wires = {wire};
            FedWorld world(std::move(setup));
            const WireSection& section = world.setup().wires[0].wire.shaft;
            const QuadratureModel line = line_model(section, wire.contact, world.setup().vessel, 0.40e-3, 1);
            const QuadratureModel tip = tip_model(section, wire.contact, world.setup().vessel, 0.40e-3);
            double ignored;
            // from both sides, what the wall's law carries at 0.95 of its pole
            const double most = 2 * (0.02 * elastic_normal(0.95 * line.depth_limit, line, &ignored) +
                                     elastic_normal(0.95 * tip.depth_limit, tip, &ignored));
            for (int k = 0; k < 4; ++k) {
                const StepReport report = step(world, 1e-3);
                CHECK_FALSE(report.failed());
                const WireReadings now = world.readings(0);
                CHECK(now.normal > 0);
                CHECK(now.normal <= 1.01 * most);  // the wall's stiffness times the overlap comes on top: 0.3 % of it
                CHECK(now.overlap >= 0.04e-3);
            }
        }
    }

    // the tip of a wire pushed head on is where the wire ends: it must carry, whatever the stiffness, and the wire buckle
    TEST_CASE("regression: a wire pushed head on at a wall, stiff or soft, buckles without sub-steps")
    {
        const auto push = [](double stiffness, double tilt, const auto& check) {
            CAPTURE(stiffness);
            CAPTURE(tilt);
            TestSetup setup;
            add_plane(setup, Vec3::UnitZ());
            TestWire wire = placed_wire(steel_wire(0.05, 21), Vec3(0, 0, 0.05 + 0.6e-3));
            wire.wire.place.direction = Vec3(tilt, 0, -1).normalized();
            wire.contact.stiffness_from_wall = false;
            wire.contact.stiffness = stiffness;
            wire.holds = {{.position = true, .direction = true, .velocity = {0, 0, -0.02}}};
            setup.wires = {wire};
            FedWorld world(std::move(setup));
            for (int k = 0; k < 60; ++k) {
                const StepReport report = step(world, 1e-3);
                REQUIRE_FALSE(report.failed());
                CHECK((report.flags & StepBestEffort) == 0);
                check(report);
            }
            // clamped and pinned, 20.19 B / L^2 = 80.8 mN, and the plane's friction of the rest of the buckling's swing
            CHECK(world.readings(0).hand_force == about(20.19 * 1e-5 / (0.05 * 0.05)).epsilon(0.15));
            CHECK(world.readings(0).overlap < 0.99 * 0.4445e-3 / 2);
        };
        // a wall as it is, 10 % and 1 % of it, half a degree off the line
        for (const double stiffness : {1.5e8, 1e7, 1e6})
            push(stiffness, 0.01, [](const StepReport& report) { CHECK(report.sub_steps == 1); });
        // exactly on it: nothing leads out of the line, and the step must find the way itself
        for (const double stiffness : {1.5e8, 1e7}) push(stiffness, 0, [](const StepReport&) {});
    }
}

}  // namespace seldinger::test::test_normal_laws
