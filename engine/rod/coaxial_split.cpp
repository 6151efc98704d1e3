// Births and merges of the node next to the hub of instruments that share a centreline.

#include "rod/coaxial_split.h"

#include "core/check.h"
#include "rod/coaxial_edge.h"
#include "rod/split.h"

#include <algorithm>

namespace seldinger {

using namespace coaxial;

namespace {

Vec3 line_forwards(const RodView& line, int j) { return (line.pos(j) - line.pos(j + 1)).normalized(); }

/// Lengths of the edges from `first` on such that they carry `force`, their sum being about `length`. @return rest length added
double set_lengths(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, int first, double force, double length)
{
    const RodView line = rods.view(wires[0]);
    prepare_group(rods, wires, rod);  // the stiffness of edges that are about as long
    double s = line.material_s[first];
    const double begin = s;
    for (int j = first; j < line.n - 1; ++j) {
        const double chord = (line.pos(j + 1) - line.pos(j)).norm();
        s += std::clamp(chord / (1 + force / line.stretch_stiffness[j]), 0.5 * line.rest_length[j], 2 * line.rest_length[j]);
        line.material_s[j + 1] = s;
    }
    prepare_group(rods, wires, rod);
    return s - begin - length;
}

/// Twist per length of an instrument on both sides of an edge [rad/m].
struct TwistRates {
    double inner = 0, base = 0;
    TwistRates(const RodView& own, const RodView& line)
    {
        const int a = line.n - 2;
        if (a > 0) inner = (own.theta[a] - own.theta[a - 1] + line.ref_twist[a]) / line.voronoi_length(a);
        base = (own.theta[a + 1] - own.theta[a] + line.clamp_twist_a[a + 1]) / (0.5 * line.rest_length[a]);
    }
};

/// Reference twists of the joints at both ends of what changes at the base [rad].
struct BaseReferences {
    double first = 0, sleeve = 0;
};

/// Frames of the last edges from `first` on anew. @return how the reference twists have changed from `last`
BaseReferences refresh_frames(RodArrays& rods, std::span<const int> wires, const CoaxialBase& base, int first,
                              const Vec3& tangent, const Vec3& d1, const BaseReferences& last)
{
    const RodView line = rods.view(wires[0]);
    for (int j = first; j < line.n - 1; ++j) set_edge_frame(line, j, tangent, d1);
    for (int i = first + 1; i < line.n - 1; ++i) line.ref_twist[i] = inner_reference(line, i, 0);
    if (first > 0) line.ref_twist[first] = inner_reference(line, first, last.first);
    line.ref_twist[line.n - 1] = 0;
    for (int i = first; i < line.n; ++i) line.clamp_twist_a[i] = line.clamp_twist_b[i] = 0;
    line.clamp_twist_a[line.n - 1] = sleeve_reference(line, base, last.sleeve);
    return {first > 0 ? line.ref_twist[first] - last.first : 0.0, line.clamp_twist_a[line.n - 1] - last.sleeve};
}

/// What a common centreline's base edge says before it is split.
struct OldBase {
    double length, force;  // [m], [N]
    Vec3 tangent, d1, momentum;
    BaseReferences ref;
    std::vector<double> theta;      // of each instrument [rad]
    std::vector<TwistRates> rates;  // of each instrument

    OldBase(RodArrays& rods, std::span<const int> wires)
    {
        const RodView line = rods.view(wires[0]);
        const int a = line.n - 2;
        length = line.rest_length[a], force = axial_force(line, a);
        tangent = line.tangent(a), d1 = line.ref_d1(a), momentum = coaxial::momentum(line, line.n - 1);
        ref = {a > 0 ? line.ref_twist[a] : 0.0, line.clamp_twist_a[a + 1]};
        for (const int w : wires) {
            theta.push_back(rods.view(w).theta[a]);
            rates.emplace_back(rods.view(w), line);
        }
    }
};

/// Frames and angles of both edges of a split base edge: each instrument keeps its twist per length on either side.
void split_frames(RodArrays& rods, std::span<const int> wires, const CoaxialBase& base, const OldBase& old)
{
    const RodView line = rods.view(wires[0]);
    const int a = line.n - 3;
    const BaseReferences change = refresh_frames(rods, wires, base, a, old.tangent, old.d1, old.ref);
    for (std::size_t k = 0; k < wires.size(); ++k) {
        const RodView own = rods.view(wires[k]);
        own.theta[a] = old.theta[k] - 0.5 * old.rates[k].inner * line.rest_length[a + 1] - change.first;
        own.theta[a + 1] = old.theta[k] + 0.5 * old.rates[k].base * line.rest_length[a] + change.sleeve;
    }
}

/// Moves the node next to the hub sideways to where the elastic forces on it balance (rod/split.cpp, balance_born_node).
void balance_born_node(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base,
                       const OldBase& old)
{
    constexpr int most_rounds = 12;
    constexpr double balanced = 1e-12;  // of the base edge's length
    const RodView line = rods.view(wires[0]);
    const int m = line.n - 2, a = m - 1;
    RodFrames frames(line.n, 1);
    std::vector<double> gradient(static_cast<std::size_t>(rod.dofs().count(line.n)));
    for (int round = 0; round < most_rounds; ++round) {
        set_lengths(rods, wires, rod, a, old.force, old.length);
        split_frames(rods, wires, base, old);
        if (!update_coaxial(rod, line, now_of(rods, wires), base, frames)) return;
        std::fill(gradient.begin(), gradient.end(), 0.0);
        add_coaxial(rod, line, now_of(rods, wires), base, frames, gradient, nullptr, HessianMode::None);
        const auto at = [&](int c) { return gradient[rod.dofs().position(m, c)]; };
        const Vec3 shift = born_node_shift(line, frames.tangent[m], Vec3(at(0), at(1), at(2)));
        line.set_pos(m, line.pos(m) - shift);
        if (shift.norm() < balanced * line.rest_length[m]) break;
    }
}

}  // namespace

void prepare_group(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod)
{
    const RodView line = rods.view(wires[0]);
    prepare_coaxial(rod, line);
    for (std::size_t k = 0; k < wires.size(); ++k) {
        const RodView own = rods.view(wires[k]);
        for (int j = 0; j < line.n - 1; ++j) own.spin_inertia[j] = rod.spin_inertia[k][j];
        if (k == 0) continue;
        for (int i = 0; i < line.n; ++i) {
            own.material_s[i] = line.material_s[i];
            own.rest_length[i] = line.rest_length[i];
            own.bend_stiffness[i] = line.bend_stiffness[i];
            own.radius[i] = rod.instrument[k].spec->shaft.radius;
            own.stretch_stiffness[i] = own.twist_stiffness[i] = own.mass[i] = 0;
            own.rest_kappa1[i] = own.rest_kappa2[i] = own.rest_twist[i] = 0;
        }
    }
}

void follow_line(RodArrays& rods, std::span<const int> wires)
{
    const RodView line = rods.view(wires[0]);
    for (const int w : wires.subspan(1)) {
        const RodView own = rods.view(w);
        for (int i = 0; i < line.n; ++i) {
            own.set_pos(i, line.pos(i));
            own.set_vel(i, line.vel(i));
            own.set_tangent(i, line.tangent(i));
            own.set_ref_d1(i, line.ref_d1(i));
            own.ax[i] = line.ax[i], own.ay[i] = line.ay[i], own.az[i] = line.az[i];
            own.ref_twist[i] = line.ref_twist[i];
            own.clamp_twist_a[i] = line.clamp_twist_a[i];
            own.clamp_twist_b[i] = 0;
        }
    }
}

SplitResult split_coaxial_base(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base,
                               double fraction)
{
    RodView line = rods.view(wires[0]);
    const int a = line.n - 2;
    const OldBase old(rods, wires);
    // a parabola that leaves the sleeve along it and comes to the node before
    const Vec3 from = line.pos(a), to = line.pos(a + 1), chord = from - to;
    const double u = 1 - fraction;
    const Vec3 position = to - u * (1 - u) * chord.norm() * base.tangent + u * u * chord;

    for (const int w : wires) rods.insert_node(w, a + 1);
    line = rods.view(wires[0]);
    line.set_pos(a + 1, position);
    line.material_s[a + 1] = line.material_s[a] + fraction * old.length;
    line.material_s[a + 2] = line.material_s[a] + old.length;
    for (const int w : wires) {
        const RodView own = rods.view(w);
        own.spin_rate[a + 1] = own.spin_rate[a];
        own.spin_acc[a + 1] = own.spin_acc[a];
    }
    follow_line(rods, wires);
    balance_born_node(rods, wires, rod, base, old);
    const double added = set_lengths(rods, wires, rod, a, old.force, old.length);
    split_frames(rods, wires, base, old);
    for (const std::span<double> acc : {line.ax, line.ay, line.az}) acc[a + 1] = fraction * acc[a + 2] + (1 - fraction) * acc[a];
    // the new node leaves the sleeve along the arc that its base edge is a chord of, as fast as the inner edge's length demands
    const Vec3 out = (2 * line_forwards(line, a + 1) + base.tangent).normalized(), inner = line_forwards(line, a);
    line.set_vel(a + 1, inner.dot(line.vel(a)) / inner.dot(out) * out);
    set_momentum(line, a + 1, old.momentum - line.mass[a + 2] * line.vel(a + 2));
    follow_line(rods, wires);
    return {added, line_forwards(line, a + 1).dot(line.vel(a + 1))};
}

void split_coaxial_tip(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod)
{
    const RodView before = rods.view(wires[0]);
    const Vec3 carried = momentum(before, before.n - 1);
    for (const int w : wires) rods.insert_node(w, 1);
    const RodView line = rods.view(wires[0]);
    line.set_pos(1, 0.5 * (line.pos(0) + line.pos(2)));
    line.set_vel(1, 0.5 * (line.vel(0) + line.vel(2)));
    line.material_s[1] = 0.5 * (line.material_s[0] + line.material_s[2]);
    line.ref_twist[1] = line.clamp_twist_a[1] = line.clamp_twist_b[1] = 0;
    line.set_tangent(1, line.tangent(0));
    line.set_ref_d1(1, line.ref_d1(0));
    for (const std::span<double> acc : {line.ax, line.ay, line.az}) acc[1] = 0.5 * (acc[0] + acc[2]);
    for (const int w : wires) {
        const RodView own = rods.view(w);
        own.theta[1] = own.theta[0];
        own.spin_rate[1] = own.spin_rate[0];
        own.spin_acc[1] = own.spin_acc[0];
    }
    prepare_group(rods, wires, rod);
    set_momentum(line, line.n - 1, carried);
    follow_line(rods, wires);
}

SplitResult merge_coaxial_base(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base)
{
    RodView line = rods.view(wires[0]);
    const int node = line.n - 2, a = node - 1;
    SEL_ASSERT(a >= 0);
    const double first = line.rest_length[a], second = line.rest_length[node], length = first + second;
    const double force = (first * axial_force(line, a) + second * axial_force(line, node)) / length;
    const Vec3 tangent = line.tangent(a), d1 = line.ref_d1(a), carried = momentum(line, line.n - 1);
    const double ref = line.ref_twist[node], at_sleeve = line.clamp_twist_a[line.n - 1], share = second / length;
    std::vector<double> twists, spins;
    for (const int w : wires) {
        const RodView own = rods.view(w);
        twists.push_back(own.theta[node] - own.theta[a] + ref);
        const double inertia = own.spin_inertia[a] + own.spin_inertia[node];
        const double momentum_of = own.spin_inertia[a] * own.spin_rate[a] + own.spin_inertia[node] * own.spin_rate[node];
        spins.push_back(inertia > 0 ? momentum_of / inertia : 0);
    }
    for (const int w : wires) rods.erase_node(w, node);
    line = rods.view(wires[0]);
    const double added = set_lengths(rods, wires, rod, a, force, length);
    const double at_first = a > 0 ? line.ref_twist[a] : 0.0;
    const BaseReferences change = refresh_frames(rods, wires, base, a, tangent, d1, {at_first, at_sleeve + ref});
    const double halves = a > 0 ? 0.5 : 1;
    for (std::size_t k = 0; k < wires.size(); ++k) {
        const RodView own = rods.view(wires[k]);
        own.theta[a] += share * twists[k] + halves * (change.sleeve - change.first);
        own.spin_rate[a] = spins[k];
    }
    set_momentum(line, line.n - 2, carried - line.mass[line.n - 1] * line.vel(line.n - 1));
    follow_line(rods, wires);
    return {added, line_forwards(line, line.n - 2).dot(line.vel(line.n - 2))};
}

}  // namespace seldinger
