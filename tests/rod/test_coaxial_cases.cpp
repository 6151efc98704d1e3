// Instruments inside each other against closed forms: arcs joined, torsion of precurved instruments, snapping [Dupont10;
// Rucker10].

#include "coaxial/references.h"
#include "rod/coaxial_fixture.h"

namespace seldinger::test::test_coaxial_cases {

namespace {

/// Section of one stiffness and curvature, tip first.
struct Part {
    double length, bend, curvature;
};
WireSpec spec_of(const std::vector<Part>& parts, double twist_over_bend)
{
    WireSpec spec = instrument_spec(0, parts.back().bend, twist_over_bend * parts.back().bend);
    for (const Part& part : parts) {
        const WireSpec one = instrument_spec(part.length, part.bend, twist_over_bend * part.bend, part.length, part.curvature);
        spec.sections.push_back({spec.length, spec.length + part.length, one.sections[0].section});
        spec.length += part.length;
    }
    return spec;
}

}  // namespace

TEST_SUITE("rod/coaxial cases")
{
    // A curved wire in a curved catheter, pushed out of it: arcs joined.
    TEST_CASE("analytic: sections that overlap in a plane")
    {
        for (const auto& row : coaxial_rows("j_wire_in_catheter")) {
            double error[3];
            for (int level = 0; level < 3; ++level) {
                Coaxial c({spec_of({{0.04, 2e-4, 20}, {0.3, 2e-4, 0}}, 0.77),
                           spec_of({{0.0075, 1e-5, 1000.0 / 3}, {0.03, 1e-5, 0}, {0.6, 1.5e-4, 0}}, 0.77)},
                          {row.outer, row.inner}, 100 << level);
                c.bend_to_rest();
                REQUIRE(c.equilibrate() >= 0);
                error[level] = std::max((c.end(0) - row.tip_outer).norm(), (c.end(1) - row.tip_inner).norm());
            }
            CHECK(error[0] < 0.005 * row.inner);
            CHECK(error[2] <
                  error[0] / 8);  // two halvings, second order: 16; where ends lie in their cells differs from grid to grid
        }
    }

    TEST_CASE("analytic: instruments turned against each other that do not twist")
    {
        for (const auto& row : coaxial_rows("rotated_rigid")) {
            double error[3];
            for (int level = 0; level < 3; ++level) {
                Coaxial c({spec_of({{0.06, 2e-4, 20}, {0.3, 2e-4, 0}}, 1e6), spec_of({{0.05, 1e-4, 25}, {0.3, 1e-4, 0}}, 1e6)},
                          {row.outer, row.inner}, 100 << level);
                c.roll(1, -row.alpha * pi / 180);
                c.bend_to_rest();
                REQUIRE(c.equilibrate() >= 0);
                error[level] = std::max((c.end(0) - row.tip_outer).norm(), (c.end(1) - row.tip_inner).norm());
            }
            CHECK(error[0] < 0.005 * row.inner);
            CHECK(error[2] <
                  error[0] / 8);  // two halvings, second order: 16; where ends lie in their cells differs from grid to grid
        }
    }

    // Both precurved over a common length at whose near end one is turned: theta'' = lambda^2 sin(theta), theta'(L) = 0
    TEST_CASE("analytic: precurved instruments twist each other")
    {
        for (const auto& row : torsion_rows()) {
            double error[3] = {}, angle_error[3] = {}, torque_error[3] = {};
            for (int level = 0; level < 3; ++level) {
                Coaxial c({instrument_spec(1, 2e-4, 1.5e-4, row.curved, 10),
                           instrument_spec(1, 1e-4, 7.7e-5, row.curved + row.beyond, 15)},
                          {row.outer, row.inner}, 100 << level);
                c.bend_to_rest();
                for (int part = 0; part < 11; ++part) {  // not past a snap
                    REQUIRE(c.equilibrate() >= 0);
                    if (part < 10) c.turn(1, -row.alpha / 10 * pi / 180);
                }
                error[level] = std::max((c.end(0) - row.tip_outer).norm(), (c.end(1) - row.tip_inner).norm());
                angle_error[level] = std::max(std::abs(c.angle_deg(0, row.beyond) - row.outer_angle),
                                              std::abs(c.angle_deg(1, row.beyond) - row.inner_angle));
                torque_error[level] = std::max(std::abs(std::abs(c.hands().torque[1]) / row.torque - 1),
                                               std::abs(std::abs(c.hands().torque[0]) / row.torque - 1));
                CHECK(c.stable());
            }
            CHECK(error[0] < 0.005 * row.inner);
            CHECK(error[2] <
                  error[0] / 8);  // two halvings, second order: 16; where ends lie in their cells differs from grid to grid
            CHECK(angle_error[0] < 2.0);
            CHECK(angle_error[2] < angle_error[0] / 12);
            CHECK(torque_error[0] < 0.03);
            CHECK(torque_error[2] < torque_error[0] / 12);
        }
    }

    // Equal stiffness and curvature, nu = 0.3: lambda^2 = 1.3 kappa^2 = 130/m^2, no snap where pi/(2 lambda) = 137.77 mm is not
    // reached.
    TEST_CASE("analytic: relative angle at the tip lags behind the base")
    {
        for (const auto& row : lag_rows()) {
            Coaxial c({instrument_spec(1, 1e-4, 1e-4 / 1.3, 0.5, 10), instrument_spec(1, 1e-4, 1e-4 / 1.3, 0.5, 10)},
                      {row.overlap, row.overlap}, 100);
            c.bend_to_rest();
            for (int part = 0; part < 11; ++part) {
                REQUIRE(c.equilibrate() >= 0);
                if (part < 10) c.turn(1, -row.base / 10 * pi / 180);
            }
            const double tip = c.angle_deg(1, 0) - c.angle_deg(0, 0);
            // second order: (lambda h)^2 / 12 of an angle of order 100 = 2e-3; the table has three decimals
            CHECK(std::abs(tip - row.tip) < 3e-3);
        }
    }

    TEST_CASE("analytic: no snap below the critical overlap")
    {
        const auto stable_at_pi = [](double overlap) {
            Coaxial c({instrument_spec(1, 1e-4, 1e-4 / 1.3, 0.5, 10), instrument_spec(1, 1e-4, 1e-4 / 1.3, 0.5, 10)},
                      {overlap, overlap}, 60);
            c.roll(1, -pi);  // opposite: straight, and an equilibrium whether stable or not
            return c.stable();
        };
        // cells: relative error (lambda h)^2 / 24 = 3e-5 in the length
        CHECK(stable_at_pi(0.13777 * (1 - 2e-4)));
        CHECK_FALSE(stable_at_pi(0.13777 * (1 + 2e-4)));
    }

    // 15_coaxial/torsion_snap: the branch ends at a base angle of 317.748 deg, the tip being at 71.538 deg, and resumes at
    // 355.671
    TEST_CASE("analytic: snapping")
    {
        Coaxial c({instrument_spec(1, 2e-4, 1.5e-4, 0.15, 10), instrument_spec(1, 1e-4, 7.7e-5, 0.17, 15)}, {0.25, 0.27}, 108);
        c.bend_to_rest();
        double base = 0, tip = 0, tip_before = 0;
        while (base < 330) {
            const double by = base < 300 ? 15 : base < 316 ? 2 : 0.1;
            c.turn(1, -by * pi / 180);
            base += by;
            REQUIRE(c.equilibrate(400) >= 0);
            REQUIRE(c.stable());
            tip_before = tip;
            tip = c.angle_deg(1, 0.02) - c.angle_deg(0, 0.02);
            if (tip > 180) break;
        }
        CHECK(std::abs(base - 317.748) < 0.5);     // steps of 0.1
        CHECK(std::abs(tip_before - 71.538) < 4);  // grows like the square root of the way to the snap
        CHECK(std::abs(tip - 355.671) < 0.5);
    }

    // The straight length behind the sleeve as a compliance there, or as a part of the centreline
    TEST_CASE("equal: twist of what is still behind the inlet")
    {
        Vec3 tips[2];
        double torques[2];
        for (const bool inside : {false, true}) {
            const double straight = inside ? 0.1 : 0.0;
            Coaxial c({instrument_spec(1, 2e-4, 1.5e-4, 0.08, 10), instrument_spec(1, 1e-4, 7.7e-5, 0.1, 15)},
                      {0.08 + straight, 0.1 + straight}, inside ? 200 : 100);
            if (!inside) c.base.behind = {0.1 / 1.5e-4, 0.1 / 7.7e-5};
            c.bend_to_rest();
            for (int part = 0; part < 11; ++part) {
                REQUIRE(c.equilibrate() >= 0);
                if (part < 10) c.turn(1, -0.2);
            }
            tips[inside] = c.end(1) - Vec3(straight, 0, 0);
            torques[inside] = c.hands().torque[1];
        }
        CHECK((tips[0] - tips[1]).norm() < 5e-6);  // h^2 kappa of either
        CHECK(torques[0] == about(torques[1]).epsilon(1e-4));
    }
}

}  // namespace seldinger::test::test_coaxial_cases
