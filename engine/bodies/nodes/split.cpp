// Splits and merges edges, and keeps forces and momentum of the rod.
#include "nodes/split.h"

#include "core/check.h"
#include "rod/clamp.h"
#include "rod/rest_shape.h"
#include "rod/transport.h"

#include <algorithm>

namespace seldinger {

RodNodes::RodNodes(RodArrays& rods, std::span<const int> wires, std::span<const RodClamp> clamps, bool rest_is_placed)
    : rods_(rods), count_(static_cast<int>(wires.size())), clamps_(clamps), rest_is_placed_(rest_is_placed)
{
    SEL_ASSERT(count_ >= 1 && count_ <= most_coaxial);
    std::ranges::copy(wires, wires_.begin());
}

namespace {

const RodClamp* find_clamp(std::span<const RodClamp> clamps, int node, bool RodClamp::*what)
{
    for (const RodClamp& clamp : clamps)
        if (clamp.node == node && clamp.*what) return &clamp;
    return nullptr;
}

}  // namespace

const RodClamp* RodNodes::clamp(int node, bool RodClamp::*what) const { return find_clamp(clamps_, node, what); }

void RodNodes::insert_node(int index) const
{
    for (int k = 0; k < count_; ++k) rods_.insert_node(wires_[k], index);
}

void RodNodes::erase_node(int index) const
{
    for (int k = 0; k < count_; ++k) rods_.erase_node(wires_[k], index);
}

double WireNodes::stretch_stiffness(double begin, double end) const { return edge_stretch_stiffness(spec_, begin, end); }

void WireNodes::refresh_rest(int first) const
{
    const RodView rod = line();
    for (int j = first; j < rod.n - 1; ++j) set_rest_edge(rod, spec_, j);
    for (int i = first; i < rod.n; ++i) set_rest_node(rod, spec_, i, rest_is_placed_);
}

Vec3 WireNodes::natural_at_end(int j) const
{
    const RodView rod = line();
    if (j > 0 && j + 2 < rod.n) return Vec3::Zero();
    const int end = j == 0 ? 0 : rod.n - 1;
    const Vec3 t = rod.tangent(j), n1 = turned(rod.ref_d1(j), t, rod.theta[j]);
    return (rod.rest_kappa1[end] * t.cross(n1) - rod.rest_kappa2[end] * n1) / rod.voronoi_length(end);
}

bool WireNodes::pull_at_base(SplitScratch& scratch, Vec3& pull, Vec3& tangent) const
{
    const RodView rod = line();
    const int m = rod.n - 2;
    scratch.clamps.assign(clamps_.begin(), clamps_.end());
    for (RodClamp& clamp : scratch.clamps) clamp.node += clamp.node == m;  // the hub's, which was the last node
    if (!update_frames(rod, {rod.x, rod.y, rod.z, rod.theta}, scratch.clamps, scratch.frames)) return false;
    const std::span<double> gradient = std::span(scratch.gradient).first(static_cast<std::size_t>(RodDofs::count(rod.n)));
    std::fill(gradient.begin(), gradient.end(), 0.0);
    add_elastic(rod, scratch.clamps, scratch.frames, gradient, nullptr, HessianMode::None);
    for (int c = 0; c < 3; ++c) pull[c] = gradient[RodDofs::position(m, c)];
    tangent = scratch.frames.tangent[m];
    return true;
}

namespace {

/// Connection of an edge to the rest of the rod at one of its nodes: the edge beyond, a spin clamp, or nothing (a free end). With
/// side 0 the edge lies on the tip side of the node, with side 1 on its hub side. Indices are those at the time of use.
struct Joint {
    int node, side;
    const RodClamp* clamp;
    [[nodiscard]] bool inner(const RodView& line) const { return node > 0 && node < line.n - 1; }
    [[nodiscard]] bool holds(const RodView& line) const { return clamp || inner(line); }
    /// Reference twist stored for this joint [rad].
    [[nodiscard]] double& ref(const RodView& line) const
    {
        return clamp ? (side == 0 ? line.clamp_twist_a : line.clamp_twist_b)[node] : line.ref_twist[node];
    }
    /// That of the present tangents and directors, nearest to `last`.
    [[nodiscard]] double ref_now(const RodView& line, double last) const
    {
        const int edge = node - 1 + side;
        if (clamp) return clamp_reference(*clamp, side, line.tangent(edge), line.ref_d1(edge), last);
        const Vec3 te = line.tangent(node - 1), tf = line.tangent(node);
        const Vec3 carried = parallel_transport(line.ref_d1(node - 1), te, tf, one_plus_cos(te, tf));
        return unwrap(signed_angle(carried, line.ref_d1(node), tf), last);
    }
    /// Twist of instrument k per length at this joint [rad/m]; 0 at a free end, where there is no torque.
    [[nodiscard]] double twist_rate(const RodNodes& rod, int k) const
    {
        const RodView line = rod.line(), own = rod.instrument(k);
        if (!holds(line) || !rod.reaches(k, node)) return 0;
        if (!clamp) return (own.theta[node] - own.theta[node - 1] + ref(line)) / line.voronoi_length(node);
        const int edge = node - 1 + side;
        const double from_clamp = own.theta[edge] - rod.clamp_angle(*clamp, k);
        return ((side == 0 ? -from_clamp : from_clamp) + ref(line)) / (0.5 * line.rest_length[edge]);
    }
    /// Change of a rate per edge (spin) of instrument k per length here [1/(s m)]; 0 where no edge follows.
    [[nodiscard]] double slope(const RodNodes& rod, int k, std::span<double> RodView::*rate) const
    {
        const RodView line = rod.line();
        if (clamp || !inner(line) || !rod.reaches(k, node)) return 0;
        const std::span<double> of = rod.instrument(k).*rate;
        return (of[node] - of[node - 1]) / line.voronoi_length(node);
    }
};

double axial_force(const RodView& rod, int j)
{
    return rod.stretch_stiffness[j] * ((rod.pos(j + 1) - rod.pos(j)).norm() / rod.rest_length[j] - 1);
}

/// Tangent at inner node i of the parabola through it and its neighbours.
Vec3 parabola_tangent(const RodView& rod, int i)
{
    const Vec3 e = rod.pos(i) - rod.pos(i - 1), f = rod.pos(i + 1) - rod.pos(i);
    const double le = e.norm(), lf = f.norm();
    return ((lf / le) * e + (le / lf) * f).normalized();
}

/// Momentum of nodes 0 to `last` [N s].
Vec3 momentum(const RodView& rod, int last)
{
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i <= last; ++i) sum += rod.mass[i] * rod.vel(i);
    return sum;
}

/// Common shift of the velocities of nodes 0 to `last` that gives them this momentum.
void set_momentum(const RodView& rod, int last, const Vec3& wanted)
{
    double mass = 0;
    for (int i = 0; i <= last; ++i) mass += rod.mass[i];
    const Vec3 shift = (wanted - momentum(rod, last)) / mass;
    for (int i = 0; i <= last; ++i) rod.set_vel(i, rod.vel(i) + shift);
}

/// Tangent of edge j from its nodes, and a director carried to it from another tangent.
void set_edge_frame(const RodView& rod, int j, const Vec3& from, const Vec3& d1)
{
    const Vec3 t = (rod.pos(j + 1) - rod.pos(j)).normalized();
    rod.set_tangent(j, t);
    rod.set_ref_d1(j, unit_normal(parallel_transport(d1, from, t, one_plus_cos(from, t)), t));
}

/// Sets a joint's reference twist from the present frames. @return its change from `last` (holonomy) [rad]; 0 at a free end
double refresh_joint(const RodView& line, const Joint& joint, double last)
{
    if (!joint.holds(line)) return 0;
    joint.ref(line) = joint.ref_now(line, last);
    return joint.ref(line) - last;
}

/// Rest length at which the material in [begin, end] carries `force` along edge j. In a rod that flies apart edges may be
/// squeezed to nothing or miles long; then lengths are kept, not forces.
double rest_under(const RodNodes& rod, int j, double begin, double end, double force)
{
    const RodView line = rod.line();
    const double chord = (line.pos(j + 1) - line.pos(j)).norm(), length = end - begin;
    return std::clamp(chord / (1 + force / rod.stretch_stiffness(begin, end)), 0.5 * length, 2 * length);
}

/// What an edge says of one instrument before it is split.
struct OldSpin {
    double theta, spin, spin_acc, spin_momentum;
    double twist_rate[2];                // at the tip-side and the hub-side joint [rad/m]
    double spin_slope[2], acc_slope[2];  // change of spin and its rate along the rod, at the same
};

/// What an edge says before it is split.
struct OldEdge {
    double length, force;  // [m], [N]
    double strain_rate;    // [1/s]
    Vec3 tangent, d1;
    Vec3 momentum;  // of the whole rod
    double ref[2];  // reference twist at the tip-side and the hub-side joint [rad]; 0 at a free end
    double rest_rate[3][2];  // rest kappa1, kappa2, twist per length of its two nodes [1/m]
    std::array<OldSpin, most_coaxial> spins;

    OldEdge(const RodNodes& nodes, int j, const Joint& at_a, const Joint& at_b)
    {
        const RodView rod = nodes.line();
        length = rod.rest_length[j];
        force = axial_force(rod, j);
        strain_rate = rod.tangent(j).dot(rod.vel(j + 1) - rod.vel(j)) / (rod.pos(j + 1) - rod.pos(j)).norm();
        tangent = rod.tangent(j), d1 = rod.ref_d1(j);
        momentum = seldinger::momentum(rod, rod.n - 1);
        const Joint* joints[2] = {&at_a, &at_b};
        for (int side = 0; side < 2; ++side) {
            ref[side] = joints[side]->holds(rod) ? joints[side]->ref(rod) : 0;
            const double cell = rod.voronoi_length(j + side);
            rest_rate[0][side] = rod.rest_kappa1[j + side] / cell;
            rest_rate[1][side] = rod.rest_kappa2[j + side] / cell;
            rest_rate[2][side] = rod.rest_twist[j + side] / cell;
        }
        for (int k = 0; k < nodes.instruments(); ++k) {
            const RodView own = nodes.instrument(k);
            OldSpin& old = spins[k];
            old.theta = own.theta[j], old.spin = own.spin_rate[j], old.spin_acc = own.spin_acc[j];
            old.spin_momentum = own.spin_inertia[j] * own.spin_rate[j];
            for (int side = 0; side < 2; ++side) {
                old.twist_rate[side] = joints[side]->twist_rate(nodes, k);
                old.spin_slope[side] = joints[side]->slope(nodes, k, &RodView::spin_rate);
                old.acc_slope[side] = joints[side]->slope(nodes, k, &RodView::spin_acc);
            }
        }
    }
};

/// material_s of the node at a+1 and of all hubwards, so that both new edges carry the old one's force; rest quantities.
/// @return rest length added [m]
double split_rest(const RodNodes& nodes, int a, double fraction, const OldEdge& old)
{
    const RodView rod = nodes.line();
    const double s = rod.material_s[a], mid = s + fraction * old.length;
    const double first = rest_under(nodes, a, s, mid, old.force),
                 second = rest_under(nodes, a + 1, mid, s + old.length, old.force);
    SEL_ASSERT(first > 0 && second > 0);
    const double added = first + second - old.length, moved = s + first + second - rod.material_s[a + 2];
    rod.material_s[a + 1] = s + first;
    for (int i = a + 2; i < rod.n; ++i) rod.material_s[i] += moved;
    nodes.refresh_rest(a);
    if (!nodes.rest_is_placed()) return added;

    const std::span<double> values[3] = {rod.rest_kappa1, rod.rest_kappa2, rod.rest_twist};
    for (int k = 0; k < 3; ++k) {  // shared out over three cells
        const double at_a = old.rest_rate[k][0], at_b = old.rest_rate[k][1];
        values[k][a] -= 0.5 * at_a * second;
        values[k][a + 1] = 0.5 * (at_a * second + at_b * first);
        values[k][a + 2] -= 0.5 * at_b * first;
    }
    return added;
}

/// Directors carried from the old edge's; angles that keep the twist per length at both neighbours. May be called again when the
/// node between has moved.
void split_frames(const RodNodes& nodes, int a, const OldEdge& old, const Joint& at_a, const Joint& at_b)
{
    const RodView line = nodes.line();
    set_edge_frame(line, a, old.tangent, old.d1);
    set_edge_frame(line, a + 1, old.tangent, old.d1);
    line.ref_twist[a + 1] = Joint{a + 1, 1, nullptr}.ref_now(line, 0);
    line.clamp_twist_a[a + 1] = line.clamp_twist_b[a + 1] = 0;
    const double change_a = refresh_joint(line, at_a, old.ref[0]), change_b = refresh_joint(line, at_b, old.ref[1]);
    for (int k = 0; k < nodes.instruments(); ++k) {
        const std::span<double> theta = nodes.instrument(k).theta;
        const OldSpin& was = old.spins[k];
        theta[a] = was.theta - 0.5 * was.twist_rate[0] * line.rest_length[a + 1] - change_a;
        theta[a + 1] = was.theta + 0.5 * was.twist_rate[1] * line.rest_length[a] + change_b;
    }
}

/// Spins of an instrument and their rates, linear along the rod, with the old spin momentum.
void split_spin(const RodView& line, const RodView& own, int a, const OldSpin& old)
{
    const double first = line.rest_length[a], second = line.rest_length[a + 1];
    own.spin_rate[a] = old.spin - 0.5 * old.spin_slope[0] * second;
    own.spin_rate[a + 1] = old.spin + 0.5 * old.spin_slope[1] * first;
    own.spin_acc[a] = old.spin_acc - 0.5 * old.acc_slope[0] * second;
    own.spin_acc[a + 1] = old.spin_acc + 0.5 * old.acc_slope[1] * first;
    const double inertia_a = own.spin_inertia[a], inertia_b = own.spin_inertia[a + 1];
    if (!(inertia_a + inertia_b > 0)) return;  // it does not reach so far
    const double now = inertia_a * own.spin_rate[a] + inertia_b * own.spin_rate[a + 1];
    const double shift = (old.spin_momentum - now) / (inertia_a + inertia_b);
    own.spin_rate[a] += shift;
    own.spin_rate[a + 1] += shift;
}

/// All but the velocities of the nodes.
void split_spins(const RodNodes& nodes, int a, double fraction, const OldEdge& old)
{
    const RodView line = nodes.line();
    for (const std::span<double> acc : {line.ax, line.ay, line.az}) acc[a + 1] = (1 - fraction) * acc[a] + fraction * acc[a + 2];
    for (int k = 0; k < nodes.instruments(); ++k) split_spin(line, nodes.instrument(k), a, old.spins[k]);
}

/// Velocity of the new node a+1: linear along the rod, and what both new edges ask for if they are to be stretched as fast as
/// the old one was [1/s]. A polygon that bends while it slides along itself does not move linearly between two nodes. Axial
/// forces answer the difference v (kappa h)^2/8 with the impedance sqrt(EA rho A): tenths of a millinewton at some centimetres a
/// second.
Vec3 split_velocity(const RodView& rod, int a, double fraction, double strain_rate)
{
    const Vec3 va = rod.vel(a), vb = rod.vel(a + 2), linear = (1 - fraction) * va + fraction * vb;
    const Vec3 first = rod.pos(a + 1) - rod.pos(a), second = rod.pos(a + 2) - rod.pos(a + 1);
    const Vec3 e = first.normalized(), f = second.normalized();
    const double from_a = strain_rate * first.norm() - e.dot(linear - va);
    const double from_b = f.dot(vb - linear) - strain_rate * second.norm();
    const Vec3 across = e - f;  // normal to the bisector of both edges
    const Vec3 along = e + f;
    Vec3 change = (from_a + from_b) / along.squaredNorm() * along;
    if (across.squaredNorm() > 1e-12) change += (from_a - from_b) / across.squaredNorm() * across;
    return linear + change;
}

}  // namespace

Vec3 split_point(const RodView& rod, int j, double u, std::span<const RodClamp> clamps, const Vec3& natural)
{
    const Vec3 xa = rod.pos(j), xb = rod.pos(j + 1);
    const double length = (xb - xa).norm();
    const Vec3 chord = (xb - xa) / length;
    const RodClamp* at_a = find_clamp(clamps, j, &RodClamp::direction);
    const RodClamp* at_b = find_clamp(clamps, j + 1, &RodClamp::direction);
    const bool known_a = at_a || j > 0, known_b = at_b || j + 2 < rod.n;
    Vec3 ta = at_a ? at_a->tangent : known_a ? parabola_tangent(rod, j) : chord;
    Vec3 tb = at_b ? at_b->tangent : known_b ? parabola_tangent(rod, j + 1) : chord;
    // A free or hinged end carries no moment: the cubic's second derivative is natural curvature there, L^2 k x t = 6 L chord -
    // 4 L ta - 2 L tb. Without it the new node is k L^2/32 off, and bends by a quarter of k too little, however short the edge.
    const Vec3 sag = 0.25 * length * natural.cross(chord);
    if (!known_a) ta = known_b ? Vec3(1.5 * chord - 0.5 * tb - sag) : chord;
    if (!known_b) tb = known_a ? Vec3(1.5 * chord - 0.5 * ta + sag) : chord;

    // speed that puts the middle of a circular arc on the circle: chord / cos^2(angle/4)
    const double speed = length * 2 / (1 + 0.5 * (ta + tb).norm());
    const double u2 = u * u, v = 1 - u;
    return (v * v * (1 + 2 * u)) * xa + (u2 * (1 + 2 * v)) * xb + (speed * u * v) * (v * ta - u * tb);
}

SplitResult split_edge(const RodNodes& rod, int edge, double fraction)
{
    const int a = edge;
    SEL_ASSERT(edge >= 0 && edge < rod.line().n - 1 && fraction > 0 && fraction < 1);
    const Joint at_a{a, 1, rod.clamp(a, &RodClamp::spin)};
    Joint at_b{a + 1, 0, rod.clamp(a + 1, &RodClamp::spin)};
    const OldEdge old(rod, a, at_a, at_b);
    const Vec3 position = split_point(rod.line(), a, fraction, rod.clamps(), rod.natural_at_end(a));

    rod.insert_node(a + 1);
    at_b.node = a + 2;
    const RodView line = rod.line();
    line.set_pos(a + 1, position);
    const double added = split_rest(rod, a, fraction, old);
    split_frames(rod, a, old, at_a, at_b);
    // What a polygon's momentum changes by, of the order of (kappa h)^2 of one node's, goes to the whole rod as one: no edge is
    // stretched by that.
    line.set_vel(a + 1, split_velocity(line, a, fraction, old.strain_rate));
    set_momentum(line, line.n - 1, old.momentum);
    split_spins(rod, a, fraction, old);
    rod.follow_line();
    return {added};
}

namespace {

/// By how much the node next to the hub is to move across `tangent`, of the base edge, where elastic forces pull it: by the
/// bending stiffness of small turns there.
Vec3 born_node_shift(const RodView& rod, const Vec3& tangent, Vec3 pull)
{
    const int m = rod.n - 2, a = m - 1;
    pull -= pull.dot(tangent) * tangent;
    const double inner = rod.rest_length[a], base = rod.rest_length[m], both = 1 / inner + 1 / base;
    const double stiffness = 2 * rod.bend_stiffness[m + 1] / (base * base * base) +
                             rod.bend_stiffness[m] / rod.voronoi_length(m) * both * both +
                             (a > 0 ? rod.bend_stiffness[a] / (rod.voronoi_length(a) * inner * inner) : 0.0);
    return pull / stiffness;
}

/// Moves node m next to the hub sideways to where the elastic forces on it balance, all other nodes held, the edges' axial force
/// kept. What else acts on it, its share of weight and contact, is carried by a base edge of length l with an error of l times
/// that force in the clamp's moment. A chord's rotation changes the moments at both of its ends, which are linear in it but for
/// the cube of the angle: Newton with the stiffness of small angles.
void balance_born_node(const RodNodes& rod, double fraction, const OldEdge& old, const Joint& at_a, const Joint& at_b,
                       SplitScratch& scratch)
{
    constexpr int most_rounds = 12;
    constexpr double balanced = 1e-12;  // of the base edge's length
    const RodView line = rod.line();
    const int m = line.n - 2, a = m - 1;
    for (int round = 0; round < most_rounds; ++round) {
        (void)split_rest(rod, a, fraction, old);
        split_frames(rod, a, old, at_a, at_b);  // a hub that has turned would twist a base edge that has not
        Vec3 pull, tangent;
        if (!rod.pull_at_base(scratch, pull, tangent)) return;
        const Vec3 shift = born_node_shift(line, tangent, pull);
        line.set_pos(m, line.pos(m) - shift);
        if (shift.norm() < balanced * line.rest_length[m]) break;
    }
}

/// Towards the tip along edge j.
Vec3 forwards(const RodView& rod, int j) { return (rod.pos(j) - rod.pos(j + 1)).normalized(); }

}  // namespace

SplitResult split_base_edge(const RodNodes& rod, double fraction, SplitScratch& scratch)
{
    const int a = rod.line().n - 2;
    const RodClamp* sleeve = rod.clamp(a + 1, &RodClamp::direction);
    SEL_ASSERT(sleeve && fraction > 0 && fraction < 1);
    const Joint at_a{a, 1, rod.clamp(a, &RodClamp::spin)};
    Joint at_b{a + 1, 0, rod.clamp(a + 1, &RodClamp::spin)};
    const OldEdge old(rod, a, at_a, at_b);
    const Vec3 position = split_point(rod.line(), a, fraction, rod.clamps(), rod.natural_at_end(a));
    scratch.provide(rod.capacity());

    rod.insert_node(a + 1);
    at_b.node = a + 2;
    const RodView line = rod.line();
    line.set_pos(a + 1, position);
    balance_born_node(rod, fraction, old, at_a, at_b, scratch);
    const double added = split_rest(rod, a, fraction, old);
    split_frames(rod, a, old, at_a, at_b);
    split_spins(rod, a, fraction, old);

    // the new node leaves the sleeve along the arc that its base edge is a chord of, as fast as the inner edge's length demands
    const Vec3 out = (2 * forwards(line, a + 1) + sleeve->tangent).normalized(), inner = forwards(line, a);
    const double speed = inner.dot(line.vel(a)) / inner.dot(out);
    line.set_vel(a + 1, speed * out);
    set_momentum(line, a + 1, old.momentum - line.mass[a + 2] * line.vel(a + 2));
    rod.follow_line();
    return {added, forwards(line, a + 1).dot(line.vel(a + 1))};
}

namespace {

/// What two edges say of one instrument before they are merged.
struct OldSpins {
    double twist, spin_momentum, spin_acc;  // twist: from one edge to the other
};

/// merge_edges but for the velocities.
SplitResult merge_shape(const RodNodes& nodes, int node)
{
    const RodView before = nodes.line();
    const int a = node - 1;
    SEL_ASSERT(node >= 1 && node < before.n - 1);
    SEL_ASSERT(!nodes.clamp(node, &RodClamp::direction) && !nodes.clamp(node, &RodClamp::spin));

    const double first = before.rest_length[a], second = before.rest_length[node], length = first + second;
    const double share_a = second / length;  // of the vanishing cell that falls to node a; the rest falls to the other one
    const double force = (first * axial_force(before, a) + second * axial_force(before, node)) / length;
    const Vec3 tangent = before.tangent(a), d1 = before.ref_d1(a);
    const double ref = before.ref_twist[node];
    const double rests[3] = {before.rest_kappa1[node], before.rest_kappa2[node], before.rest_twist[node]};
    std::array<OldSpins, most_coaxial> spins;
    for (int k = 0; k < nodes.instruments(); ++k) {
        const RodView own = nodes.instrument(k);
        spins[k].twist = own.theta[node] - own.theta[a] + ref;
        spins[k].spin_momentum = own.spin_inertia[a] * own.spin_rate[a] + own.spin_inertia[node] * own.spin_rate[node];
        spins[k].spin_acc = (first * own.spin_acc[a] + second * own.spin_acc[node]) / length;
    }
    const Joint at_a{a, 1, nodes.clamp(a, &RodClamp::spin)};
    Joint at_b{a + 2, 0, nodes.clamp(a + 2, &RodClamp::spin)};

    nodes.erase_node(node);
    at_b.node = a + 1;
    const RodView line = nodes.line();
    const double s = line.material_s[a], added = rest_under(nodes, a, s, s + length, force) - length;
    for (int i = a + 1; i < line.n; ++i) line.material_s[i] += added;
    nodes.refresh_rest(a);
    if (nodes.rest_is_placed()) {
        const std::span<double> values[3] = {line.rest_kappa1, line.rest_kappa2, line.rest_twist};
        for (int k = 0; k < 3; ++k) {
            values[k][a] += share_a * rests[k];
            values[k][a + 1] += (1 - share_a) * rests[k];
        }
    }

    // the merged edge keeps the tip-side edge's director; its angle is the mean of both, seen from there
    set_edge_frame(line, a, tangent, d1);
    // (changes: what the new tangent does to the reference twists, holonomy)
    const double change_a = refresh_joint(line, at_a, at_a.ref(line));
    const double change_b = refresh_joint(line, at_b, at_b.ref(line) + ref);
    const double halves = at_a.holds(line) && at_b.holds(line) ? 0.5 : 1;
    for (int k = 0; k < nodes.instruments(); ++k) {
        const RodView own = nodes.instrument(k);
        own.theta[a] += share_a * spins[k].twist + halves * (change_b - change_a);
        own.spin_rate[a] = own.spin_inertia[a] > 0 ? spins[k].spin_momentum / own.spin_inertia[a] : 0.0;
        own.spin_acc[a] = spins[k].spin_acc;
    }
    return {added};
}

}  // namespace

SplitResult merge_edges(const RodNodes& rod, int node)
{
    const Vec3 carried_momentum = momentum(rod.line(), rod.line().n - 1);
    const SplitResult result = merge_shape(rod, node);
    set_momentum(rod.line(), rod.line().n - 1, carried_momentum);
    rod.follow_line();
    return result;
}

SplitResult merge_base_edges(const RodNodes& rod)
{
    const int hub = rod.line().n - 1;
    const Vec3 carried_momentum = momentum(rod.line(), hub);
    SplitResult result = merge_shape(rod, hub - 1);
    const RodView line = rod.line();
    set_momentum(line, line.n - 2, carried_momentum - line.mass[line.n - 1] * line.vel(line.n - 1));
    result.base_rate = forwards(line, line.n - 2).dot(line.vel(line.n - 2));
    rod.follow_line();
    return result;
}

}  // namespace seldinger
