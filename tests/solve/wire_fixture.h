#pragma once
// A wire as a user describes it, with a solver round it: base at the origin, tip along +x, first material director +z.

#include "newton/solver.h"
#include "solve/constraints.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

namespace seldinger::test {

using test::about;

constexpr double pi = std::numbers::pi;

/// The 0.014 inch nitinol wire of the references.
inline WireSpec nitinol(double length)
{
    WireSpec spec;
    spec.length = length;
    spec.shaft.radius = 0.000178;
    spec.shaft.density = 6450;
    spec.shaft.bend_stiffness = 5.5190957750700876e-5;
    spec.shaft.twist_stiffness = 4.2e-5;
    spec.shaft.stretch_stiffness = 6966;
    return spec;
}

/// Position as a function of arc length from the base.
using Curve = std::function<Vec3(double)>;

inline Vec3 straight(double s) { return {s, 0, 0}; }

inline Curve arc_towards_z(double radius)
{
    return [radius](double s) { return Vec3(radius * std::sin(s / radius), 0, radius * (1 - std::cos(s / radius))); };
}

/// With rest_is_placed rest lengths are the chords, so that the wire is free of stress as it lies.
inline void place_nodes(const RodView& rod, const WireSpec& spec, const Curve& curve = straight, bool rest_is_placed = false)
{
    const int n = rod.n;
    for (int i = 0; i < n; ++i) {
        const double s = spec.length * i / (n - 1);
        rod.set_pos(i, curve(spec.length - s));
        const double chord = i > 0 ? (rod.pos(i) - rod.pos(i - 1)).norm() : 0.0;
        rod.material_s[i] = rest_is_placed && i > 0 ? rod.material_s[i - 1] + chord : s;
        rod.set_vel(i, Vec3::Zero());
        rod.spin_rate[i] = rod.ax[i] = rod.ay[i] = rod.az[i] = rod.spin_acc[i] = 0;
    }
    initialise_frames(rod, Vec3::UnitZ());
    set_rest_shape(rod, spec, rest_is_placed);
}

inline HoldSpec clamp_base()
{
    HoldSpec hold;
    hold.position = hold.direction = hold.spin = true;
    return hold;
}

inline LoadSpec tip_load(const Vec3& force) { return {.at = {WirePoint::Kind::Tip}, .force = force}; }

/// One or more equal wires.
struct Rig {
    WireSpec wire;
    RodArrays rods;
    std::vector<WireConstraints> constraints;
    std::vector<SolveReport> reports;
    std::vector<std::uint8_t> active;
    std::vector<WireHolds> holds;
    std::unique_ptr<Solver> solver;
    double time = 0;

    Rig(const WireSpec& spec, int nodes, int wires = 1, const Curve& curve = straight, bool rest_is_placed = false)
        : wire(spec), rods(std::vector<int>(wires, nodes)), constraints(wires), reports(wires), active(wires, 1)
    {
        for (int w = 0; w < wires; ++w) {
            rods.set_node_count(w, nodes);
            rods.set_curvature(w, spec.curvature);
            place_nodes(rods.view(w), spec, curve, rest_is_placed);
        }
    }

    void hold(const std::vector<HoldSpec>& held, const std::vector<LoadSpec>& loads = {}, const std::vector<LinkSpec>& links = {})
    {
        holds.clear();
        for (int w = 0; w < rods.wire_count(); ++w) holds.emplace_back(held, loads, links, rods.view(w), wire.length);
        fill(0);
    }
    void fill(double t)
    {
        for (int w = 0; w < static_cast<int>(holds.size()); ++w) holds[w].fill(t, rods.view(w), constraints[w]);
    }
    /// @param partition  wires of each system; none: every wire is one
    void integrate_with(const IntegratorSpec& spec, const Vec3& gravity = Vec3::Zero(), std::span<const int> partition = {})
    {
        solver = std::make_unique<Solver>(rods, spec, gravity, partition);
    }
    bool settle(ForceTerms terms = {})
    {
        fill(INFINITY);
        solver->equilibrium(constraints, terms, active, reports);
        return reports[0].converged;
    }
    bool step(double h, ForceTerms terms = {})
    {
        time += h;
        fill(time);
        solver->step(h, constraints, terms, active, reports);
        return reports[0].converged;
    }
    [[nodiscard]] RodView rod(int w = 0) { return rods.view(w); }
    [[nodiscard]] Vec3 tip(int w = 0) { return rods.view(w).pos(0); }
};

}  // namespace seldinger::test
