#pragma once
// Bending and twist where two edges meet (or an edge meets a clamp): the stencil of D2 and D3 with its derivatives.
//
// Unknowns of the stencil are the edge vectors e (tip side) and f (hub side) and the angles theta_e, theta_f. With unit
// tangents te, tf:   chi = 1 + te.tf,   tt = (te + tf)/chi,   kb = 2 te x tf/chi,   |kb| = 2 tan(phi/2), phi the turning angle.
// Curvature is g kb, g a function of chi (rod/curvature.h): g kb.n replaces kb.n of the papers below. W = |g kb|^2/2.
//
// **Which material frame kappa is measured in.** [Bergou10] averages the directors of both edges, kappa1 = kb.(m2e + m2f)/2.
// That is |kb| cos(tau/2) times the true component: bending stiffness would fade with the twist tau of the node, vanish at
// tau = pi and come back. Here kappa is measured in the frame midway between them (e's frame turned by +tau/2, f's by
// -tau/2, so that there is no twist left between these two, n_e and n_f):
//     kappa1 = g kb.(n2e + n2f)/2 = g kb.n2e,   kappa2 = -g kb.(n1e + n1f)/2 = -g kb.n1e.
// Both agree to O(tau^2); this one holds for any tau, several turns included, and an isotropic wire with no natural
// curvature needs no frame at all: |kappa|^2 = 2 W. Derivatives with respect to e and f are those of [Bergou10] and [Jawed18]
// with n for m (the twist's own variation cancels). For either angle d kappa1/d theta = kappa2/2, d kappa2/d theta = -kappa1/2.
//
// A clamp that holds only the direction has no director: its frame follows the edge's. That is the same formula with the frame
// taken at a share lambda = 1/2 + mu of the twist, counted from e. Between edges mu = 0. At a clamp that is the tip-side partner
// (the frame is f's) it is +1/2, at one on the hub side -1/2.
//
// **Hessian, projected.** Newton needs a descent direction, so each stencil must be positive semidefinite; an eigenvalue
// decomposition of 8x8 per node costs as much as the whole step. In the basis of the stencil (in-plane g = b x t, out of
// plane b = kb/|kb|) the exact Hessian of W splits, apart from the coupling of an edge's rotation with its own
// lengthening, into 2x2 blocks whose projection onto the positive ones is known in closed form, c = chi - 1 = cos(phi):
//     in plane, on the turning angle:   -c W' + sin^2 W''     (Gauss-Newton alone: chi^2 W'^2/(4 g^2))
//     out of plane, on the difference:  -chi W'/2             (Gauss-Newton alone: g^2)
// So the projection keeps exact curvature for every change of the turning angle. It drops the indefinite parts: the common
// out-of-plane rotation of both edges, (2 - chi) W'/2, and the lengthening coupling. Stretching stiffness keeps the latter from
// acting (EA l^2/B >= 100 for edges of five radii). With natural curvature and kappa near it, Gauss-Newton B/l sum_a grad
// kappa_a grad kappa_a^T is exact. In between the two are blended by s = 1 - kappa.rest_kappa/|kappa|^2 in [0, 1]: a convex
// combination of positive semidefinite matrices. Twist: Gauss-Newton (dropped: stored moment times the Hessian of the writhe).
// Near a solution, Newton's method converges linearly with it, at a rate set by shear force and torque over stiffness. With
// Exact it converges quadratically: try that first wherever it can be factorised. Measured: a cantilever of 100 nodes whipped
// through large angles at 1 ms takes 4.0 iterations with either, under axial load 5.3 (Projected) and 4.7 (Exact).

#include "rod/curvature.h"
#include "rod/elastic.h"
#include "rod/transport.h"

#include <algorithm>

namespace seldinger {

/// Two unit tangents that meet. An inverse length of 0 marks a clamp: a tangent that does not move.
struct Pair {
    Vec3 te, tf;
    double inv_e = 0, inv_f = 0;  // 1/|e|, 1/|f| [1/m]
    Vec3 kb;
    double chi = 2;        // 1 + te.tf
    double q = 2.0 / 3.0;  // of the measure of curvature (rod/curvature.h)
};

/// Gradient and Hessian of a stencil's energy over e, f (vectors) and a = theta_e, b = theta_f.
struct PairTerms {
    Vec3 ge = Vec3::Zero(), gf = Vec3::Zero();
    double ga = 0, gb = 0;
    Mat3 ee = Mat3::Zero(), ef = Mat3::Zero(), ff = Mat3::Zero();
    Vec3 ea = Vec3::Zero(), eb = Vec3::Zero(), fa = Vec3::Zero(), fb = Vec3::Zero();
    double aa = 0, ab = 0, bb = 0;
};

/// a b^T + b a^T
inline Mat3 both(const Vec3& a, const Vec3& b)
{
    const Mat3 m = outer(a, b);
    return m + m.transpose();
}

/// Natural curvature and the frame that it is fixed to, at one stencil.
struct RestBend {
    double kappa1 = 0, kappa2 = 0;  // integrated [-]
    Vec3 n1 = Vec3::Zero();         // first director of the kappa frame, at te
    double mu = 0;                  // see top of file
};

/// Curvature's components in the frame whose first director, at te, is n1.
inline Vec2 kappa_in(const Pair& pair, const Vec3& n1)
{
    const Vec3 curvature = curvature_factor(pair.q, pair.chi) * pair.kb;
    return {curvature.dot(pair.te.cross(n1)), -curvature.dot(n1)};
}

/// Hessian of chi = 1 + te.tf.
struct ChiHessian {
    Mat3 ee, ef, ff;
    explicit ChiHessian(const Pair& p)
    {
        const double c = p.chi - 1;
        const Vec3 fe = p.tf - c * p.te, ef_ = p.te - c * p.tf;  // normal to te, to tf
        const Mat3 one = Mat3::Identity();
        ee = -p.inv_e * p.inv_e * (both(p.te, fe) + c * (one - outer(p.te, p.te)));
        ff = -p.inv_f * p.inv_f * (both(p.tf, ef_) + c * (one - outer(p.tf, p.tf)));
        ef = p.inv_e * p.inv_f * (one - outer(p.te, p.te) - outer(p.tf, p.tf) + outer(c * p.te, p.tf));
    }
};

/// W times `stiffness`: bending with no natural curvature, gradient.
inline void add_bend_gradient(const Pair& p, double stiffness, PairTerms& out)
{
    const double c = p.chi - 1, slope = stiffness * bend_slope(p.q, p.chi);
    out.ge += (slope * p.inv_e) * (p.tf - c * p.te);
    out.gf += (slope * p.inv_f) * (p.te - c * p.tf);
}

/// Exact Hessian of the same.
inline void add_bend_hessian_exact(const Pair& p, double stiffness, PairTerms& out)
{
    const double c = p.chi - 1, d1 = stiffness * bend_slope(p.q, p.chi), d2 = stiffness * bend_slope_rate(p.q, p.chi);
    const Vec3 fe = p.tf - c * p.te, ef = p.te - c * p.tf;
    const ChiHessian chi(p);
    out.ee += outer((d2 * p.inv_e * p.inv_e) * fe, fe) + d1 * chi.ee;
    out.ff += outer((d2 * p.inv_f * p.inv_f) * ef, ef) + d1 * chi.ff;
    out.ef += outer((d2 * p.inv_e * p.inv_f) * fe, ef) + d1 * chi.ef;
}

/// Projected Hessian: omega (projector on b) + alpha (projector on g) in each block. It is written so that nothing is singular in
/// a straight wire: b b^T = 1 - t t^T - g g^T, sin^2 g_e g_e^T = fe fe^T, and gamma = (alpha - omega)/sin^2.
/// @param s      1: no natural curvature felt, projected exact Hessian; 0: Gauss-Newton
/// @param share  1 between edges; 1 - |kb|^2/4 = 2 c/chi at a clamp whose frame follows the edge (Gauss-Newton's d kappa/dx
///               is that much smaller out of plane)
inline void add_bend_hessian_safe(const Pair& p, double stiffness, double s, double share, PairTerms& out)
{
    const double c = p.chi - 1, inv_chi = 1 / p.chi, rest = 4 * (1 - p.q);
    const double slope = bend_slope(p.q, p.chi), factor2 = curvature_factor_squared(p.q, p.chi);
    const double newton_gamma =  // Gauss-Newton's, (alpha - omega)/sin^2 with the sine divided out
        (share == 1 ? 0.5 * rest * (2 * factor2 - p.chi * slope) : (rest + p.q * p.chi) * (rest + p.q * (3 * p.chi - 2))) *
        (0.25 * inv_chi * inv_chi / factor2);
    const double omega = stiffness * (-0.5 * s * p.chi * slope + (1 - s) * factor2 * share * share);
    const double gamma = stiffness * (s * (0.5 * slope * inv_chi + bend_slope_rate(p.q, p.chi)) + (1 - s) * newton_gamma);
    const Vec3 fe = p.tf - c * p.te, ef = p.te - c * p.tf, q = (0.5 * p.chi) * p.kb;  // q = te x tf
    const Mat3 one = Mat3::Identity();
    out.ee += p.inv_e * p.inv_e * (omega * (one - outer(p.te, p.te)) + outer(gamma * fe, fe));
    out.ff += p.inv_f * p.inv_f * (omega * (one - outer(p.tf, p.tf)) + outer(gamma * ef, ef));
    const Mat3 f_to_e = c * one - skew(q) + outer(inv_chi * q, q);  // rotation that takes tf to te
    out.ef -= p.inv_e * p.inv_f * (omega * (f_to_e - outer(p.te, p.tf)) - outer(gamma * fe, ef));
}

/// kb.w_e with w fixed to the kappa frame, and its derivatives with respect to e and f.
struct FrameDot {
    Vec3 we, wf, td, grad_e, grad_f;
    double value;
    FrameDot(const Pair& p, const Vec3& w, const Vec3& tt)
        : we(w), wf(parallel_transport(w, p.te, p.tf, p.chi)), td((we + wf) / p.chi), value(p.kb.dot(we))
    {
        grad_e = p.inv_e * (p.tf.cross(td) - value * tt);
        grad_f = p.inv_f * (-p.te.cross(td) - value * tt);
    }
};

/// Second derivatives of the twist angle (of the writhe), times `moment`.
inline void add_twist_curvature(const Pair& p, double moment, PairTerms& out)
{
    const Vec3 tt = (p.te + p.tf) / p.chi, mk = moment * p.kb;
    out.ee -= 0.25 * p.inv_e * p.inv_e * both(mk, p.te + tt);
    out.ff -= 0.25 * p.inv_f * p.inv_f * both(mk, p.tf + tt);
    out.ef += 0.5 * p.inv_e * p.inv_f * (skew((2 * moment / p.chi) * p.te) - outer(mk, tt));
}

/// What natural curvature adds: the energy term -stiffness kappa.rest_kappa, with everything that belongs to it.
inline void add_rest_bend(const Pair& p, double stiffness, const RestBend& rest, HessianMode mode, PairTerms& out)
{
    const Vec3 tt = (p.te + p.tf) / p.chi, n2 = p.te.cross(rest.n1);
    const Vec3 w = rest.kappa1 * n2 - rest.kappa2 * rest.n1;
    const FrameDot dot(p, w, tt);              // kappa.rest_kappa
    const FrameDot rot(p, p.te.cross(w), tt);  // its derivative with respect to the frame's angle
    const double mu = rest.mu, ca = 0.5 - mu, cb = 0.5 + mu, k = dot.value;
    const double g = curvature_factor(p.q, p.chi), g1 = 0.25 * p.q / g, g2 = -g1 * g1 / g;  // g and its derivatives by chi
    const Vec3 twist_e = 0.5 * p.inv_e * p.kb, twist_f = 0.5 * p.inv_f * p.kb;              // grad of the twist
    const Vec3 chi_e = p.inv_e * (p.tf - (p.chi - 1) * p.te), chi_f = p.inv_f * (p.te - (p.chi - 1) * p.tf);
    const Vec3 grad_e = dot.grad_e + (mu * rot.value) * twist_e, grad_f = dot.grad_f + (mu * rot.value) * twist_f;
    out.ge -= stiffness * (g * grad_e + (k * g1) * chi_e);
    out.gf -= stiffness * (g * grad_f + (k * g1) * chi_f);
    out.ga -= stiffness * g * ca * rot.value;
    out.gb -= stiffness * g * cb * rot.value;
    if (mode != HessianMode::Exact) return;

    // g times what the papers have for kb.w, then what g's own change adds
    const double scaled = stiffness * g, ie = p.inv_e, jf = p.inv_f;
    const Vec3 te_dd = p.te.cross(dot.td), tf_dd = p.tf.cross(dot.td);
    const Mat3 one = Mat3::Identity();
    const Mat3 tt2 = outer((2 * k) * tt, tt);
    Mat3 ee = ie * ie * (tt2 - both(tf_dd, tt) - (k / p.chi) * (one - outer(p.te, p.te)) + 0.25 * both(p.kb, dot.we));
    Mat3 ff = jf * jf * (tt2 + both(te_dd, tt) - (k / p.chi) * (one - outer(p.tf, p.tf)) + 0.25 * both(p.kb, dot.wf));
    Mat3 ef = ie * jf * (tt2 - (k / p.chi) * (one + outer(p.te, p.tf)) - outer(tf_dd, tt) + outer(tt, te_dd) - skew(dot.td));
    // the frame itself turns by lambda d(twist) at e and -(1 - lambda) d(twist) at f
    const double turn = (0.25 - mu * mu) * k;
    ee += outer(turn * twist_e, twist_e) + mu * both(rot.grad_e, twist_e);
    ff += outer(turn * twist_f, twist_f) + mu * both(rot.grad_f, twist_f);
    ef += outer(turn * twist_e, twist_f) + mu * (outer(rot.grad_e, twist_f) + outer(twist_e, rot.grad_f));
    const ChiHessian chi(p);
    const double first = stiffness * g1, second = stiffness * k * g2;
    out.ee -= scaled * ee + first * (both(chi_e, grad_e) + k * chi.ee) + outer(second * chi_e, chi_e);
    out.ff -= scaled * ff + first * (both(chi_f, grad_f) + k * chi.ff) + outer(second * chi_f, chi_f);
    out.ef -= scaled * ef + first * (outer(chi_e, grad_f) + outer(grad_e, chi_f) + k * chi.ef) + outer(second * chi_e, chi_f);
    if (mu != 0) add_twist_curvature(p, -scaled * mu * rot.value, out);
    const Vec3 ea = scaled * (rot.grad_e - (mu * k) * twist_e) + (first * rot.value) * chi_e;
    const Vec3 fa = scaled * (rot.grad_f - (mu * k) * twist_f) + (first * rot.value) * chi_f;
    out.ea -= ca * ea;
    out.eb -= cb * ea;
    out.fa -= ca * fa;
    out.fb -= cb * fa;
    out.aa += scaled * ca * ca * k;
    out.ab += scaled * ca * cb * k;
    out.bb += scaled * cb * cb * k;
}

/// Bending energy stiffness |kappa - rest_kappa|^2/2 of one stencil, stiffness = B/l [N m].
inline void add_bend(const Pair& p, double stiffness, const RestBend& rest, HessianMode mode, PairTerms& out)
{
    const bool straight = rest.kappa1 == 0 && rest.kappa2 == 0;
    add_bend_gradient(p, stiffness, out);
    if (!straight) add_rest_bend(p, stiffness, rest, mode, out);
    if (mode == HessianMode::Exact) add_bend_hessian_exact(p, stiffness, out);
    if (mode != HessianMode::Projected) return;
    if (straight) return add_bend_hessian_safe(p, stiffness, 1, 1, out);

    const Vec2 kappa = kappa_in(p, rest.n1);
    const double square = kappa.squaredNorm(), dot = kappa[0] * rest.kappa1 + kappa[1] * rest.kappa2;
    const double s = square > 0 ? std::clamp(1 - dot / square, 0.0, 1.0) : 0.0;
    const double share = rest.mu == 0 ? 1 : 2 - 2 / p.chi, ca = 0.5 - rest.mu, cb = 0.5 + rest.mu;
    add_bend_hessian_safe(p, stiffness, s, share, out);
    // Gauss-Newton's part on the angles: turning the frame by d moves kappa by |kappa| d, out of plane
    const double g = stiffness * (1 - s) * curvature_factor_squared(p.q, p.chi);
    const Vec3 e = (g * share * p.inv_e) * p.kb, f = (-g * share * p.inv_f) * p.kb;
    out.ea += ca * e;
    out.eb += cb * e;
    out.fa += ca * f;
    out.fb += cb * f;
    const double turning = stiffness * (1 - s) * square;
    out.aa += turning * ca * ca;
    out.ab += turning * ca * cb;
    out.bb += turning * cb * cb;
}

/// Twisting energy stiffness (tau - rest)^2/2, stiffness = C/l [N m], strain = tau - rest [rad]:
/// d tau = kb.(de/|e| + df/|f|)/2 + d theta_f - d theta_e   [Bergou08, eq. 9]
inline void add_twist(const Pair& p, double stiffness, double strain, HessianMode mode, PairTerms& out)
{
    const double moment = stiffness * strain;
    const Vec3 e = 0.5 * p.inv_e * p.kb, f = 0.5 * p.inv_f * p.kb;
    out.ge += moment * e;
    out.gf += moment * f;
    out.ga -= moment;
    out.gb += moment;
    if (mode == HessianMode::None) return;
    if (mode == HessianMode::Exact) add_twist_curvature(p, moment, out);
    const Vec3 se = stiffness * e, sf = stiffness * f;
    out.ee += outer(se, e);
    out.ff += outer(sf, f);
    out.ef += outer(se, f);
    out.ea -= se;
    out.eb += se;
    out.fa -= sf;
    out.fb += sf;
    out.aa += stiffness;
    out.ab -= stiffness;
    out.bb += stiffness;
}

}  // namespace seldinger
