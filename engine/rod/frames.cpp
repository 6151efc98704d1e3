// Frames of a wire: parallel transport in time of each edge's reference frame, reference twist, curvature, twist.

#include "core/check.h"
#include "rod/clamp.h"
#include "rod/curvature.h"
#include "rod/elastic.h"
#include "rod/transport.h"

#include <algorithm>

namespace seldinger {

RodFrames::RodFrames(int capacity, int clamp_capacity)
    : tangent(capacity),
      d1(capacity),
      m1(capacity),
      m2(capacity),
      kb(capacity),
      edge_length(capacity),
      chi(capacity),
      ref_twist(capacity),
      kappa1(capacity),
      kappa2(capacity),
      twist(capacity),
      clamp_node(clamp_capacity),
      clamp_ref_twist(2 * clamp_capacity),
      clamp_twist(2 * clamp_capacity)
{
}

namespace {

/// Tangent, reference and material frame of edge j. @return false when the edge has no direction or has turned by pi
bool update_edge(const RodView& rod, const RodTrial& q, int j, RodFrames& frames)
{
    const Vec3 edge(q.x[j + 1] - q.x[j], q.y[j + 1] - q.y[j], q.z[j + 1] - q.z[j]);
    const double length = edge.norm();
    if (!(length > 0 && std::isfinite(length) && std::isfinite(q.theta[j]))) return false;

    const Vec3 before = rod.tangent(j), now = edge / length;
    const double chi = one_plus_cos(before, now);
    if (!(chi > fold_limit)) return false;
    frames.edge_length[j] = length;
    frames.tangent[j] = now;
    if (!frames.spins) return true;

    const Vec3 d1 = parallel_transport(rod.ref_d1(j), before, now, chi), d2 = now.cross(d1);
    const double c = std::cos(q.theta[j]), s = std::sin(q.theta[j]);
    frames.d1[j] = d1;
    frames.m1[j] = c * d1 + s * d2;
    frames.m2[j] = c * d2 - s * d1;
    return true;
}

/// Curvature binormal, reference twist, twist and kappa of inner node i. @return false when the wire is folded there
bool update_node(const RodView& rod, const RodTrial& q, int i, RodFrames& frames)
{
    const Vec3 &te = frames.tangent[i - 1], &tf = frames.tangent[i];
    const double chi = one_plus_cos(te, tf);
    if (!(chi > fold_limit)) return false;
    const Vec3 kb = (2 / chi) * te.cross(tf);
    frames.chi[i] = chi;
    frames.kb[i] = kb;
    if (!frames.spins) return true;

    const Vec3 carried = parallel_transport(frames.d1[i - 1], te, tf, chi);
    const double ref_twist = unwrap(signed_angle(carried, frames.d1[i], tf), rod.ref_twist[i]);
    const double twist = q.theta[i] - q.theta[i - 1] + ref_twist;

    // components in the midway frame: those in e's material frame, seen from half the twist further on
    const double g = curvature_factor(curvature_q(rod.curvature), chi);
    const double k1 = g * kb.dot(frames.m2[i - 1]), k2 = -g * kb.dot(frames.m1[i - 1]);
    const double c = std::cos(0.5 * twist), s = std::sin(0.5 * twist);
    frames.ref_twist[i] = ref_twist;
    frames.twist[i] = twist;
    frames.kappa1[i] = c * k1 + s * k2;
    frames.kappa2[i] = c * k2 - s * k1;
    return true;
}

/// Whether nothing in the wire is fixed to its material frames.
[[maybe_unused]] bool has_no_frame(const RodView& rod)
{
    for (int i = 0; i < rod.n; ++i)
        if (rod.rest_kappa1[i] != 0 || rod.rest_kappa2[i] != 0 || rod.rest_twist[i] != 0) return false;
    return true;
}

void clear_end(RodFrames& frames, int i)
{
    frames.kb[i].setZero();
    frames.chi[i] = 2;
    frames.ref_twist[i] = frames.twist[i] = frames.kappa1[i] = frames.kappa2[i] = 0;
}

}  // namespace

bool update_frames(const RodView& rod, const RodTrial& trial, std::span<const RodClamp> clamps, RodFrames& frames)
{
    SEL_ASSERT(rod.n >= 2 && rod.n <= static_cast<int>(frames.kb.size()));
    SEL_ASSERT(clamps.size() <= frames.clamp_node.size());
    SEL_VALIDATE(frames.spins || has_no_frame(rod));
    clear_end(frames, 0);
    clear_end(frames, rod.n - 1);
    for (int j = 0; j < rod.n - 1; ++j) {
        if (!update_edge(rod, trial, j, frames)) return false;
        if (j > 0 && !update_node(rod, trial, j, frames)) return false;
    }
    frames.clamp_count = static_cast<int>(clamps.size());
    for (int k = 0; k < frames.clamp_count; ++k)
        if (!update_clamp(rod, trial, clamps[k], k, frames)) return false;
    return true;
}

void accept_frames(const RodView& rod, const RodTrial& trial, const RodFrames& frames)
{
    SEL_ASSERT(frames.spins);
    const int n = rod.n;
    std::copy_n(trial.x.begin(), n, rod.x.begin());
    std::copy_n(trial.y.begin(), n, rod.y.begin());
    std::copy_n(trial.z.begin(), n, rod.z.begin());
    std::copy_n(trial.theta.begin(), n - 1, rod.theta.begin());
    std::copy_n(frames.ref_twist.begin(), n, rod.ref_twist.begin());
    for (int j = 0; j < n - 1; ++j) {
        rod.set_tangent(j, frames.tangent[j]);
        rod.set_ref_d1(j, unit_normal(frames.d1[j], frames.tangent[j]));  // rounding would add up over a million steps
    }
    std::fill_n(rod.clamp_twist_a.begin(), n, 0.0);
    std::fill_n(rod.clamp_twist_b.begin(), n, 0.0);
    for (int k = 0; k < frames.clamp_count; ++k) {
        rod.clamp_twist_a[frames.clamp_node[k]] = frames.clamp_ref_twist[2 * k];
        rod.clamp_twist_b[frames.clamp_node[k]] = frames.clamp_ref_twist[2 * k + 1];
    }
}

void initialise_frames(const RodView& rod, const Vec3& normal)
{
    const int n = rod.n;
    for (int j = 0; j < n - 1; ++j) rod.set_tangent(j, (rod.pos(j + 1) - rod.pos(j)).normalized());
    rod.set_ref_d1(n - 2, unit_normal(normal, rod.tangent(n - 2)));
    for (int j = n - 3; j >= 0; --j) {
        const Vec3 from = rod.tangent(j + 1), to = rod.tangent(j);
        const Vec3 carried = parallel_transport(rod.ref_d1(j + 1), from, to, std::max(one_plus_cos(from, to), fold_limit));
        rod.set_ref_d1(j, unit_normal(carried, to));
    }
    for (const std::span<double> angles : {rod.theta, rod.ref_twist, rod.clamp_twist_a, rod.clamp_twist_b})
        std::fill_n(angles.begin(), n, 0.0);
}

}  // namespace seldinger
