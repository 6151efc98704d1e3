// Projects points, and aims a camera along the vessel's shortest principal axis from where all of it is in the picture.
#include "view/camera.h"

#include "core/check.h"
#include "math/eigen.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

struct Principal {
    Vec3 longest, middle, shortest;  // unit
    Vec3 facing = Vec3::Zero();      // sum of area-weighted normals over the total area; 0 for a closed surface
};

Principal principal_axes(const WallMesh& mesh, const std::vector<Vec3>& extra)
{
    // moments about the mean: triangles count by area (centroid rule), loose points equally
    double weight = 0;
    Vec3 mean = Vec3::Zero(), facing = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    const auto add = [&](const Vec3& p, double w) {
        weight += w;
        mean += w * p;
        second += outer(w * p, p);
    };
    if (mesh.triangles.empty()) {
        for (const Vec3& p : extra) add(p, 1.0);
    }
    for (const auto& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const Vec3 area = 0.5 * (b - a).cross(c - a);
        facing += area;
        add((a + b + c) / 3.0, area.norm());
    }
    Principal axes;
    if (!(weight > 0)) return {Vec3::UnitX(), Vec3::UnitZ(), Vec3::UnitY(), Vec3::Zero()};
    mean /= weight;
    const Mat3 about_mean = second / weight - outer(mean, mean);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(eigen(about_mean));
    axes.shortest = to_vec3(solver.eigenvectors().col(0));
    axes.middle = to_vec3(solver.eigenvectors().col(1));
    axes.longest = to_vec3(solver.eigenvectors().col(2));
    if (!mesh.triangles.empty()) axes.facing = facing / weight;
    return axes;
}

/// An eigenvector has no sign. Look from the front, from the left or from the head, whichever the axis is nearest to.
Vec3 viewing_direction(const Principal& axes, const Vec3& head, const Vec3& back)
{
    if (axes.facing.norm() > 0.3) {
        return axes.facing.dot(axes.shortest) > 0 ? Vec3(-axes.shortest) : axes.shortest;
    }
    const Vec3 from[] = {-back, back.cross(head), head};
    const Vec3* nearest = &from[0];
    for (const Vec3& side : from)
        if (std::abs(side.dot(axes.shortest)) > std::abs(nearest->dot(axes.shortest))) nearest = &side;
    return axes.shortest.dot(*nearest) > 0 ? Vec3(-axes.shortest) : axes.shortest;
}

}  // namespace

Projected project(const Camera& camera, const Viewport& viewport, const Vec3& point)
{
    const Vec3 forward = camera.forward(), right = camera.right(), up = right.cross(forward), d = point - camera.eye;
    const double depth = d.dot(forward), scale = pixels_per_metre(camera, viewport, depth);
    return {viewport.x + 0.5 * viewport.width + scale * d.dot(right), viewport.y + 0.5 * viewport.height - scale * d.dot(up),
            depth};
}

double pixels_per_metre(const Camera& camera, const Viewport& viewport, double depth)
{
    return 0.5 * viewport.height / (std::tan(0.5 * camera.fov_y) * depth);
}

Camera fit_camera(const std::vector<Vec3>& points, const Vec3& forward_in, const Vec3& up_in, double aspect, double fov_y,
                  double margin)
{
    SEL_ASSERT(aspect > 0 && fov_y > 0 && margin < 1);
    const Vec3 back = -forward_in.normalized();
    const Vec3 right = up_in.cross(back).normalized(), up = back.cross(right);
    const double tan_y = std::tan(0.5 * fov_y) * (1 - margin), tan_x = tan_y * aspect;
    constexpr double none = -std::numeric_limits<double>::infinity();
    double right_bound = none, left_bound = none, top_bound = none, bottom_bound = none, nearest = none, farthest = -none;
    for (const Vec3& p : points) {
        const double x = p.dot(right), y = p.dot(up), z = p.dot(back);
        right_bound = std::max(right_bound, x + tan_x * z);
        left_bound = std::max(left_bound, -x + tan_x * z);
        top_bound = std::max(top_bound, y + tan_y * z);
        bottom_bound = std::max(bottom_bound, -y + tan_y * z);
        nearest = std::max(nearest, z);
        farthest = std::min(farthest, z);
    }
    if (points.empty()) return {Vec3(back), Vec3::Zero(), up, fov_y};
    double distance = std::max((right_bound + left_bound) / (2 * tan_x), (top_bound + bottom_bound) / (2 * tan_y));
    // a single point or a line of sight along the wire: stay clear of it
    distance = std::max(distance, nearest + 0.05 * std::max(nearest - farthest, 1e-3) + 1e-3);
    Camera camera;
    camera.eye = 0.5 * (right_bound - left_bound) * right + 0.5 * (top_bound - bottom_bound) * up + distance * back;
    camera.target = camera.eye - (distance - 0.5 * (nearest + farthest)) * back;
    camera.up = up;
    camera.fov_y = fov_y;
    return camera;
}

Camera automatic_camera(const WallMesh& mesh, const std::vector<Vec3>& extra, double aspect, const Vec3& head, const Vec3& back)
{
    const Principal axes = principal_axes(mesh, extra);
    const Vec3 forward = viewing_direction(axes, head, back);
    std::vector<Vec3> points = mesh.vertices;
    points.insert(points.end(), extra.begin(), extra.end());

    const auto upright = [&](const Vec3& axis) { return axis.dot(head) < 0 ? Vec3(-axis) : axis; };
    const auto reach = [](const Camera& c) { return (c.target - c.eye).norm(); };
    const std::array<Camera, 2> along = {fit_camera(points, forward, upright(axes.middle), aspect),
                                         fit_camera(points, forward, upright(axes.longest), aspect)};
    const Camera& best = reach(along[0]) <= reach(along[1]) ? along[0] : along[1];

    // upright is readable when "up" keeps most of its length in the picture
    const Vec3 sky = head - head.dot(forward) * forward;
    if (sky.norm() < 0.5) return best;
    const Camera standing = fit_camera(points, forward, sky, aspect);
    return reach(standing) < 1.5 * reach(best) ? standing : best;
}

}  // namespace seldinger
