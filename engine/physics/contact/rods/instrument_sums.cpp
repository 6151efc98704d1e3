// Forces and tangents of contact between instruments, summed over the cells of a system.
#include "contact/rods/instrument_sums.h"

#include "math/node_lanes.h"
#include "shared/spline.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {
namespace {

constexpr int per_node = RodDofs::per_node;
using Vector = InstrumentSums::Vector;

/// Adds +- w_k v at the three nodes of a side.
void add_side(Vector& to, int from, double sign, const double* w, const double* v)
{
    for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) to[from + per_node * k + c] += sign * w[k] * v[c];
}

/// The spin at a place of derivative d.
void put_spin(Vector& to, int from, const double* d, double spin)
{
    to[from + RodDofs::spin_place] = first_spin(d) * spin;
    to[from + per_node + RodDofs::spin_place] = second_spin(d) * spin;
}

/// How the gap at a point changes with the nodes.
template <class Place>
Vector gap_gradient(const Place& p)
{
    Vector g{};
    add_side(g, 0, 1, p.wa, p.n);
    add_side(g, InstrumentSums::side, -1, p.wb, p.n);
    add_side(g, InstrumentSums::side, 1, p.db, p.turn);
    return g;
}

Vector row_of(const InstrumentForce& f, const InstrumentRow& row)
{
    Vector r{};
    add_side(r, 0, 1, f.wa, row.v);
    add_side(r, 0, 1, f.da, row.turn_a);
    add_side(r, InstrumentSums::side, -1, f.wb, row.v);
    add_side(r, InstrumentSums::side, -1, f.db, row.turn_b);
    put_spin(r, 0, f.da, row.spin_a);
    put_spin(r, InstrumentSums::side, f.db, -row.spin_b);
    return r;
}

/// Where on its piece of the curve a place is, 0 to 1, from its weights (kernels/shared/spline.h): a straight end has two.
double place_of(const double* w) { return w[2] == 0 ? w[1] : w[0] == 0 ? w[2] : std::sqrt(2 * w[2]); }

/// Weights of the curve's derivative there.
std::array<double, 3> derivative_of(const double* w)
{
    if (w[2] == 0) return {-1, 1, 0};
    if (w[0] == 0) return {0, -1, 1};
    const double t = place_of(w);
    return {t - 1, 1 - 2 * t, t};
}

/// The weights w of a place of derivative d moved to a point's: linear in the way where both are on one piece of the curve.
std::array<double, 3> moved_to(const double* at_point, const double* w, const double* d, bool same_nodes)
{
    std::array<double, 3> moved;
    const bool one_piece = same_nodes && (w[0] == 0) == (at_point[0] == 0) && (w[2] == 0) == (at_point[2] == 0);
    const double way = one_piece ? place_of(at_point) - place_of(w) : 0;
    for (int k = 0; k < 3; ++k) moved[k] = one_piece ? w[k] + way * d[k] : at_point[k];
    return moved;
}

/// The row along the slip, as if friction acted at one of the points that push.
Vector along_beside(const InstrumentForce& f, const InstrumentPoint& p)
{
    const InstrumentRow& row = f.along;
    const auto wa = moved_to(p.wa, f.wa, f.da, f.node_a == p.node_a), wb = moved_to(p.wb, f.wb, f.db, f.node_b == p.node_b);
    Vector r{};
    const auto da = derivative_of(p.wa);
    add_side(r, 0, 1, wa.data(), row.v);
    add_side(r, 0, 1, da.data(), row.turn_a);
    add_side(r, InstrumentSums::side, -1, wb.data(), row.v);
    add_side(r, InstrumentSums::side, -1, p.db, row.turn_b);
    put_spin(r, 0, da.data(), row.spin_a);
    put_spin(r, InstrumentSums::side, p.db, -row.spin_b);
    return r;
}

void add_outer_product(double (&to)[InstrumentSums::size][InstrumentSums::size], double s, const Vector& u, const Vector& v)
{
    if (s == 0) return;
    for (int i = 0; i < InstrumentSums::size; ++i) {
        const double su = s * u[i];
        if (su == 0) continue;
        for (int j = 0; j < InstrumentSums::size; j += per_node) {
            Vec4d row;
            read_block(&v[j], row);
            block(&to[i][j]) += su * row;
        }
    }
}

/// What sliding friction does as the normal force N_k at one point changes. Friction mu sum N_k acts at the middle of the
/// contact, s = sum N_k s_k / sum N_k: with r(s) its row along the slip the change is
///   mu (r dN + r' (d(sum N_k s_k) - s dN)) = mu sum r(s_k) dN_k,     r(s_k) = r + (s_k - s) r',     dN_k = -slope_k g_k.
void add_load(double (&to)[InstrumentSums::size][InstrumentSums::size], const InstrumentForce& f, const InstrumentPoint& p)
{
    const double share = f.slope_sum > 0 ? p.slope / f.slope_sum : 0;
    add_outer_product(to, -f.skew * share, along_beside(f, p), gap_gradient(p));
}

/// A 3x3 matrix by rows that are as long as a node's unknowns; nothing of the spin.
struct Rows3 {
    Vec4d r[3];
    friend Rows3 operator*(double s, const Rows3& m) { return {{s * m.r[0], s * m.r[1], s * m.r[2]}}; }
    friend Rows3 operator+(const Rows3& a, const Rows3& b) { return {{a.r[0] + b.r[0], a.r[1] + b.r[1], a.r[2] + b.r[2]}}; }
};

/// s u v^T + t p q^T
Rows3 two_products(double s, const double* u, const double* v, double t, const double* p, const double* q)
{
    const Vec4d along = {v[0], v[1], v[2], 0}, across = {q[0], q[1], q[2], 0};
    Rows3 m;
    for (int c = 0; c < 3; ++c) m.r[c] = s * u[c] * along + t * p[c] * across;
    return m;
}

void add_rows(double (&to)[InstrumentSums::size][InstrumentSums::size], int row, int col, const Rows3& m)
{
    for (int c = 0; c < 3; ++c) block(&to[row + c][col]) += m.r[c];
}

/// K = slope g g^T - force (d2 gap). With delta = x_a - c_b and e the change of b's derivative both terms are of these six
/// numbers,
///   K = (delta e) (A C; C^T D) (delta e)^T,     A = slope n n^T - force (m + bend p p^T),  C = slope n turn^T - force bend p q^T,
///                                               D = slope turn turn^T - force bend q q^T,
/// where a pair of nodes i, j takes delta by the weights wa_i, -wb_i of both, e by db_i.
void add_point(double (&to)[InstrumentSums::size][InstrumentSums::size], const InstrumentPoint& p)
{
    constexpr int side = InstrumentSums::side;
    const double bend = -p.force * p.bend;
    Rows3 a = two_products(p.slope, p.n, p.n, bend, p.p, p.p);
    const double m[3][3] = {{p.m[0], p.m[1], p.m[2]}, {p.m[1], p.m[3], p.m[4]}, {p.m[2], p.m[4], p.m[5]}};
    for (int c = 0; c < 3; ++c) a.r[c] -= p.force * Vec4d{m[c][0], m[c][1], m[c][2], 0};
    const Rows3 c = two_products(p.slope, p.n, p.turn, bend, p.p, p.q), back = two_products(p.slope, p.turn, p.n, bend, p.q, p.p);
    const Rows3 d = two_products(p.slope, p.turn, p.turn, bend, p.q, p.q);
    for (int j = 0; j < 3; ++j) {
        const Rows3 of_a = p.wa[j] * a, from_a = p.wa[j] * back;              // of delta, of e: with a's node j
        const Rows3 of_b = -p.wb[j] * a + p.db[j] * c, from_b = -p.wb[j] * back + p.db[j] * d;  // with b's
        for (int i = 0; i < 3; ++i) {
            add_rows(to, per_node * i, per_node * j, p.wa[i] * of_a);
            add_rows(to, per_node * i, side + per_node * j, p.wa[i] * of_b);
            add_rows(to, side + per_node * i, per_node * j, -p.wb[i] * of_a + p.db[i] * from_a);
            add_rows(to, side + per_node * i, side + per_node * j, -p.wb[i] * of_b + p.db[i] * from_b);
        }
    }
}

void add_friction(double (&to)[InstrumentSums::size][InstrumentSums::size], const InstrumentForce& f)
{
    add_outer_product(to, f.stiff_along, row_of(f, f.along), row_of(f, f.along));
    add_outer_product(to, f.stiff_across, row_of(f, f.across), row_of(f, f.across));
}

}  // namespace

InstrumentSums::InstrumentSums(const RodArrays& rods, int first_wire, int wires)
    : rods_(rods), first_wire_(first_wire), first_node_(rods.node_begin(first_wire)), wires_(wires)
{
    const int last = first_wire + wires - 1;
    nodal_.resize(static_cast<std::size_t>(rods.node_begin(last) + rods.capacity(last) - first_node_));
}

void InstrumentSums::clear()
{
    if (!taken_.empty() || blocked_) {
        std::fill(nodal_.begin(), nodal_.end(), std::array<double, per_node>{});
        std::fill(wires_.begin(), wires_.end(), OfWire{});
    }
    taken_.clear();
    used_ = 0;
    blocked_ = sliding_ = assembled_ = false;
}

/// That of the last call, most often: cells come in order.
InstrumentSums::Block& InstrumentSums::block(int wire_a, int wire_b, int node_a, int node_b) const
{
    for (std::size_t k = used_; k > 0 && k + 8 > used_; --k) {
        Block& b = blocks_[k - 1];
        if (b.wire_a == wire_a && b.wire_b == wire_b && b.node_a == node_a && b.node_b == node_b) return b;
    }
    if (used_ == blocks_.size()) blocks_.emplace_back();
    Block& b = blocks_[used_++];
    std::memset(b.value, 0, sizeof b.value);
    b.wire_a = wire_a;
    b.wire_b = wire_b;
    b.node_a = node_a;
    b.node_b = node_b;
    return b;
}

void InstrumentSums::take(const InstrumentForce& force, const InstrumentPoint* points, int wire_a, int wire_b,
                          const InstrumentMoves& moves)
{
    if (force.flags & SEL_FORCE_BLOCKED) blocked_ = true;
    if (force.count == 0) return;
    taken_.push_back({&force, points, wire_a, wire_b});
    const Taken taken = taken_.back();
    std::array<double, 2> pushing{}, rubbing{};
    for (std::uint32_t k = 0; k < force.count; ++k) {
        const InstrumentPoint& point = points[k];
        Vector pushed = gap_gradient(point);
        for (double& value : pushed) value *= point.force;
        const auto work = exert(taken, static_cast<int>(point.node_a), static_cast<int>(point.node_b), pushed, moves);
        for (int s = 0; s < 2; ++s) pushing[s] += work[s];
    }
    if (force.flags & SEL_FORCE_COUPLE) {
        rubbing = exert(taken, static_cast<int>(force.node_a), static_cast<int>(force.node_b), row_of(force, force.force), moves);
        sliding_ = sliding_ || (force.flags & SEL_FORCE_SLIDING);
    }
    const double normal = 0.5 * (pushing[0] + pushing[1]), friction = 0.5 * (rubbing[0] + rubbing[1]);
    const double to_a = 0.5 * (pushing[0] - pushing[1] + rubbing[0] - rubbing[1]);
    sum_up(force, wire_a, normal, friction, to_a);
    if (wire_a != wire_b) sum_up(force, wire_b, normal, friction, -to_a);
    else {
        OfWire& sum = of(wire_a);
        sum.totals.work.normal += normal;
        sum.totals.work.friction += friction;
        sum.from_other -= to_a;
    }
}

void InstrumentSums::assemble(bool symmetric) const
{
    if (assembled_ && symmetric_ == symmetric) return;
    assembled_ = true;
    symmetric_ = symmetric;
    used_ = 0;
    for (const Taken& of : taken_) {
        const InstrumentForce& force = *of.force;
        const bool slides = !symmetric && (force.flags & SEL_FORCE_SLIDING);
        const auto block_at = [&](const auto& place) -> Block& {
            return block(of.wire_a, of.wire_b, static_cast<int>(place.node_a), static_cast<int>(place.node_b));
        };
        for (std::uint32_t k = 0; k < force.count; ++k) {
            Block& at = block_at(of.points[k]);
            add_point(at.value, of.points[k]);
            if (slides) add_load(at.value, force, of.points[k]);
        }
        if (force.flags & SEL_FORCE_COUPLE) add_friction(block_at(force).value, force);
    }
}

std::array<double, 2> InstrumentSums::exert(const Taken& of, int node_a, int node_b, const Vector& pushed,
                                            const InstrumentMoves& moves)
{
    std::array<double, 2> work{};
    for (int s = 0; s < 2; ++s) {
        const int first = s == 0 ? rods_.node_begin(of.wire_a) + node_a : rods_.node_begin(of.wire_b) + node_b;
        for (int k = 0; k < 3; ++k) {
            const double* force = pushed.data() + side * s + per_node * k;
            if (force[0] == 0 && force[1] == 0 && force[2] == 0 && force[3] == 0) continue;
            const auto node = static_cast<std::size_t>(first + k);
            auto& sum = nodal_[node - static_cast<std::size_t>(first_node_)];
            for (int c = 0; c < per_node; ++c) sum[c] += force[c];
            for (int c = 0; c < 3; ++c) work[s] += force[c] * (moves.position[3 * node + c] - moves.position_t0[3 * node + c]);
            work[s] += force[RodDofs::spin_place] * (moves.theta[node] - moves.theta_t0[node]);
        }
    }
    return work;
}

void InstrumentSums::sum_up(const InstrumentForce& force, int wire, double own_normal, double own_friction, double from_other)
{
    OfWire& sum = of(wire);
    sum.totals.contacts += 1;
    sum.totals.depth = std::max(sum.totals.depth, static_cast<double>(force.depth));
    sum.totals.normal += force.normal_sum;
    sum.totals.friction += force.friction_sum;
    sum.totals.sliding += force.sliding_sum;
    sum.totals.length += force.length;
    sum.totals.work.normal += own_normal;
    sum.totals.work.friction += own_friction;
    sum.largest = std::max(sum.largest, static_cast<double>(force.normal_sum));
    sum.stored += 0.5 * force.stored;
    sum.from_other += from_other;
}

void InstrumentSums::add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const
{
    if (taken_.empty()) return;
    const int first = rods_.node_begin(wire) - first_node_;
    for (int i = 0; i < rods_.node_count(wire); ++i)
        for (int c = 0; c < per_node; ++c) residual[RodDofs::position(i, c)] -= nodal_[static_cast<std::size_t>(first + i)][c];
    if (!tangent) return;
    assemble(symmetric);
    for (std::size_t b = 0; b < used_; ++b)
        for (int s = 0; s < 2; ++s) {
            const Block& block = blocks_[b];
            if ((s == 0 ? block.wire_a : block.wire_b) != wire) continue;
            const int at = RodDofs::position(s == 0 ? block.node_a : block.node_b);
            const int count = std::min(side, tangent->size() - at);  // a rod of two nodes has a third without weight
            for (int i = 0; i < count; ++i) {
                double* row = tangent->row(at + i) + BandRows::half_bandwidth - i;
                for (int j = 0; j < count; ++j) row[j] += block.value[side * s + i][side * s + j];
            }
        }
}

void InstrumentSums::couple(const SystemUnknowns& system, BandedSolver& tangent, bool symmetric) const
{
    assemble(symmetric);
    for (std::size_t b = 0; b < used_; ++b) {
        const Block& block = blocks_[b];
        const int a_rod = system.rod_of(block.wire_a), b_rod = system.rod_of(block.wire_b);
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                if (block.node_a + k >= system.map.nodes(a_rod) || block.node_b + l >= system.map.nodes(b_rod)) continue;
                const int row = RodDofs::node(system.map.node(a_rod, block.node_a + k));
                const int col = RodDofs::node(system.map.node(b_rod, block.node_b + l));
                const int i = per_node * k, j = side + per_node * l;
                auto& ab = tangent.far.block(row, col);
                for (int c = 0; c < per_node; ++c)
                    for (int d = 0; d < per_node; ++d) ab.value[c][d] += block.value[i + c][j + d];
                auto& ba = tangent.far.block(col, row);
                for (int c = 0; c < per_node; ++c)
                    for (int d = 0; d < per_node; ++d) ba.value[d][c] += block.value[j + d][i + c];
            }
    }
}

void InstrumentSums::add_nodal_forces(int wire, std::span<Vec3> forces) const
{
    const int first = rods_.node_begin(wire) - first_node_;
    for (int i = 0; i < rods_.node_count(wire); ++i)
        for (int c = 0; c < 3; ++c) forces[i][c] += nodal_[static_cast<std::size_t>(first + i)][c];
}

}  // namespace seldinger
