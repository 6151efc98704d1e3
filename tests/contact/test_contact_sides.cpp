// kernels/shared/contact_sides.h: what a contact takes from its two sides, in limits that are known, and with the sides swapped.

#include "contact/one_quadrature_point.h"
#include "contact/wall_law.h"
#include "shared/contact_sides.h"
#include "support/approx.h"

#include <cmath>

namespace seldinger::test::test_contact_sides {

namespace {

LawContext sliding_context()
{
    LawContext c{};
    c.m.weight = 4e-4;
    c.m.radius = 0.4e-3;
    c.m.stiffness = 1.5e8;
    c.m.exponent = 1.5;
    c.m.friction_stiffness = 1e5;
    c.m.mu_static = 0.25;
    c.m.mu_sliding = 0.2;
    c.m.speed_floor = 1e-4;
    c.m.damping = 1.4;
    c.mv.tangent = v3(1, 0, 0);
    c.mv.length = 2e-3;
    c.mv.epoch = 5;
    c.par.friction = SEL_FRICTION_STICK_SLIP;
    c.par.inv_dt = 1000;
    return c;
}

}  // namespace

TEST_SUITE("contact/contact_sides")
{
    TEST_CASE("analytic: effective radius between planes, rods and lumens")
    {
        const double r = 0.5e-3;
        const LawSide rod = rod_side(r, 0);
        CHECK(effective_radius(rod, wall_side(INFINITY, r, 1e9)) == r);
        CHECK(effective_radius(rod, wall_side(1e9 * r, r, 1e9)) == about(r).epsilon(1.1e-9));   // 1 / (1 - 1e-9)
        CHECK(effective_radius(rod, wall_side(2 * r, r, 1e9)) == about(2 * r).epsilon(1e-15));  // 1/r* = 1/r - 1/R
        CHECK(effective_radius(rod, rod_side(r, 0)) == about(r / 2).epsilon(1e-15));            // two equal rods
        CHECK(effective_radius(rod, wall_side(0.9 * r, r, 1e9)) == r);  // a lumen that does not hold the wire counts as a plane
    }

    TEST_CASE("analytic: stiffness of two surfaces that carry the same pressure")
    {
        const double r = 0.5e-3, k = 2e9;
        CHECK(effective_modulus(rod_side(r, 0), wall_side(0.01, r, k)) == k);  // a rigid wire: the wall's own
        CHECK(effective_modulus(rod_side(r, k), rod_side(r, k)) == about(k / 2).epsilon(1e-15));
        CHECK(effective_modulus(rod_side(r, 1e6 * k), rod_side(r, k)) == about(k).epsilon(1.1e-6));  // the softer
        // (D6b), as printed: f = (4/3) k_f sqrt(2 r*) depth^1.5
        CHECK(line_stiffness(rod_side(r, 0), wall_side(INFINITY, r, k)) ==
              about(4.0 / 3 * k * std::sqrt(2 * r)).epsilon(1e-15));
    }

    TEST_CASE("property: with the sides swapped the numbers are the same, bit for bit")
    {
        for (const double ra : {0.3e-3, 0.5e-3, 2e-3})
            for (const double ka : {0.0, 1e8, 3e9}) {
                const LawSide a = rod_side(ra, ka);
                for (const LawSide& b : {rod_side(0.7e-3, 2e8), wall_side(0.01, ra, 1.7e9), wall_side(INFINITY, ra, 1.7e9)}) {
                    CHECK(effective_radius(a, b) == effective_radius(b, a));
                    CHECK(effective_modulus(a, b) == effective_modulus(b, a));
                    CHECK(line_stiffness(a, b) == line_stiffness(b, a));
                }
            }
    }

    // What side b feels is what the laws give with the normal turned round and the motion seen from the other side. The sections
    // do not turn: a torque or couple belongs to the rod, not to the contact.
    TEST_CASE("property: with the sides swapped forces are opposite and equal")
    {
        const vec3 normals[] = {v3(0, 0, 1), v3(0, 0.6, 0.8)};
        const vec3 move_a = v3(2e-6, -1e-6, -0.5e-6), move_b = v3(-1e-6, 0.5e-6, 0.25e-6);
        for (const uint friction : {SEL_FRICTION_STICK_SLIP, SEL_FRICTION_SMOOTH, SEL_FRICTION_SIGN})
            for (const vec3 n : normals)
                for (const double scale : {1e-3, 1.0, 100.0}) {  // stuck, and beyond the cone
                    ContactForce force[2];
                    ContactState now[2];
                    for (const int swapped : {0, 1}) {
                        LawContext c = sliding_context();
                        c.par.friction = friction;
                        const vec3 move = swapped ? move_b - move_a : move_a - move_b;
                        c.mv.move = scale * move;
                        ContactPoint contact = no_contact_point(0);
                        contact.found = 1;
                        contact.depth = 3e-6;
                        contact.normal = swapped ? -n : n;
                        force[swapped] = no_force(c.m);
                        now[swapped] = no_contact_state();
                        add_contact_point(contact, v3(0, 0, 0), no_contact_state(), no_multiplier(), &c, &now[swapped],
                                          &force[swapped]);
                    }
                    REQUIRE(force[0].normal_sum > 0);
                    REQUIRE(force[0].friction_sum > 0);
                    for (int i = 0; i < 3; ++i) {
                        CHECK(force[0].force[i] == -force[1].force[i]);
                        CHECK(now[0].friction[i] == -now[1].friction[i]);
                    }
                    CHECK(force[0].normal_sum == force[1].normal_sum);
                    CHECK(force[0].friction_sum == force[1].friction_sum);
                    CHECK(force[0].sliding_sum == force[1].sliding_sum);
                    CHECK(now[0].flags == now[1].flags);
                    CHECK(now[0].rate == now[1].rate);
                }
    }
}

}  // namespace seldinger::test::test_contact_sides
