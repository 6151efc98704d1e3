// Friction between instruments that share one centreline by what presses in the lumen: against a rod each, Euler's rope, a lever.
// The force that presses: tests/rod/test_lumen_press.cpp.

#include "coaxial/friction_fixture.h"
#include "support/steps.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace seldinger::test::test_merged_lumen {

namespace {

/// Friction by the pressing force, of instruments that come to rest soon.
void rub_on_lumen(WorldSetup& setup, double mu)
{
    setup.integrator.damping_mass = 100;
    setup.coaxial[0].lumen_friction = true;
    setup.coaxial[0].mu_static = setup.coaxial[0].mu_sliding = mu;
}

/// At the inner one's. @param ramp  time in which it comes on [s]
void pull_at_tip(WorldSetup& setup, const Vec3& force, double ramp)
{
    setup.wires[1].loads.push_back({.at = {WirePoint::Kind::Tip}, .force = force, .ramp = ramp});
}

/// A wire as soft as a rope in a catheter's lumen, that far inside and 1 cm farther, pulled at its tip.
WorldSetup rope_in(const WireSpec& catheter, double inside, double mu, const Vec3& pull)
{
    WorldSetup setup =
        merged_setup({catheter, instrument_of({{0.5, 1e-8, 0}}, 1)}, {inside, inside + 0.01}, 1e-3, Scheme::Newton);
    setup.wires[0].wire.lumen_radius = 0.49e-3;
    WireSpec& wire = setup.wires[1].wire;
    wire.shaft.radius = 0.4e-3;
    wire.shaft.stretch_stiffness = 2e4;
    for (WireSectionRange& range : wire.sections) range.section = wire.shaft;
    setup.integrator.tolerance = 1e-6;
    rub_on_lumen(setup, mu);
    pull_at_tip(setup, pull, 0.05);
    return setup;
}

/// What the hands feel when the rope is drawn by 1 cm, at rest before.
WireReadings draw_rope(World& world)
{
    (void)move(world, 1, 0, 0, 200, 1e-3);
    return move(world, 1, -0.01, 0, 200, 1e-3);
}

}  // namespace

TEST_SUITE("coaxial/merged lumen")
{
    // A curved catheter over a straight wire at a clearance of 0.1 mm, the wire pushed: what presses is what straightens the one
    // and bends the other. `separate` finds that by contact. Friction is the part of a hand force that is not there without it.
    // The rest bends both as a change of stiffness comes in: at that change in a merged line, else spread over the length that
    // the clearance allows. Seen were 3 %, and 12 where friction changes fast.
    TEST_CASE("independent: friction of what presses in the lumen is that of a rod each")
    {
        const auto setup_of = [](CoaxialSpec::Model model, bool friction) {
            WorldSetup setup = merged_setup({instrument_of({{0.005, 3e-4, 0}, {0.012, 3e-4, 65}, {0.383, 3e-4, 0}}, 1),
                                             instrument_of({{0.05, 2e-5, 0}, {0.55, 2.9e-4, 0}}, 0.77)},
                                            {0.06, 0.05}, 1e-3, Scheme::Newton);
            const double radii[2] = {0.833e-3, 0.4445e-3};
            for (std::size_t w = 0; w < 2; ++w) {
                WireSpec& wire = setup.wires[w].wire;
                wire.shaft.radius = radii[w];
                for (WireSectionRange& range : wire.sections) range.section.radius = radii[w];
            }
            setup.wires[0].wire.lumen_radius = 0.55e-3;
            setup.integrator.damping_mass = 20;
            setup.integrator.tolerance = 1e-6;
            setup.coaxial[0].model = model;
            setup.coaxial[0].lumen_friction = friction;
            if (!friction) setup.coaxial[0].mu_static = setup.coaxial[0].mu_sliding = 0;
            return setup;
        };
        const auto hand_forces = [&](CoaxialSpec::Model model, bool friction) {
            World world(setup_of(model, friction));
            std::vector<double> means;  // over 4 mm each
            double sum = 0;
            for (int k = 1; k <= 800; ++k) {  // its soft part goes through the bend, then its shaft comes into it
                step_to(world, 4e-3, {{0.06}, {0.05 + 8e-5 * k}});
                sum += world.readings(1).hand_force / 50;
                if (k % 50 == 0) means.push_back(std::exchange(sum, 0));
            }
            return means;
        };
        using enum CoaxialSpec::Model;
        const std::vector<double> with = hand_forces(Merged, true), without = hand_forces(Merged, false);
        const std::vector<double> contact = hand_forces(Separate, true), smooth = hand_forces(Separate, false);
        double least = 1, most = 0;
        for (std::size_t k = 0; k < with.size(); ++k) {
            const double predicted = with[k] - without[k], found = contact[k] - smooth[k];
            CAPTURE(k);
            CHECK(predicted == about(found).epsilon(0.15));
            least = std::min(least, found), most = std::max(most, found);
        }
        CHECK(most > 6 * least);  // it has been through a wide range: 23 to 247 mN
        CHECK(with.back() == about(contact.back()).epsilon(0.05));
    }

    // Euler's T e^(mu phi). The wire is soft: its bending force is less than 0.1 % of that. In the clearance it goes round on
    // the inside, c/R shorter. The tension is a step behind, which is at rest by then.
    TEST_CASE("analytic: a soft wire drawn through a curved catheter, with a weight at its tip")
    {
        const double pull = 0.4, radius_of_bend = 0.04;
        for (const double mu : {0.05, 0.2}) {
            const double quarter = 0.5 * pi * radius_of_bend;  // turn to +z, the way the wire leaves
            World world(
                rope_in(instrument_of({{quarter, 1e-2, 1 / radius_of_bend}, {0.3, 1e-2, 0}}, 1), quarter, mu, {0, 0, pull}));
            const WireReadings drawn = draw_rope(world);
            CHECK(-drawn.hand_force == about(pull * std::exp(0.5 * pi * mu)).epsilon(0.01));
            CHECK(world.readings(0).hand_force == about(pull * (std::exp(0.5 * pi * mu) - 1)).epsilon(0.05));
        }
    }

    // The same over a catheter that a force F near its tip bends: its curvature F s/B grows along one and the same stretch, and
    // the rope turns by it where it is, not where the stretch has its middle. At the mouth it is pulled on a little farther
    // round.
    TEST_CASE("analytic: a soft wire drawn through a catheter whose curvature grows towards its hub")
    {
        const double pull = 0.4, length = 0.06, before = 0.01, stiffness = 1e-2, turned = 0.45, mu = 0.5;
        WorldSetup setup =
            rope_in(instrument_of({{0.3, stiffness, 0}}, 1), length, mu, pull * Vec3(std::cos(turned), 0, std::sin(turned)));
        setup.wires[0].loads.push_back({.at = {WirePoint::Kind::Distance, before},
                                        .force = {0, 0, 2 * stiffness * 0.4 / ((length - before) * (length - before))},
                                        .ramp = 0.05});
        World world(setup);
        const WireReadings drawn = draw_rope(world);
        const ConstRodView line = world.rod(1);
        const auto direction = [&](int edge) { return Vec3(line.pos(edge) - line.pos(edge + 1)).normalized(); };
        const double bent = std::asin(direction(12).z());  // beside the mouth
        MESSAGE("bent by " << bent << ", drawn with " << -drawn.hand_force);
        CHECK(bent > 0.3);
        CHECK(bent < turned);
        CHECK(std::log(-drawn.hand_force / pull) / mu == about(turned).epsilon(0.05));
    }

    // A force F across the tip, `a` beyond the mouth of a stiff catheter: the rim takes F + M/l and the lumen M/l, M = F a, l^2 =
    // 12 B c/M. The lumen gives by as much as in rod/test_lumen_press, 2 %, and at the hub, eight times as far on, they are held
    // in each other's middle: 1 %.
    TEST_CASE("analytic: a force beyond the mouth is levered against the lumen")
    {
        const double beyond = 0.04, across = 5e-3, stiffness = 1e-4, room = 1e-4, mu = 0.2;
        const auto hand = [&](bool friction) {
            WorldSetup setup = merged_setup({instrument_of({{0.3, 1.0, 0}}, 1), instrument_of({{0.5, stiffness, 0}}, 1)},
                                            {0.2, 0.2 + beyond}, 1e-3, Scheme::Newton);
            setup.wires[0].wire.lumen_radius = radius + room;
            for (WireSectionRange& range : setup.wires[0].wire.sections) range.section.radius = 2 * radius;
            setup.wires[0].wire.shaft.radius = 2 * radius;
            setup.integrator.tolerance = 1e-7;
            rub_on_lumen(setup, mu);
            setup.coaxial[0].lumen_friction = friction;
            pull_at_tip(setup, {0, 0, across}, 0.1);
            World world(setup);
            (void)move(world, 1, 0, 0, 300, 2e-3);
            return move(world, 1, -1e-3, 0, 100, 1e-3).hand_force;
        };
        const double moment = across * (beyond - 1e-4), lever = std::sqrt(12 * stiffness * room / moment);
        CHECK(hand(false) - hand(true) == about(mu * (across + 2 * moment / lever)).epsilon(0.05));
    }

    TEST_CASE("property: what presses is of the saved state, and needs room in the lumen")
    {
        WorldSetup setup = straight_pair(0.05, 0.06, 0, 0);
        setup.coaxial[0].lumen_friction = true;
        CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains("wires[0].wire.lumen_radius"), Error);
        setup.wires[0].wire.lumen_radius = 0.6e-3;
        setup.wires[0].wire.sections.push_back({0, 0.02, section_of(bend, twist, 20)});
        const auto ways = [](World& world, int from, int to) {
            for (int k = from; k <= to; ++k) {
                step_to(world, 1e-3, {{0.05}, {0.06 - 0.02 * (1 - std::cos(0.02 * k)), 2e-3 * k}});
            }
        };
        World whole(setup), first(setup), second(setup);
        ways(whole, 1, 300);
        ways(first, 1, 60);
        second.restore_state(first.save_state());
        CHECK(second.state_hash() == first.state_hash());
        ways(first, 61, 61);  // later on what was there is forgotten
        ways(second, 61, 61);
        CHECK(second.state_hash() == first.state_hash());
        CHECK(std::abs(first.readings(1).hand_force) > 1e-3);
        CHECK(second.readings(1).hand_force == first.readings(1).hand_force);
        ways(second, 62, 300);
        CHECK(second.state_hash() == whole.state_hash());
        CHECK(std::abs(whole.readings(1).hand_force) > 1e-3);
        const EnergyLedger& ledger = whole.readings(0).energy;
        CHECK(ledger.friction > 1e-5);
        CHECK(std::abs(ledger.open()) < 0.01 * ledger.friction);
    }
}

}  // namespace seldinger::test::test_merged_lumen
