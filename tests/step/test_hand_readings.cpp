// Input and readings of the hand at a wire's base. Feed and hold have one sense of rotation, right-handed about the direction
// of insertion. Forces are along the wire's tangent at its base, to second order in the edge length.

#include "support/world_fixture.h"

#include <algorithm>
#include <array>

namespace seldinger::test::test_hand_readings {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double length = 0.1;
constexpr int nodes = 41;

HoldSpec hold(WirePoint::Kind at, bool position, bool direction, bool spin)
{
    return {.at = {at}, .position = position, .direction = direction, .spin = spin};
}

LoadSpec load(const WirePoint& at, const Vec3& force) { return {.at = at, .force = force}; }

/// A wire along +x whose last 3 cm are bent by nature, in air that slows it down.
TestSetup bent_tip()
{
    TestSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.damping_mass = 100;
    WireSpec spec = steel_wire(length, nodes);
    WireSection tip = spec.shaft;
    tip.rest_curvature = {30, 0};
    spec.sections.push_back({0, 0.03, tip});
    setup.wires = {placed_wire(spec, Vec3::Zero())};
    return setup;
}

TestSetup turned_by_hold(double rate, double from)
{
    TestSetup setup = bent_tip();
    setup.wires[0].holds = {hold(WirePoint::Kind::Base, true, true, true)};
    setup.wires[0].holds[0].turn = {{from, 0}, {from + 10, 10 * rate}};
    return setup;
}

TestSetup turned_by_feed(double rate, double from)
{
    TestSetup setup = bent_tip();
    TestFeed& feed = setup.wires[0].feed;
    feed.on = true;
    feed.keys = {{0, length, 0}, {from, length, 0}, {from + 10, length, 10 * rate}};
    return setup;
}

/// Angle of the tip about +x, right-handed, from +z [rad].
double tip_angle(const World& world)
{
    const Vec3 tip = world.rod(0).pos(0);
    return std::atan2(-tip.y(), tip.z());
}

/// A quarter of a circle about (0, 0, R), stress-free as placed, at rest under a load.
FedWorld loaded_arc(int edges, const std::vector<HoldSpec>& holds, const LoadSpec& pressed)
{
    TestSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.scheme = Scheme::Static;
    setup.integrator.tolerance = 1e-9;
    TestWire wire = placed_wire(steel_wire(length, edges + 1), Vec3::Zero());
    wire.wire.place.shape = PlaceShape::Arc;
    wire.wire.place.bend_radius = length / (pi / 2);
    wire.wire.place.rest_is_placed = true;
    wire.holds = holds;
    wire.loads = {pressed};
    setup.wires = {wire};
    FedWorld world(std::move(setup));
    REQUIRE_FALSE(settle(world).failed());
    return world;
}

/// Both ends pinned, pressed in its middle.
FedWorld pinned_arch(int edges, const Vec3& force)
{
    return loaded_arc(edges, {hold(WirePoint::Kind::Base, true, false, false), hold(WirePoint::Kind::Tip, true, false, false)},
                      load({WirePoint::Kind::Distance, length / 2}, force));
}

}  // namespace

TEST_SUITE("step/hand_readings")
{
    TEST_CASE("property: a bent tip turned by the feed and by a hold lies in the same place and asks for the same torque")
    {
        const double rate = 2, from = 0.1;  // [rad/s], the tip has curled up before [s]
        for (const double sign : {1.0, -1.0}) {
            CAPTURE(sign);
            FedWorld held(turned_by_hold(sign * rate, from)), fed(turned_by_feed(sign * rate, from));
            const double scale = length * 1e-6;  // a millionth: what the solver's tolerance (1e-6) leaves of a shape
            double apart = 0;
            for (int k = 0; k < 400; ++k) {
                REQUIRE_FALSE(step(held, 1e-3).failed());
                REQUIRE_FALSE(step(fed, 1e-3).failed());
                REQUIRE(held.rod(0).n == fed.rod(0).n);
                for (int i = 0; i < held.rod(0).n; ++i) apart = std::max(apart, (held.rod(0).pos(i) - fed.rod(0).pos(i)).norm());
            }
            MESSAGE("turned " << fed.readings(0).turned << " rad: tips at " << tip_angle(held) << " and " << tip_angle(fed)
                              << " rad, torques " << held.readings(0).hand_torque << " and " << fed.readings(0).hand_torque
                              << " N m, nodes within " << apart << " m");
            CHECK(apart <= scale);
            CHECK(fed.readings(0).turned == about(sign * 0.3 * rate));
            for (const World* world : {&held, &fed}) {
                // the tip follows, behind the hand, since the air holds it back
                CHECK(sign * tip_angle(*world) > 0.5 * 0.3 * rate);
                CHECK(sign * tip_angle(*world) < 0.3 * rate);
                CHECK(sign * world->readings(0).hand_torque > 0);  // what turns a wire against a drag does work on it
                for (int j = 0; j + 1 < nodes; ++j) CHECK(-sign * world->rod(0).theta[j] > 0);
            }
            CHECK(held.readings(0).hand_torque == about(fed.readings(0).hand_torque).epsilon(1e-3));
        }
    }

    // E = C angle^2 / 2L, all of it work of the hand. Torque d(angle) by the trapezoid is exact for a torque that is linear in
    // the angle. The ramp's own oscillation is left out by equilibria
    TEST_CASE("analytic: the torque of a hold times the angle it turns is the energy that a twisted wire holds")
    {
        for (const WirePoint::Kind turned : {WirePoint::Kind::Base, WirePoint::Kind::Tip}) {
            TestSetup setup;
            setup.gravity = Vec3::Zero();
            setup.integrator.tolerance = 1e-9;
            setup.wires = {placed_wire(steel_wire(length, nodes), Vec3::Zero())};
            setup.wires[0].holds = {hold(WirePoint::Kind::Base, true, true, true), hold(WirePoint::Kind::Tip, true, true, true)};
            const double angle = 3, time = 0.2, dt = 1e-3;
            HoldSpec& moving = setup.wires[0].holds[turned == WirePoint::Kind::Base ? 0 : 1];
            moving.turn = {{0, 0}, {time, angle}};
            FedWorld world(std::move(setup));
            double work = 0, before = 0;
            for (double t = 0; t < time - dt / 2; t += dt) {
                REQUIRE_FALSE(step(world, dt).failed());
                const double torque = world.readings(0).hand_torque;
                work += 0.5 * (before + torque) * angle * dt / time;
                before = torque;
            }
            const double held = world.rod(0).twist_stiffness[1] * angle * angle / (2 * length);
            // turned at the tip the base's hand holds against it: the same torque with the other sign
            const double sign = turned == WirePoint::Kind::Base ? 1 : -1;
            MESSAGE("work " << work << " J, held " << held << " J");
            CHECK(world.readings(0).elastic == about(held).epsilon(1e-3));
            CHECK(sign * work == about(held).epsilon(0.02));  // backward Euler loses torsional waves of the start
            for (int j = 0; j + 1 < nodes; ++j) CHECK(world.rod(0).theta[j] < 0);
        }
    }

    TEST_CASE("property: a spin that a wire starts with is right-handed about the direction of insertion")
    {
        TestSetup setup = bent_tip();
        setup.wires[0].wire.place.spin_rate = 2;
        setup.wires[0].wire.sections.clear();
        setup.integrator.damping_mass = 0;
        FedWorld world(std::move(setup));
        for (int k = 0; k < 10; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        const ConstRodView rod = world.rod(0);
        const Vec3 t = rod.tangent(5), d1 = rod.ref_d1(5), d2 = t.cross(d1);
        const Vec3 director = std::cos(rod.theta[5]) * d1 + std::sin(rod.theta[5]) * d2;
        // +z turned about +x by 0.02 rad
        CHECK(director.y() == about(-std::sin(0.02)).epsilon(1e-6));
        CHECK(director.z() == about(std::cos(0.02)).epsilon(1e-6));
    }

    // Whatever loads a clamped wire otherwise, the clamp's reaction along its own tangent is the load's along it. The edge at the
    // clamp turns by P L h/2B from that tangent: its component of the reaction was P^2 L h/2B off.
    TEST_CASE("analytic: along the clamp's tangent a hold feels none of a load across it, at any number of edges")
    {
        for (const int edges : {5, 10, 25, 50}) {
            CAPTURE(edges);
            TestSetup setup;
            setup.gravity = Vec3::Zero();
            setup.integrator.scheme = Scheme::Static;
            setup.integrator.tolerance = 1e-9;
            const WireSpec spec = steel_wire(length, edges + 1);
            const double across = 0.5 * spec.shaft.bend_stiffness / (length * length), along = 0.1 * across;
            setup.wires = {placed_wire(spec, Vec3::Zero())};
            setup.wires[0].holds = {hold(WirePoint::Kind::Base, true, true, true)};
            setup.wires[0].loads = {load({WirePoint::Kind::Tip, 0}, {-along, 0, across})};
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            const double error = world.readings(0).hand_force - along;
            MESSAGE(edges << " edges: off by " << error / across << " of the load across");
            CHECK(std::abs(error) <= (edges + 1) * world.readings(0).force_residual + 1e-12);
        }
    }

    // Balance of moments about the direction of insertion a at the base: +x, except for the angle between the polygon's clamp
    // and the arc's tangent. The load's is (r x F).a, about -z F, and the hand holds against it. Exact for any polygon, since
    // its energy does not change when wire and clamp are turned together.
    TEST_CASE("analytic: the torque with which a hold keeps an arc from turning under a load across its plane")
    {
        for (const int edges : {5, 20}) {
            CAPTURE(edges);
            const Vec3 force(0, 2e-4, 0);
            FedWorld world =
                loaded_arc(edges, {hold(WirePoint::Kind::Base, true, true, true)}, load({WirePoint::Kind::Tip, 0}, force));
            const WireReadings now = world.readings(0);
            const Vec3 tip = world.rod(0).pos(0);
            REQUIRE(tip.z() > 0.5 * length);
            const Vec3 insertion = -data_of(world).constraints(0).clamps[0].tangent;
            CHECK(insertion.x() > 0.999);
            CHECK(now.hand_torque > 0);
            CHECK(now.hand_torque == about(-tip.cross(force).dot(insertion)).epsilon(1e-6));
            CHECK(std::abs(now.hand_force) <= (edges + 1) * now.force_residual + 1e-12);  // nothing along +x
        }
    }

    // Exact for the same polygon: the reaction (a balance of forces), along the circle's tangent at the base. A linear
    // continuation of the edges' tangents is off by no more than the square of the angle h/R between two of them.
    TEST_CASE("analytic: a pinned arch pushes along the circle's tangent, to second order")
    {
        const Vec3 force(-1e-4, 0, -1e-4);  // towards the arch's centre of curvature and away; bends it by a thousandth
        double error[3];
        for (const int k : {0, 1, 2}) {
            const int edges = std::array{10, 20, 40}[k];
            const FedWorld world = pinned_arch(edges, force), unloaded = pinned_arch(edges, Vec3::Zero());
            const Vec3 reaction = world.readings(0).base_force;
            REQUIRE(reaction.norm() > 1e-5);
            // the bent arch's tangent: the circle's, turned by what the load turned the base edge (exact to that times h/L)
            const Vec3 was = unloaded.rod(0).tangent(edges - 1), is = world.rod(0).tangent(edges - 1);
            const Vec3 tangent = Vec3(-1, 0, 0) + (is - was);
            error[k] = std::abs(world.readings(0).hand_force + reaction.dot(tangent.normalized())) / reaction.norm();
            MESSAGE(edges << " edges: off by " << error[k] << " of the reaction");
            const double between = pi / 2 / edges;
            CHECK(error[k] <= between * between);
        }
        CHECK(error[0] / error[1] > 3.5);
        CHECK(error[1] / error[2] > 3.5);
    }
}

}  // namespace seldinger::test::test_hand_readings
