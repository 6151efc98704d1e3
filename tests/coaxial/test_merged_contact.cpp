// Instruments that share one centreline in a vessel: whose surface touches, what each hand feels of it.

#include "coaxial/bend_fixture.h"
#include "coaxial/merged_fixture.h"
#include "support/refusal.h"
#include "support/steps.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_merged_contact {

namespace {

/// With a catheter that slides more easily. @param youngs  of the wall, 0: rigid [Pa]
WorldSetup slippery_in_a_bend(double catheter, double wire, double youngs = 0)
{
    WorldSetup setup = in_a_bend(catheter, wire, 2e-3, youngs);
    setup.wires[0].wire.shaft.mu_sliding = 0.1;
    setup.wires[0].wire.shaft.mu_static = 0.12;
    return setup;
}

}  // namespace

TEST_SUITE("coaxial/merged contact")
{
    // What the ledger misses is what contact has stored in points of the wire that the catheter passes over, which are let go.
    // The sum of both hands is the force at the inlet but for the energy per length there, (1/2) B kappa^2 of a straight lead-in.
    TEST_CASE("property: pushed round a bend one after the other and back, with energy and momentum closed")
    {
        const Place start{0.01, 0.02}, wire_out{0.01, 0.1}, over_it{0.07, 0.1}, ahead{0.1, 0.08}, back{0.03, 0.02};
        World world(slippery_in_a_bend(start.catheter, start.wire));
        Place at = start;
        for (const Place& next : {wire_out, over_it, ahead, back}) {
            CAPTURE(next.catheter);
            go(world, at, next, 800);
            at = next;
            const WireReadings outer = world.readings(0), inner = world.readings(1);
            CHECK(std::abs(outer.energy.open()) < 0.004 * turned_over(outer.energy));
            CHECK(outer.outside == 0);
            CHECK(inner.outside == 0);
            CHECK(outer.momentum.error().norm() < 1e-6);
            const double hands = outer.hand_force + inner.hand_force;
            CHECK(std::abs(hands - outer.base_force.x()) < 0.05 * std::abs(hands) + 2e-5);
            for (const int w : {0, 1})
                CHECK(world.rod(w).material_s[world.rod(w).n - 1] == about(w == 0 ? at.catheter : at.wire).epsilon(1e-3));
        }
    }

    // Forces on the wire's surface act on the line, whose residual cannot be smaller than their rounding. Where that is not known
    // 20 of these 800 steps are divided, and they take 6,390 iterations in all. With it the tolerance is the wider one.
    TEST_CASE(
        "property: contact in float32 costs no iterations and divides no step, and the line is within 0.1 um of that in double")
    {
        const Place start{0.01, 0.02}, wire_out{0.01, 0.1};
        long iterations[2] = {0, 0};
        Vec3 tip[2];
        for (const Precision precision : {Precision::Float64, Precision::Float32}) {
            WorldSetup setup = slippery_in_a_bend(start.catheter, start.wire);
            for (WireSetup& wire : setup.wires) wire.contact.precision = precision;
            World world(setup);
            const bool single = precision == Precision::Float32;
            for (int k = 1; k <= 800; ++k) {
                Control control;
                control.move_to(0, start.catheter, 0);
                control.move_to(1, start.wire + k / 800.0 * (wire_out.wire - start.wire), 0);
                const StepReport report = step(world, control, 1e-3);
                CHECK(report.flags == StepOk);
                iterations[single] += report.newton_iterations;
            }
            REQUIRE(world.readings(1).normal > 0);
            tip[single] = world.rod(1).pos(0);
        }
        MESSAGE("iterations " << iterations[0] << ", in float32 " << iterations[1] << "; tips " << (tip[0] - tip[1]).norm()
                              << " m apart");
        CHECK(iterations[1] <= iterations[0]);
        CHECK((tip[0] - tip[1]).norm() < 1e-7);  // a hundred times what a gap is off by, as the wire is softer than its contacts
    }

    // Wire and catheter push one wall: the passenger's contact acts through the line's unknowns.
    TEST_CASE("property: beside an elastic wall, with energy closed, nothing outside, and the rigid wall as its limit")
    {
        const Place start{0.01, 0.02}, wire_out{0.01, 0.09}, over_it{0.07, 0.1};
        const auto end_of = [&](double youngs) {
            World world(slippery_in_a_bend(start.catheter, start.wire, youngs));
            go(world, start, wire_out, 800);
            go(world, wire_out, over_it, 800);
            const WireReadings outer = world.readings(0), inner = world.readings(1);
            CAPTURE(youngs);
            CHECK(std::abs(outer.energy.open()) < 0.004 * turned_over(outer.energy));
            CHECK(outer.outside == 0);
            CHECK(inner.outside == 0);
            CHECK(outer.momentum.error().norm() < 1e-6);
            if (youngs > 0) {
                const Output now = world.output(Output::WallShape);
                CHECK(now.walls[0].readings.move_max > 0);
                CHECK(outer.energy.wall > 0);
                CHECK(inner.normal > 0);
                CHECK(outer.normal > 0);
            }
            return std::pair(world.rod(0).pos(0), outer.energy.wall);
        };
        const auto [rigid, none] = end_of(0);
        CHECK(none == 0);
        const auto [soft, soft_work] = end_of(0.4e6);
        const auto [hard, hard_work] = end_of(40e6);
        // what the wall takes and how far the tip is from the rigid run's go like 1/E; k_s, which stays, and the way there bend
        // that
        CHECK(hard_work < 0.1 * soft_work);
        CHECK((hard - rigid).norm() < 0.3 * (soft - rigid).norm());
    }

    // A catheter that comes down to a plane at a slope, by so much further than it: a cantilever of 3 B d/L^3, though a thread
    // goes on from its tip. The wall itself gives by 3 % of d. Where the polyline turns before the tip, the force on the half
    // edge between is along the thread, not the catheter: hands share it by up to the angle between both, 0.05.
    TEST_CASE("analytic: the tip of a catheter presses on a wall as a cantilever's does, though a thread goes on from there")
    {
        const double stiffness = 1e-3, slope = 0.05, pressed = 1e-3, radius = 0.9e-3;
        for (int k = 0; k < 8; ++k) {
            const double length = 0.05 + 2.5e-4 * k;
            CAPTURE(k);
            TestSetup made;
            made.gravity = Vec3::Zero();
            add_plane(made, 0.2, 800);
            WireSpec outer = steel_wire(0.3, 151), inner = steel_wire(0.3, 151);
            outer.shaft.radius = radius;
            outer.shaft.bend_stiffness = outer.shaft.twist_stiffness = stiffness;
            inner.shaft.bend_stiffness = inner.shaft.twist_stiffness = 1e-8;
            for (WireSpec* spec : {&outer, &inner}) {
                spec->shaft.mu_static = spec->shaft.mu_sliding = 0;
                made.wires.push_back(fed_wire(*spec, {0, 0, radius + length * slope - pressed}, 0));
                made.wires.back().feed.direction = Vec3(1, 0, -slope).normalized();
                made.wires.back().feed.keys = {{0, spec == &outer ? 0.02 : 0.03, 0}};
            }
            made.systems = {2};
            made.integrator.damping_mass = 200;
            WorldSetup setup = made;
            setup.coaxial.push_back({.order = {0, 1}, .model = CoaxialSpec::Model::Merged});
            World world(setup);
            go(world, {0.02, 0.03}, {length, 0.06}, 300);
            go(world, {length, 0.06}, {length, 0.06}, 100);
            Vec3 force = Vec3::Zero();
            for (const Vec3& f : world.nodal_contact_force(0)) force += f;
            const double cantilever = 3 * stiffness * pressed / std::pow(length, 3);
            CHECK(force.z() == about(cantilever).epsilon(0.03));
            CHECK(-world.readings(0).base_force.z() == about(force.z()).epsilon(1e-3));
            const double along = slope * force.z() -
                                 std::pow(force.z() * length, 2) / (2 * stiffness);  // at the inlet, less (1/2) B kappa^2 there
            CHECK(world.readings(0).hand_force + world.readings(1).hand_force == about(along).scale(cantilever).epsilon(5e-3));
            CHECK(std::abs(world.readings(1).hand_force) < 0.06 * cantilever);
        }
    }

    // The wire slides out of a catheter that stands still: all of its friction is in its own hand.
    TEST_CASE("property: friction is felt by the hand of the instrument that it acts on")
    {
        World world(slippery_in_a_bend(0.01, 0.02));
        go(world, {0.01, 0.02}, {0.03, 0.04}, 200);
        go(world, {0.03, 0.04}, {0.03, 0.1}, 600);
        const WireReadings wire = world.readings(1);
        REQUIRE(wire.friction > 1e-3);
        CHECK(wire.sliding == about(wire.friction).epsilon(1e-6));
        CHECK(world.readings(0).friction < 0.02 * wire.friction);
        WorldSetup smooth = slippery_in_a_bend(0.01, 0.02);
        smooth.wires[1].wire.shaft.mu_sliding = smooth.wires[1].wire.shaft.mu_static = 0;
        World slippery(smooth);
        go(slippery, {0.01, 0.02}, {0.03, 0.04}, 200);
        go(slippery, {0.03, 0.04}, {0.03, 0.1}, 600);
        // friction presses the wire against the bend a little more, exp(mu phi) - 1 instead of mu phi, and changes the shape that
        // the catheter would be pushed into
        const double more = wire.hand_force - slippery.readings(1).hand_force;
        CHECK(more == about(wire.friction).epsilon(0.15));
        CHECK(std::abs(world.readings(0).hand_force - slippery.readings(0).hand_force) < 0.2 * wire.friction);
    }

    TEST_CASE("property: a run in a vessel, rigid or elastic, that is taken up again ends with the same bits")
    {
        for (const double youngs : {0.0, 0.4e6}) {
            CAPTURE(youngs);
            const auto on = [](World& world, int from, int to) {
                if (from == 0) go(world, {0.01, 0.02}, {0.05, 0.09}, 350);
                if (to == 550) go(world, {0.05, 0.09}, {0.09, 0.07}, 200);
            };
            const TakenUp runs(slippery_in_a_bend(0.01, 0.02, youngs), on, 350, 550);
            CHECK(runs.second.contacts().size() == runs.whole.contacts().size());
            CHECK(runs.second.readings(0).energy.hand == runs.whole.readings(0).energy.hand);
            CHECK(runs.second.readings(0).energy.wall == runs.whole.readings(0).energy.wall);
        }
    }

    TEST_CASE("bad input: what cannot share a centreline is named")
    {
        const auto message = [](const WorldSetup& setup) { return refusal([&] { World world(setup); }); };
        WorldSetup setup = slippery_in_a_bend(0.02, 0.05);
        CHECK(message(setup).empty());
        setup.coaxial[0].order = {0};
        CHECK(has(message(setup), "coaxial[0].order: got fewer than two instruments"));
        setup.coaxial[0].order = {0, 2};
        CHECK(has(message(setup), "got instrument 2; expected 0 to 1"));
        setup = slippery_in_a_bend(0.02, 0.05);
        setup.systems = {1, 1};
        CHECK(has(message(setup), "got instruments of different systems"));
        setup = slippery_in_a_bend(0.02, 0.05);
        setup.integrator.newmark = true;
        CHECK(message(setup).empty());
        setup.integrator.newmark = false;
        setup.integrator.conserve = true;
        CHECK(has(message(setup), "integrator: "));
        setup = slippery_in_a_bend(0.02, 0.05);
        setup.wires[1].feed.point.x() += 1e-3;
        CHECK(has(message(setup), "wires[1].feed: got another inlet"));
        setup = slippery_in_a_bend(0.02, 0.05);
        setup.coaxial.clear();
        setup.wires[1].feed.behind = 0.1;
        CHECK(has(message(setup), "wires[1].feed.behind"));
    }
}

}  // namespace seldinger::test::test_merged_contact
