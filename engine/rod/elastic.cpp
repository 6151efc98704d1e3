// Energy, force and Hessian of a wire, assembled edge by edge, and what hand and clamp feel of it.
//
// All elastic energy is a function of y_j = (e_j, theta_j), the edge vectors and angles, and couples neighbours only: the
// Hessian in y is block tridiagonal, A_j on the diagonal, C_j between j and j+1. With e_j = x_{j+1} - x_j each 4x4 block of
// the nodes' Hessian is a signed sum of at most four of these, so the wire is walked once, from tip to hub, with two edges
// in hand, and every entry of the band is touched once.

#include "rod/elastic.h"

#include "core/check.h"
#include "rod/clamp.h"

namespace seldinger {

namespace {

struct EdgeBlock {  // A_j
    Mat3 xx = Mat3::Zero();
    Vec3 xt = Vec3::Zero();
    double tt = 0;
};

struct EdgeCoupling {  // C_j; xt: e_j with theta_{j+1}, tx: theta_j with e_{j+1}
    Mat3 xx = Mat3::Zero();
    Vec3 xt = Vec3::Zero(), tx = Vec3::Zero();
    double tt = 0;
};

Pair node_pair(const RodView& rod, const RodFrames& frames, int i)
{
    return {frames.tangent[i - 1], frames.tangent[i], 1 / frames.edge_length[i - 1], 1 / frames.edge_length[i],
            frames.kb[i],          frames.chi[i],     curvature_q(rod.curvature)};
}

/// Natural curvature of inner node i with the frame that kappa is measured in.
RestBend node_rest(const RodView& rod, const RodFrames& frames, int i)
{
    RestBend rest{rod.rest_kappa1[i], rod.rest_kappa2[i]};
    if (rest.kappa1 != 0 || rest.kappa2 != 0) rest.n1 = turned(frames.m1[i - 1], frames.tangent[i - 1], 0.5 * frames.twist[i]);
    return rest;
}

double stretch_strain(const RodView& rod, const RodFrames& frames, int j)
{
    return (frames.edge_length[j] - rod.rest_length[j]) / rod.rest_length[j];
}

/// (D1) of edge j. Hessian: EA/rest t t^T + N/|e| (1 - t t^T), N the axial force.
/// Safe drops the second term in compression, where it is negative: the buckling term.
void add_stretch(const RodView& rod, const RodFrames& frames, int j, HessianMode mode, Vec3& gradient, EdgeBlock& block)
{
    const Vec3& t = frames.tangent[j];
    const double force = rod.stretch_stiffness[j] * stretch_strain(rod, frames, j);
    gradient = force * t;
    if (mode == HessianMode::None) return;
    const double lateral = (mode == HessianMode::Safe ? std::max(force, 0.0) : force) / frames.edge_length[j];
    const double axial = rod.stretch_stiffness[j] / rod.rest_length[j];
    block.xx = outer((axial - lateral) * t, t);
    block.xx.diagonal().array() += lateral;
}

/// (D2), (D3) of inner node i.
void add_node(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, int i, HessianMode mode,
              PairTerms& out)
{
    const ClampedNode clamped = clamped_at(clamps, i);
    const Pair pair = node_pair(rod, frames, i);
    const double inv_cell = 1 / rod.voronoi_length(i);
    if (!clamped.bend) add_bend(pair, rod.bend_stiffness[i] * inv_cell, node_rest(rod, frames, i), mode, out);
    if (!clamped.twist && frames.spins)
        add_twist(pair, rod.twist_stiffness[i] * inv_cell, frames.twist[i] - rod.rest_twist[i], mode, out);
}

void add_vector(double* to, const Vec3& v)
{
    to[0] += v.x();
    to[1] += v.y();
    to[2] += v.z();
}

/// Rows of the band that belong to node i, and their mirror images below the diagonal. `before`, `after`: A_{i-1}, A_i;
/// `c_before`, `c_after`: C_{i-1}, C_i; zero beyond the ends.
void write_node(BandMatrix& band, int i, int n, const EdgeBlock& before, const EdgeBlock& after, const EdgeCoupling& c_before,
                const EdgeCoupling& c_after)
{
    constexpr int centre = BandMatrix::half_bandwidth;
    const Mat3 own = before.xx + after.xx - c_before.xx - c_before.xx.transpose();
    const Vec3 own_t = c_before.xt - after.xt;
    double* rows[4];  // entry of this node's first unknown in each of its rows
    for (int c = 0; c < 4; ++c) rows[c] = band.row(4 * i + c) + centre - c;
    for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) rows[c][d] += own(c, d);
        rows[c][3] += own_t[c];
        rows[3][c] += own_t[c];
    }
    rows[3][3] += after.tt;
    if (i + 1 == n) return;

    const Mat3 next = c_before.xx + c_after.xx - after.xx;
    const Vec3 next_tx = after.xt - c_after.tx;
    double* next_rows[4];  // entry of this node's first unknown in the rows of node i + 1
    for (int d = 0; d < 4; ++d) next_rows[d] = band.row(4 * (i + 1) + d) + centre - d - 4;
    for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
            rows[c][4 + d] += next(c, d);
            next_rows[d][c] += next(c, d);
        }
        rows[c][7] -= c_after.xt[c];
        next_rows[3][c] -= c_after.xt[c];
        rows[3][4 + c] += next_tx[c];
        next_rows[c][3] += next_tx[c];
    }
    rows[3][7] += c_after.tt;
    next_rows[3][3] += c_after.tt;
    if (i + 2 == n) return;

    for (int d = 0; d < 3; ++d) {
        double* row = band.row(4 * (i + 2) + d) + centre - d - 8;
        for (int c = 0; c < 3; ++c) {
            rows[c][8 + d] -= c_after.xx(c, d);
            row[c] -= c_after.xx(c, d);
        }
        rows[3][8 + d] += c_after.tx[d];
        row[3] += c_after.tx[d];
    }
}

/// The walk from tip to hub: what it holds while it stands at node i.
struct Walk {
    std::span<double> gradient;
    BandMatrix* hessian;  // null: gradient only
    int n;
    EdgeBlock before = {}, current = {}, next = {};                                     // A_{i-2}, A_{i-1}, A_i
    EdgeCoupling c_before = {}, c_current = {};                                         // C_{i-2}, C_{i-1}
    Vec3 force_before = Vec3::Zero(), force = Vec3::Zero(), force_next = Vec3::Zero();  // dE/de of the same edges

    /// The stencil at node i: e is edge i-1, f edge i.
    void add(int i, const PairTerms& terms)
    {
        force += terms.ge;
        force_next += terms.gf;
        if (i > 0) gradient[4 * (i - 1) + 3] += terms.ga;
        gradient[4 * i + 3] += terms.gb;
        if (!hessian) return;
        current.xx += terms.ee;
        current.xt += terms.ea;
        current.tt += terms.aa;
        next.xx += terms.ff;
        next.xt += terms.fb;
        next.tt += terms.bb;
        c_current.xx += terms.ef;
        c_current.xt += terms.eb;
        c_current.tx += terms.fa;
        c_current.tt += terms.ab;
    }

    /// All of edge i-1 has been added, so node i-1 can be written; then on to node i+1.
    void leave(int i)
    {
        if (i > 0) {
            add_vector(&gradient[4 * (i - 1)], force_before - force);
            if (hessian) write_node(*hessian, i - 1, n, before, current, c_before, c_current);
        }
        before = current;
        current = next;
        next = EdgeBlock();
        c_before = c_current;
        c_current = EdgeCoupling();
        force_before = force;
        force = force_next;
        force_next.setZero();
    }

    void finish()
    {
        add_vector(&gradient[4 * (n - 1)], force_before);
        if (hessian) write_node(*hessian, n - 1, n, before, EdgeBlock(), c_before, EdgeCoupling());
    }
};

/// One side of clamp k, with the clamp's own angle prescribed: only the edge's part stays.
PairTerms clamp_terms(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, int k, int side,
                      HessianMode mode)
{
    PairTerms terms;
    add_clamp(rod, clamps[k], clamp_side(rod, clamps[k], frames, k, side), mode, terms);
    if (side == 0) {
        terms.gb = terms.bb = 0;
        terms.fb.setZero();
    } else {
        terms.ga = terms.aa = 0;
        terms.ea.setZero();
    }
    terms.ab = 0;
    terms.eb.setZero();
    terms.fa.setZero();
    return terms;
}

}  // namespace

double elastic_energy(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames)
{
    SEL_ASSERT(frames.spins);
    double energy = 0;
    for (int j = 0; j < rod.n - 1; ++j) {
        const double strain = stretch_strain(rod, frames, j);
        energy += 0.5 * rod.stretch_stiffness[j] * strain * strain * rod.rest_length[j];
    }
    for (int i = 1; i < rod.n - 1; ++i) {
        const ClampedNode clamped = clamped_at(clamps, i);
        const double half_inv_cell = 0.5 / rod.voronoi_length(i);
        const double k1 = frames.kappa1[i] - rod.rest_kappa1[i], k2 = frames.kappa2[i] - rod.rest_kappa2[i];
        const double twist = frames.twist[i] - rod.rest_twist[i];
        if (!clamped.bend) energy += rod.bend_stiffness[i] * half_inv_cell * (k1 * k1 + k2 * k2);
        if (!clamped.twist) energy += rod.twist_stiffness[i] * half_inv_cell * twist * twist;
    }
    for (int k = 0; k < static_cast<int>(clamps.size()); ++k)
        for (int side = 0; side < 2; ++side)
            if (clamp_edge(rod, clamps[k].node, side) >= 0)
                energy += clamp_energy(rod, clamps[k], clamp_side(rod, clamps[k], frames, k, side));
    return energy;
}

void add_elastic(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, std::span<double> gradient,
                 BandMatrix* hessian, HessianMode mode)
{
    const int n = rod.n;
    SEL_ASSERT(static_cast<int>(gradient.size()) >= 4 * n);
    if (!hessian) mode = HessianMode::None;
    SEL_ASSERT(mode == HessianMode::None || hessian->size() == 4 * n);

    Walk walk{gradient, mode == HessianMode::None ? nullptr : hessian, n};
    for (int i = 0; i < n; ++i) {
        if (i < n - 1) add_stretch(rod, frames, i, mode, walk.force_next, walk.next);
        if (i > 0 && i < n - 1) {
            PairTerms terms;
            add_node(rod, clamps, frames, i, mode, terms);
            walk.add(i, terms);
        }
        for (int k = 0; k < static_cast<int>(clamps.size()); ++k)
            for (int side = 0; side < 2 && clamps[k].node == i; ++side)
                if (clamp_edge(rod, i, side) >= 0) walk.add(i, clamp_terms(rod, clamps, frames, k, side, mode));
        walk.leave(i);
    }
    walk.finish();
}

// E depends on the base edge's rest length l through its strain and through the cells of its two ends, which grow by dl/2:
//   stretch  d/dl [EA (|e|/l - 1)^2 l/2]            = -N - EA strain^2/2
//   cell     d/da [B (kappa - k a)^2/(2a)] (da/dl)  = -B/2 ((kappa/a)^2 - k^2)/2,   k the natural curvature of the wire fed
// The sum of both cells' halves is -M^2/(2B) for k = 0: the configurational force of a sleeve, [Bosi14]. The material fed is
// taken to be like that of its cell; the moment a change of section passes the clamp is not seen.
//
// N is the force in the middle of the base edge. Of a length dl that comes in at the inlet x_hub, dl/2 becomes mass of either
// node of the edge: its weight does the work -rho A dl g.(x_hub + x_before)/2 + rho A dl g.x_hub = m_hub g.e dl/l, e from before
// to hub.
double feed_force(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, const Vec3& gravity)
{
    SEL_ASSERT(frames.spins);
    const int j = rod.n - 2;
    const double strain = stretch_strain(rod, frames, j);
    double force = -rod.stretch_stiffness[j] * strain * (1 + 0.5 * strain);
    force += rod.mass[j + 1] * (1 + strain) * gravity.dot(frames.tangent[j]);

    const auto cell = [](double stiffness, double value, double rest, double length) {
        return -0.25 * stiffness * (value * value - rest * rest) / (length * length);
    };
    if (j > 0) {  // otherwise the tip is the other end, with no energy of its own
        const ClampedNode clamped = clamped_at(clamps, j);
        const double length = rod.voronoi_length(j), b = rod.bend_stiffness[j];
        if (!clamped.bend)
            force +=
                cell(b, frames.kappa1[j], rod.rest_kappa1[j], length) + cell(b, frames.kappa2[j], rod.rest_kappa2[j], length);
        if (!clamped.twist) force += cell(rod.twist_stiffness[j], frames.twist[j], rod.rest_twist[j], length);
    }
    for (int k = 0; k < static_cast<int>(clamps.size()); ++k) {
        const int side = clamps[k].node == j + 1 ? 0 : 1;
        if (clamp_edge(rod, clamps[k].node, side) != j) continue;
        const ClampSide s = clamp_side(rod, clamps[k], frames, k, side);
        const int node = clamps[k].node;
        if (clamps[k].direction) {
            const Eigen::Vector2d kappa = kappa_in(s.pair, s.rest.n1);
            force += cell(rod.bend_stiffness[node], kappa[0], s.rest.kappa1, s.half) +
                     cell(rod.bend_stiffness[node], kappa[1], s.rest.kappa2, s.half);
        }
        if (clamps[k].spin) force += cell(rod.twist_stiffness[node], s.twist, s.share * rod.rest_twist[node], s.half);
    }
    return force;
}

// dE/d(turns): the clamp is the pair's f on its tip side, its e on the hub side.
double clamp_torque(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, int clamp)
{
    double torque = 0;
    for (int side = 0; side < 2 && clamps[clamp].spin; ++side) {
        if (clamp_edge(rod, clamps[clamp].node, side) < 0) continue;
        PairTerms terms;
        add_clamp(rod, clamps[clamp], clamp_side(rod, clamps[clamp], frames, clamp, side), HessianMode::None, terms);
        torque += side == 0 ? terms.gb : terms.ga;
    }
    return torque;
}

}  // namespace seldinger
