// Thinning out and the rounds of isotropic remeshing.
#include "surface/remesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace seldinger {
namespace {

// of the target edge [Botsch04]: longer ones are split, shorter ones collapsed
constexpr double long_edge = 4.0 / 3, short_edge = 4.0 / 5;
// thinning out ends with edges of this part of the target: short enough for the rounds to find a mesh of their own
constexpr double thin_part = 0.55;
constexpr double thin_growth = 1.5;  // of the shortest edge from one pass to the next
constexpr int most_valence = 9;
constexpr int least_rim_edges = 4;
// A triangle may lie across the wall's normals by up to 60 degrees: on a lumen of 1.7 edges' radius that of a good one is 20.
constexpr double least_along = 0.5;
/// Whether a change takes triangles too far from the wall's normals; where the wall is folded it may not make it worse.
constexpr bool turns_over(double along_before, double along_after) { return along_after < std::min(least_along, along_before); }

constexpr double mend_angle = 25 * std::numbers::pi / 180;
constexpr double good_angle = 30 * std::numbers::pi / 180;

}  // namespace

double least_angle(const Vec3& a, const Vec3& b, const Vec3& c)
{
    const auto angle = [](const Vec3& p, const Vec3& q, const Vec3& r) {
        return std::atan2((q - p).cross(r - p).norm(), (q - p).dot(r - p));
    };
    return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
}

Remesher::Remesher(const WallMesh& wall, EditMesh sheet, EdgeField field)
    : surface_(wall), mesh_(std::move(sheet)), field_(std::move(field))
{
    vertex_.resize(static_cast<std::size_t>(mesh_.vertex_count()));
    for (std::size_t v = 0; v < vertex_.size(); ++v) {
        const auto origin = static_cast<std::size_t>(mesh_.origin()[v]);
        vertex_[v].place = wall.vertices[origin];
        vertex_[v].normal = surface_.normal(origin);
    }
    find_rims();
}

void Remesher::find_rims()
{
    for (std::int32_t first = 0; first < mesh_.vertex_count(); ++first) {
        if (!mesh_.has_vertex(first) || !mesh_.on_rim(first) || vertex_[first].rim >= 0) continue;
        const auto index = static_cast<std::int32_t>(rims_.size());
        std::vector<std::int32_t> chain;
        std::vector<Vec3> points;
        for (std::int32_t v = first; vertex_[v].rim < 0; v = mesh_.to(mesh_.out(v))) {
            vertex_[v].rim = index;
            chain.push_back(v);
            points.push_back(at(v));
        }
        RimCurve curve(std::move(points));
        for (std::size_t i = 0; i < chain.size(); ++i) vertex_[chain[i]].s = curve.arc_length_of(i);
        field_.add_circle(curve.centre(), curve.length() / (2 * std::numbers::pi));
        const double window = field_.at(curve.at(0));
        for (const std::size_t i : curve.corners(window)) vertex_[chain[i]].corner = true;
        rim_edges_.push_back(static_cast<int>(chain.size()));
        rims_.push_back(std::move(curve));
    }
}

void Remesher::set_targets()
{
    for (std::size_t v = 0; v < vertex_.size(); ++v)
        if (mesh_.has_vertex(static_cast<std::int32_t>(v))) vertex_[v].target = field_.at(vertex_[v].place);
}

void Remesher::compact()
{
    const std::vector<std::int32_t> to = mesh_.compact();
    for (std::size_t v = 0; v < to.size(); ++v)
        if (to[v] >= 0) vertex_[to[v]] = vertex_[v];
    vertex_.resize(static_cast<std::size_t>(mesh_.vertex_count()));
}

Remesher::Vertex Remesher::middle(std::int32_t h) const
{
    const Vertex &a = vertex_[mesh_.from(h)], &b = vertex_[mesh_.to(h)];
    Vertex m;
    if (mesh_.across(h) < 0) {
        const RimCurve& rim = rims_[a.rim];
        m.rim = a.rim;
        m.s = a.s + 0.5 * rim.way(a.s, b.s);
        m.place = rim.at(m.s);
        m.normal = surface_.nearest(m.place).normal;
    } else {
        const Vec3 between = 0.5 * (a.place + b.place);
        const FineSurface::Place on = surface_.nearest(between);
        m.normal = (a.normal + b.normal).normalized();
        m.place = between;
        if (on.normal.dot(m.normal) > 0) m.place = on.point, m.normal = on.normal;  // else another sheet lies nearer
    }
    m.target = field_.at(m.place);
    return m;
}

bool Remesher::merged(std::int32_t h, bool to_middle, Vertex& result) const
{
    const Vertex &a = vertex_[mesh_.from(h)], &b = vertex_[mesh_.to(h)];
    const bool along_rim = mesh_.across(h) < 0;
    if (a.corner && b.corner) return false;
    if (along_rim && rim_edges_[a.rim] <= least_rim_edges) return false;
    if (b.corner || (b.rim >= 0 && a.rim < 0)) result = b;
    else if (a.corner || (a.rim >= 0 && b.rim < 0) || !to_middle) result = a;
    else result = middle(h);
    return true;
}

double Remesher::along_wall(const Vertex& a, const Vertex& b, const Vertex& c)
{
    const Vec3 area = (b.place - a.place).cross(c.place - a.place);
    const double size = area.norm();
    if (!(size > 0)) return -1;
    return std::min({area.dot(a.normal), area.dot(b.normal), area.dot(c.normal)}) / size;
}

double Remesher::along_around(std::int32_t h) const
{
    double least = 1;
    for (const std::int32_t v : {mesh_.from(h), mesh_.to(h)})
        mesh_.for_triangles(v, [&](std::int32_t k) {
            least = std::min(least, along_wall(vertex_[v], vertex_[mesh_.to(k)], vertex_[mesh_.apex(k)]));
        });
    return least;
}

bool Remesher::try_collapse(std::int32_t h, const Vertex& to, double longest)
{
    const std::int32_t a = mesh_.from(h), b = mesh_.to(h);
    bool good = true;
    double after = 1;
    for (const std::int32_t v : {a, b}) {
        const std::int32_t other = v == a ? b : a;
        mesh_.for_triangles(v, [&](std::int32_t k) {
            const std::int32_t p = mesh_.to(k), q = mesh_.apex(k);
            if (!good || p == other || q == other) return;
            after = std::min(after, along_wall(to, vertex_[p], vertex_[q]));
            for (const std::int32_t w : {p, q})
                good &= (at(w) - to.place).norm() <= longest * 0.5 * (to.target + vertex_[w].target);
        });
        if (!good) return false;
    }
    if (after < least_along && turns_over(along_around(h), after)) return false;
    if (!mesh_.can_collapse(h) || mesh_.valence(a) + mesh_.valence(b) - 4 > most_valence) return false;
    if (mesh_.across(h) < 0) --rim_edges_[vertex_[a].rim];
    mesh_.collapse(h);
    vertex_[a] = to;
    return true;
}

void Remesher::thin_out_pass(double longest, double part)
{
    for (std::int32_t h = 0; h < mesh_.half_edge_count(); ++h) {
        if (!mesh_.has_triangle_of(h) || (mesh_.across(h) >= 0 && mesh_.across(h) < h)) continue;
        const double most = std::min(longest, part * target(h));
        Vertex to;
        if (length(h) >= most || !merged(h, false, to)) continue;
        try_collapse(h, to, 2 * most / target(h));
    }
}

void Remesher::thin_out()
{
    double sum = 0;
    for (std::int32_t h = 0; h < mesh_.half_edge_count(); ++h) sum += length(h);
    const double mean = sum / mesh_.half_edge_count();
    // targets are expensive: while there are few vertices the smallest one serves for all
    const double least = field_.least();
    for (Vertex& v : vertex_) v.target = least;
    for (const bool uniform : {true, false}) {
        const double end = thin_part * (uniform ? least : field_.edge());
        for (double longest = mean; longest < end; longest *= thin_growth) {
            thin_out_pass(longest, thin_part);
            compact();
        }
        thin_out_pass(end, thin_part);
        compact();
        set_targets();
    }
}

void Remesher::split_long()
{
    // new edges are examined in the next round
    for (std::int32_t h = 0, end = mesh_.half_edge_count(); h < end; ++h) {
        if (!mesh_.has_triangle_of(h) || (mesh_.across(h) >= 0 && mesh_.across(h) < h)) continue;
        if (length(h) <= long_edge * target(h)) continue;
        const Vertex m = middle(h);
        if (mesh_.across(h) < 0) ++rim_edges_[m.rim];
        mesh_.split(h);
        vertex_.push_back(m);
    }
}

void Remesher::collapse_short()
{
    for (std::int32_t h = 0; h < mesh_.half_edge_count(); ++h) {
        if (!mesh_.has_triangle_of(h) || (mesh_.across(h) >= 0 && mesh_.across(h) < h)) continue;
        Vertex to;
        if (length(h) >= short_edge * target(h) || !merged(h, true, to)) continue;
        try_collapse(h, to, long_edge);
    }
}

void Remesher::remove_sparse()
{
    for (std::int32_t v = 0; v < mesh_.vertex_count(); ++v) {
        if (!mesh_.has_vertex(v) || vertex_[v].rim >= 0 || mesh_.valence(v) > 4) continue;
        std::int32_t shortest = -1;
        mesh_.for_triangles(v, [&](std::int32_t h) {
            if (shortest < 0 || length(h) < length(shortest)) shortest = h;
        });
        const std::int32_t into = mesh_.across(shortest);
        try_collapse(into, vertex_[mesh_.from(into)], 1.5 * long_edge);
    }
}

void Remesher::mend()
{
    for (std::int32_t t = 0; t < mesh_.half_edge_count(); t += 3) {
        if (!mesh_.has_triangle_of(t) || angle_of(t) >= mend_angle) continue;
        std::array<std::int32_t, 3> by_length = {t, t + 1, t + 2};
        std::stable_sort(by_length.begin(), by_length.end(), [&](auto g, auto h) { return length(g) < length(h); });
        const std::int32_t shortest = by_length[0], longest = by_length[2];
        Vertex to;
        if (length(shortest) < 0.4 * length(longest) && merged(shortest, true, to) && try_collapse(shortest, to, 1.3 * long_edge))
            continue;
        if (mesh_.across(longest) >= 0 && turn_helps(longest, true)) mesh_.flip(longest);
    }
}

int Remesher::best_valence(std::int32_t v) const
{
    if (vertex_[v].rim < 0) return 6;
    if (!vertex_[v].corner) return 4;
    double sum = 0;  // the angle inside: a triangle for each 60 degrees
    mesh_.for_triangles(v, [&](std::int32_t h) {
        const Vec3 p = at(mesh_.to(h)) - at(v), q = at(mesh_.apex(h)) - at(v);
        sum += std::atan2(p.cross(q).norm(), p.dot(q));
    });
    return 1 + std::max(1, static_cast<int>(std::lround(sum / (std::numbers::pi / 3))));
}

bool Remesher::turn_helps(std::int32_t h, bool for_angles) const
{
    if (!mesh_.can_flip(h)) return false;
    const std::int32_t a = mesh_.from(h), b = mesh_.to(h), c = mesh_.apex(h), d = mesh_.apex(mesh_.across(h));
    if (vertex_[c].rim >= 0 && vertex_[d].rim >= 0) return false;  // would cut off a piece of the sheet
    int now = 0, then = 0;
    for (const auto& [v, change] : {std::pair(a, -1), {b, -1}, {c, 1}, {d, 1}}) {
        const int off = mesh_.valence(v) - best_valence(v);
        now += off * off;
        then += (off + change) * (off + change);
    }
    const auto angles = [&](std::int32_t p, std::int32_t q, std::int32_t r, std::int32_t s) {
        return std::min(least_angle(at(p), at(q), at(r)), least_angle(at(q), at(p), at(s)));
    };
    const double angle_now = angles(a, b, c, d), angle_then = angles(d, c, a, b);
    const bool bridge = vertex_[a].rim >= 0 && vertex_[b].rim >= 0;
    const bool better = bridge       ? angle_then > 0.5 * angle_now
                        : for_angles ? (then <= now + 2 && angle_now < good_angle && angle_then > 1.05 * angle_now) ||
                                           (then < now && angle_then > std::min(angle_now, good_angle))
                                     : then < now || (then == now && angle_then > 1.05 * angle_now);
    if (!better) return false;
    const double along_now =
        std::min(along_wall(vertex_[a], vertex_[b], vertex_[c]), along_wall(vertex_[b], vertex_[a], vertex_[d]));
    const double along_then =
        std::min(along_wall(vertex_[d], vertex_[c], vertex_[a]), along_wall(vertex_[c], vertex_[d], vertex_[b]));
    return !turns_over(along_now, along_then) && angle_then > 0.2 * angle_now;
}

void Remesher::turn_edges(bool for_angles)
{
    for (int sweep = 0; sweep < 4; ++sweep) {
        int turned = 0;
        for (std::int32_t h = 0; h < mesh_.half_edge_count(); ++h) {
            if (!mesh_.has_triangle_of(h) || mesh_.across(h) < h || !turn_helps(h, for_angles)) continue;
            mesh_.flip(h);
            ++turned;
        }
        if (turned == 0) break;
    }
}

/// To the centroid of its triangles, each weighted by area / target^4: the density of vertices that the field asks for, as in
/// centroidal Voronoi meshes [Du, Faber & Gunzburger 1999, doi:10.1137/S0036144599352836].
void Remesher::relax_inside(std::int32_t v)
{
    Vertex& here = vertex_[v];
    Vec3 sum = Vec3::Zero();
    double weights = 0, before = 1;
    mesh_.for_triangles(v, [&](std::int32_t h) {
        const Vertex &p = vertex_[mesh_.to(h)], &q = vertex_[mesh_.apex(h)];
        const double target = (here.target + p.target + q.target) / here.target;
        const double weight = (p.place - here.place).cross(q.place - here.place).norm() / std::pow(target, 4);
        sum += weight * (here.place + p.place + q.place) / 3;
        weights += weight;
        before = std::min(before, along_wall(here, p, q));
    });
    if (!(weights > 0)) return;
    Vec3 step = sum / weights - here.place;
    step -= here.normal * here.normal.dot(step);
    for (int attempt = 0; attempt < 3; ++attempt, step *= 0.5) {
        const FineSurface::Place on = surface_.nearest(here.place + step);
        Vertex there = here;
        there.place = on.point;
        there.normal = on.normal;
        if (on.normal.dot(here.normal) <= 0) continue;  // another sheet
        double after = 1;
        mesh_.for_triangles(
            v, [&](std::int32_t h) { after = std::min(after, along_wall(there, vertex_[mesh_.to(h)], vertex_[mesh_.apex(h)])); });
        if (turns_over(before, after)) continue;
        here = there;
        here.target = field_.at(here.place);
        return;
    }
}

void Remesher::relax_on_rim(std::int32_t v)
{
    Vertex& here = vertex_[v];
    if (here.corner) return;
    std::int32_t before = -1;
    const std::int32_t after = mesh_.to(mesh_.out(v));
    mesh_.for_neighbours(v, [&](std::int32_t w) { before = w; });
    const RimCurve& rim = rims_[here.rim];
    // the middle, weighted so that both ways have the same length in targets
    const double back = rim.way(vertex_[before].s, here.s), forth = rim.way(here.s, vertex_[after].s);
    const double h0 = vertex_[before].target + here.target, h1 = vertex_[after].target + here.target;
    Vertex there = here;
    there.s = here.s - back + (back + forth) * h0 / (h0 + h1);
    there.place = rim.at(there.s);
    double worst = 1, worst_before = 1;  // along the wall
    mesh_.for_triangles(v, [&](std::int32_t h) {
        worst = std::min(worst, along_wall(there, vertex_[mesh_.to(h)], vertex_[mesh_.apex(h)]));
        worst_before = std::min(worst_before, along_wall(here, vertex_[mesh_.to(h)], vertex_[mesh_.apex(h)]));
    });
    if (turns_over(worst_before, worst)) return;
    there.normal = surface_.nearest(there.place).normal;
    there.target = field_.at(there.place);
    here = there;
}

void Remesher::relax()
{
    for (std::int32_t v = 0; v < mesh_.vertex_count(); ++v) {
        if (!mesh_.has_vertex(v)) continue;
        if (vertex_[v].rim >= 0) relax_on_rim(v);
        else relax_inside(v);
    }
}

void Remesher::run(int rounds)
{
    thin_out();
    for (int round = 0; round < rounds; ++round) {
        split_long();
        collapse_short();
        remove_sparse();
        turn_edges(false);
        for (int k = 0; k < 2; ++k) relax();
        compact();
    }
    // numbers of vertices are right: angles now
    for (int round = 0; round < 6; ++round) {
        turn_edges(round >= 3);
        if (round >= 3) mend();
        for (int k = 0; k < 3; ++k) relax();
    }
    turn_edges(true);
    compact();
}

WallMesh Remesher::result() const
{
    WallMesh mesh;
    mesh.triangles = mesh_.triangles();
    for (const Vertex& v : vertex_) mesh.vertices.push_back(v.place);
    return mesh;
}

}  // namespace seldinger
