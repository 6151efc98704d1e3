// Worlds of instruments that share one centreline at rest: arcs joined, torsion, snapping [Dupont10; Rucker10].

#include "coaxial/merged_fixture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace test_merged_statics {

using namespace seldinger;
using namespace seldinger::test;

namespace {

constexpr double tip_tolerance = 0.005;  // of the length; that of the references, for 100 edges

}  // namespace

TEST_SUITE("coaxial/merged statics")
{
    // A curved wire in a curved catheter, pushed out of it.
    TEST_CASE("analytic: sections that overlap in a plane (15_coaxial/j_wire_in_catheter)")
    {
        struct Row {
            double outer, inner;
            Vec3 tip_outer, tip_inner;
        };
        const Row rows[] = {
            {0.1, 0.1, {0.09621168993018896, 0.014176709896914294, 0}, {0.09621168993018896, 0.014176709896914294, 0}},
            {0.1, 0.115, {0.09782289276596488, 0.010732083034532684, 0}, {0.10216449823224984, 0.020568357407467163, 0}},
            {0.1, 0.16, {0.09862128798709376, 0.00898473960930927, 0}, {0.14495650284832226, 0.03779857611603603, 0}},
        };
        for (const Row& row : rows) {
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
        struct Row {
            double alpha;
            Vec3 tip_outer, tip_inner;
        };
        const Row rows[] = {
            {60,
             {0.09239162699215095, 0.024045591643508526, 0.003161249008032451},
             {0.10091269229669304, 0.040047798487904906, 0.01110206912535595}},
            {120,
             {0.0946874816792131, 0.021126662982649473, 0.0032145778063288034},
             {0.11001329728464321, 0.030521426164629856, 0.011496703302460097}},
            {180, {0.09586015299755052, 0.019627719838459484, 0}, {0.11476847538394974, 0.025476749371877903, 0}},
        };
        for (const Row& row : rows) {
            CAPTURE(row.alpha);
            World world(merged_setup(
                {instrument_of({{0.06, 2e-4, 20}, {0.3, 2e-4, 0}}, 1e4), instrument_of({{0.05, 1e-4, 25}, {0.3, 1e-4, 0}}, 1e4)},
                {0.1, 0.12}, 0.12 / 100));
            turn_slowly(world, 1, 0.12, 0, row.alpha * pi / 180, 10);
            CHECK((world.rod(0).pos(0) - from_reference(row.tip_outer)).norm() < tip_tolerance * 0.12);
            CHECK((world.rod(1).pos(0) - from_reference(row.tip_inner)).norm() < tip_tolerance * 0.12);
        }
    }

    // Equal stiffness and curvature, nu = 0.3: no snap where the overlap is below 137.77 mm.
    TEST_CASE("analytic: relative angle at the tip lags behind the base")
    {
        struct Row {
            double overlap, base, tip;
        };
        const Row rows[] = {{0.06, 45, 36.733}, {0.06, 90, 76.851}, {0.06, 150, 142.002},
                            {0.12, 45, 21.973}, {0.12, 90, 47.120}, {0.12, 150, 99.931}};
        for (const Row& row : rows) {
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
        struct Row {
            double straight, curved, beyond, alpha, inner_angle, outer_angle, torque;
            Vec3 tip_outer, tip_inner;
        };
        const Row rows[] = {
            {0,
             0.08,
             0.02,
             90,
             68.87043915863089,
             10.846507898569481,
             0.0007340957348015298,
             {0.07260178099253375, 0.02300356307014125, 0.016819416415031825},
             {0.08496634777930241, 0.03465098604830921, 0.027234022105766864}},
            {0,
             0.08,
             0.02,
             170,
             161.76297129765857,
             4.2283414005352675,
             0.00024852896312209464,
             {0.07952351170064209, 0.005782914025607672, 0.00460727417567894},
             {0.09913385903973747, 0.005856513148280653, 0.008134007219070155}},
            {0.2,
             0.02,
             0.01,
             120,
             89.81157425999699,
             15.496725213201548,
             0.00019320743788518556,
             {0.21988504090708808, 0.0012742053719569692, 0.0013440251161477602},
             {0.22957458133211825, 0.0025393449437129765, 0.0034236570028520026}},
            {0.1,
             0.15,
             0.02,
             220,
             92.30487896452294,
             65.55016213154491,
             0.0010533528002372376,
             {0.1993174752630895, 0.017168922951259793, 0.0891589568896044},
             {0.19651398907674533, 0.020657435164440466, 0.10857492282725312}},
        };
        for (const Row& row : rows) {
            CAPTURE(row.alpha);
            const double outer = row.straight + row.curved, inner = outer + row.beyond;
            World world(merged_setup(
                {instrument_of(1, 2e-4, 1.5e-4, row.curved, 10), instrument_of(1, 1e-4, 7.7e-5, row.curved + row.beyond, 15)},
                {outer, inner}, inner / 100));
            turn_slowly(world, 1, inner, 0, row.alpha * pi / 180, 12);
            CHECK((world.rod(0).pos(0) - from_reference(row.tip_outer)).norm() < tip_tolerance * inner);
            CHECK((world.rod(1).pos(0) - from_reference(row.tip_inner)).norm() < tip_tolerance * inner);
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

}  // namespace test_merged_statics
