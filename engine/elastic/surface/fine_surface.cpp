// Projection onto the fine wall and onto its rims.
#include "surface/fine_surface.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double corner_cosine = 0.5;  // of 60 degrees

}  // namespace

FineSurface::FineSurface(const WallMesh& mesh)
    : mesh_(mesh), tree_(shared_wall_tree(mesh)), normals_(mesh.vertices.size(), Vec3::Zero())
{
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3 area = double_area(triangle_of(mesh, t));
        for (const std::int32_t v : mesh.triangles[t]) normals_[v] += area;
    }
    for (Vec3& n : normals_) n.normalize();
}

FineSurface::Place FineSurface::nearest(const Vec3& p) const
{
    const TreeHit hit = nearest_on_wall(*tree_, p);
    const std::size_t t = tree_->original[hit.triangle];
    const auto& corner = mesh_.triangles[t];
    const Triangle3 tri = triangle_of(mesh_, t);
    const Vec3 point = closest_point(p, tri).point;  // of the wall itself, not rounded
    const Vec3 area = double_area(tri);
    const double whole = area.squaredNorm();
    if (!(whole > 0)) return {point, normals_[corner[0]]};
    const double b = (tri.c - tri.a).cross(tri.a - point).dot(area), c = (tri.a - tri.b).cross(tri.b - point).dot(area);
    const Vec3 normal = (whole - b - c) * normals_[corner[0]] + b * normals_[corner[1]] + c * normals_[corner[2]];
    return {point, normal.squaredNorm() > 0 ? Vec3(normal.normalized()) : Vec3(area.normalized())};
}

RimCurve::RimCurve(std::vector<Vec3> points) : points_(std::move(points))
{
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vec3 &a = points_[i], &b = points_[(i + 1) % points_.size()];
        const double edge = (b - a).norm();
        arc_.push_back(length_);
        length_ += edge;
        centre_ += 0.5 * edge * (a + b);
    }
    centre_ = length_ > 0 ? Vec3(centre_ / length_) : points_[0];
}

Vec3 RimCurve::at(double s) const
{
    s = way(0, s);
    const auto after = static_cast<std::size_t>(std::upper_bound(arc_.begin(), arc_.end(), s) - arc_.begin());
    const std::size_t i = after - 1;
    const double end = after < arc_.size() ? arc_[after] : length_;
    const Vec3 &a = points_[i], &b = points_[after % points_.size()];
    return end > arc_[i] ? Vec3(a + (s - arc_[i]) / (end - arc_[i]) * (b - a)) : a;
}

double RimCurve::way(double s0, double s1) const
{
    const double s = std::fmod(s1 - s0, length_);
    const double forward = s < 0 ? s + length_ : s;
    return forward < length_ ? forward : 0;  // -1e-20 + length is length
}

std::vector<std::size_t> RimCurve::corners(double window) const
{
    window = std::min(window, length_ / 8);
    std::vector<double> cosine(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vec3 in = points_[i] - at(arc_[i] - window), out = at(arc_[i] + window) - points_[i];
        cosine[i] = in.dot(out) / std::max(in.norm() * out.norm(), 1e-300);
    }
    std::vector<std::size_t> sharp, found;
    for (std::size_t i = 0; i < points_.size(); ++i)
        if (cosine[i] < corner_cosine) sharp.push_back(i);
    std::stable_sort(sharp.begin(), sharp.end(), [&](std::size_t a, std::size_t b) { return cosine[a] < cosine[b]; });
    for (const std::size_t i : sharp) {
        const bool near = std::any_of(found.begin(), found.end(), [&](std::size_t j) {
            return std::min(way(arc_[i], arc_[j]), way(arc_[j], arc_[i])) < 2 * window;
        });
        if (!near) found.push_back(i);
    }
    return found;
}

}  // namespace seldinger
