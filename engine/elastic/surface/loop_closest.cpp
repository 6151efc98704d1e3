// Closest point of the limit surface: a start from flat pieces, then Newton steps that walk over triangles.
#include "surface/loop_surface.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace seldinger {
namespace {

constexpr int start_pieces = 3;       // flat pieces along each edge of a control triangle
constexpr int most_closest_steps = 60;        // about four do from a start nearby
constexpr double small_move = 1e-11;  // of an edge: a Newton step that ends the search
constexpr double small_fold = 1e-12;  // weights below it are on an edge

using Uv = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;

/// Barycentric weights of a place.
using Weights3 = std::array<double, 3>;
Weights3 weights_of(const Uv& uv) { return {1 - uv[0] - uv[1], uv[0], uv[1]}; }

/// A place and what the surface is like there.
struct Place {
    std::int32_t triangle = 0;
    Uv uv = Uv::Zero();
    Vec3 x = Vec3::Zero(), xu = x, xv = x, xuu = x, xuv = x, xvv = x;
    double squared = 0;  // distance from p
};

/// Direction in (u, v) along edge e of a triangle, and out of the triangle across it as a weight that falls: that of corner e
/// + 2.
constexpr double corner_u[3] = {0, 1, 0}, corner_v[3] = {0, 0, 1};
Uv along_edge(int e)
{
    const int a = e, b = (e + 1) % 3;
    return {corner_u[b] - corner_u[a], corner_v[b] - corner_v[a]};
}
/// Change of the weight of corner c per step d.
double change(const Uv& d, int c) { return c == 0 ? -d[0] - d[1] : d[c - 1]; }

/// Moves by d over the mesh unfolded flat; stops at rims.
void walk(const LoopTopology& mesh, std::int32_t& triangle, Uv& uv, Uv d)
{
    Weights3 l = weights_of(uv), dl = {change(d, 0), change(d, 1), change(d, 2)};
    for (int hop = 0; hop < 24; ++hop) {
        double reach = 1;
        int out = -1;
        for (int c = 0; c < 3; ++c)
            if (dl[static_cast<std::size_t>(c)] < 0 && l[static_cast<std::size_t>(c)] < -reach * dl[static_cast<std::size_t>(c)])
                reach = std::max(0.0, l[static_cast<std::size_t>(c)] / -dl[static_cast<std::size_t>(c)]), out = c;
        for (std::size_t c = 0; c < 3; ++c) l[c] = std::max(0.0, l[c] + reach * dl[c]);
        if (out < 0) break;
        const auto o = static_cast<std::size_t>(out), a = (o + 1) % 3, b = (o + 2) % 3;
        l[o] = 0;
        const std::int32_t across = mesh.opposite[static_cast<std::size_t>(3 * triangle) + a];
        if (across < 0) break;
        // the neighbour's corners: b, a, and its own, which gains what `out` loses
        const auto e = static_cast<std::size_t>(across % 3);
        Weights3 nl{}, nd{};
        nl[e] = l[b], nl[(e + 1) % 3] = l[a];
        nd[e] = (1 - reach) * (dl[b] + dl[o]), nd[(e + 1) % 3] = (1 - reach) * (dl[a] + dl[o]),
        nd[(e + 2) % 3] = -(1 - reach) * dl[o];
        l = nl, dl = nd;
        triangle = across / 3;
    }
    const double sum = l[0] + l[1] + l[2];
    uv = Uv(l[1] / sum, l[2] / sum);
    for (double& w : {std::ref(uv[0]), std::ref(uv[1])})
        if (w < small_fold) w = 0;
    if (1 - uv[0] - uv[1] < small_fold) uv /= uv[0] + uv[1];
}

/// Newton's step downhill in the squared distance, within the rims that the place lies on.
Uv newton_step(const LoopTopology& mesh, const Place& at, const Vec3& p)
{
    const Vec3 r = p - at.x;
    const Uv g(r.dot(at.xu), r.dot(at.xv));
    Mat2 gauss, h;
    gauss << at.xu.dot(at.xu), at.xu.dot(at.xv), at.xu.dot(at.xv), at.xv.dot(at.xv);
    h << r.dot(at.xuu), r.dot(at.xuv), r.dot(at.xuv), r.dot(at.xvv);
    h = gauss - h;
    // past a centre of curvature the distance has no minimum there: steps of the flat surface instead
    if (!(h(0, 0) + h(1, 1) > 0.1 * gauss.trace() && h.determinant() > 0.05 * gauss.determinant())) h = gauss;
    Uv d = h.determinant() > 0 ? Uv(h.inverse() * g) : Uv(Uv::Zero());
    const Weights3 l = weights_of(at.uv);
    const auto blocked = [&](const Uv& step, int c) {  // out across the edge that faces corner c, a rim
        return l[static_cast<std::size_t>(c)] <= small_fold && change(step, c) < 0 &&
               mesh.opposite[static_cast<std::size_t>(3 * at.triangle + (c + 1) % 3)] < 0;
    };
    for (int tries = 0; tries < 2; ++tries) {
        int c = 0;
        while (c < 3 && !blocked(d, c)) ++c;
        if (c == 3) return d;
        const Uv e = along_edge((c + 1) % 3);
        d = e * (g.dot(e) / e.dot(h * e));
    }
    for (int c = 0; c < 3; ++c)
        if (blocked(d, c)) return Uv::Zero();  // in a corner
    return d;
}

}  // namespace

void LoopSurface::build_start()
{
    // not shared between triangles: the tree does not mind
    constexpr int n = start_pieces;
    WallMesh flat;
    flat.vertices.reserve(control_.triangles.size() * (n + 1) * (n + 2) / 2);
    flat.triangles.reserve(control_.triangles.size() * n * n);
    for (std::int32_t t = 0; t < topology_.triangle_count(); ++t) {
        const auto base = static_cast<std::int32_t>(flat.vertices.size());
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i + j <= n; ++i)
                flat.vertices.push_back(at(t, static_cast<double>(i) / n, static_cast<double>(j) / n).position);
        const auto index = [&](int i, int j) { return base + j * (n + 1) - j * (j - 1) / 2 + i; };
        for (int j = 0; j < n; ++j)
            for (int i = 0; i + j < n; ++i) {
                flat.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
                if (i + j < n - 1) flat.triangles.push_back({index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
            }
    }
    start_ = build_wall_tree(flat, 1);
}

void LoopSurface::closest(const Vec3& p, LoopFoot& foot) const
{
    if (foot.triangle < 0) {
        const TreeHit hit = nearest_on_wall(start_, p);
        const auto piece = static_cast<std::int32_t>(start_.original[static_cast<std::size_t>(hit.triangle)]);
        foot.triangle = piece / (start_pieces * start_pieces);
        // its place among the triangle's pieces, in the order they were made
        int k = piece % (start_pieces * start_pieces), row = 0;
        while (k >= 2 * (start_pieces - row) - 1) k -= 2 * (start_pieces - row) - 1, ++row;
        const double third = k % 2 ? 2.0 / 3 : 1.0 / 3;
        foot.u = (k / 2 + third) / start_pieces, foot.v = (row + third) / start_pieces;
    }
    descend(p, foot);
}

void LoopSurface::descend(const Vec3& p, LoopFoot& foot) const
{
    LoopCurvedStencil s;
    const auto look = [&](std::int32_t triangle, const Uv& uv) {
        Place place;
        place.triangle = triangle, place.uv = uv;
        basis(triangle, uv[0], uv[1], s);
        for (std::size_t k = 0; k < static_cast<std::size_t>(s.size); ++k) {
            const Vec3& x = control_.vertices[static_cast<std::size_t>(s.vertex[k])];
            place.x += s.n[k] * x, place.xu += s.n_u[k] * x, place.xv += s.n_v[k] * x;
            place.xuu += s.n_uu[k] * x, place.xuv += s.n_uv[k] * x, place.xvv += s.n_vv[k] * x;
        }
        place.squared = (p - place.x).squaredNorm();
        return place;
    };
    Place here = look(foot.triangle, Uv(foot.u, foot.v));
    for (int step = 0; step < most_closest_steps; ++step) {
        Uv d = newton_step(topology_, here, p);
        if (d.norm() > 1) d /= d.norm();  // a triangle at a time
        if ((d[0] * here.xu + d[1] * here.xv).norm() < small_move * edge_) break;
        // a step that is flat to rounding cannot be told downhill: take it
        const double slack = 1e-14 * (here.squared + edge_ * edge_ * 1e-4);
        Place next;
        int halving = 0;
        for (; halving < 12; ++halving, d *= 0.5) {
            std::int32_t triangle = here.triangle;
            Uv uv = here.uv;
            walk(topology_, triangle, uv, d);
            next = look(triangle, uv);
            if (next.squared <= here.squared + slack) break;
        }
        if (halving == 12) break;
        const bool still = next.triangle == here.triangle && next.uv == here.uv;
        here = next;
        if (still) break;
    }
    foot.triangle = here.triangle, foot.u = here.uv[0], foot.v = here.uv[1];
    foot.position = here.x, foot.tangent_u = here.xu, foot.tangent_v = here.xv;
    foot.normal = here.xu.cross(here.xv).normalized();
    foot.distance = std::sqrt(here.squared);
    const Weights3 l = weights_of(here.uv);
    foot.rim = false;
    for (int c = 0; c < 3; ++c)
        foot.rim = foot.rim || (l[static_cast<std::size_t>(c)] <= small_fold &&
                                topology_.opposite[static_cast<std::size_t>(3 * here.triangle + (c + 1) % 3)] < 0);
}

}  // namespace seldinger
