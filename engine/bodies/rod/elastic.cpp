// Energy, force and Hessian of a wire, assembled edge by edge, and the forces at hand and clamp.
//
// All elastic energy is a function of y_j = (e_j, theta_j), the edge vectors and angles, and couples neighbours only. The Hessian
// in y is block tridiagonal, A_j on the diagonal, C_j between j and j+1. With e_j = x_{j+1} - x_j each 4x4 block of the
// nodes' Hessian is a signed sum of at most four of these. So the wire is walked once, from tip to hub, with two edges in hand,
// and every entry of the band is touched once.
#include "rod/elastic.h"

#include "core/check.h"
#include "math/lanes.h"
#include "rod/clamp.h"

#include <numbers>

namespace seldinger {
namespace {

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

constexpr int dofs = RodDofs::per_node, spin = RodDofs::spin_place;

/// Stencils of nodes side by side: the lanes of PairTerms.
struct StencilForces {
    Lanes3 ge, gf;
    Lanes ga, gb;
};
struct StencilBlocks {
    Lanes ee[9], ef[9], ff[9];
    Lanes3 ea, eb, fa, fb;
    Lanes aa, ab, bb;
};

/// Walks from tip to hub, as many nodes at a time as there are lanes. In step k the lanes have the stencils of nodes first + l
/// and the edges before these. They write the nodes at which these edges begin, which need the last lane of the step before.
struct Walk {
    const RodView& rod;
    std::span<const RodClamp> clamps;
    const RodFrames& frames;
    HessianMode mode;

    /// What stencils are made of: pair.h's Pair and the stiffnesses over the cell, 0 where a clamp takes their place.
    struct Pairs {
        Lanes3 te, tf, kb;
        Lanes inv_e, inv_f, chi, bend, twist, moment;
        LaneMask inner;
    };

    [[nodiscard]] Pairs pairs(int first) const
    {
        Pairs p;
        const int left = rod.n - 1 - first;  // inner nodes from `first` on
        const auto of = [&](std::span<const double> values, int at) { return load_lanes(values.data() + at, rod.n - at, 1); };
        p.te = load_lanes3(frames.tangent, first - 1);
        p.tf = load_lanes3(frames.tangent, first);
        p.inv_e = 1.0 / load_lanes(&frames.edge_length[first - 1]);
        p.inv_f = 1.0 / load_lanes(&frames.edge_length[first]);
        p.chi = load_lanes(&frames.chi[first]);
        p.inner = first_lanes(left);
        const Lanes inv_cell = 1.0 / (0.5 * (of(rod.rest_length, first - 1) + of(rod.rest_length, first)));
        p.bend = of(rod.bend_stiffness, first) * inv_cell;
        p.twist = of(rod.twist_stiffness, first) * inv_cell;
        for (const RodClamp& clamp : clamps) {
            const int l = clamp.node - first;
            if (l < 0 || l >= lane_count) continue;
            if (clamp.direction) p.bend[l] = 0;
            if (clamp.spin) p.twist[l] = 0;
        }
        if (!frames.spins) return p;
        p.kb = load_lanes3(frames.kb, first);
        p.moment = p.twist * (load_lanes(&frames.twist[first]) - of(rod.rest_twist, first));
        return p;
    }

    /// Calls put(lane, terms) for all stencils from `first` on that lanes cannot do: natural curvature, which replaces the terms
    /// there, and clamps, which add to them. @param terms_of  which derivatives are wanted
    template <class Replace, class Add>
    void for_others(int first, bool every, HessianMode terms_of, const Replace& replace, const Add& add) const
    {
        for (int i = first; i < std::min(first + lane_count, rod.n - 1) && i > 0; ++i) {
            if (!every && rod.rest_kappa1[i] == 0 && rod.rest_kappa2[i] == 0) continue;
            PairTerms terms;
            add_node(rod, clamps, frames, i, terms_of, terms);
            replace(i - first, terms);
        }
        for (int k = 0; k < static_cast<int>(clamps.size()); ++k) {
            const int l = clamps[k].node - first;
            if (l < 0 || l >= lane_count) continue;
            for (int side = 0; side < 2; ++side)
                if (clamp_edge(rod, clamps[k].node, side) >= 0) add(l, clamp_terms(rod, clamps, frames, k, side, terms_of));
        }
    }

    /// pair.h: add_bend_gradient(), add_twist()
    [[nodiscard]] StencilForces forces(int first) const
    {
        const double q = curvature_q(rod.curvature);
        const Pairs p = pairs(first);
        const Lanes c = p.chi - 1.0, slope = p.bend * (-4 * (1 - q) / (p.chi * p.chi) - q);
        StencilForces s;
        s.ge = (slope * p.inv_e) * (p.tf - c * p.te);
        s.gf = (slope * p.inv_f) * (p.te - c * p.tf);
        s.ga = s.gb = Lanes{};
        if (frames.spins) {
            s.ge = s.ge + p.moment * ((0.5 * p.inv_e) * p.kb);
            s.gf = s.gf + p.moment * ((0.5 * p.inv_f) * p.kb);
            s.ga = -p.moment;
            s.gb = p.moment;
        }
        for (Lanes* value : {&s.ge[0], &s.ge[1], &s.ge[2], &s.gf[0], &s.gf[1], &s.gf[2], &s.ga, &s.gb})
            *value = p.inner ? *value : Lanes{};
        const auto replace = [&](int l, const PairTerms& terms) {
            for (int k = 0; k < 3; ++k) s.ge[k][l] = terms.ge[k], s.gf[k][l] = terms.gf[k];
            s.ga[l] = terms.ga, s.gb[l] = terms.gb;
        };
        const auto add = [&](int l, const PairTerms& terms) {
            for (int k = 0; k < 3; ++k) s.ge[k][l] += terms.ge[k], s.gf[k][l] += terms.gf[k];
            s.ga[l] += terms.ga, s.gb[l] += terms.gb;
        };
        for_others(first, false, HessianMode::None, replace, add);
        return s;
    }

    /// pair.h: add_bend_hessian_exact(), add_twist_curvature(), add_twist()
    [[nodiscard]] StencilBlocks exact_blocks(int first) const
    {
        const double q = curvature_q(rod.curvature);
        const Pairs p = pairs(first);
        const Lanes c = p.chi - 1.0;
        const Lanes d1 = p.bend * (-4 * (1 - q) / (p.chi * p.chi) - q), d2 = p.bend * (8 * (1 - q) / (p.chi * p.chi * p.chi));
        const Lanes3 fe = p.tf - c * p.te, ef = p.te - c * p.tf, cte = c * p.te;
        const Lanes3 fee = (d2 * p.inv_e * p.inv_e) * fe, eff = (d2 * p.inv_f * p.inv_f) * ef,
                     fef = (d2 * p.inv_e * p.inv_f) * fe;
        const Lanes per_ee = -p.inv_e * p.inv_e, per_ff = -p.inv_f * p.inv_f, per_ef = p.inv_e * p.inv_f;
        StencilBlocks s;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double one = i == j ? 1 : 0;
                const Lanes ee = p.te[i] * p.te[j], ff = p.tf[i] * p.tf[j];
                const Lanes chi_ee = per_ee * ((p.te[i] * fe[j] + p.te[j] * fe[i]) + c * (one - ee));
                const Lanes chi_ff = per_ff * ((p.tf[i] * ef[j] + p.tf[j] * ef[i]) + c * (one - ff));
                const Lanes chi_ef = per_ef * (((one - ee) - ff) + cte[i] * p.tf[j]);
                s.ee[3 * i + j] = fee[i] * fe[j] + d1 * chi_ee;
                s.ff[3 * i + j] = eff[i] * ef[j] + d1 * chi_ff;
                s.ef[3 * i + j] = fef[i] * ef[j] + d1 * chi_ef;
            }
        if (frames.spins) add_twist_blocks(p, s);
        return s;
    }

    static void add_twist_blocks(const Pairs& p, StencilBlocks& s)
    {
        const Lanes3 tt = (p.te + p.tf) / p.chi, mk = p.moment * p.kb, ett = p.te + tt, ftt = p.tf + tt;
        const Lanes per_ee = 0.25 * p.inv_e * p.inv_e, per_ff = 0.25 * p.inv_f * p.inv_f, per_ef = 0.5 * p.inv_e * p.inv_f;
        const Lanes3 v = (2.0 * p.moment / p.chi) * p.te;
        const Lanes zero{}, skew[9] = {zero, -v[2], v[1], v[2], zero, -v[0], -v[1], v[0], zero};
        const Lanes3 e = (0.5 * p.inv_e) * p.kb, f = (0.5 * p.inv_f) * p.kb, se = p.twist * e, sf = p.twist * f;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                Lanes &ee = s.ee[3 * i + j], &ff = s.ff[3 * i + j], &ef = s.ef[3 * i + j];
                ee -= per_ee * (mk[i] * ett[j] + mk[j] * ett[i]);
                ff -= per_ff * (mk[i] * ftt[j] + mk[j] * ftt[i]);
                ef += per_ef * (skew[3 * i + j] - mk[i] * tt[j]);
                ee += se[i] * e[j];
                ff += sf[i] * f[j];
                ef += se[i] * f[j];
            }
        for (int c = 0; c < 3; ++c) {
            s.ea[c] = -se[c];
            s.eb[c] = se[c];
            s.fa[c] = -sf[c];
            s.fb[c] = sf[c];
        }
        s.aa = s.bb = p.twist;
        s.ab = -p.twist;
    }

    /// Every entry of the two with `how`.
    template <class How>
    static void each(StencilBlocks& s, int l, const PairTerms& terms, const How& how)
    {
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                how(s.ee[3 * i + j], l, terms.ee(i, j));
                how(s.ef[3 * i + j], l, terms.ef(i, j));
                how(s.ff[3 * i + j], l, terms.ff(i, j));
            }
            how(s.ea[i], l, terms.ea[i]);
            how(s.eb[i], l, terms.eb[i]);
            how(s.fa[i], l, terms.fa[i]);
            how(s.fb[i], l, terms.fb[i]);
        }
        how(s.aa, l, terms.aa);
        how(s.ab, l, terms.ab);
        how(s.bb, l, terms.bb);
    }

    [[nodiscard]] StencilBlocks blocks(int first) const
    {
        StencilBlocks s{};
        const bool lanes = mode == HessianMode::Exact && first > 0;
        if (lanes) s = exact_blocks(first);
        if (lanes && !frames.spins) {
            s.ea = s.eb = s.fa = s.fb = Lanes3{};
            s.aa = s.ab = s.bb = Lanes{};
        }
        if (lanes && first + lane_count > rod.n - 1) {  // beyond the hub
            const LaneMask inner = first_lanes(rod.n - 1 - first);
            const auto keep_inner = [inner](Lanes* entries, int count) {
                for (int k = 0; k < count; ++k) entries[k] = inner ? entries[k] : Lanes{};
            };
            for (Lanes(*block)[9] : {&s.ee, &s.ef, &s.ff}) keep_inner(*block, 9);
            for (Lanes3* block : {&s.ea, &s.eb, &s.fa, &s.fb}) keep_inner(block->v, 3);
            for (Lanes* entry : {&s.aa, &s.ab, &s.bb}) keep_inner(entry, 1);
        }
        const auto set = [](Lanes& to, int l, double value) { to[l] = value; };
        const auto more = [](Lanes& to, int l, double value) { to[l] += value; };
        for_others(
            first, !lanes, mode, [&](int l, const PairTerms& terms) { each(s, l, terms, set); },
            [&](int l, const PairTerms& terms) { each(s, l, terms, more); });
        return s;
    }

    /// Axial force of edges first, first + 1, ..., 0 beyond the hub.
    [[nodiscard]] Lanes tension(int first) const
    {
        const int left = rod.n - 1 - first;
        const Lanes rest = load_lanes(&rod.rest_length[first], left, 1), length = load_lanes(&frames.edge_length[first]);
        const Lanes force = load_lanes(&rod.stretch_stiffness[first], left, 0) * ((length - rest) / rest);
        return first_lanes(left) ? force : Lanes{};
    }

    void add_gradient(std::span<double> gradient) const
    {
        StencilForces last = end_forces();
        Lanes3 last_force{};                              // dE/de of the edges before
        for (int at = 0; at < rod.n; at += lane_count) {  // writes nodes at, at + 1, ...
            const StencilForces next = forces(at + 1);
            const Lanes pull = tension(at);
            const Lanes3 t = load_lanes3(frames.tangent, at);
            const LaneMask edges = first_lanes(rod.n - 1 - at);
            double out[RodDofs::coordinates][lane_count];
            for (int c = 0; c < 3; ++c) {
                const Lanes stretch = edges ? pull * t[c] : Lanes{};
                const Lanes force = (stretch + shifted(last.gf[c], next.gf[c])) + next.ge[c];
                store_lanes(out[c], shifted(last_force[c], force) - force);
                last_force[c] = force;
            }
            const Lanes gb = shifted(last.gb, next.gb);
            for (int l = 0; l < lane_count && at + l < rod.n; ++l) {
                double* g = &gradient[RodDofs::position(at + l)];
                for (int c = 0; c < 3; ++c) g[c] += out[c][l];
                g[spin] = (g[spin] + gb[l]) + next.ga[l];
            }
            last = next;
        }
    }

    /// Forces of the tip's clamp, in the last lane.
    [[nodiscard]] StencilForces end_forces() const
    {
        StencilForces s{};
        constexpr int l = lane_count - 1;
        for_others(
            -l, false, HessianMode::None, [](int, const PairTerms&) {},
            [&](int at, const PairTerms& terms) {
                for (int k = 0; k < 3; ++k) s.ge[k][at] += terms.ge[k], s.gf[k][at] += terms.gf[k];
                s.ga[at] += terms.ga, s.gb[at] += terms.gb;
            });
        return s;
    }

    /// (D1). Hessian: EA/rest t t^T + N/|e| (1 - t t^T), N the axial force. Projected drops the second term in compression, where
    /// it is negative: the buckling term.
    void stretch_blocks(int first, Lanes (&xx)[9]) const
    {
        const int left = rod.n - 1 - first;
        const LaneMask edges = first_lanes(left);
        const Lanes3 t = load_lanes3(frames.tangent, first);
        Lanes force = tension(first);
        if (mode == HessianMode::Projected) force = force > 0 ? force : Lanes{};
        const Lanes lateral = force / load_lanes(&frames.edge_length[first]);
        const Lanes axial = load_lanes(&rod.stretch_stiffness[first], left, 0) / load_lanes(&rod.rest_length[first], left, 1);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                Lanes entry = ((axial - lateral) * t[i]) * t[j];
                if (i == j) entry += lateral;
                xx[3 * i + j] = edges ? entry : Lanes{};
            }
    }

    void add_hessian(BandRows& band) const
    {
        StencilBlocks last = blocks(-(lane_count - 1));
        Lanes last_xx[9] = {};  // A of the edge before
        for (int at = 0; at < rod.n; at += lane_count) {
            const StencilBlocks next = blocks(at + 1);
            Lanes rows[dofs][3 * dofs];  // of nodes at, at + 1, ...: columns of this node and of the next two
            Lanes xx[9];        // A of their edges
            stretch_blocks(at, xx);
            for (int k = 0; k < 9; ++k) xx[k] = (xx[k] + shifted(last.ff[k], next.ff[k])) + next.ee[k];
            for (int c = 0; c < 3; ++c) {
                for (int d = 0; d < 3; ++d) {
                    const int k = 3 * c + d, turned = 3 * d + c;
                    const Lanes before = shifted(last.ef[k], next.ef[k]),
                                before_turned = shifted(last.ef[turned], next.ef[turned]);
                    rows[c][d] = ((shifted(last_xx[k], xx[k]) + xx[k]) - before) - before_turned;
                    rows[c][dofs + d] = (before + next.ef[k]) - xx[k];
                    rows[c][2 * dofs + d] = -next.ef[k];
                }
                const Lanes xt = shifted(last.fb[c], next.fb[c]) + next.ea[c];
                rows[c][spin] = rows[spin][c] = shifted(last.eb[c], next.eb[c]) - xt;
                rows[c][dofs + spin] = -next.eb[c];
                rows[spin][dofs + c] = xt - next.fa[c];
                rows[spin][2 * dofs + c] = next.fa[c];
                rows[c][2 * dofs + spin] = Lanes{};
            }
            rows[spin][spin] = shifted(last.bb, next.bb) + next.aa;
            rows[spin][dofs + spin] = next.ab;
            rows[spin][2 * dofs + spin] = Lanes{};
            for (int l = 0; l < lane_count && at + l < rod.n; ++l) {
                const int after = rod.n - 1 - (at + l);
                if (after >= 2) write_node<2>(band, at + l, l, rows);
                else if (after == 1) write_node<1>(band, at + l, l, rows);
                else write_node<0>(band, at + l, l, rows);
            }
            last = next;
            for (int k = 0; k < 9; ++k) last_xx[k] = xx[k];
        }
    }

    /// Rows of the band that belong to node i, and their mirror images below the diagonal. `after`: nodes that follow, 2 at most.
    template <int after>
    static void write_node(BandRows& band, int i, int l, const Lanes (&rows)[dofs][3 * dofs])
    {
        constexpr int centre = BandRows::half_bandwidth;
        for (int p = 0; p < dofs; ++p) {
            double* row = band.row(RodDofs::position(i, p)) + centre - p;
            for (int q = 0; q < dofs * (1 + after); ++q) row[q] += rows[p][q][l];
        }
        for (int b = 1; b <= after; ++b)
            for (int d = 0; d < (b == 1 ? dofs : RodDofs::coordinates); ++d) {
                double* row = band.row(RodDofs::position(i + b, d)) + centre - d - dofs * b;
                for (int c = 0; c < dofs; ++c) row[c] += rows[c][dofs * b + d][l];
            }
    }
};

/// |kappa - rest_kappa|^2 at inner node i; of a wire that is straight by nature it takes no frame.
double squared_bend(const RodView& rod, const RodFrames& frames, int i)
{
    if (!frames.material) return squared_curvature(curvature_q(rod.curvature), frames.chi[i], frames.kb[i]);
    const double k1 = frames.kappa1[i] - rod.rest_kappa1[i], k2 = frames.kappa2[i] - rod.rest_kappa2[i];
    return k1 * k1 + k2 * k2;
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
        const double twist = frames.twist[i] - rod.rest_twist[i];
        if (!clamped.bend) energy += rod.bend_stiffness[i] * half_inv_cell * squared_bend(rod, frames, i);
        if (!clamped.twist) energy += rod.twist_stiffness[i] * half_inv_cell * twist * twist;
    }
    for (int k = 0; k < static_cast<int>(clamps.size()); ++k)
        for (int side = 0; side < 2; ++side)
            if (clamp_edge(rod, clamps[k].node, side) >= 0)
                energy += clamp_energy(rod, clamps[k], clamp_side(rod, clamps[k], frames, k, side));
    return energy;
}

void add_elastic(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& frames, std::span<double> gradient,
                 BandRows* hessian, HessianMode mode)
{
    SEL_ASSERT(gradient.empty() || static_cast<int>(gradient.size()) >= RodDofs::count(rod.n));
    SEL_VALIDATE(!frames.spins || frames.material || straight_by_nature(rod));
    if (!hessian) mode = HessianMode::None;
    SEL_ASSERT(mode == HessianMode::None || hessian->size() == RodDofs::count(rod.n));
    const Walk walk{rod, clamps, frames, mode};
    if (!gradient.empty()) walk.add_gradient(gradient);
    if (mode != HessianMode::None) walk.add_hessian(*hessian);
}

// E depends on the base edge's rest length l through its strain and through the cells of its two ends. Each has a natural angle
// theta and a compliance C = int ds/B, and E = |kappa - theta|^2/(2 C) with the moment M = (kappa - theta)/C:
//
//     stretch  E = (|e| - l)^2/(2 int ds/EA)         dE/dl = -N - N^2/(2 EA)
//     bend     dE/dl = -M.dtheta/dl - M^2/2 dC/dl
//
// The hub's half cell gains what is fed, with the curvature k and the compliance 1/B; its other end, in the middle of the edge,
// loses half as much of the material m there to the cell before:
//
//     hub      dtheta/dl = k - k_m/2,   dC/dl = 1/B - 1/(2 B_m)
//     before   dtheta/dl = k_m/2,       dC/dl = 1/(2 B_m)
//
// A clamp at the node before the hub shares its cell between both sides by length alone, so that the sum is exact where that cell
// has one material. In a wire of one material both are k/2 and 1/(2 B): -B/4 ((kappa/a)^2 - k^2) in a cell of length a, and for k
// = 0 both together are
// -M^2/(2 B), the configurational force of a sleeve [Bosi14]. Twist has the same with its torque and without a natural angle.
//
// N is the force in the middle of the base edge. If a length dl enters at the inlet x_hub, half as much of the material in the
// middle goes from the hub's mass to that of the node before. The weight does the work -rho A dl g.(x_hub - x_before)/2 less than
// at the inlet's height.
double feed_force(const RodView& rod, const WireSpec& spec, std::span<const RodClamp> clamps, const RodFrames& frames,
                  const Vec3& gravity)
{
    SEL_ASSERT(frames.spins);
    const int j = rod.n - 2, hub = j + 1;
    const WireSection &fed = spec.at(rod.material_s[hub]), &middle = spec.at(0.5 * (rod.material_s[j] + rod.material_s[hub]));
    const double tension = rod.stretch_stiffness[j] * stretch_strain(rod, frames, j);
    double force = -tension - tension * tension / (2 * fed.stretch_stiffness);
    force += 0.5 * middle.density * std::numbers::pi * middle.radius * middle.radius * frames.edge_length[j] *
             gravity.dot(frames.tangent[j]);

    struct Rate {
        Vec2 angle;
        double bend, twist;  // compliance
    };
    const Rate before{0.5 * middle.rest_curvature, 0.5 / middle.bend_stiffness, 0.5 / middle.twist_stiffness};
    const Rate at_hub{fed.rest_curvature - before.angle, 1 / fed.bend_stiffness - before.bend,
                      1 / fed.twist_stiffness - before.twist};
    const auto bend = [](double per_angle, double squared, const Vec2& strain, const Rate& rate) {
        return -per_angle * (strain.dot(rate.angle) + 0.5 * per_angle * squared * rate.bend);
    };
    const auto twist = [](double torque, const Rate& rate) { return -0.5 * torque * torque * rate.twist; };
    if (j > 0) {  // otherwise the tip is the other end, with no energy of its own
        const ClampedNode clamped = clamped_at(clamps, j);
        const double length = rod.voronoi_length(j);
        const Vec2 strain =
            frames.material ? Vec2(frames.kappa1[j] - rod.rest_kappa1[j], frames.kappa2[j] - rod.rest_kappa2[j]) : Vec2::Zero();
        if (!clamped.bend) force += bend(rod.bend_stiffness[j] / length, squared_bend(rod, frames, j), strain, before);
        if (!clamped.twist) force += twist(rod.twist_stiffness[j] / length * (frames.twist[j] - rod.rest_twist[j]), before);
    }
    for (int k = 0; k < static_cast<int>(clamps.size()); ++k) {
        const int node = clamps[k].node, side = node == hub ? 0 : 1;
        if (clamp_edge(rod, node, side) != j) continue;
        const ClampSide s = clamp_side(rod, clamps[k], frames, k, side);
        const Rate& rate = node == hub ? at_hub : before;
        if (clamps[k].direction) {
            const Vec2 strain =
                s.material ? Vec2(kappa_in(s.pair, s.rest.n1) - Vec2(s.rest.kappa1, s.rest.kappa2)) : Vec2::Zero();
            const double squared = s.material ? strain.squaredNorm() : squared_curvature(s.pair.q, s.pair.chi, s.pair.kb);
            force += bend(rod.bend_stiffness[node] / s.half, squared, strain, rate);
        }
        if (clamps[k].spin) force += twist(rod.twist_stiffness[node] / s.half * (s.twist - s.share * rod.rest_twist[node]), rate);
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
