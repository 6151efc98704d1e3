// Instruments inside each other against closed forms: arcs joined, torsion of precurved instruments, snapping [Dupont10;
// Rucker10].

#include "rod/coaxial_fixture.h"

#include <doctest/doctest.h>

namespace test_coaxial_cases {

using namespace seldinger;
using namespace seldinger::test;

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
            double error[3];
            for (int level = 0; level < 3; ++level) {
                Coaxial c({spec_of({{0.06, 2e-4, 20}, {0.3, 2e-4, 0}}, 1e6), spec_of({{0.05, 1e-4, 25}, {0.3, 1e-4, 0}}, 1e6)},
                          {0.1, 0.12}, 100 << level);
                c.roll(1, -row.alpha * pi / 180);
                c.bend_to_rest();
                REQUIRE(c.equilibrate() >= 0);
                error[level] = std::max((c.end(0) - row.tip_outer).norm(), (c.end(1) - row.tip_inner).norm());
            }
            CHECK(error[0] < 0.005 * 0.12);
            CHECK(error[2] <
                  error[0] / 8);  // two halvings, second order: 16; where ends lie in their cells differs from grid to grid
        }
    }

    // Both precurved over a common length at whose near end one is turned: theta'' = lambda^2 sin(theta), theta'(L) = 0
    TEST_CASE("analytic: precurved instruments twist each other")
    {
        struct Row {
            double straight, curved, beyond, alpha, inner_angle, outer_angle, torque;
            Vec3 tip_outer, tip_inner;
        };
        const Row rows[] = {
            {0,
             0.08,
             0.02,
             45,
             33.15125796697199,
             6.082354243621043,
             0.0004319537283905034,
             {0.06984331423871643, 0.03153981748303715, 0.010460505076256316},
             {0.07992091986930637, 0.047625990908486474, 0.016517391638757234}},
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
             135,
             112.33377821868753,
             11.635327181073741,
             0.0007284610980491018,
             {0.07665685655478856, 0.012065733047107051, 0.014998581183893986},
             {0.09292131282034682, 0.016985609785452847, 0.025403928886657247}},
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
             60,
             42.53506468135986,
             8.965333463568607,
             0.00011179626510367827,
             {0.21983424550980776, 0.0020412626778096607, 0.000880565047752952},
             {0.22939273362057958, 0.004603275526039825, 0.0022531668728467476}},
            {0.2,
             0.02,
             0.01,
             120,
             89.81157425999699,
             15.496725213201548,
             0.00019320743788518556,
             {0.21988504090708808, 0.0012742053719569692, 0.0013440251161477602},
             {0.22957458133211825, 0.0025393449437129765, 0.0034236570028520026}},
            {0.2,
             0.02,
             0.01,
             170,
             149.99473041288348,
             10.269371721386479,
             0.00012799362434914022,
             {0.21997588477131716, 0.00044258673263269227, 0.0007244355155327799},
             {0.22990362605793974, 0.00023604732896154805, 0.0018244059647419897}},
            {0.1,
             0.15,
             0.02,
             90,
             36.739988967437405,
             27.34013899671547,
             0.00045659960231060924,
             {0.18652874347092102, 0.08417541927092892, 0.053389376345305516},
             {0.1805800180357956, 0.1002444718026152, 0.06355830952345798}},
            {0.1,
             0.15,
             0.02,
             180,
             74.57018863771856,
             54.12063649930448,
             0.000884880379191394,
             {0.19378737664997853, 0.04046220016803496, 0.08584578402947197},
             {0.1895651489051895, 0.04868534460036973, 0.10349689374151719}},
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
            double error[3] = {}, angle_error[3] = {}, torque_error[3] = {};
            for (int level = 0; level < 3; ++level) {
                const double outer = row.straight + row.curved, inner = outer + row.beyond;
                Coaxial c({instrument_spec(1, 2e-4, 1.5e-4, row.curved, 10),
                           instrument_spec(1, 1e-4, 7.7e-5, row.curved + row.beyond, 15)},
                          {outer, inner}, 100 << level);
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
            CHECK(error[0] < 0.005 * (row.straight + row.curved + row.beyond));
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
        struct Row {
            double overlap, base, tip;
        };
        const Row rows[] = {{0.06, 45, 36.733}, {0.06, 90, 76.851}, {0.06, 150, 142.002},
                            {0.12, 45, 21.973}, {0.12, 90, 47.120}, {0.12, 150, 99.931}};
        for (const Row& row : rows) {
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

}  // namespace test_coaxial_cases
