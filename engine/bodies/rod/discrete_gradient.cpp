// Discrete gradients of stretching, bending and twist, stencil by stencil.
#include "rod/discrete_gradient.h"

#include "core/check.h"
#include "rod/clamp.h"
#include "rod/curvature.h"

#include <algorithm>

namespace seldinger {
namespace {

/// sin(x)/x
double sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }

/// A vector at the start and the end of the step.
struct Change {
    Vec3 from, to;
    [[nodiscard]] Vec3 mean() const { return 0.5 * (from + to); }
};

/// A scalar, in the same way.
struct Span {
    double from, to;
    [[nodiscard]] double mean() const { return 0.5 * (from + to); }
    [[nodiscard]] double change() const { return to - from; }
};

Span dot(const Change& a, const Change& b) { return {a.from.dot(b.from), a.to.dot(b.to)}; }

/// An edge, or a clamp, which is one of length 1 that nothing moves.
struct Side {
    Change t, m1, m2;
    Span length{1, 1};
    double turned = 0;
    bool moves = false;

    [[nodiscard]] Vec3 mean_edge() const { return 0.5 * (length.from * t.from + length.to * t.to); }
    /// Force on the edge vector, conjugate to its change, of a moment on the frame; exact in work.
    [[nodiscard]] Vec3 force_of(const Vec3& moment) const
    {
        const Vec3 e = mean_edge();
        const double e2 = e.squaredNorm(), t2 = t.mean().squaredNorm();
        const double along = moment.dot(t.from.cross(t.to)) * length.change() / (4 * length.mean() * t2 * e2);
        return moment.cross(e) / e2 + along * e;
    }
    [[nodiscard]] double torque_of(const Vec3& moment) const
    {
        const double half = 0.5 * turned;
        const double ratio = std::abs(half) < 1e-4 ? 1 + half * half / 3 : std::tan(half) / half;
        return moment.dot(t.mean()) * ratio / t.mean().squaredNorm();
    }
};

Side edge_side(const RodFrames& before, const RodFrames& after, std::span<const double> turned, int j)
{
    Side side;
    side.t = {before.tangent[j], after.tangent[j]};
    side.m1 = {before.m1[j], after.m1[j]};
    side.m2 = {before.m2[j], after.m2[j]};
    side.length = {before.edge_length[j], after.edge_length[j]};
    side.turned = turned[j];
    side.moves = true;
    return side;
}

Side clamp_side_of(const RodClamp& clamp)
{
    Side side;
    const Vec3 second = clamp.tangent.cross(clamp.director);
    side.t = {clamp.tangent, clamp.tangent};
    side.m1 = {clamp.director, clamp.director};
    side.m2 = {second, second};
    return side;
}

/// Data of one stencil: stiffnesses and rest values, and the frame of natural curvature.
struct PathStencil {
    double bend = 0, twist_stiffness = 0;  // B/l, C/l [N m]; 0: not here
    double rest_kappa1 = 0, rest_kappa2 = 0, rest_twist = 0;
    Span twist{0, 0};
    enum class Frame { Midway, First, Second } frame = Frame::Midway;
    double q = 0;
};

/// Gradient of a stencil over e, f (vectors) and their angles.
struct Forces {
    Vec3 e = Vec3::Zero(), f = Vec3::Zero();
    double a = 0, b = 0;
};

Span chi_of(const Side& e, const Side& f) { return {one_plus_cos(e.t.from, f.t.from), one_plus_cos(e.t.to, f.t.to)}; }

/// B/l W(chi), chi = 1 + e.f u v, u = 1/|e|, v = 1/|f|: Delta of the product term by term.
void add_bending(const Side& e, const Side& f, const PathStencil& s, Forces& out)
{
    const Span chi = chi_of(e, f);
    const double slope = s.bend * (-4 * (1 - s.q) / (chi.from * chi.to) - s.q);  // Delta W/Delta chi
    const Span u{1 / e.length.from, 1 / e.length.to}, v{1 / f.length.from, 1 / f.length.to};
    const Span product{(chi.from - 1) * e.length.from * f.length.from, (chi.to - 1) * e.length.to * f.length.to};
    const double weight = 0.5 * (u.from * v.from + u.to * v.to);
    const Vec3 em = e.mean_edge(), fm = f.mean_edge();
    // Delta u = -Delta|e|^2/(2 mean|e| |e0||e1|)
    out.e += slope * (weight * fm - (product.mean() * v.mean() * u.from * u.to / e.length.mean()) * em);
    out.f += slope * (weight * em - (product.mean() * u.mean() * v.from * v.to / f.length.mean()) * fm);
}

/// Moment on e, opposite on f, whose work is Delta(twist): tan(twist) = S/C, S = m2e.m1f - m1e.m2f, C = m1e.m1f + m2e.m2f.
Vec3 twist_moment(const Side& e, const Side& f, const Span& twist)
{
    const Span chi = chi_of(e, f);
    const double sum = chi.from * chi.to;
    const double c = 0.5 * (chi.from * std::cos(twist.from) + chi.to * std::cos(twist.to));
    const double s = 0.5 * (chi.from * std::sin(twist.from) + chi.to * std::sin(twist.to));
    const Vec3 me1 = e.m1.mean(), me2 = e.m2.mean(), mf1 = f.m1.mean(), mf2 = f.m2.mean();
    const Vec3 of_s = me2.cross(mf1) - me1.cross(mf2), of_c = me1.cross(mf1) + me2.cross(mf2);
    return (c * of_s - s * of_c) / (sum * sinc(twist.change()));
}

/// Moment on e, opposite on f, whose work is the change of kappa.rest_kappa = Q P: Q = 2 g/chi, P = sum of w_a (t.m_a), t one
/// side's tangent, m_a the other's directors, w the rest curvature in their frame.
Vec3 rest_moment(const Side& e, const Side& f, const PathStencil& s, const Vec3& by_twist)
{
    const Span chi = chi_of(e, f);
    const Span g{curvature_factor(s.q, chi.from), curvature_factor(s.q, chi.to)};
    const Span big_q{2 * g.from / chi.from, 2 * g.to / chi.to};
    // Delta Q/Delta chi
    const double slope = 0.5 * s.q / g.mean() * 0.5 * (1 / chi.from + 1 / chi.to) - 2 * g.mean() / (chi.from * chi.to);

    const bool second = s.frame == PathStencil::Frame::Second;  // then kappa_a = -Q t_e.m_a(f)
    const Span a1 = second ? dot(e.t, f.m1) : dot(f.t, e.m1), a2 = second ? dot(e.t, f.m2) : dot(f.t, e.m2);
    const Vec3 of_a1 = second ? e.t.mean().cross(f.m1.mean()) : e.m1.mean().cross(f.t.mean());
    const Vec3 of_a2 = second ? e.t.mean().cross(f.m2.mean()) : e.m2.mean().cross(f.t.mean());

    Span w1{s.rest_kappa1, s.rest_kappa1}, w2{s.rest_kappa2, s.rest_kappa2};
    double turn = 0;                          // mean(a).Delta w/Delta twist
    if (s.frame == PathStencil::Frame::Midway) {  // half the twist further on than e's frame
        const double c0 = std::cos(0.5 * s.twist.from), s0 = std::sin(0.5 * s.twist.from);
        const double c1 = std::cos(0.5 * s.twist.to), s1 = std::sin(0.5 * s.twist.to);
        w1 = {c0 * s.rest_kappa1 - s0 * s.rest_kappa2, c1 * s.rest_kappa1 - s1 * s.rest_kappa2};
        w2 = {s0 * s.rest_kappa1 + c0 * s.rest_kappa2, s1 * s.rest_kappa1 + c1 * s.rest_kappa2};
        const double half = 0.5 * sinc(0.25 * s.twist.change());
        const double cm = std::cos(0.5 * s.twist.mean()), sm = std::sin(0.5 * s.twist.mean());
        turn = half *
               (a1.mean() * (-sm * s.rest_kappa1 - cm * s.rest_kappa2) + a2.mean() * (cm * s.rest_kappa1 - sm * s.rest_kappa2));
    }
    const double p = 0.5 * (w1.from * a1.from + w2.from * a2.from + w1.to * a1.to + w2.to * a2.to);
    const Vec3 moment =
        (slope * p) * e.t.mean().cross(f.t.mean()) + big_q.mean() * (w1.mean() * of_a1 + w2.mean() * of_a2 + turn * by_twist);
    return second ? Vec3(-moment) : moment;
}

Forces stencil_forces(const Side& e, const Side& f, const PathStencil& s)
{
    Forces out;
    if (s.bend > 0) add_bending(e, f, s, out);
    const bool curved = s.bend > 0 && (s.rest_kappa1 != 0 || s.rest_kappa2 != 0);
    if (!curved && s.twist_stiffness == 0) return out;
    const bool twists = s.twist_stiffness > 0 || s.frame == PathStencil::Frame::Midway;
    const Vec3 by_twist = twists ? twist_moment(e, f, s.twist) : Vec3(Vec3::Zero());
    Vec3 moment = (s.twist_stiffness * (s.twist.mean() - s.rest_twist)) * by_twist;
    if (curved) moment -= s.bend * rest_moment(e, f, s, by_twist);
    if (e.moves) {
        out.e += e.force_of(moment);
        out.a = e.torque_of(moment);
    }
    if (f.moves) {
        out.f -= f.force_of(moment);
        out.b = -f.torque_of(moment);
    }
    return out;
}

void add_vector(double* to, const Vec3& v)
{
    to[0] += v.x();
    to[1] += v.y();
    to[2] += v.z();
}

/// dE/d(edge vector) and dE/d(angle) of edge j into the nodes' gradient.
void add_edge(std::span<double> gradient, int j, const Vec3& force, double torque)
{
    add_vector(&gradient[RodDofs::position(j)], -force);
    add_vector(&gradient[RodDofs::position(j + 1)], force);
    gradient[RodDofs::spin(j)] += torque;
}

}  // namespace

void add_discrete_gradient(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& before, const RodFrames& after,
                           std::span<const double> turned, std::span<double> gradient, double base_grown)
{
    SEL_ASSERT(static_cast<int>(gradient.size()) >= RodDofs::count(rod.n) && static_cast<int>(turned.size()) >= rod.n - 1);
    const double q = curvature_q(rod.curvature);
    Side e;
    for (int j = 0; j < rod.n - 1; ++j) {
        const Side f = edge_side(before, after, turned, j);
        // (D1): Delta E/Delta|e|^2 = EA/(2 l) (1 - l/mean|e|)
        const double length = f.length.mean() + feed_stretch(rod, before, j, base_grown);
        const double tension = rod.stretch_stiffness[j] * (length / rod.rest_length[j] - 1);
        add_edge(gradient, j, tension * mean_direction(before, after, j), 0);
        if (j > 0) {
            const ClampedNode clamped = clamped_at(clamps, j);
            const double inv_cell = 1 / rod.voronoi_length(j);
            PathStencil s;
            s.bend = clamped.bend ? 0 : rod.bend_stiffness[j] * inv_cell;
            s.twist_stiffness = clamped.twist || !after.spins ? 0 : rod.twist_stiffness[j] * inv_cell;
            s.rest_kappa1 = rod.rest_kappa1[j];
            s.rest_kappa2 = rod.rest_kappa2[j];
            s.rest_twist = rod.rest_twist[j];
            s.twist = {before.twist[j], after.twist[j]};
            s.q = q;
            const Forces forces = stencil_forces(e, f, s);
            add_edge(gradient, j - 1, forces.e, forces.a);
            add_edge(gradient, j, forces.f, forces.b);
        }
        e = f;
    }
    for (int k = 0; k < static_cast<int>(clamps.size()); ++k) {
        const RodClamp& clamp = clamps[k];
        for (int side = 0; side < 2; ++side) {
            const int j = clamp_edge(rod, clamp.node, side);
            if (j < 0) continue;
            const ClampSide now = clamp_side(rod, clamp, after, k, side);
            PathStencil s;
            s.bend = clamp.direction ? rod.bend_stiffness[clamp.node] / now.half : 0;
            s.twist_stiffness = clamp.spin && after.spins ? rod.twist_stiffness[clamp.node] / now.half : 0;
            s.rest_kappa1 = now.rest.kappa1;
            s.rest_kappa2 = now.rest.kappa2;
            s.rest_twist = now.share * rod.rest_twist[clamp.node];
            s.twist = {before.clamp_twist[2 * k + side], after.clamp_twist[2 * k + side]};
            if (!clamp.spin) s.frame = side == 0 ? PathStencil::Frame::First : PathStencil::Frame::Second;
            s.q = q;
            const Side edge = edge_side(before, after, turned, j), fixed = clamp_side_of(clamp);
            const Forces forces = side == 0 ? stencil_forces(edge, fixed, s) : stencil_forces(fixed, edge, s);
            if (side == 0) add_edge(gradient, j, forces.e, forces.a);
            else add_edge(gradient, j, forces.f, forces.b);
        }
    }
}

}  // namespace seldinger
