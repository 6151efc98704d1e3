#pragma once
// Worlds of instruments that touch each other, without a vessel.

#include "support/approx.h"
#include "support/shared_folder.h"
#include "world/world.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <optional>
#include <vector>

namespace seldinger::test {

/// A straight wire of even nodes, no friction; contact by f = stiffness depth per metre.
inline WireSetup straight_wire(double bend, double stretch, double length, double radius, int nodes, double stiffness = 1e10)
{
    WireSetup made;
    made.wire.length = length;
    made.wire.nodes = nodes;
    WireSection& s = made.wire.shaft;
    s.radius = radius;
    s.density = 6450;
    s.bend_stiffness = bend;
    s.twist_stiffness = 0.76 * bend;
    s.stretch_stiffness = stretch;
    made.contact.stiffness_from_wall = false;
    made.contact.stiffness = stiffness;
    made.contact.exponent = 1;
    made.contact.friction = FrictionLaw::None;
    return made;
}

inline void put(WireSetup& wire, const Vec3& base, const Vec3& direction)
{
    wire.wire.place.base = base;
    wire.wire.place.direction = direction;
    wire.wire.place.normal = std::abs(direction.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX();
}

inline HoldSpec hold_of(WirePoint::Kind kind, bool direction, bool spin = false)
{
    return {.at = {kind}, .position = true, .direction = direction, .spin = spin};
}

/// A long overhand knot, tails included, to be drawn tight: a polynomial of the knot, as wide as the loop that it is to have.
inline std::vector<Vec3> knot_path(double loop, double tail)
{
    constexpr double end = 2.15;
    constexpr int points = 4000;
    std::vector<Vec3> path;
    for (int i = 0; i <= points; ++i) {
        const double t = end * (2.0 * i / points - 1), t2 = t * t;
        path.push_back(0.45 * loop * Vec3(t * (t2 - 3), t2 * (t2 - 4), 0.3 * t * (t2 * t2 - 10)));
    }
    path.insert(path.begin(), path[0] + tail * (path[0] - path[1]).normalized());
    path.push_back(path.back() + tail * (path.back() - path[path.size() - 2]).normalized());
    return path;
}

/// All wires one system that touch each other; equilibria.
inline WorldSetup touching(std::vector<WireSetup> wires)
{
    WorldSetup made;
    made.gravity = Vec3::Zero();
    made.integrator.scheme = Scheme::Static;
    made.systems = {static_cast<int>(wires.size())};
    made.wires = std::move(wires);
    made.instruments_touch = true;
    return made;
}

/// Sum of the contact forces on a wire [N].
inline Vec3 contact_force(const World& world, int wire)
{
    Vec3 sum = Vec3::Zero();
    for (const Vec3& force : world.nodal_contact_force(wire)) sum += force;
    return sum;
}

/// A reference of the shared folder, or nothing: the test case then counts as skipped.
inline std::optional<nlohmann::json> shared_case(const std::string& file, const std::string& id)
{
    const auto shared = shared_folder_or_skip();
    if (!shared) return std::nullopt;
    std::ifstream in(*shared / "reference" / file);
    REQUIRE(in);
    const nlohmann::json all = nlohmann::json::parse(in);
    for (const auto& one : all["cases"])
        if (one["id"] == id) return one;
    FAIL("no case " << id);
    return std::nullopt;
}

}  // namespace seldinger::test
