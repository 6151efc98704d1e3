// Holds, loads and links: where they act, how they move, and refusals.
#include "core/error.h"
#include "solve/feed.h"
#include "solve/wire_fixture.h"
#include "support/approx.h"
#include "support/refusal.h"

#include <string>

namespace seldinger::test::test_constraints {

namespace {

WirePoint at_distance(double s) { return {WirePoint::Kind::Distance, s}; }

std::string refusal(const std::vector<HoldSpec>& holds, const std::vector<LoadSpec>& loads = {})
{
    Rig rig(nitinol(0.1), 11);
    return test::refusal([&] { rig.hold(holds, loads); }, ErrorKind::BadScene);
}

}  // namespace

TEST_SUITE("solve/constraints")
{
    TEST_CASE("property: a moving hold follows its keys and velocity, and stays where the keys end")
    {
        Rig rig(nitinol(0.1), 11);
        HoldSpec hold = clamp_base();
        hold.move = {{1, 0, 0, 0}, {3, 0.02, 0, 0}};
        hold.velocity = {0, 0.01, 0};
        hold.turn = {{0, 0}, {2, 1}};
        rig.hold({hold});
        struct Expected {
            double t, x, y, turn;
        };
        for (const Expected& e :
             {Expected{0, 0, 0, 0}, {1, 0, 0.01, 0.5}, {2, 0.01, 0.02, 1}, {3, 0.02, 0.03, 1}, {9, 0.02, 0.09, 1}}) {
            CAPTURE(e.t);
            rig.fill(e.t);
            const auto& prescribed = rig.constraints[0].prescribed;
            REQUIRE(prescribed.size() == 3);
            CHECK(prescribed[0].first == 40);
            CHECK(prescribed[0].second == test::about(e.x));
            CHECK(prescribed[1].second == test::about(e.y));
            REQUIRE(rig.constraints[0].clamps.size() == 1);
            const RodClamp& clamp = rig.constraints[0].clamps[0];
            CHECK(clamp.turns == test::about(-e.turn));
            // +z turned about the direction of insertion, +x: towards -y
            CHECK(clamp.director.y() == test::about(-std::sin(e.turn)));
            CHECK(clamp.tangent.x() == about(-1));
        }
    }

    TEST_CASE("property: a load is shared by the nodes of its edge and grows over its ramp")
    {
        Rig rig(nitinol(0.1), 11);
        LoadSpec load{.at = at_distance(0.0325), .force = {0, 0, 2}, .ramp = 4};
        rig.hold({}, {load});
        rig.fill(1);
        REQUIRE(rig.constraints[0].loads.size() == 1);
        CHECK(rig.constraints[0].loads[0].edge == 3);
        CHECK(rig.constraints[0].loads[0].bary == about(0.25));
        CHECK(rig.constraints[0].loads[0].force.z() == about(0.5));
        rig.fill(INFINITY);
        CHECK(rig.constraints[0].loads[0].force.z() == 2);
    }

    TEST_CASE("property: points stay on the material when nodes come and go")
    {
        Rig rig(nitinol(0.1), 21);
        rig.rods.set_node_count(0, 11);
        place_nodes(rig.rods.view(0), rig.wire);
        HoldSpec middle = clamp_base();
        middle.at = at_distance(0.06);
        LoadSpec load = tip_load({0, 0, 1});
        load.at = at_distance(0.0575);
        rig.hold({middle}, {load});
        CHECK(rig.constraints[0].prescribed[0].first == 24);
        CHECK(rig.holds[0].offset(0) < 1e-12);
        CHECK(rig.holds[0].held_distances()[0] == about(0.06));
        rig.rods.set_node_count(0, 21);
        place_nodes(rig.rods.view(0), rig.wire);
        rig.fill(0);
        CHECK(rig.constraints[0].prescribed[0].first == 48);
        CHECK(rig.constraints[0].loads[0].edge == 11);
        CHECK(rig.constraints[0].loads[0].bary == about(0.5));
    }

    // the tangent of an arc's first edge is that of its middle; the clamp must hold the arc's own, to second order
    TEST_CASE("analytic: a clamp takes the arc's tangent at the node, not the edge's")
    {
        double error[2];
        for (int k : {0, 1}) {
            Rig rig(nitinol(0.1), k == 0 ? 11 : 21, 1, arc_towards_z(0.1));
            const NodeFrame frame = node_frame(rig.rod(), rig.rod().n - 1);
            error[k] = (frame.tangent + Vec3::UnitX()).norm();
            CHECK(std::abs(frame.tangent.dot(frame.director)) < 1e-12);
        }
        CHECK(error[0] < 0.006);
        CHECK(error[0] / error[1] > 3.5);
    }

    TEST_CASE("property: contradictions and points off the wire are refused with the place and a way out")
    {
        HoldSpec base = clamp_base(), near = clamp_base(), nothing, off = clamp_base();
        near.at = at_distance(0.0995);
        off.at = at_distance(0.3);
        CHECK(refusal({base, near}).find("hold[0] and hold[1] both hold the position") != std::string::npos);
        CHECK(refusal({nothing}).find("holds nothing") != std::string::npos);
        CHECK(refusal({off}).find("hold[0].at: 0.3 m") != std::string::npos);
        LoadSpec load = tip_load({0, 0, 1});
        load.at = at_distance(-0.1);
        CHECK(refusal({base}, {load}).find("load[0].at") != std::string::npos);
        // position here, direction there is no contradiction
        HoldSpec position, direction;
        position.position = direction.direction = true;
        CHECK(refusal({position, direction}).empty());
    }

    TEST_CASE("property: feed keys are piecewise linear and constant outside")
    {
        const FeedKey keys[] = {{1, 0, 0}, {2, 0.1, 3}, {4, 0.1, 6}};
        const HubPath feed(keys);
        CHECK(feed.at(0).advance == 0);
        CHECK(feed.at(1.5).advance == about(0.05));
        CHECK(feed.at(3).turn == about(4.5));
        CHECK(feed.at(9).turn == 6);
    }

    // spring and load balance: k stretch = F
    TEST_CASE("analytic: a link holds a free wire against a load, and a dead moment bends a clamped wire to an arc")
    {
        Rig linked(nitinol(0.1), 11);
        LinkSpec link{.at = {WirePoint::Kind::Tip}, .anchor = {0.1, 0, 0}, .stiffness = 5};
        linked.hold({}, {tip_load({0.01, 0, 0})}, {link});
        linked.integrate_with({});
        REQUIRE(linked.settle());
        CHECK(linked.tip().x() == about(0.102).epsilon(1e-6));

        // M = B/R: a quarter circle, tip at (R, 0, R); second order in the edge length
        WireSpec spec = nitinol(0.1);
        Rig bent(spec, 51);
        LoadSpec moment;
        moment.at.kind = WirePoint::Kind::Tip;
        const double radius = 0.1 / (pi / 2);
        moment.moment = {0, -spec.shaft.bend_stiffness / radius, 0};  // turns +x towards +z
        bent.hold({clamp_base()}, {moment});
        bent.integrate_with({});
        REQUIRE(bent.settle());
        CHECK(bent.tip().x() == about(radius).epsilon(0.002));
        CHECK(bent.tip().z() == about(radius).epsilon(0.002));
    }

    TEST_CASE("property: what is prescribed changes until the last key, the end of a ramp, or an end in time")
    {
        Rig rig(nitinol(0.1), 11);
        LoadSpec slow, fast;
        slow.at = fast.at = at_distance(0.05);
        slow.ramp = 4;
        fast.ramp = 1;
        HoldSpec moved = clamp_base();
        moved.move = {{0, 0, 0, 0}, {3, 0, 0, 0.001}};
        const auto until = [&](const std::vector<LoadSpec>& loads) {
            return WireHolds(std::vector{moved}, loads, {}, rig.rod(), 0.1).moving_until();
        };
        CHECK(until({}) == 3);
        CHECK(until({fast}) == 3);
        CHECK(until({slow, fast}) == 4);
        CHECK(until({fast, slow}) == 4);
        fast.until = 5;
        CHECK(until({slow, fast}) == 5);
    }

    TEST_CASE("property: an equilibrium is followed along moves in parts, to where they end")
    {
        Rig rig(nitinol(0.1), 11);
        const auto path = [&](const HoldSpec& hold) { return WireHolds(std::vector{hold}, {}, {}, rig.rod(), 0.1).path(0.1); };
        CHECK(path(clamp_base()) == std::vector<double>{INFINITY});
        HoldSpec turned = clamp_base();
        turned.turn = {{0, 0}, {2, 2 * pi}};  // 45 degrees a part
        std::vector<double> parts = path(turned);
        REQUIRE(parts.size() == 9);  // from time 0, where work begins
        CHECK(parts[0] == 0);
        CHECK(parts[1] == about(0.25).epsilon(1e-12));
        CHECK(std::isinf(parts[8]));
        turned.move = {{1, 0, 0, 0}, {2, 0, 0, 0.001}};  // two parts of half a hundredth of the length, fewer than the turn's
        parts = path(turned);
        REQUIRE(parts.size() == 9);
        CHECK(parts[4] == 1);  // a key is never stepped over
    }
}

}  // namespace seldinger::test::test_constraints
