// Splits and merges edges, and keeps forces and momentum of the wire.

#include "rod/split.h"

#include "core/check.h"
#include "rod/clamp.h"
#include "rod/rest_shape.h"
#include "rod/transport.h"

namespace seldinger {

namespace {

const RodClamp* find_clamp(std::span<const RodClamp> clamps, int node, bool RodClamp::*what)
{
    for (const RodClamp& clamp : clamps)
        if (clamp.node == node && clamp.*what) return &clamp;
    return nullptr;
}

/// Connection of an edge to the rest of the wire at one of its nodes: the edge beyond, a spin clamp, or nothing (a free end). With
/// side 0 the edge lies on the tip side of the node, with side 1 on its hub side. Indices are those at the time of use.
struct Joint {
    int node, side;
    const RodClamp* clamp;
    [[nodiscard]] bool inner(const RodView& rod) const { return node > 0 && node < rod.n - 1; }
    [[nodiscard]] bool holds(const RodView& rod) const { return clamp || inner(rod); }
    /// Reference twist stored for this joint [rad].
    [[nodiscard]] double& ref(const RodView& rod) const
    {
        return clamp ? (side == 0 ? rod.clamp_twist_a : rod.clamp_twist_b)[node] : rod.ref_twist[node];
    }
    /// That of the present tangents and directors, nearest to `last`.
    [[nodiscard]] double ref_now(const RodView& rod, double last) const
    {
        const int edge = node - 1 + side;
        if (clamp) return clamp_reference(*clamp, side, rod.tangent(edge), rod.ref_d1(edge), last);
        const Vec3 te = rod.tangent(node - 1), tf = rod.tangent(node);
        const Vec3 carried = parallel_transport(rod.ref_d1(node - 1), te, tf, one_plus_cos(te, tf));
        return unwrap(signed_angle(carried, rod.ref_d1(node), tf), last);
    }
    /// Twist per length at this joint [rad/m]; 0 at a free end, where there is no torque.
    [[nodiscard]] double twist_rate(const RodView& rod) const
    {
        if (!holds(rod)) return 0;
        if (!clamp) return (rod.theta[node] - rod.theta[node - 1] + ref(rod)) / rod.voronoi_length(node);
        const int edge = node - 1 + side;
        const double from_clamp = rod.theta[edge] - clamp->turns;
        return ((side == 0 ? -from_clamp : from_clamp) + ref(rod)) / (0.5 * rod.rest_length[edge]);
    }
    /// Change of a per-edge rate (spin) per length here [1/(s m)]; 0 where no edge follows.
    [[nodiscard]] double slope(const RodView& rod, std::span<const double> rate) const
    {
        return inner(rod) && !clamp ? (rate[node] - rate[node - 1]) / rod.voronoi_length(node) : 0;
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

Vec3 momentum(const RodView& rod, int first, int last)
{
    Vec3 sum = Vec3::Zero();
    for (int i = first; i <= last; ++i) sum += rod.mass[i] * rod.vel(i);
    return sum;
}

/// Common shift of the velocities of nodes first..last that gives them this momentum.
void set_momentum(const RodView& rod, int first, int last, const Vec3& wanted)
{
    double mass = 0;
    for (int i = first; i <= last; ++i) mass += rod.mass[i];
    const Vec3 shift = (wanted - momentum(rod, first, last)) / mass;
    for (int i = first; i <= last; ++i) rod.set_vel(i, rod.vel(i) + shift);
}

/// Rest quantities from node `first` to the hub, all of which material_s has changed for.
void refresh_rest(const RodView& rod, const WireSpec& spec, int first, bool keep_shape)
{
    for (int j = first; j < rod.n - 1; ++j) set_rest_edge(rod, spec, j);
    for (int i = first; i < rod.n; ++i) set_rest_node(rod, spec, i, keep_shape);
}

/// Tangent of edge j from its nodes, and a director carried to it from another tangent.
void set_edge_frame(const RodView& rod, int j, const Vec3& from, const Vec3& d1)
{
    const Vec3 t = (rod.pos(j + 1) - rod.pos(j)).normalized();
    rod.set_tangent(j, t);
    rod.set_ref_d1(j, unit_normal(parallel_transport(d1, from, t, one_plus_cos(from, t)), t));
}

/// Sets a joint's reference twist from the present frames. @return its change from `last` (holonomy) [rad]; 0 at a free end
double refresh_joint(const RodView& rod, const Joint& joint, double last)
{
    if (!joint.holds(rod)) return 0;
    joint.ref(rod) = joint.ref_now(rod, last);
    return joint.ref(rod) - last;
}

/// What an edge says before it is split.
struct OldEdge {
    double length, force;  // [m], [N]
    double strain_rate;    // [1/s]
    Vec3 tangent, d1;
    Vec3 momentum;  // of the whole wire
    double theta, spin, spin_acc, spin_momentum;
    double ref[2];                       // reference twist at the tip-side and the hub-side joint [rad]; 0 at a free end
    double twist_rate[2];                // at the same [rad/m]
    double spin_slope[2], acc_slope[2];  // change of spin and its rate along the wire, at the same
    double rest_rate[3][2];              // rest kappa1, kappa2, twist per length of its two nodes [1/m]

    OldEdge(const RodView& rod, int j, const Joint& at_a, const Joint& at_b)
        : length(rod.rest_length[j]),
          force(axial_force(rod, j)),
          strain_rate(rod.tangent(j).dot(rod.vel(j + 1) - rod.vel(j)) / (rod.pos(j + 1) - rod.pos(j)).norm()),
          tangent(rod.tangent(j)),
          d1(rod.ref_d1(j)),
          momentum(seldinger::momentum(rod, 0, rod.n - 1)),
          theta(rod.theta[j]),
          spin(rod.spin_rate[j]),
          spin_acc(rod.spin_acc[j]),
          spin_momentum(rod.spin_inertia[j] * rod.spin_rate[j])
    {
        const Joint* joints[2] = {&at_a, &at_b};
        for (int k = 0; k < 2; ++k) {
            ref[k] = joints[k]->holds(rod) ? joints[k]->ref(rod) : 0;
            twist_rate[k] = joints[k]->twist_rate(rod);
            spin_slope[k] = joints[k]->slope(rod, rod.spin_rate);
            acc_slope[k] = joints[k]->slope(rod, rod.spin_acc);
            const double cell = rod.voronoi_length(j + k);
            rest_rate[0][k] = rod.rest_kappa1[j + k] / cell;
            rest_rate[1][k] = rod.rest_kappa2[j + k] / cell;
            rest_rate[2][k] = rod.rest_twist[j + k] / cell;
        }
    }
};

/// material_s of the node at a+1 and of all hubwards, so that both new edges carry the old one's force; rest quantities.
/// @return rest length added [m]
double split_rest(const RodView& rod, int a, double fraction, const OldEdge& old, const WireSpec& spec, bool keep_shape)
{
    const double s = rod.material_s[a], mid = s + fraction * old.length;
    const auto rest = [&](int j, double begin, double end) {
        const double chord = (rod.pos(j + 1) - rod.pos(j)).norm(), was = end - begin;
        // of a wire that flies apart, edges may be squeezed to nothing or miles long: then lengths are kept, not forces
        return std::clamp(chord / (1 + old.force / edge_stretch_stiffness(spec, begin, end)), 0.5 * was, 2 * was);
    };
    const double first = rest(a, s, mid), second = rest(a + 1, mid, s + old.length);
    SEL_ASSERT(first > 0 && second > 0);
    const double added = first + second - old.length, moved = s + first + second - rod.material_s[a + 2];
    rod.material_s[a + 1] = s + first;
    for (int i = a + 2; i < rod.n; ++i) rod.material_s[i] += moved;
    refresh_rest(rod, spec, a, keep_shape);
    if (!keep_shape) return added;

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
void split_frames(const RodView& rod, int a, const OldEdge& old, const Joint& at_a, const Joint& at_b)
{
    set_edge_frame(rod, a, old.tangent, old.d1);
    set_edge_frame(rod, a + 1, old.tangent, old.d1);
    rod.ref_twist[a + 1] = Joint{a + 1, 1, nullptr}.ref_now(rod, 0);
    rod.clamp_twist_a[a + 1] = rod.clamp_twist_b[a + 1] = 0;
    rod.theta[a] = old.theta - 0.5 * old.twist_rate[0] * rod.rest_length[a + 1] - refresh_joint(rod, at_a, old.ref[0]);
    rod.theta[a + 1] = old.theta + 0.5 * old.twist_rate[1] * rod.rest_length[a] + refresh_joint(rod, at_b, old.ref[1]);
}

/// Spins and their rates, linear along the wire, with the old spin momentum.
void split_spin(const RodView& rod, int a, const OldEdge& old)
{
    const double first = rod.rest_length[a], second = rod.rest_length[a + 1];
    rod.spin_rate[a] = old.spin - 0.5 * old.spin_slope[0] * second;
    rod.spin_rate[a + 1] = old.spin + 0.5 * old.spin_slope[1] * first;
    rod.spin_acc[a] = old.spin_acc - 0.5 * old.acc_slope[0] * second;
    rod.spin_acc[a + 1] = old.spin_acc + 0.5 * old.acc_slope[1] * first;
    const double inertia_a = rod.spin_inertia[a], inertia_b = rod.spin_inertia[a + 1];
    const double now = inertia_a * rod.spin_rate[a] + inertia_b * rod.spin_rate[a + 1];
    const double shift = (old.spin_momentum - now) / (inertia_a + inertia_b);
    rod.spin_rate[a] += shift;
    rod.spin_rate[a + 1] += shift;
}

/// Velocities, spins and their rates, with the old momentum and spin momentum. What a polygon's momentum changes by, of the order
/// of (kappa h)^2 of one node's, goes to the whole wire as one: no edge is stretched by that.
void split_motion(const RodView& rod, int a, double fraction, const OldEdge& old)
{
    for (const std::span<double> acc : {rod.ax, rod.ay, rod.az}) acc[a + 1] = (1 - fraction) * acc[a] + fraction * acc[a + 2];
    rod.set_vel(a + 1, split_velocity(rod, a, fraction, old.strain_rate));
    set_momentum(rod, 0, rod.n - 1, old.momentum);
    split_spin(rod, a, old);
}

/// Rest curvature at the wire's end that edge j is at, along the binormal (signs of rod/pair.h); 0 of an edge inside [1/m].
Vec3 natural_at_end(const RodView& rod, int j)
{
    if (j > 0 && j + 2 < rod.n) return Vec3::Zero();
    const int end = j == 0 ? 0 : rod.n - 1;
    const Vec3 t = rod.tangent(j), n1 = turned(rod.ref_d1(j), t, rod.theta[j]);
    return (rod.rest_kappa1[end] * t.cross(n1) - rod.rest_kappa2[end] * n1) / rod.voronoi_length(end);
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

SplitResult split_edge(RodArrays& rods, int wire, int edge, double fraction, const WireSpec& spec,
                       std::span<const RodClamp> clamps, bool rest_is_placed)
{
    const RodView before = rods.view(wire);
    const int a = edge;
    SEL_ASSERT(edge >= 0 && edge < before.n - 1 && fraction > 0 && fraction < 1);
    const Joint at_a{a, 1, find_clamp(clamps, a, &RodClamp::spin)};
    Joint at_b{a + 1, 0, find_clamp(clamps, a + 1, &RodClamp::spin)};
    const OldEdge old(before, a, at_a, at_b);
    const Vec3 position = split_point(before, a, fraction, clamps, natural_at_end(before, a));

    rods.insert_node(wire, a + 1);
    at_b.node = a + 2;
    const RodView rod = rods.view(wire);
    rod.set_pos(a + 1, position);
    const double added = split_rest(rod, a, fraction, old, spec, rest_is_placed);
    split_frames(rod, a, old, at_a, at_b);
    split_motion(rod, a, fraction, old);
    return {added};
}

namespace {

/// Moves node m next to the hub sideways to where the elastic forces on it balance, all other nodes held, the edges' axial force
/// kept. What else acts on it, its share of weight and contact, is carried by a base edge of length l with an error of l times
/// that force in the clamp's moment. A chord's rotation changes the moments at both of its ends, which are linear in it but for
/// the cube of the angle: Newton with the stiffness of small angles.
void balance_born_node(const RodView& rod, double fraction, const OldEdge& old, const Joint& at_a, const Joint& at_b,
                       const WireSpec& spec, SplitScratch& scratch)
{
    constexpr int most_rounds = 12;
    constexpr double balanced = 1e-12;  // of the base edge's length
    const int m = rod.n - 2, a = m - 1;
    for (int round = 0; round < most_rounds; ++round) {
        (void)split_rest(rod, a, fraction, old, spec, false);
        split_frames(rod, a, old, at_a, at_b);  // a hub that has turned would twist a base edge that has not
        const RodTrial now{rod.x, rod.y, rod.z, rod.theta};
        if (!update_frames(rod, now, scratch.clamps, scratch.frames)) return;
        const std::span<double> gradient = std::span(scratch.gradient).first(static_cast<std::size_t>(RodDofs::count(rod.n)));
        std::fill(gradient.begin(), gradient.end(), 0.0);
        add_elastic(rod, scratch.clamps, scratch.frames, gradient, nullptr, HessianMode::None);
        const auto at = [&](int c) { return gradient[RodDofs::position(m, c)]; };
        const Vec3 shift = born_node_shift(rod, scratch.frames.tangent[m], Vec3(at(0), at(1), at(2)));
        rod.set_pos(m, rod.pos(m) - shift);
        if (shift.norm() < balanced * rod.rest_length[m]) break;
    }
}

/// Towards the tip along edge j.
Vec3 forwards(const RodView& rod, int j) { return (rod.pos(j) - rod.pos(j + 1)).normalized(); }

}  // namespace

Vec3 born_node_shift(const RodView& rod, const Vec3& tangent, const Vec3& gradient)
{
    const int m = rod.n - 2, a = m - 1;
    Vec3 pull = gradient;
    pull -= pull.dot(tangent) * tangent;
    const double inner = rod.rest_length[a], base = rod.rest_length[m], both = 1 / inner + 1 / base;
    const double stiffness = 2 * rod.bend_stiffness[m + 1] / (base * base * base) +
                             rod.bend_stiffness[m] / rod.voronoi_length(m) * both * both +
                             (a > 0 ? rod.bend_stiffness[a] / (rod.voronoi_length(a) * inner * inner) : 0.0);
    return pull / stiffness;
}

SplitResult split_base_edge(RodArrays& rods, int wire, double fraction, const WireSpec& spec, std::span<const RodClamp> clamps,
                            SplitScratch& scratch)
{
    const RodView before = rods.view(wire);
    const int a = before.n - 2;
    const RodClamp* sleeve = find_clamp(clamps, a + 1, &RodClamp::direction);
    SEL_ASSERT(sleeve && fraction > 0 && fraction < 1);
    const Joint at_a{a, 1, find_clamp(clamps, a, &RodClamp::spin)};
    Joint at_b{a + 1, 0, find_clamp(clamps, a + 1, &RodClamp::spin)};
    const OldEdge old(before, a, at_a, at_b);
    const Vec3 position = split_point(before, a, fraction, clamps, natural_at_end(before, a));
    scratch.provide(rods.capacity(wire));
    scratch.clamps.assign(clamps.begin(), clamps.end());
    for (RodClamp& clamp : scratch.clamps) clamp.node += clamp.node == a + 1;

    rods.insert_node(wire, a + 1);
    at_b.node = a + 2;
    const RodView rod = rods.view(wire);
    rod.set_pos(a + 1, position);
    balance_born_node(rod, fraction, old, at_a, at_b, spec, scratch);
    const double added = split_rest(rod, a, fraction, old, spec, false);
    split_frames(rod, a, old, at_a, at_b);
    split_spin(rod, a, old);
    for (const std::span<double> acc : {rod.ax, rod.ay, rod.az}) acc[a + 1] = (1 - fraction) * acc[a] + fraction * acc[a + 2];

    // the new node leaves the sleeve along the arc that its base edge is a chord of, as fast as the inner edge's length demands
    const Vec3 out = (2 * forwards(rod, a + 1) + sleeve->tangent).normalized(), inner = forwards(rod, a);
    const double speed = inner.dot(rod.vel(a)) / inner.dot(out);
    rod.set_vel(a + 1, speed * out);
    set_momentum(rod, 0, a + 1, old.momentum - rod.mass[a + 2] * rod.vel(a + 2));
    return {added, forwards(rod, a + 1).dot(rod.vel(a + 1))};
}

namespace {

/// merge_edges but for the velocities.
SplitResult merge_shape(RodArrays& rods, int wire, int node, const WireSpec& spec, std::span<const RodClamp> clamps,
                        bool rest_is_placed)
{
    const RodView old = rods.view(wire);
    const int a = node - 1;
    SEL_ASSERT(node >= 1 && node < old.n - 1);
    SEL_ASSERT(!find_clamp(clamps, node, &RodClamp::direction) && !find_clamp(clamps, node, &RodClamp::spin));

    const double first = old.rest_length[a], second = old.rest_length[node], length = first + second;
    const double share_a = second / length;  // of the vanishing cell that falls to node a; the rest falls to the other one
    const double force = (first * axial_force(old, a) + second * axial_force(old, node)) / length;
    const Vec3 tangent = old.tangent(a), d1 = old.ref_d1(a);
    const double spin_momentum = old.spin_inertia[a] * old.spin_rate[a] + old.spin_inertia[node] * old.spin_rate[node];
    const double spin_acc = (first * old.spin_acc[a] + second * old.spin_acc[node]) / length;
    const double ref = old.ref_twist[node], twist = old.theta[node] - old.theta[a] + ref;
    const double rests[3] = {old.rest_kappa1[node], old.rest_kappa2[node], old.rest_twist[node]};
    const Joint at_a{a, 1, find_clamp(clamps, a, &RodClamp::spin)};
    Joint at_b{a + 2, 0, find_clamp(clamps, a + 2, &RodClamp::spin)};

    rods.erase_node(wire, node);
    const RodView rod = rods.view(wire);
    at_b.node = a + 1;

    const double s = rod.material_s[a];
    const double chord = (rod.pos(a + 1) - rod.pos(a)).norm();
    const double merged = chord / (1 + force / edge_stretch_stiffness(spec, s, s + length));
    const double added = merged - length;
    for (int i = a + 1; i < rod.n; ++i) rod.material_s[i] += added;
    refresh_rest(rod, spec, a, rest_is_placed);
    if (rest_is_placed) {
        const std::span<double> values[3] = {rod.rest_kappa1, rod.rest_kappa2, rod.rest_twist};
        for (int k = 0; k < 3; ++k) {
            values[k][a] += share_a * rests[k];
            values[k][a + 1] += (1 - share_a) * rests[k];
        }
    }

    // the merged edge keeps the tip-side edge's director; its angle is the mean of both, seen from there
    set_edge_frame(rod, a, tangent, d1);
    // (changes: what the new tangent does to the reference twists, holonomy)
    const double change_a = refresh_joint(rod, at_a, at_a.ref(rod));
    const double change_b = refresh_joint(rod, at_b, at_b.ref(rod) + ref);
    const double halves = at_a.holds(rod) && at_b.holds(rod) ? 0.5 : 1;
    rod.theta[a] += share_a * twist + halves * (change_b - change_a);

    rod.spin_rate[a] = spin_momentum / rod.spin_inertia[a];
    rod.spin_acc[a] = spin_acc;
    return {added};
}

}  // namespace

SplitResult merge_edges(RodArrays& rods, int wire, int node, const WireSpec& spec, std::span<const RodClamp> clamps,
                        bool rest_is_placed)
{
    const Vec3 carried_momentum = momentum(rods.view(wire), 0, rods.node_count(wire) - 1);
    const SplitResult result = merge_shape(rods, wire, node, spec, clamps, rest_is_placed);
    const RodView rod = rods.view(wire);
    set_momentum(rod, 0, rod.n - 1, carried_momentum);
    return result;
}

SplitResult merge_base_edges(RodArrays& rods, int wire, const WireSpec& spec, std::span<const RodClamp> clamps)
{
    const int hub = rods.node_count(wire) - 1;
    const Vec3 carried_momentum = momentum(rods.view(wire), 0, hub);
    SplitResult result = merge_shape(rods, wire, hub - 1, spec, clamps, false);
    const RodView rod = rods.view(wire);
    set_momentum(rod, 0, rod.n - 2, carried_momentum - rod.mass[rod.n - 1] * rod.vel(rod.n - 1));
    result.base_rate = forwards(rod, rod.n - 2).dot(rod.vel(rod.n - 2));
    return result;
}

}  // namespace seldinger
