// Moments and torques of instruments that share a centreline, and its edges split and merged anywhere along it.

#include "rod/coaxial_nodes.h"

#include "core/check.h"
#include "rod/adapt.h"
#include "rod/coaxial_edge.h"
#include "rod/coaxial_split.h"
#include "rod/coaxial_stencil.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

using namespace coaxial;

namespace {

/// A complex curvature in the frame (n1, te x n1), as a vector along its binormal (the signs of rod/pair.h).
Vec3 as_vector(Complex kappa, const Stencil& s) { return kappa.real() * s.pair.te.cross(s.n1) - kappa.imag() * s.n1; }

/// dE/d(integrated curvature) of a cell: f S (f kappa - sum r_k).
Vec3 moment_of(const CoaxialCell& cell, const Stencil& s, int instruments)
{
    if (s.end || !(cell.covered > 0)) return Vec3::Zero();
    const double part = cell.covered / cell.length;
    Complex strain = part * s.kappa;
    for (int k = 0; k < instruments; ++k) strain -= s.phase[k] * cell.rest[k];
    return part / cell.compliance * as_vector(strain, s);
}

/// Torque of instrument k in a cell, dE/d(twist); 0 where it is not.
double torque_of(const CoaxialCell& cell, const Stencil& s, int k)
{
    if (s.end || !(cell.twist_covered[k] > 0)) return 0;
    const double part = cell.twist_covered[k] / cell.length;
    return part * part * s.twist[k] / cell.twist_compliance[k];
}

int count_in(const CoaxialCell& cell, int instruments)
{
    int count = 0;
    for (int k = 0; k < instruments; ++k) count += cell.twist_covered[k] > 0;
    return count;
}

/// Adds what instrument k's torques make of the tip's error.
void add_turning(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                 const RodFrames& frames, int k, std::span<double> turning)
{
    const double tip = -rod.instrument[k].offset;
    const auto torque_at = [&](int i) { return torque_of(rod.cells[i], stencil_at(rod, line, trial, base, frames, i), k); };
    int end = 0;  // node whose distance from the tangent counts
    double last = 0, slope = 0;
    for (int i = 0; i + 1 < line.n; ++i) {
        const double next = torque_at(i + 1), after = (next - last) / line.rest_length[i];
        const CoaxialCell& cell = rod.cells[i];
        if (i > 0 && cell.twist_covered[k] > 0 && count_in(cell, rod.instruments) > 1) {
            const double from = std::max(tip, line.material_s[i] - longest_lever);
            while (end < i && line.material_s[end] < from) ++end;
            const double off = (line.pos(end) - line.pos(i)).cross(line.tangent(i)).norm();
            const double compliance = cell.twist_compliance[k] / cell.twist_covered[k];
            turning[i] += off * std::abs(after - slope) * compliance;
        }
        last = next, slope = after;
    }
}

}  // namespace

void measure_coaxial(const CoaxialRod& rod, const RodView& line, const CoaxialTrial& trial, const CoaxialBase& base,
                     const RodFrames& frames, std::span<Vec3> moment, std::span<double> turning)
{
    for (int i = 0; i < line.n; ++i)
        moment[i] = moment_of(rod.cells[i], stencil_at(rod, line, trial, base, frames, i), rod.instruments);
    std::fill_n(turning.begin(), line.n, 0.0);
    if (rod.instruments < 2) return;
    for (int k = 0; k < rod.instruments; ++k) add_turning(rod, line, trial, base, frames, k, turning);
}

namespace {

RodClamp sleeve_of(const RodView& line, const CoaxialBase& base)
{
    RodClamp clamp;
    clamp.node = line.n - 1;
    clamp.direction = clamp.spin = true;
    clamp.tangent = base.tangent;
    clamp.director = base.director;
    return clamp;
}

/// Data of one instrument on an edge before it is split.
struct OldSpin {
    double theta = 0, spin = 0, momentum = 0;
    double twist_rate[2] = {}, slope[2] = {};  // of angle [rad/m] and of spin along the line [1/(s m)], at both nodes

    OldSpin(const RodView& own, const RodView& line, const CoaxialRod& rod, int k, int a)
        : theta(own.theta[a]), spin(own.spin_rate[a]), momentum(own.spin_inertia[a] * own.spin_rate[a])
    {
        for (int side = 0; side < 2; ++side) {
            const int i = a + side;
            if (i == 0 || !(rod.cells[i].twist_covered[k] > 0)) continue;  // a free end, or beyond one
            const double cell = rod.cells[i].length;
            twist_rate[side] = (own.theta[i] - own.theta[i - 1] + joint_reference(line, i)) / cell;
            if (i < line.n - 1) slope[side] = (own.spin_rate[i] - own.spin_rate[i - 1]) / cell;
        }
    }
};

/// Curvature of the line's tip where nothing bends it, sum B_k R_k kappa_k / sum B_k, along the binormal (rod/coaxial.h) [1/m].
Vec3 natural_at_tip(RodArrays& rods, std::span<const int> wires, const CoaxialRod& rod)
{
    const RodView line = rods.view(wires[0]);
    const double s = line.material_s[0] + 0.25 * line.rest_length[0];  // the middle of the tip's half cell
    const Vec3 t = line.tangent(0);
    Vec3 moment = Vec3::Zero();
    double stiffness = 0;
    for (std::size_t k = 0; k < wires.size(); ++k) {
        const CoaxialInstrument& one = rod.instrument[k];
        const double material = s + one.offset;
        if (material < 0) continue;
        const WireSection& section = one.spec->at(std::min(material, one.spec->length));
        const Vec3 n1 = turned(line.ref_d1(0), t, rods.view(wires[k]).theta[0]);
        moment += section.bend_stiffness * (section.rest_curvature[0] * t.cross(n1) - section.rest_curvature[1] * n1);
        stiffness += section.bend_stiffness;
    }
    return stiffness > 0 ? Vec3(moment / stiffness) : Vec3::Zero();
}

/// Nodes from `first` on move along the material by `added`.
void move_hubwards(const RodView& line, int first, double added)
{
    for (int i = first; i < line.n; ++i) line.material_s[i] += added;
}

/// Rest length at which edge j, of about its present length, carries `force`. In a line that flies apart edges may be squeezed to
/// nothing or miles long; then lengths are kept, not forces.
double rest_under(const RodView& line, int j, double force)
{
    const double chord = (line.pos(j + 1) - line.pos(j)).norm();
    return std::clamp(chord / (1 + force / line.stretch_stiffness[j]), 0.5 * line.rest_length[j], 2 * line.rest_length[j]);
}

/// Angle and spins of both edges that edge a became. @param change  of the reference twists at their outer nodes [rad]
void split_spins(const RodView& own, const RodView& line, int a, const OldSpin& old, const std::array<double, 2>& change)
{
    const double first = line.rest_length[a], second = line.rest_length[a + 1];
    own.theta[a] = old.theta - 0.5 * old.twist_rate[0] * second - change[0];
    own.theta[a + 1] = old.theta + 0.5 * old.twist_rate[1] * first + change[1];
    own.spin_rate[a] = old.spin - 0.5 * old.slope[0] * second;
    own.spin_rate[a + 1] = old.spin + 0.5 * old.slope[1] * first;
    own.spin_acc[a + 1] = own.spin_acc[a];
    const double inertia_a = own.spin_inertia[a], inertia_b = own.spin_inertia[a + 1];
    if (!(inertia_a + inertia_b > 0)) return;
    const double now = inertia_a * own.spin_rate[a] + inertia_b * own.spin_rate[a + 1];
    const double shift = (old.momentum - now) / (inertia_a + inertia_b);
    own.spin_rate[a] += shift;
    own.spin_rate[a + 1] += shift;
}

}  // namespace

SplitResult split_coaxial_edge(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base, int edge,
                               double fraction)
{
    const int a = edge;
    RodView line = rods.view(wires[0]);
    SEL_ASSERT(edge >= 0 && edge < line.n - 1 && fraction > 0 && fraction < 1);
    const double length = line.rest_length[a], force = axial_force(line, a);
    const double strain_rate = line.tangent(a).dot(line.vel(a + 1) - line.vel(a)) / (line.pos(a + 1) - line.pos(a)).norm();
    const Vec3 tangent = line.tangent(a), d1 = line.ref_d1(a), carried = momentum(line, line.n - 1);
    const std::array<double, 2> reference = {joint_reference(line, a), joint_reference(line, a + 1)};
    std::vector<OldSpin> spins;
    for (std::size_t k = 0; k < wires.size(); ++k) spins.emplace_back(rods.view(wires[k]), line, rod, static_cast<int>(k), a);
    const RodClamp sleeve = sleeve_of(line, base);
    const Vec3 natural = a == 0 ? natural_at_tip(rods, wires, rod) : Vec3::Zero();
    const Vec3 position = split_point(line, a, fraction, {&sleeve, 1}, natural);

    for (const int w : wires) rods.insert_node(w, a + 1);
    line = rods.view(wires[0]);
    line.set_pos(a + 1, position);
    line.material_s[a + 1] = line.material_s[a] + fraction * length;
    prepare_group(rods, wires, rod);  // the stiffness of edges that are about as long
    const double first = rest_under(line, a, force), second = rest_under(line, a + 1, force), added = first + second - length;
    line.material_s[a + 1] = line.material_s[a] + first;
    move_hubwards(line, a + 2, added);
    prepare_group(rods, wires, rod);

    set_edge_frame(line, a, tangent, d1);
    set_edge_frame(line, a + 1, tangent, d1);
    line.clamp_twist_a[a + 1] = line.clamp_twist_b[a + 1] = 0;
    line.ref_twist[a + 1] = inner_reference(line, a + 1, 0);
    const std::array<double, 2> change = {refresh_reference(line, base, a, reference[0]),
                                          refresh_reference(line, base, a + 2, reference[1])};
    for (std::size_t k = 0; k < wires.size(); ++k) split_spins(rods.view(wires[k]), line, a, spins[k], change);
    for (const std::span<double> acc : {line.ax, line.ay, line.az}) acc[a + 1] = (1 - fraction) * acc[a] + fraction * acc[a + 2];
    line.set_vel(a + 1, split_velocity(line, a, fraction, strain_rate));
    set_momentum(line, line.n - 1, carried);
    follow_line(rods, wires);
    return {added};
}

SplitResult merge_coaxial_edges(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base, int node)
{
    RodView line = rods.view(wires[0]);
    const int a = node - 1;
    SEL_ASSERT(node >= 1 && node < line.n - 1);
    const double first = line.rest_length[a], second = line.rest_length[node], length = first + second;
    const double force = (first * axial_force(line, a) + second * axial_force(line, node)) / length;
    const double share = second / length;  // of the vanishing cell that falls to node a; the rest falls to the other one
    const Vec3 tangent = line.tangent(a), d1 = line.ref_d1(a), carried = momentum(line, line.n - 1);
    const double own_reference = line.ref_twist[node], at_a = joint_reference(line, a), at_b = joint_reference(line, node + 1);
    struct OldSpins {
        double twist, momentum;
    };
    std::vector<OldSpins> old;
    for (const int w : wires) {
        const RodView own = rods.view(w);
        const double momentum_of = own.spin_inertia[a] * own.spin_rate[a] + own.spin_inertia[node] * own.spin_rate[node];
        old.push_back({own.theta[node] - own.theta[a] + own_reference, momentum_of});
    }

    for (const int w : wires) rods.erase_node(w, node);
    line = rods.view(wires[0]);
    prepare_group(rods, wires, rod);  // the stiffness of an edge that is about as long
    const double added = rest_under(line, a, force) - length;
    move_hubwards(line, a + 1, added);
    prepare_group(rods, wires, rod);

    // the merged edge keeps the tip-side edge's director; angles are the mean of both, seen from there
    set_edge_frame(line, a, tangent, d1);
    const double change_a = refresh_reference(line, base, a, at_a);
    const double change_b = refresh_reference(line, base, a + 1, at_b + own_reference);
    const double halves = a > 0 ? 0.5 : 1;
    for (std::size_t k = 0; k < wires.size(); ++k) {
        const RodView own = rods.view(wires[k]);
        own.theta[a] += share * old[k].twist + halves * (change_b - change_a);
        own.spin_rate[a] = own.spin_inertia[a] > 0 ? old[k].momentum / own.spin_inertia[a] : 0.0;
    }
    set_momentum(line, line.n - 1, carried);
    follow_line(rods, wires);
    return {added};
}

}  // namespace seldinger
