// Chooses edges to split and nodes to merge, by the measures of adapt.h.
#include "nodes/adapt.h"

#include "core/check.h"
#include "rod/curvature.h"
#include "rod/rest_shape.h"
#include "rod/transport.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double merge_share = 0.65;    // merged edge against the longest allowed, see adapt.h
// The hand force is read off the base edge, so errors of that edge swing with each edge fed. Measured on an arc of 40 mm at 240
// mN: base edges of up to half the longest leave an error of 1 mN, those of up to 1.5 times the longest 4 mN. The former cost
// three to five more nodes.
constexpr double base_share = 0.5;
constexpr int most_seeds = 3;  // edges split in one call, not counting neighbours that have to follow

/// Nodes of a wire that must stay, as flags.
void flag_kept(const RodView& rod, std::span<const double> distances, std::vector<std::uint8_t>& kept)
{
    for (const double s : distances) {
        if (s > rod.material_s[rod.n - 1]) continue;
        const auto begin = rod.material_s.begin(), end = begin + rod.n;
        const int above = std::clamp(static_cast<int>(std::lower_bound(begin, end, s) - begin), 1, rod.n - 1);
        kept[s - rod.material_s[above - 1] < rod.material_s[above] - s ? above - 1 : above] = 1;
    }
}

/// Integrated curvature between two tangents, as a vector along the binormal.
Vec3 binormal(const RodView& rod, const Vec3& te, const Vec3& tf)
{
    const double chi = one_plus_cos(te, tf);
    return (2 / chi * curvature_factor(curvature_q(rod.curvature), chi)) * te.cross(tf);
}

/// a of e(h): what the discrete curvature has too much of an angle.
double angle_share(const RodView& rod) { return 1.0 / 12 - curvature_q(rod.curvature) / 8; }

/// Rest curvature of node i in the world, integrated (the same signs as in rod/pair.h).
Vec3 rest_binormal(const RodView& rod, int i)
{
    const Vec3 t = rod.tangent(i - 1), n1 = turned(rod.ref_d1(i - 1), t, rod.theta[i - 1]);
    return rod.rest_kappa1[i] * t.cross(n1) - rod.rest_kappa2[i] * n1;
}

}  // namespace

NodePlanner::NodePlanner(const WireSpec& spec, int capacity)
    : longest_(capacity),
      curvature_(capacity),
      shear_jump_(capacity),
      turning_(capacity),
      moment_(capacity, Vec3::Zero()),
      bend_(capacity, Vec3::Zero()),
      marked_(capacity)
{
    spec.for_each_end([&](double s) {
        if (s > 0 && s < spec.length) boundaries_.push_back(s);
    });
    changes_.reserve(capacity);
    touching_.assign(capacity, std::numeric_limits<double>::infinity());
}

/// Curvature, moment and jump of shear at all nodes.
void NodePlanner::measure(const RodView& rod, const NodeDemands& demands)
{
    const int hub = rod.n - 1;
    const Vec3& hub_tangent = demands.hub_tangent;
    curvature_[0] = curvature_[hub] = shear_jump_[0] = shear_jump_[hub] = 0;
    moment_[0] = moment_[hub] = bend_[0] = bend_[hub] = Vec3::Zero();
    for (int i = 1; i < hub; ++i) {
        const Vec3 kb = binormal(rod, rod.tangent(i - 1), rod.tangent(i));
        curvature_[i] = kb.norm() / rod.voronoi_length(i);
        bend_[i] = kb / rod.voronoi_length(i);
        moment_[i] = (rod.bend_stiffness[i] / rod.voronoi_length(i)) * (kb - rest_binormal(rod, i));
    }
    if (!hub_tangent.isZero()) {
        const Vec3 t = rod.tangent(hub - 1);
        const Vec3 kappa = binormal(rod, t, hub_tangent) / rod.voronoi_length(hub);
        curvature_[hub] = kappa.norm();
        bend_[hub] = kappa;
        moment_[hub] = rod.bend_stiffness[hub] * kappa;
    }
    std::ranges::copy(demands.moment, moment_.begin());
    std::fill_n(turning_.begin(), rod.n, 0.0);
    std::ranges::copy(demands.turning, turning_.begin());
    for (int i = 1; i < hub; ++i)
        shear_jump_[i] =
            ((moment_[i + 1] - moment_[i]) / rod.rest_length[i] - (moment_[i] - moment_[i - 1]) / rod.rest_length[i - 1]).norm();
    if (hub == 1) return;
    curvature_[0] = curvature_[1];
    shear_jump_[0] = shear_jump_[1];          // what is at an end itself, a load or a reaction, is no error;
    shear_jump_[hub] = shear_jump_[hub - 1];  // weight and wall go on as beside it
}

/// Errors of one edge in place of the material between nodes `from` and `to`, with the jumps of shear inside moved to its ends.
NodePlanner::EdgeErrors NodePlanner::errors_between(const RodView& rod, int from, int to, double lever) const
{
    double kappa = 0, jump = 0.5 * (shear_jump_[from] + shear_jump_[to]), stiffness = rod.bend_stiffness[from];
    double turning = 0.5 * (turning_[from] + turning_[to]);
    for (int i = from; i <= to; ++i) {
        kappa = std::max(kappa, curvature_[i]);
        stiffness = std::min(stiffness, rod.bend_stiffness[i]);
    }
    for (int i = from + 1; i < to; ++i) jump += shear_jump_[i], turning += turning_[i];
    return {kappa * kappa * (1.0 / 24 + lever * kappa * angle_share(rod)),
            lever * jump / (12 * stiffness) + turning / 12};
}

/// Longest edge [m] that errors allow in that place.
double NodePlanner::longest_edge(const RodView& rod, const WireSpec& spec, int from, int to) const
{
    const auto [cubic, square] = errors_between(rod, from, to, std::min(rod.material_s[to], longest_lever));
    double longest = spec.max_edge / merge_share;  // an edge of max_edge is no error: it may be merged from two
    if (cubic * longest * longest * longest > spec.edge_error) longest = std::cbrt(spec.edge_error / cubic);
    if (square * longest * longest > spec.edge_error) longest = std::sqrt(spec.edge_error / square);
    for (int i = from; i <= to; ++i) longest = std::min(longest, touching_[i]);
    return std::max(longest, spec.min_edge);
}

/// o of an edge: by how much nodes have the displacement over it wrong, about the binormal [m].
Vec3 NodePlanner::displaced(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, int j) const
{
    if (!demands.moment.empty()) {  // of many sections, whose ends are not looked for: at most this
        const double compliance = 1 / rod.bend_stiffness[j + 1] - 1 / rod.bend_stiffness[j], h = rod.rest_length[j];
        return 0.5 * (moment_[j] + moment_[j + 1]) * std::abs(compliance) * h * h / 8;
    }
    const EdgeOffset offset = edge_offset(rod, spec, j);
    const Vec3 t = rod.tangent(j), n1 = turned(rod.ref_d1(j), t, rod.theta[j]);
    return offset.natural[0] * t.cross(n1) - offset.natural[1] * n1 + offset.compliance * 0.5 * (moment_[j] + moment_[j + 1]);
}

std::vector<NodePlanner::Reach> NodePlanner::reaches(const RodView& rod, std::span<const Vec3> contact) const
{
    std::vector<Reach> list(static_cast<std::size_t>(rod.n - 1));
    double held = 0;
    for (int from = 0, span = 0; from < rod.n - 1; ++span) {
        int to = from + (span > 0);
        while (to < rod.n && (contact.empty() || contact[to].isZero())) ++to;
        const int last = std::min(to, rod.n - 1);
        const double begin = rod.material_s[from], end = rod.material_s[last];
        held = span > 1 ? passes_span * held : begin;  // the first span behind the first contact has all of it
        double turned = 0;
        for (int j = from; j < last; ++j) turned += rod.rest_length[j] * 0.5 * (curvature_[j] + curvature_[j + 1]);
        for (int j = from; j < last; ++j) {
            const double middle = 0.5 * (rod.material_s[j] + rod.material_s[j + 1]);
            if (span == 0) list[j] = {middle, 1};
            else list[j] = {held * (end - middle) / (end - begin) + turned * (end - begin) / 8, held / (end - begin)};
        }
        from = last;
    }
    return list;
}

double NodePlanner::tip_error(const RodView& rod, const WireSpec& spec, const NodeDemands& demands)
{
    measure(rod, demands);
    const std::vector<Reach> reach = reaches(rod, demands.contact);
    double along = 0, turned = 0, twist = 0;
    Vec3 off = Vec3::Zero();
    for (int j = 0; j < rod.n - 1; ++j) {
        const double h = rod.rest_length[j], kappa = std::max(curvature_[j], curvature_[j + 1]), lever = reach[j].lever;
        const double stiffness = std::min(rod.bend_stiffness[j], rod.bend_stiffness[j + 1]),
                     jump = 0.5 * (shear_jump_[j] + shear_jump_[j + 1]);
        along += kappa * kappa * h * h * h / 12;
        turned += lever * (angle_share(rod) * kappa * kappa * kappa * h + jump / (12 * stiffness)) * h * h;
        turned += reach[j].carried * (moment_[j + 1] - moment_[j]).norm() / (6 * stiffness) * h * h;
        twist += 0.5 * (turning_[j] + turning_[j + 1]) * h * h / 12;
        off += reach[j].carried * displaced(rod, spec, demands, j);
    }
    return std::hypot(along, turned + off.norm(), twist);
}

BendingError NodePlanner::bending_error(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, double from,
                                        double to)
{
    measure(rod, demands);
    BendingError sum;
    double by_offsets = 0;
    for (int i = 0; i < rod.n; ++i) {
        if (rod.material_s[i] < from || rod.material_s[i] > to) continue;
        const double b = rod.bend_stiffness[i], l = rod.voronoi_length(i);
        const double h = l * (i == 0 || i == rod.n - 1 ? 2 : 1);  // mean of the edges beside it
        const double touch = demands.contact.empty() ? 0 : demands.contact[i].norm();
        sum.energy += l * moment_[i].squaredNorm() / (2 * b);
        sum.missed += touch * curvature_[i] * h * h / 8;
        if (i == 0 || rod.material_s[i - 1] < from) continue;
        const double mean_b = 0.5 * (rod.bend_stiffness[i - 1] + b);
        const Vec3 rise = moment_[i] - moment_[i - 1];
        sum.missed +=
            rod.rest_length[i - 1] * rise.norm() * std::min(rise.norm() / mean_b, (bend_[i] - bend_[i - 1]).norm()) / 12;
        const double off = rise.dot(displaced(rod, spec, demands, i - 1)) / rod.rest_length[i - 1];
        by_offsets += demands.moment.empty() ? off : std::abs(off);
    }
    sum.missed += std::abs(by_offsets);
    return sum;
}

void NodePlanner::note_touching(const RodView& rod, const NodeDemands& demands)
{
    std::fill(touching_.begin(), touching_.end(), std::numeric_limits<double>::infinity());
    const int n = std::min(rod.n, static_cast<int>(demands.contact.size()));
    for (int i = 0; i < n && std::isfinite(demands.touching_edge); ++i)
        if (!demands.contact[i].isZero()) touching_[i] = demands.touching_edge;
}

std::span<const double> NodePlanner::longest_edges(const RodView& rod, const WireSpec& spec, const NodeDemands& demands)
{
    measure(rod, demands);
    for (int j = 0; j < rod.n - 1; ++j) longest_[j] = std::min(spec.max_edge, longest_edge(rod, spec, j, j + 1));
    return std::span(longest_).first(rod.n - 1);
}

/// Where to split the edge [begin, end] so that a node comes to a section's boundary in it; 0: none is, or too near to an end.
double NodePlanner::boundary_fraction(const WireSpec& spec, double begin, double end) const
{
    for (const double s : boundaries_)
        if (s - begin >= spec.min_edge && end - s >= spec.min_edge) return (s - begin) / (end - begin);
    return 0;
}

double NodePlanner::base_edge(const RodView& rod, const WireSpec& spec, const NodeDemands& demands)
{
    measure(rod, demands);
    note_touching(rod, {});
    const int base = rod.n - 2;
    double whole = std::max(base_share * std::min(spec.max_edge, longest_edge(rod, spec, base, base + 1)), 2 * spec.min_edge);
    if (base > 0) whole = std::min(whole, edge_ratio_limit * rod.rest_length[base - 1]);
    for (const double s : boundaries_) {
        const double left = s - rod.material_s[base];
        if (left < spec.min_edge || left >= whole + spec.min_edge) continue;
        whole = left <= whole ? left : 0.5 * left;  // no rest of an edge before the boundary that is shorter than any may be
    }
    return whole;
}

/// Marks neighbours that would be more than edge_ratio_limit times as long as a half of edge `from`, and so on.
void NodePlanner::spread_marks(const RodView& rod, const WireSpec& spec, int from)
{
    const double slack = 1.05;  // surpluses and the hub's own splits leave ratios of 2 a little above
    for (const int step : {-1, 1})
        for (int j = from; j + step >= 0 && j + step < rod.n - 1; j += step) {
            const double half = (marked_[j] ? 0.5 : 1) * rod.rest_length[j], next = rod.rest_length[j + step];
            if (next <= slack * edge_ratio_limit * half || next < 2 * spec.min_edge) break;
            marked_[j + step] = 1;
        }
}

void NodePlanner::plan_splits(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, int capacity)
{
    std::fill(marked_.begin(), marked_.end(), 0);
    // ratios that a boundary has spoilt, or feeding; a base edge that is being pulled out is short for good reason
    for (int j = 0; j < rod.n - (demands.fed ? 2 : 1); ++j) spread_marks(rod, spec, j);
    for (int seed = 0; demands.may_refine && seed < most_seeds; ++seed) {
        int worst = -1;
        double most = 1;
        for (int j = 0; j < rod.n - 1; ++j) {
            if (marked_[j] || rod.rest_length[j] < 2 * spec.min_edge) continue;
            const double boundary = boundary_fraction(spec, rod.material_s[j], rod.material_s[j + 1]) > 0 ? 1e3 : 0;
            const bool judged = !(demands.fed && j == rod.n - 2);  // the base edge is feeding's
            const double excess = std::max(boundary, judged ? rod.rest_length[j] / longest_[j] : 0.0);
            if (excess > most) worst = j, most = excess;
        }
        if (worst < 0) break;
        marked_[worst] = 1;
        spread_marks(rod, spec, worst);
    }
    int room = capacity - rod.n;
    for (int j = rod.n - 2; j >= 0 && room > 0; --j) {
        if (!marked_[j]) continue;
        const double fraction = boundary_fraction(spec, rod.material_s[j], rod.material_s[j + 1]);
        changes_.push_back({true, j, fraction > 0 ? fraction : 0.5});
        --room;
    }
}

void NodePlanner::plan_merge(const RodView& rod, const WireSpec& spec, const NodeDemands& demands)
{
    std::fill(marked_.begin(), marked_.end(), 0);
    flag_kept(rod, demands.kept, marked_);
    flag_kept(rod, boundaries_, marked_);
    int best = -1;
    double least = merge_share * (1 + 1e-9);
    for (int i = 1; i < rod.n - (demands.fed ? 2 : 1); ++i) {
        if (marked_[i] || (!demands.bowed.empty() && demands.bowed[i])) continue;
        const double length = rod.rest_length[i - 1] + rod.rest_length[i];
        if (length > spec.max_edge) continue;
        if (i > 1 && length > edge_ratio_limit * rod.rest_length[i - 2]) continue;
        if (i + 1 < rod.n - 1 && length > edge_ratio_limit * rod.rest_length[i + 1]) continue;
        if (boundary_fraction(spec, rod.material_s[i - 1], rod.material_s[i + 1]) > 0) continue;
        const double share = length / longest_edge(rod, spec, i - 1, i + 1);
        if (share < least) best = i, least = share;
    }
    if (best > 0) changes_.push_back({false, best, 0});
}

std::span<const NodeChange> NodePlanner::plan(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, int capacity)
{
    changes_.clear();
    note_touching(rod, demands);
    longest_edges(rod, spec, demands);
    plan_splits(rod, spec, demands, capacity);
    if (changes_.empty() && demands.may_merge) plan_merge(rod, spec, demands);
    return changes_;
}

double apply_changes(const RodNodes& rod, std::span<const NodeChange> changes)
{
    double added = 0;
    for (const NodeChange& change : changes) {
        const SplitResult result = change.split ? split_edge(rod, change.at, change.fraction) : merge_edges(rod, change.at);
        added += result.rest_length_added;
    }
    return added;
}

void shorten_evenly(const RodView& rod, const WireSpec& spec, double amount, bool rest_is_placed)
{
    const double scale = 1 - amount / rod.material_s[rod.n - 1];
    SEL_ASSERT(scale > 0);
    for (int i = 1; i < rod.n; ++i) rod.material_s[i] *= scale;
    for (int j = 0; j < rod.n - 1; ++j) set_rest_edge(rod, spec, j);
    for (int i = 0; i < rod.n; ++i) set_rest_node(rod, spec, i, rest_is_placed);
}

}  // namespace seldinger
