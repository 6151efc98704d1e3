// Weights at a point of the limit surface: its regular patch, and the points of that patch.
#include "surface/loop_surface.h"

#include "core/check.h"
#include "surface/loop_basis.h"

#include <algorithm>

namespace seldinger {
namespace {

/// (u, v) within a part of a triangle, and its derivatives by the triangle's own.
struct Local {
    double u, v;
    double by[2][2] = {{1, 0}, {0, 1}};  // [local][of the triangle]
};

/// Child c of a triangle: 0, 1, 2 at the corners (each has that corner first), 3 in the middle.
Local child_place(const Local& at, int c)
{
    // barycentric weights and their derivatives
    const double l[3] = {1 - at.u - at.v, at.u, at.v};
    double d[3][2];
    for (int k = 0; k < 2; ++k) d[0][k] = -at.by[0][k] - at.by[1][k], d[1][k] = at.by[0][k], d[2][k] = at.by[1][k];
    const int a = c == 3 ? 1 : (c + 1) % 3, b = c == 3 ? 2 : (c + 2) % 3;
    const double sign = c == 3 ? -2 : 2, offset = c == 3 ? 1 : 0;
    return {offset + sign * l[a], offset + sign * l[b], {{sign * d[a][0], sign * d[a][1]}, {sign * d[b][0], sign * d[b][1]}}};
}

int child_of(double u, double v)
{
    if (u >= 0.5) return 1;
    if (v >= 0.5) return 2;
    return u + v <= 0.5 ? 0 : 3;
}

}  // namespace

/// Values and derivatives [n, n_u, n_v, (n_uu, n_uv, n_vv)] beside each other, so that one sum runs over them.
template <bool curved>
struct LoopSurface::Weights {
    static constexpr int channels = curved ? 8 : 4;
    alignas(64) double sum[LoopStencil::capacity][channels];

    void clear(int n)
    {
        for (int k = 0; k < n; ++k)
            for (int c = 0; c < channels; ++c) sum[k][c] = 0;
    }
    /// The functions of a regular patch, by the triangle's own (u, v).
    void functions(const Local& at, double (*out)[channels]) const
    {
        LoopBasis b;
        loop_basis(at.u, at.v, curved, b);
        const double j00 = at.by[0][0], j01 = at.by[0][1], j10 = at.by[1][0], j11 = at.by[1][1];
        for (int i = 0; i < 12; ++i) {
            out[i][0] = b.n[i];
            out[i][1] = b.n_u[i] * j00 + b.n_v[i] * j10;
            out[i][2] = b.n_u[i] * j01 + b.n_v[i] * j11;
            out[i][3] = 0;
            if constexpr (curved) {
                out[i][3] = b.n_uu[i] * j00 * j00 + 2 * b.n_uv[i] * j00 * j10 + b.n_vv[i] * j10 * j10;
                out[i][4] = b.n_uu[i] * j00 * j01 + b.n_uv[i] * (j00 * j11 + j01 * j10) + b.n_vv[i] * j10 * j11;
                out[i][5] = b.n_uu[i] * j01 * j01 + 2 * b.n_uv[i] * j01 * j11 + b.n_vv[i] * j11 * j11;
                out[i][6] = out[i][7] = 0;
            }
        }
    }
};

namespace {

/// Weights of a corner's points at a place of its triangle: rounds of subdivision until a regular child holds it.
template <int channels, class Functions>
void corner_weights(const LoopCorner& corner, Local at, const Functions& at_place, double (*out)[channels])
{
    int round = 0;
    for (; round < LoopCorner::depth && at.u + at.v < 0.5; ++round) at = child_place(at, 0);
    const int points = corner.points;
    for (int k = 0; k < points; ++k)
        for (int c = 0; c < channels; ++c) out[k][c] = 0;
    if (round == LoopCorner::depth) {  // flat between the limits of its corners
        const double l[3] = {1 - at.u - at.v, at.u, at.v};
        for (int i = 0; i < 3; ++i) {
            const double* row = corner.last.data() + i * points;
            double d[2];
            for (int a = 0; a < 2; ++a) d[a] = i == 0 ? -at.by[0][a] - at.by[1][a] : at.by[i - 1][a];
            for (int k = 0; k < points; ++k) out[k][0] += l[i] * row[k], out[k][1] += d[0] * row[k], out[k][2] += d[1] * row[k];
        }
        return;
    }
    const int child = child_of(at.u, at.v) == 0 ? 3 : child_of(at.u, at.v);
    double regular[12][channels];
    at_place(child_place(at, child), regular);
    const double* row = corner.patch(round, child);
    for (int i = 0; i < 12; ++i, row += points)
        for (int k = 0; k < points; ++k)
            for (int c = 0; c < channels; ++c) out[k][c] += row[k] * regular[i][c];
}

}  // namespace

template <bool curved>
void LoopSurface::weigh(std::int32_t triangle, double u, double v, Weights<curved>& weights) const
{
    constexpr int channels = Weights<curved>::channels;
    const Patch& patch = patches_[static_cast<std::size_t>(triangle)];
    Local at{u, v};
    if (patch.first_child < 0) {
        weights.functions(at, weights.sum);
        return;
    }
    const int c = patch.divided ? child_of(u, v) : 0;
    if (patch.divided) at = child_place(at, c);
    const Child& child = children_[static_cast<std::size_t>(patch.first_child + c)];
    double points[LoopTopology::max_valence + 8][channels];
    int count = 12;
    const auto of_patch = [&](const Local& place, double(*out)[channels]) { weights.functions(place, out); };
    if (child.corner < 0) of_patch(at, points);
    else {
        const LoopCorner& corner = corners_[static_cast<std::size_t>(child.corner)];
        count = corner.points;
        corner_weights<channels>(corner, at, of_patch, points);
    }
    weights.clear(patch.vertex_count);
    const std::int32_t* row = &rows_[static_cast<std::size_t>(child.first_point)];
    for (int k = 0; k < count; ++k)
        for (std::int32_t e = row[k]; e < row[k + 1]; ++e) {
            double* sum = weights.sum[slots_[static_cast<std::size_t>(e)]];
            const double w = row_weights_[static_cast<std::size_t>(e)];
            for (int i = 0; i < channels; ++i) sum[i] += w * points[k][i];
        }
}

/// Vertices, values and first derivatives.
template <bool curved>
void LoopSurface::fill(std::int32_t triangle, const Weights<curved>& weights, LoopStencil& stencil) const
{
    const Patch& patch = patches_[static_cast<std::size_t>(triangle)];
    stencil.size = patch.vertex_count;
    for (std::size_t k = 0; k < static_cast<std::size_t>(stencil.size); ++k) {
        stencil.vertex[k] = patch_vertices_[static_cast<std::size_t>(patch.first_vertex) + k];
        stencil.n[k] = weights.sum[k][0], stencil.n_u[k] = weights.sum[k][1], stencil.n_v[k] = weights.sum[k][2];
    }
}

void LoopSurface::basis(std::int32_t triangle, double u, double v, LoopStencil& stencil) const
{
    Weights<false> weights;
    weigh(triangle, u, v, weights);
    fill(triangle, weights, stencil);
}

void LoopSurface::basis(std::int32_t triangle, double u, double v, LoopCurvedStencil& stencil) const
{
    Weights<true> weights;
    weigh(triangle, u, v, weights);
    fill(triangle, weights, stencil);
    for (std::size_t k = 0; k < static_cast<std::size_t>(stencil.size); ++k)
        stencil.n_uu[k] = weights.sum[k][3], stencil.n_uv[k] = weights.sum[k][4], stencil.n_vv[k] = weights.sum[k][5];
}

LoopFoot LoopSurface::at(std::int32_t triangle, double u, double v) const
{
    LoopStencil stencil;
    basis(triangle, u, v, stencil);
    LoopFoot foot;
    foot.triangle = triangle, foot.u = u, foot.v = v;
    for (std::size_t k = 0; k < static_cast<std::size_t>(stencil.size); ++k) {
        const Vec3& x = control_.vertices[static_cast<std::size_t>(stencil.vertex[k])];
        foot.position += stencil.n[k] * x;
        foot.tangent_u += stencil.n_u[k] * x;
        foot.tangent_v += stencil.n_v[k] * x;
    }
    foot.normal = foot.tangent_u.cross(foot.tangent_v).normalized();
    return foot;
}

void LoopSurface::limit_of_vertex(std::int32_t vertex, LoopStencil& stencil) const
{
    const std::int32_t h = topology_.first[static_cast<std::size_t>(vertex)];
    basis(h / 3, h % 3 == 1, h % 3 == 2, stencil);
}

LoopSurface::LoopSurface(WallMesh control) : control_(std::move(control)), topology_(control_)
{
    const LoopRefinement fine = refine(topology_);
    patches_.reserve(control_.triangles.size());
    for (std::int32_t t = 0; t < topology_.triangle_count(); ++t) build_patch(t, fine);
    rows_.push_back(static_cast<std::int32_t>(slots_.size()));
    double sum = 0;
    for (const auto& [a, b, c] : control_.triangles)
        for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
            sum += (control_.vertices[static_cast<std::size_t>(i)] - control_.vertices[static_cast<std::size_t>(j)]).norm();
    edge_ = sum / (3 * static_cast<double>(control_.triangles.size()));
    build_start();
}

std::int32_t LoopSurface::corner_index(LoopVertex kind, int triangles, int place)
{
    for (std::size_t k = 0; k < corners_.size(); ++k)
        if (corners_[k].kind == kind && corners_[k].triangles == triangles && corners_[k].place == place)
            return static_cast<std::int32_t>(k);
    corners_.push_back(make_loop_corner(kind, triangles, place));
    return static_cast<std::int32_t>(corners_.size()) - 1;
}

/// A row: the point's weights on control vertices, directly or through one round of subdivision.
void LoopSurface::add_point(Patch& patch, const LoopPoint& point, const LoopRefinement* fine)
{
    const auto begin = static_cast<std::int32_t>(slots_.size());
    rows_.push_back(begin);
    const auto add = [&](std::int32_t vertex, double weight) {
        const auto first = patch_vertices_.begin() + patch.first_vertex;
        const auto slot = static_cast<unsigned char>(std::find(first, patch_vertices_.end(), vertex) - first);
        if (first + slot == patch_vertices_.end()) patch_vertices_.push_back(vertex), ++patch.vertex_count;
        SEL_ASSERT(patch.vertex_count <= LoopStencil::capacity);
        for (auto e = static_cast<std::size_t>(begin); e < slots_.size(); ++e)
            if (slots_[e] == slot) return void(row_weights_[e] += weight);
        slots_.push_back(slot), row_weights_.push_back(weight);
    };
    const auto add_vertex = [&](std::int32_t vertex, double weight) {
        if (!fine) return add(vertex, weight);
        for (auto e = static_cast<std::size_t>(fine->first[static_cast<std::size_t>(vertex)]);
             e < static_cast<std::size_t>(fine->first[static_cast<std::size_t>(vertex) + 1]); ++e)
            add(fine->vertex[e], weight * fine->weight[e]);
    };
    add_vertex(point.a, 1);
    if (point.phantom()) add_vertex(point.b, 1), add_vertex(point.c, -1);
}

void LoopSurface::build_patch(std::int32_t triangle, const LoopRefinement& fine)
{
    Patch patch{static_cast<std::int32_t>(patch_vertices_.size()), 0, -1, false};
    const auto regular = [](const LoopTopology& mesh, std::int32_t t) {
        const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(t)];
        return mesh.regular(a) && mesh.regular(b) && mesh.regular(c);
    };
    if (regular(topology_, triangle)) {
        const auto points = topology_.patch(triangle);
        bool plain = true;
        for (std::size_t i = 0; i < 12; ++i) {
            plain = plain && !points[i].phantom();
            for (std::size_t k = 0; k < i; ++k) plain = plain && points[i].a != points[k].a;
        }
        if (plain) {
            for (const LoopPoint& p : points) patch_vertices_.push_back(p.a);
            patch.vertex_count = 12;
        } else {
            patch.first_child = static_cast<std::int32_t>(children_.size());
            children_.push_back({-1, static_cast<std::int32_t>(rows_.size())});
            for (const LoopPoint& p : points) add_point(patch, p, nullptr);
            rows_.push_back(static_cast<std::int32_t>(slots_.size()));
        }
        patches_.push_back(patch);
        return;
    }
    patch.first_child = static_cast<std::int32_t>(children_.size());
    patch.divided = true;
    const LoopTopology& mesh = fine.topology;
    for (std::int32_t t = 4 * triangle; t < 4 * triangle + 4; ++t) {
        Child child{-1, static_cast<std::int32_t>(rows_.size())};
        if (regular(mesh, t)) {
            for (const LoopPoint& p : mesh.patch(t)) add_point(patch, p, &fine);
        } else {
            int place;
            const std::int32_t v = mesh.triangles[static_cast<std::size_t>(t)][0];
            for (const std::int32_t p : mesh.corner_patch(t, place)) add_point(patch, {p}, &fine);
            child.corner =
                corner_index(mesh.kind[static_cast<std::size_t>(v)], mesh.triangles_about[static_cast<std::size_t>(v)], place);
        }
        rows_.push_back(static_cast<std::int32_t>(slots_.size()));
        children_.push_back(child);
    }
    patches_.push_back(patch);
}

double LoopSurface::interpolate(std::span<const Vec3> points, int sweeps)
{
    SEL_ASSERT(points.size() == control_.vertices.size());
    double left = 0;
    for (int sweep = 0; sweep <= sweeps; ++sweep) {  // Gauss-Seidel; the last only measures
        left = 0;
        for (std::int32_t v = 0; v < topology_.vertex_count(); ++v) {
            const LoopTopology::LimitMask mask = topology_.limit_mask(v);
            Vec3& x = control_.vertices[static_cast<std::size_t>(v)];
            Vec3 off = points[static_cast<std::size_t>(v)] - mask.own * x;
            for (int k = 0; k < mask.count; ++k)
                off -= mask.each * control_.vertices[static_cast<std::size_t>(mask.neighbours[static_cast<std::size_t>(k)])];
            left = std::max(left, off.norm());
            if (sweep < sweeps) x += off / mask.own;
        }
    }
    build_start();
    return left;
}

}  // namespace seldinger
