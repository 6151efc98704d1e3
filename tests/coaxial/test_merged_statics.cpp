// Worlds of instruments that share one centreline at rest: arcs joined, torsion, snapping [Dupont10; Rucker10].

#include "coaxial/merged_fixture.h"
#include "coaxial/references.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_merged_statics {

namespace {

constexpr double tip_tolerance = 0.005;  // of the length; that of the references, for 100 edges

}  // namespace

TEST_SUITE("coaxial/merged statics")
{
    // A curved wire in a curved catheter, pushed out of it.
    TEST_CASE("analytic: sections that overlap in a plane (15_coaxial/j_wire_in_catheter)")
    {
        for (const auto& row : coaxial_rows("j_wire_in_catheter")) {
            CAPTURE(row.inner);
            World world(merged_setup({instrument_of({{0.04, 2e-4, 20}, {0.3, 2e-4, 0}}, 0.77),
                                      instrument_of({{0.0075, 1e-5, 1000.0 / 3}, {0.03, 1e-5, 0}, {0.6, 1.5e-4, 0}}, 0.77)},
                                     {row.outer, row.inner}, row.inner / 100));
            REQUIRE_FALSE(settle(world).failed());
            CHECK((world.rod(0).pos(0) - from_reference(row.tip_outer)).norm() < tip_tolerance * row.inner);
            CHECK((world.rod(1).pos(0) - from_reference(row.tip_inner)).norm() < tip_tolerance * row.inner);
            CHECK(world.readings(0).inserted == 0);
        }
    }

    TEST_CASE("analytic: turned against each other, hardly twisting (15_coaxial/rotated_rigid)")
    {
        for (const auto& row : coaxial_rows("rotated_rigid")) {
            CAPTURE(row.alpha);
            World world(merged_setup(
                {instrument_of({{0.06, 2e-4, 20}, {0.3, 2e-4, 0}}, 1e4), instrument_of({{0.05, 1e-4, 25}, {0.3, 1e-4, 0}}, 1e4)},
                {row.outer, row.inner}, row.inner / 100));
            turn_slowly(world, 1, row.inner, 0, row.alpha * pi / 180, 10);
            CHECK((world.rod(0).pos(0) - from_reference(row.tip_outer)).norm() < tip_tolerance * row.inner);
            CHECK((world.rod(1).pos(0) - from_reference(row.tip_inner)).norm() < tip_tolerance * row.inner);
        }
    }

    // Equal stiffness and curvature, nu = 0.3: no snap where the overlap is below 137.77 mm.
    TEST_CASE("analytic: relative angle at the tip lags behind the base")
    {
        for (const auto& row : lag_rows()) {
            CAPTURE(row.overlap);
            CAPTURE(row.base);
            const WireSpec spec = instrument_of(1, 1e-4, 1e-4 / 1.3, 0.5, 10);
            World world(merged_setup({spec, spec}, {row.overlap, row.overlap}, row.overlap / 100));
            turn_slowly(world, 1, row.overlap, 0, row.base * pi / 180, 10);
            const double tip = angle_deg(world, 1, 0) - angle_deg(world, 0, 0);
            CHECK(std::abs(tip - row.tip) < 0.05);  // linear beyond the middle of the tip's edge, where twist goes to 0
            // the hands at both hold each other's torque
            CHECK(world.readings(0).hand_torque == about(-world.readings(1).hand_torque).epsilon(1e-3));
        }
    }

    TEST_CASE("analytic: torsion of instruments that are straight, then curved, then one alone (15_coaxial/torsion_*)")
    {
        for (const auto& row : torsion_rows()) {
            CAPTURE(row.alpha);
            World world(merged_setup(
                {instrument_of(1, 2e-4, 1.5e-4, row.curved, 10), instrument_of(1, 1e-4, 7.7e-5, row.curved + row.beyond, 15)},
                {row.outer, row.inner}, row.inner / 100));
            turn_slowly(world, 1, row.inner, 0, row.alpha * pi / 180, 12);
            CHECK((world.rod(0).pos(0) - from_reference(row.tip_outer)).norm() < tip_tolerance * row.inner);
            CHECK((world.rod(1).pos(0) - from_reference(row.tip_inner)).norm() < tip_tolerance * row.inner);
            CHECK(std::abs(angle_deg(world, 0, 0) - row.outer_angle) < 2);
            CHECK(std::abs(angle_deg(world, 1, row.beyond) - row.inner_angle) < 2);
            CHECK(world.readings(1).hand_torque == about(row.torque).epsilon(0.03));
            CHECK(world.readings(0).hand_torque == about(-row.torque).epsilon(0.03));
        }
    }

    // 15_coaxial/torsion_snap: the branch ends at a base angle of 317.748 deg, the tip being at 71.538, and resumes at 355.671.
    TEST_CASE("analytic: snapping")
    {
        World world(merged_setup({instrument_of(1, 2e-4, 1.5e-4, 0.15, 10), instrument_of(1, 1e-4, 7.7e-5, 0.17, 15)},
                                 {0.25, 0.27}, 0.27 / 100));
        double base = 0, tip = 0;
        while (base < 330) {
            const double by = base < 300 ? 10 : 1;
            turn_slowly(world, 1, 0.27, base * pi / 180, (base + by) * pi / 180, 1);
            base += by;
            tip = angle_deg(world, 1, 0.02) - angle_deg(world, 0, 0);
            if (tip > 180) break;
        }
        CHECK(std::abs(base - 317.748) < 3);  // steps of 1; the reference allows 6
        CHECK(std::abs(tip - 355.671) < 2);
    }
}

}  // namespace seldinger::test::test_merged_statics
