// Wires that touch each other: reference cases 16_rod_rod, and properties of any such contact.

#include "contact/instrument_fixture.h"

#include <cmath>
#include <numbers>

namespace seldinger::test::test_instruments {

namespace {

WireSetup wire_of(const nlohmann::json& numbers, int nodes)
{
    return straight_wire(numbers[0], numbers[1], numbers[2], numbers[3], nodes);
}

/// Two wires held at both ends cross in their middles; the upper one's ends have come down by `approach`.
World crossing_clamped(const nlohmann::json& in, double approach, int nodes)
{
    WireSetup a = wire_of(in["wire_a"], nodes), b = wire_of(in["wire_b"], nodes);
    const double height = a.wire.shaft.radius + b.wire.shaft.radius;
    put(a, {-a.wire.length / 2, 0, 0}, Vec3::UnitX());
    put(b, {0, -b.wire.length / 2, height}, Vec3::UnitY());
    for (const WirePoint::Kind kind : {WirePoint::Kind::Base, WirePoint::Kind::Tip}) {
        a.holds.push_back(hold_of(kind, true));
        b.holds.push_back(hold_of(kind, true));
        b.holds.back().move = {{0, 0, 0, 0}, {1, 0, 0, -approach}};
    }
    World world(touching({a, b}));
    for (int k = 0; k < 10; ++k) REQUIRE_FALSE(step(world, 0.1).failed());
    return world;
}

const nlohmann::json clamped_inputs = {{"wire_a", {5e-05, 7000.0, 0.1, 0.00018}}, {"wire_b", {0.0002, 12000.0, 0.12, 0.00023}}};

/// Two strands side by side along x between two discs, the far one of which turns until time 1 and then comes nearer by 8 um.
WorldSetup ply(const nlohmann::json& in, double shortening)
{
    const double r = in["r_wire"];
    std::vector<WireSetup> strands;
    for (const double side : {1.0, -1.0}) {
        WireSetup strand = straight_wire(in["B"], in["EA"], in["L"], r, 61, 1e8);
        put(strand, {0, side * r, 0}, Vec3::UnitX());
        HoldSpec tip = hold_of(WirePoint::Kind::Tip, false);
        for (int i = 0; i <= 400; ++i) {
            const double t = i / 400.0, angle = 2 * std::numbers::pi * static_cast<double>(in["turns"]) * t;
            tip.move.push_back({t, -shortening * t * t, side * r * (std::cos(angle) - 1), side * r * std::sin(angle)});
        }
        tip.move.push_back({2, -shortening - 8e-6, 0, 0});
        strand.holds = {hold_of(WirePoint::Kind::Base, false), tip};
        strands.push_back(strand);
    }
    return touching(strands);
}

struct PlyReading {
    double pull = 0, per_length = 0, moment = 0;
};

/// At the fixed disc; contact force in the middle third.
PlyReading read_ply(const World& world, double length, double r)
{
    PlyReading now;
    now.pull = -world.readings(0).base_force.x();
    now.moment = std::abs(world.readings(0).base_force.z()) * r;
    double force = 0, metres = 0;
    for (const ContactRow& row : world.contacts()) {
        if (std::abs(row.point.x() - length / 2) > length / 6) continue;
        force += row.normal_force;
        metres += row.length;
    }
    now.per_length = force / metres;
    return now;
}

}  // namespace

TEST_SUITE("contact/instruments")
{
    TEST_CASE("reference: 16_rod_rod/crossing_clamped")
    {
        const auto given = shared_case("16_rod_rod.json", "16_rod_rod/crossing_clamped");
        if (!given) return;
        for (const auto& row : (*given)["expected"]["table"]) {
            const double approach = row["approach"];
            CAPTURE(approach);
            const World world = crossing_clamped((*given)["inputs"], approach, 81);
            CHECK(-contact_force(world, 0).z() == about(row["contact_force"]).epsilon(0.02));
            const double length = (*given)["inputs"]["wire_a"][2];
            CHECK(std::abs(-world.rod(0).z[40] - static_cast<double>(row["deflection_a"])) < 0.002 * length);
        }
    }

    TEST_CASE("analytic: two clamped wires that cross, small approach: 192 B/L^3 of each in series")
    {
        // stretch stiffens by (delta/r_gyration)^2/.. of 1e-6/1e-4: 1e-4; the law's depth is a thousandth of the approach
        const double approach = 2e-6;
        const World world = crossing_clamped(clamped_inputs, approach, 81);
        const double ka = 192 * 5e-5 / 1e-3, kb = 192 * 2e-4 / (0.12 * 0.12 * 0.12);
        CHECK(-contact_force(world, 0).z() == about(approach * ka * kb / (ka + kb)).epsilon(0.02));
    }

    TEST_CASE("property: what one wire exerts on the other it feels itself, to rounding")
    {
        const World world = crossing_clamped(clamped_inputs, 5e-4, 60);
        const Vec3 on_a = contact_force(world, 0), on_b = contact_force(world, 1);
        REQUIRE(on_a.norm() > 1e-3);
        CHECK((on_a + on_b).norm() < 1e-14 * on_a.norm());
        const std::vector<ContactRow>& rows = world.contacts();
        REQUIRE_FALSE(rows.empty());
        double sum = 0;
        for (const ContactRow& row : rows) {
            CHECK(row.a.kind == BodyKind::Rod);
            CHECK(row.b.kind == BodyKind::Rod);
            CHECK(row.a.body == 0);
            CHECK(row.b.body == 1);
            CHECK(row.gap < 0);
            CHECK(std::abs(row.normal.norm() - 1) < 1e-12);
            sum += row.normal_force;
        }
        CHECK(sum == about(world.readings(0).normal).epsilon(1e-12));
        CHECK(sum == about(on_a.norm()).epsilon(1e-3));
    }

    TEST_CASE("reference: 16_rod_rod/crossing_cantilevers")
    {
        const auto given = shared_case("16_rod_rod.json", "16_rod_rod/crossing_cantilevers");
        if (!given) return;
        const auto& in = (*given)["inputs"];
        for (const auto& row : (*given)["expected"]["table"]) {
            const double approach = row["approach"];
            CAPTURE(approach);
            WireSetup a = wire_of(in["wire_a"], 81), b = wire_of(in["wire_b"], 81);
            const double at_a = in["wire_a"][4], at_b = in["wire_b"][4];
            const double height = a.wire.shaft.radius + b.wire.shaft.radius;
            put(a, {0, 0, 0}, Vec3::UnitX());
            put(b, {at_a, -at_b, height}, Vec3::UnitY());
            a.holds = {hold_of(WirePoint::Kind::Base, true)};
            b.holds = {hold_of(WirePoint::Kind::Base, true)};
            b.holds[0].move = {{0, 0, 0, 0}, {1, 0, 0, -approach}};
            World world(touching({a, b}));
            for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 0.05).failed());
            const Vec3 force = contact_force(world, 0);
            CHECK(force.norm() == about(row["contact_force"]).epsilon(0.02));
            const double scale = row["contact_force"];
            for (int c = 0; c < 3; ++c)
                CHECK(std::abs(force[c] - static_cast<double>(row["force_on_a"][static_cast<std::size_t>(c)])) < 0.02 * scale);
        }
    }

    TEST_CASE("reference: 16_rod_rod/three_point")
    {
        const auto given = shared_case("16_rod_rod.json", "16_rod_rod/three_point");
        if (!given) return;
        const auto& in = (*given)["inputs"];
        const double r = in["r_wire"], support = in["r_support"], span = in["half_span"], length = in["L"];
        for (const auto& row : (*given)["expected"]["table"]) {
            const double sunk = row["midspan_deflection"];
            CAPTURE(sunk);
            WireSetup wire = straight_wire(in["B"], in["EA"], length, r, 81);
            put(wire, {-length / 2, 0, r + support}, Vec3::UnitX());
            // its middle is moved, not loaded: a wire that is free to slide over frictionless supports tilts and falls between
            // them
            HoldSpec middle = hold_of(WirePoint::Kind::Distance, true);
            middle.at.from_tip = length / 2;
            middle.move = {{0, 0, 0, 0}, {1, 0, 0, -sunk}};
            wire.holds = {middle};
            std::vector<WireSetup> wires = {wire};
            for (const double side : {-1.0, 1.0}) {
                WireSetup fixed = straight_wire(1, 1e6, 0.02, support, 9);  // stiff, held all along
                put(fixed, {side * span, -0.01, 0}, Vec3::UnitY());
                for (int k = 0; k <= 8; ++k) {
                    HoldSpec hold = hold_of(WirePoint::Kind::Distance, false);
                    hold.at.from_tip = 0.0025 * k;
                    fixed.holds.push_back(hold);
                }
                wires.push_back(fixed);
            }
            World world(touching(wires));
            for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 0.05).failed());
            CHECK(contact_force(world, 1).norm() == about(row["contact_force_each"]).epsilon(0.02));
        }
    }

    TEST_CASE("reference: 16_rod_rod/ply")
    {
        const auto given = shared_case("16_rod_rod.json", "16_rod_rod/ply");
        if (!given) return;
        const auto& in = (*given)["inputs"];
        const auto& expected = (*given)["expected"];
        const double length = in["L"], r = in["r_wire"], pull = in["F_z_per_strand"];
        World world(ply(in, expected["end_shortening L - z"]));
        for (int k = 0; k < 200; ++k) REQUIRE_FALSE(step(world, 0.005).failed());
        // where the discs come nearer the pull falls through the one asked for
        PlyReading last = read_ply(world, length, r);
        REQUIRE(last.pull > pull);
        for (int k = 0; k < 20 && last.pull > pull; ++k) {
            REQUIRE_FALSE(step(world, 0.05).failed());
            const PlyReading now = read_ply(world, length, r);
            if (now.pull <= pull) {
                const double share = (last.pull - pull) / (last.pull - now.pull);
                const auto between = [&](double then, double here) { return then + share * (here - then); };
                CHECK(between(last.per_length, now.per_length) ==
                      about(expected["contact_force_per_length_of_strand_in_the_middle"]).epsilon(0.05));
                CHECK(between(last.moment, now.moment) == about(expected["end_moment_about_the_axis_per_strand"]).epsilon(0.05));
            }
            last = now;
        }
        CHECK(last.pull <= pull);
    }

    TEST_CASE("reference: 16_rod_rod/knot: an overhand knot, its loop 50 wires wide")
    {
        const auto given = shared_case("16_rod_rod.json", "16_rod_rod/knot");
        if (!given) return;
        const auto& in = (*given)["inputs"];
        const auto& row = (*given)["expected"]["table"][0];
        const double r = in["r_wire"], loop = static_cast<double>(row["R_over_r"]) * r, pull = row["tension T = B/(2 R^2)"];
        const std::vector<Vec3> path = knot_path(loop, 0.0263);  // tails of eight loop radii when it is tight
        double length = -6e-4;                                   // edges cut corners
        for (std::size_t k = 1; k < path.size(); ++k) length += (path[k] - path[k - 1]).norm();
        WireSetup wire = straight_wire(in["B"], 7000, length, r, static_cast<int>(length / (4 * r)) + 1, 1e9);
        wire.wire.place.shape = PlaceShape::Points;
        wire.wire.place.points = path;
        for (const double side : {-1.0, 1.0}) {
            wire.loads.push_back({.at = {side < 0 ? WirePoint::Kind::Base : WirePoint::Kind::Tip}, .force = {side * pull, 0, 0}});
        }
        WorldSetup setup = touching({wire});
        setup.integrator.scheme = Scheme::Newton;
        setup.integrator.damping_mass = 1000;
        World world(setup);
        for (int k = 0; k < 400; ++k) REQUIRE_FALSE(step(world, 2e-4).failed());
        REQUIRE(world.readings(0).kinetic < 1e-10);
        const ConstRodView rod = world.rod(0);
        const double shortening = length - (rod.pos(0) - rod.pos(rod.n - 1)).norm();
        CHECK(shortening == about(row["end_shortening"]).epsilon(0.03));
        CHECK(contact_force(world, 0).norm() < 1e-12 * world.readings(0).normal);
    }
}

}  // namespace seldinger::test::test_instruments
