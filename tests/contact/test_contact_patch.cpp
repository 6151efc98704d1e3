// Area and pressure where a wire lies on a wall: the chord, laws with and without an overlap, and what a world tells.
#include "contact/loads/contact_patch.h"

#include "support/approx.h"
#include "support/world_fixture.h"

#include <cmath>
#include <numbers>

namespace seldinger::test::test_contact_patch {

namespace {

constexpr double r = 0.5e-3;  // [m]

/// k [N/m^(n+1)] depth^n per metre, for `length` metres.
QuadratureModel plain_model(double k, double n, double length)
{
    QuadratureModel m{};
    m.weight = m.length = length;
    m.radius = r;
    m.stiffness = k;
    m.exponent = n;
    return m;
}

}  // namespace

TEST_SUITE("contact/contact_patch")
{
    TEST_CASE("analytic: width of the chord of a circle")
    {
        CHECK(overlap_width(0, r) == 0);
        CHECK(overlap_width(-1e-6, r) == 0);
        // 2 sqrt(0.2 x 1.8) r = 1.2 r
        CHECK(overlap_width(0.2 * r, r) == test::about(1.2 * r).epsilon(1e-14));
        CHECK(overlap_width(r, r) == test::about(2 * r).epsilon(1e-14));
        CHECK(overlap_width(1.7 * r, r) == test::about(2 * r).epsilon(1e-14));  // no wider than the wire
    }

    TEST_CASE("analytic: a linear law of 50 kN/m^2 that carries 5 N/m over 2 mm of wire")
    {
        // depth 5/5e4 = 0.1 mm = 0.2 r, chord 1.2 r = 0.6 mm, area 1.2 mm^2, 10 mN over it: 8333 Pa
        const QuadratureModel m = plain_model(5e4, 1, 2e-3);
        const ContactPatch sunk = contact_patch(m, SEL_NORMAL_DAMPED, -1e-4, 1e-2);
        CHECK(sunk.area == test::about(1.2e-6).epsilon(1e-12));
        CHECK(sunk.pressure == test::about(1e-2 / 1.2e-6).epsilon(1e-12));
        // laws that let nothing in: the same wire on the same bed, whatever their gap is
        for (const uint law : {SEL_NORMAL_AUGMENTED, SEL_NORMAL_CONSTRAINT, SEL_NORMAL_IMPULSE, SEL_NORMAL_BARRIER})
            for (const double gap : {1e-6, 0.0, -1e-9}) {
                const ContactPatch held = contact_patch(m, law, gap, 1e-2);
                CHECK(held.area == test::about(1.2e-6).epsilon(1e-12));
                CHECK(held.pressure == test::about(1e-2 / 1.2e-6).epsilon(1e-12));
            }
    }

    TEST_CASE("analytic: the tip's point law lies on a disc")
    {
        QuadratureModel tip = plain_model(1e8, 2, 0);
        tip.weight = 1;
        const ContactPatch patch = contact_patch(tip, SEL_NORMAL_DAMPED, -0.2 * r, 1e-3);
        CHECK(patch.area == test::about(std::numbers::pi * std::pow(0.6 * r, 2)).epsilon(1e-12));
        CHECK(patch.pressure == test::about(1e-3 / patch.area).epsilon(1e-12));
    }

    TEST_CASE("regression: no force, or a force without overlap, has neither area nor pressure")
    {
        const QuadratureModel m = plain_model(5e4, 1, 2e-3);
        for (const auto& [gap, force] : {std::pair{-1e-4, 0.0}, {1e-5, 1e-3}, {0.0, 1e-3}}) {
            const ContactPatch none = contact_patch(m, SEL_NORMAL_DAMPED, gap, force);
            CHECK(none.area == 0);
            CHECK(none.pressure == 0);
        }
    }

    TEST_CASE("analytic: a straight wire that its weight presses into a flat wall")
    {
        // pi r^2 rho g = 0.60521 N/m on k = 6052.1 N/m^2: depth 0.1 mm = 0.2 r (as given to 0.4 r), chord 1.2 r; 40 mm of wire
        test::TestSetup setup;
        setup.integrator.scheme = Scheme::Static;
        test::add_plane(setup, 0.2, 200);
        WireSpec spec = test::steel_wire(0.04, 41);
        spec.shaft.radius = r;
        spec.shaft.density = 78548;
        const double load = std::numbers::pi * r * r * spec.shaft.density * 9.81;
        setup.wires = {test::placed_wire(spec, {-0.02, 0, 0.9 * r})};
        ContactSpec& contact = setup.wires[0].contact;
        contact.stiffness_from_wall = false;
        contact.stiffness = load / 1e-4;
        contact.exponent = 1;
        World world(setup);
        REQUIRE_FALSE(settle(world).failed());
        const Output now = world.output(Output::Contacts);
        double area = 0, length = 0, most = 0;
        for (const ContactRow& row : now.contacts) {
            area += row.area, length += row.length, most = std::max(most, row.pressure);
            // beside the tip its own law lifts the wire a little
            if (std::abs(row.along_a - 0.02) < 0.01) CHECK(row.pressure == test::about(load / (1.2 * r)).epsilon(0.02));
        }
        CHECK(length == test::about(0.04).epsilon(1e-9));
        CHECK(now.wires[0].contact_area == test::about(area).epsilon(1e-12));
        CHECK(now.wires[0].contact_pressure_max == test::about(most).epsilon(1e-12));
        // the tip's own point law carries a little of the weight beside its end: 2 % of 40 mm
        CHECK(area == test::about(0.04 * 1.2 * r).epsilon(0.02));
        CHECK(most == test::about(load / (1.2 * r)).epsilon(0.02));
    }

    // Lists of what is near hold facets within radius, reach and slack of where they were made. Along a floor to a wall that was
    // beyond that then.
    TEST_CASE("property: a wire moved sideways finds a wall as one that starts there does")
    {
        const double radius = 0.4445e-3, wide = 0.03, high = 0.01, side = 0.01;
        test::TestSetup setup;
        setup.gravity = Vec3::Zero();
        setup.vessel.shape = VesselShape::Plane;
        setup.mesh.vertices = {{-wide, -wide, 0}, {wide, -wide, 0},   {wide, side, 0},
                               {-wide, side, 0},  {wide, side, high}, {-wide, side, high}};
        setup.mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}, {{3, 2, 4}}, {{3, 4, 5}}};
        WireSpec spec = test::steel_wire(0.02, 11);
        spec.shaft.bend_stiffness = 1e-2;
        setup.wires = {test::placed_wire(spec, {-0.01, side - 1.6 * radius, 0.99 * radius})};
        HoldSpec base, tip;
        base.position = base.direction = tip.position = true;
        tip.at.kind = WirePoint::Kind::Tip;
        base.move = tip.move = {{0, 0, 0, 0}, {0.03, 0, 0.62 * radius, 0}};
        setup.wires[0].holds = {base, tip};
        World world(setup), fresh(setup);
        double pushed = 0;
        for (int k = 0; k < 30; ++k) {
            fresh.restore_state(world.save_state());
            for (World* one : {&world, &fresh}) REQUIRE_FALSE(step(*one, 1e-3).failed());
            REQUIRE(world.state_hash() == fresh.state_hash());
            pushed = 0;
            for (const Vec3& force : world.nodal_contact_force(0)) pushed += force.y();
        }
        CHECK(pushed < 0);
    }
}

}  // namespace seldinger::test::test_contact_patch
