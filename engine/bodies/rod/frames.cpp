// Frames of a wire: parallel transport in time of each edge's reference frame, reference twist, curvature, twist.
#include "core/check.h"
#include "math/lanes.h"
#include "rod/clamp.h"
#include "rod/curvature.h"
#include "rod/elastic.h"
#include "rod/transport.h"

#include <algorithm>
#include <limits>

namespace seldinger {

RodFrames::RodFrames(int nodes, int clamp_capacity)
    : capacity(nodes),
      tangent(nodes + lane_padding),
      d1(nodes + lane_padding),
      m1(nodes + lane_padding),
      m2(nodes + lane_padding),
      kb(nodes + lane_padding),
      edge_length(nodes + lane_padding),
      chi(nodes + lane_padding),
      ref_twist(nodes + lane_padding),
      kappa1(nodes + lane_padding),
      kappa2(nodes + lane_padding),
      twist(nodes + lane_padding),
      clamp_node(clamp_capacity),
      clamp_ref_twist(2 * clamp_capacity),
      clamp_twist(2 * clamp_capacity)
{
}

namespace {

// ---- lanes of transport.h ---------------------------------------------------------------------------------------------------

Lanes one_plus_cos(const Lanes3& a, const Lanes3& b)
{
    const Lanes3 sum = a + b;
    return 0.5 * dot(sum, sum);
}

Lanes3 parallel_transport(const Lanes3& v, const Lanes3& from, const Lanes3& to, const Lanes& chi)
{
    return v - (dot(v, to) / chi) * (from + to);
}

Lanes3 load_some(std::span<const double> x, std::span<const double> y, std::span<const double> z, int i, int count)
{
    return {{load_lanes(&x[i], count, 1), load_lanes(&y[i], count, 1), load_lanes(&z[i], count, 1)}};
}

// ---- the walk along the wire ------------------------------------------------------------------------------------------------

/// Tangents and reference directors of edges j, j + 1, ... of `count` left. @return false when one has no direction or has turned
/// by pi
bool update_edges(const RodView& rod, const RodTrial& q, int j, int count, RodFrames& frames)
{
    const Lanes3 tip = load_some(q.x, q.y, q.z, j, count), hub = load_some(q.x, q.y, q.z, j + 1, count);
    const Lanes theta = load_lanes(&q.theta[j], count, 0);
    const Lanes3 edge = hub - tip;
    const Lanes length = sqrt_lanes(dot(edge, edge));
    const Lanes3 before = load_some(rod.tx, rod.ty, rod.tz, j, count), now = edge / length;
    const Lanes chi = one_plus_cos(before, now);
    const Lanes infinite = all_lanes(std::numeric_limits<double>::infinity());
    const LaneMask fine = (length > 0) & (length < infinite) & (theta - theta == 0) & (chi > fold_limit);
    if (!all_set(fine, count)) return false;
    store_lanes(&frames.edge_length[j], length);
    store_lanes3(frames.tangent, j, now);
    if (!frames.spins) return true;
    store_lanes3(frames.d1, j, parallel_transport(load_some(rod.d1x, rod.d1y, rod.d1z, j, count), before, now, chi));
    return true;
}

/// Curvature binormal, reference twist and twist of inner nodes i, i + 1, ... of `count` left. @return false when the wire is
/// folded at one
bool update_nodes(const RodView& rod, const RodTrial& q, int i, int count, RodFrames& frames)
{
    const Lanes3 te = load_lanes3(frames.tangent, i - 1), tf = load_lanes3(frames.tangent, i);
    const Lanes chi = one_plus_cos(te, tf);
    if (!all_set(chi > fold_limit, count)) return false;
    store_lanes(&frames.chi[i], chi);
    store_lanes3(frames.kb, i, (2.0 / chi) * cross(te, tf));
    if (!frames.spins) return true;

    const Lanes3 carried = parallel_transport(load_lanes3(frames.d1, i - 1), te, tf, chi), there = load_lanes3(frames.d1, i);
    const Lanes sine = dot(cross(carried, there), tf), cosine = dot(carried, there);
    for (int l = 0; l < lane_count && l < count; ++l) {
        const double ref_twist = unwrap(std::atan2(sine[l], cosine[l]), rod.ref_twist[i + l]);
        frames.ref_twist[i + l] = ref_twist;
        frames.twist[i + l] = q.theta[i + l] - q.theta[i + l - 1] + ref_twist;
    }
    return true;
}

/// Material directors and kappa.
void update_material(const RodView& rod, const RodTrial& trial, RodFrames& frames)
{
    for (int j = 0; j < rod.n - 1; ++j) {
        const Vec3 d1 = frames.d1[j], d2 = frames.tangent[j].cross(d1);
        const double c = std::cos(trial.theta[j]), s = std::sin(trial.theta[j]);
        frames.m1.set(j, c * d1 + s * d2);
        frames.m2.set(j, c * d2 - s * d1);
    }
    for (int i = 1; i < rod.n - 1; ++i) {
        // components in the midway frame: those in e's material frame, seen from half the twist further on
        const double g = curvature_factor(curvature_q(rod.curvature), frames.chi[i]);
        const Vec3 kb = frames.kb[i];
        const double k1 = g * kb.dot(frames.m2[i - 1]), k2 = -g * kb.dot(frames.m1[i - 1]);
        const double c = std::cos(0.5 * frames.twist[i]), s = std::sin(0.5 * frames.twist[i]);
        frames.kappa1[i] = c * k1 + s * k2;
        frames.kappa2[i] = c * k2 - s * k1;
    }
}

/// Whether nothing in the wire is fixed to its material frames.
[[maybe_unused]] bool has_no_frame(const RodView& rod)
{
    for (int i = 0; i < rod.n; ++i)
        if (rod.rest_twist[i] != 0) return false;
    return straight_by_nature(rod);
}

void clear_end(RodFrames& frames, int i)
{
    frames.kb.set(i, Vec3::Zero());
    frames.chi[i] = 2;
    frames.ref_twist[i] = frames.twist[i] = frames.kappa1[i] = frames.kappa2[i] = 0;
}

}  // namespace

bool straight_by_nature(const RodView& rod)
{
    for (int i = 0; i < rod.n; ++i)
        if (rod.rest_kappa1[i] != 0 || rod.rest_kappa2[i] != 0) return false;
    return true;
}

bool update_frames(const RodView& rod, const RodTrial& trial, std::span<const RodClamp> clamps, RodFrames& frames)
{
    SEL_ASSERT(rod.n >= 2 && rod.n <= frames.capacity);
    SEL_ASSERT(clamps.size() <= frames.clamp_node.size());
    SEL_VALIDATE(frames.spins || has_no_frame(rod));
    for (int j = 0; j < rod.n - 1; j += lane_count)
        if (!update_edges(rod, trial, j, rod.n - 1 - j, frames)) return false;
    for (int i = 1; i < rod.n - 1; i += lane_count)
        if (!update_nodes(rod, trial, i, rod.n - 1 - i, frames)) return false;
    clear_end(frames, 0);
    clear_end(frames, rod.n - 1);
    if (frames.spins && frames.material) update_material(rod, trial, frames);
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
    for (int c = 0; c < 3; ++c)
        std::copy_n(frames.tangent.component(c), n - 1, (c == 0 ? rod.tx : c == 1 ? rod.ty : rod.tz).begin());
    // rounding would add up over a million steps
    for (int j = 0; j < n - 1; ++j) rod.set_ref_d1(j, unit_normal(frames.d1[j], frames.tangent[j]));
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
