// Energy of a cell of a centreline that instruments share, and its derivatives.
//
// In a cell, with complex numbers for the two components of curvature in the frame midway between the edges' reference frames:
// phase_k = exp(i phi_k), phi_k the mean of the angles of instrument k on both edges, r_k = phase_k rest_k:
//     E = 1/2 S |f kappa - sum r_k|^2 + forced - sum_{k<l} Re(conj(phase_k) phase_l couple_kl),   S = 1/compliance
//       = S f^2 |kappa|^2/2 - sum S f kappa.r_k + sum_{k<l} Re(conj(phase_k) phase_l G_kl) + const,
//     G_kl = S conj(rest_k) rest_l - couple_kl
// The first two are rod/pair.h's; the third knows angles only.
#include "rod/coaxial_stencil.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

using namespace coaxial;

namespace {

Complex complex(const Vec2& v) { return {v[0], v[1]}; }
/// conj(a) b's real part is the scalar product.
double dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }

void set_angle(Stencil& s, int k, double phi)
{
    s.phi[k] = phi;
    s.phase[k] = {std::cos(phi), std::sin(phi)};
}

}  // namespace

Stencil coaxial::stencil_at(const CoaxialShape& shape, int i)
{
    const auto& [rod, line, trial, base, f] = shape;
    if (i == 0) {
        Stencil tip;
        tip.end = true;
        for (int k = 0; k < rod.instruments; ++k) set_angle(tip, k, trial.theta[k][0]);
        return tip;
    }
    const bool hub = i == line.n - 1;
    Stencil s;
    Pair& pair = s.pair;
    pair.te = f.tangent[i - 1];
    pair.tf = hub ? base.tangent : f.tangent[i];
    pair.inv_e = 1 / f.edge_length[i - 1];
    pair.inv_f = hub ? 0 : 1 / f.edge_length[i];
    pair.chi = hub ? one_plus_cos(pair.te, pair.tf) : f.chi[i];
    pair.kb = hub ? Vec3((2 / pair.chi) * pair.te.cross(pair.tf)) : f.kb[i];
    pair.q = curvature_q(line.curvature);
    const double ref_twist = hub ? f.clamp_ref_twist[0] : f.ref_twist[i];
    s.n1 = turned(f.d1[i - 1], pair.te, 0.5 * ref_twist);
    s.kappa = complex(kappa_in(pair, s.n1));
    for (int k = 0; k < rod.instruments; ++k) {
        const double a = trial.theta[k][i - 1], b = trial.theta[k][i];
        set_angle(s, k, 0.5 * (a + b));
        s.twist[k] = b - a + ref_twist;
    }
    return s;
}

namespace {

/// f kappa - sum r_k
Complex bend_strain(const CoaxialCell& cell, const Stencil& s, int instruments)
{
    if (s.end) return 0;
    Complex strain = cell.covered / cell.length * s.kappa;
    for (int k = 0; k < instruments; ++k) strain -= s.phase[k] * cell.rest[k];
    return strain;
}

}  // namespace

double coaxial::cell_energy(const CoaxialCell& cell, const Stencil& s, int instruments)
{
    if (!(cell.covered > 0)) return 0;
    double energy = 0.5 / cell.compliance * std::norm(bend_strain(cell, s, instruments)) + cell.forced;
    for (int k = 0; k < instruments; ++k) {
        for (int l = k + 1; l < instruments; ++l) energy -= dot(s.phase[k], s.phase[l] * cell.couple[coaxial_pair(k, l)]);
        if (s.end || !(cell.twist_covered[k] > 0)) continue;
        const double twist = cell.twist_covered[k] / cell.length * s.twist[k];
        energy += 0.5 * twist * twist / cell.twist_compliance[k];
    }
    return energy;
}

double coaxial::cell_energy_rate(const CoaxialCell& cell, const CoaxialCell& rate, const Stencil& s, int instruments)
{
    if (!(cell.covered > 0)) return 0;
    const auto part_rate = [&](double covered, double gained) {
        return (gained - covered / cell.length * rate.length) / cell.length;
    };
    const Complex strain = bend_strain(cell, s, instruments);
    Complex strain_rate = part_rate(cell.covered, rate.covered) * s.kappa;  // of no account at the tip
    for (int k = 0; k < instruments; ++k) strain_rate -= s.phase[k] * rate.rest[k];
    double energy = (dot(strain, strain_rate) - 0.5 * std::norm(strain) * rate.compliance / cell.compliance) / cell.compliance;
    energy += rate.forced;
    for (int k = 0; k < instruments; ++k) {
        for (int l = k + 1; l < instruments; ++l) energy -= dot(s.phase[k], s.phase[l] * rate.couple[coaxial_pair(k, l)]);
        if (s.end || !(cell.twist_covered[k] > 0)) continue;
        const double twist = cell.twist_covered[k] / cell.length * s.twist[k], inv = 1 / cell.twist_compliance[k];
        energy += inv * twist * part_rate(cell.twist_covered[k], rate.twist_covered[k]) * s.twist[k];
        energy -= 0.5 * twist * twist * inv * inv * rate.twist_compliance[k];
    }
    return energy;
}

namespace {

/// The term that knows angles only; exact, or its share that is never negative without what Gauss-Newton has.
void add_coupling(const CoaxialCell& cell, const Stencil& s, int k, int l, HessianMode mode, StencilTerms& out)
{
    const Complex product = std::conj(cell.rest[k]) * cell.rest[l] / cell.compliance;
    const Complex turning = std::conj(s.phase[k]) * s.phase[l], couple = cell.couple[coaxial_pair(k, l)];
    const Complex energy = turning * (product - couple);  // its real part
    const double slope = -0.5 * energy.imag();
    out.own[k].ga -= slope;
    out.own[k].gb -= slope;
    out.own[l].ga += slope;
    out.own[l].gb += slope;
    if (mode == HessianMode::None) return;
    const double second = 0.25 * (mode == HessianMode::Exact ? -energy.real() : std::max(0.0, (turning * couple).real()));
    for (PairTerms* own : {&out.own[k], &out.own[l]}) {
        own->aa += second;
        own->ab += second;
        own->bb += second;
    }
    out.cross[k][l] -= second;
}

/// Positive semidefinite Hessian of bending: the wire's, blended by the effective natural curvature (rod/pair.h). For the part (1
/// - blend) it has the angles' part of Gauss-Newton with the residual f kappa - sum r_k in the reference frame.
void add_bend_safe(const CoaxialCell& cell, const Stencil& s, int instruments, StencilTerms& out)
{
    const Pair& p = s.pair;
    const double part = cell.covered / cell.length, square = part * std::norm(s.kappa), stiffness = 1 / cell.compliance;
    Complex rest = 0;
    for (int k = 0; k < instruments; ++k) rest += s.phase[k] * cell.rest[k];
    double blend = 1;
    if (rest != 0.0) blend = square > 0 ? std::clamp(1 - dot(s.kappa, rest) / square, 0.0, 1.0) : 0.0;
    add_bend_hessian_safe(p, part * part * stiffness, blend, 1, out.common);
    if (blend == 1) return;

    const Vec3 tt = (p.te + p.tf) / p.chi, n2 = p.te.cross(s.n1);
    const Vec3 chi_e = p.inv_e * (p.tf - (p.chi - 1) * p.te), chi_f = p.inv_f * (p.te - (p.chi - 1) * p.tf);
    const double g = curvature_factor(p.q, p.chi), g1 = 0.25 * p.q / g, scaled = (1 - blend) * stiffness;
    for (int k = 0; k < instruments; ++k) {
        if (cell.rest[k] == 0.0) continue;
        const Complex turning = Complex(0, 1) * s.phase[k] * cell.rest[k];  // d r_k / d phi_k
        const FrameDot along(p, turning.real() * n2 - turning.imag() * s.n1, tt);
        const Vec3 e = (-0.5 * scaled * part) * (g * along.grad_e + (along.value * g1) * chi_e);
        const Vec3 f = (-0.5 * scaled * part) * (g * along.grad_f + (along.value * g1) * chi_f);
        PairTerms& own = out.own[k];
        own.ea += e;
        own.eb += e;
        own.fa += f;
        own.fb += f;
        for (int l = 0; l <= k; ++l) {
            const double second = 0.25 * scaled * dot(s.phase[k] * cell.rest[k], s.phase[l] * cell.rest[l]);
            if (l < k) {
                out.cross[l][k] += second;
                continue;
            }
            own.aa += second;
            own.ab += second;
            own.bb += second;
        }
    }
}

}  // namespace

/// The tip's half cell: where its bending has relaxed, what forcing costs is left, of the angles of the first edge.
void coaxial::add_end(const CoaxialCell& cell, const Stencil& s, int instruments, HessianMode mode, StencilTerms& out)
{
    for (int l = 0; l < instruments; ++l)
        for (int k = 0; k < l; ++k) {
            const Complex energy = std::conj(s.phase[k]) * s.phase[l] * cell.couple[coaxial_pair(k, l)];  // minus its real part
            out.own[k].gb -= energy.imag();
            out.own[l].gb += energy.imag();
            if (mode == HessianMode::None) continue;
            const double second = mode == HessianMode::Exact ? energy.real() : std::max(0.0, energy.real());
            out.own[k].bb += second;
            out.own[l].bb += second;
            out.cross[k][l] -= second;
        }
}

void coaxial::add_cell(const CoaxialCell& cell, const Stencil& s, int instruments, HessianMode mode, StencilTerms& out)
{
    if (!(cell.covered > 0)) return;
    const double part = cell.covered / cell.length, stiffness = 1 / cell.compliance;
    add_bend_gradient(s.pair, part * part * stiffness, out.common);
    if (mode == HessianMode::Exact) add_bend_hessian_exact(s.pair, part * part * stiffness, out.common);
    for (int k = 0; k < instruments; ++k) {
        PairTerms& own = out.own[k];
        if (cell.rest[k] != 0.0) {
            const RestBend rest{cell.rest[k].real(), cell.rest[k].imag(), turned(s.n1, s.pair.te, s.phi[k])};
            add_rest_bend(s.pair, part * stiffness, rest, mode, own);
        }
        for (int l = k + 1; l < instruments; ++l)
            if (cell.rest[k] != 0.0 && cell.rest[l] != 0.0) add_coupling(cell, s, k, l, mode, out);
        if (!(cell.twist_covered[k] > 0)) continue;
        const double twist_part = cell.twist_covered[k] / cell.length;
        add_twist(s.pair, twist_part * twist_part / cell.twist_compliance[k], s.twist[k], mode, own);
    }
    if (mode == HessianMode::Projected) add_bend_safe(cell, s, instruments, out);
    for (int k = 0; k < instruments; ++k) {
        const PairTerms& own = out.own[k];
        out.common.ge += own.ge;
        out.common.gf += own.gf;
        out.common.ee += own.ee;
        out.common.ef += own.ef;
        out.common.ff += own.ff;
    }
}

}  // namespace seldinger
