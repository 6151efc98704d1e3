// Sizes of control edges from the spheres of the centreline.
#include "surface/edge_field.h"

#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

// growth of edges with the distance from a narrow place [-]: neighbours differ by less than 1/3
constexpr double grade = 0.25;
// Shortest edge, relative to the requested one. Where a centreline touches the wall of a folded branch its radius is nothing.
constexpr double floor_part = 1.0 / 15;
// spheres nearer to each other than this part of their radius say the same
constexpr double apart_share = 0.2;

constexpr std::size_t stretch_points = 16;

/// Whether a square of a distance is that of a greater one, and by more than rounding: without a root, which would take longer
/// than all the rest.
bool is_beyond(double square, double distance) { return distance <= 0 || square > distance * distance * (1 + 1e-9); }

}  // namespace

EdgeField::EdgeField(double edge, double share, const Centreline& centreline, const EdgePath& path) : edge_(edge), share_(share)
{
    if (path.edge < edge_) path_ = path;
    for (std::size_t begin = 0; begin < path_.points.size(); begin += stretch_points) {
        Stretch made{Vec3::Zero(), 0, begin, std::min(begin + stretch_points, path_.points.size())};
        for (std::size_t i = made.begin; i < made.end; ++i)
            made.centre += path_.points[i] / static_cast<double>(made.end - made.begin);
        for (std::size_t i = made.begin; i < made.end; ++i)
            made.radius = std::max(made.radius, (path_.points[i] - made.centre).norm());
        stretches_.push_back(made);
    }
    std::vector<double> since(centreline.points.size(), -1);  // path from the last point that was taken [m]
    for (std::size_t i = 0; i < centreline.points.size(); ++i) {
        const int up = centreline.parent[i];
        const double radius = centreline.radius[i];
        if (up >= 0 && since[up] >= 0) since[i] = since[up] + (centreline.points[i] - centreline.points[up]).norm();
        if (since[i] >= 0 && since[i] < apart_share * radius) continue;
        since[i] = 0;
        add_circle(centreline.points[i], radius);
    }
}

void EdgeField::add_circle(const Vec3& centre, double radius)
{
    const double least = std::max(share_ * radius, floor_part * edge_);
    if (least < edge_) balls_.push_back({centre, radius, least});
}

double EdgeField::at(const Vec3& p) const
{
    double least = edge_;
    for (const Ball& ball : balls_) {
        const double square = (p - ball.centre).squaredNorm();
        if (is_beyond(square, (least - ball.edge) / grade + ball.radius)) continue;
        least = std::min(least, ball.edge + grade * std::max(0.0, std::sqrt(square) - ball.radius));
    }
    return along_path(p, least);
}

double EdgeField::along_path(const Vec3& p, double least) const
{
    for (const Stretch& stretch : stretches_) {
        if (is_beyond((p - stretch.centre).squaredNorm(), (least - path_.edge) / grade + path_.reach + stretch.radius)) continue;
        for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
            const double square = (p - path_.points[i]).squaredNorm();
            if (is_beyond(square, (least - path_.edge) / grade + path_.reach)) continue;
            least = std::min(least, path_.edge + grade * std::max(0.0, std::sqrt(square) - path_.reach));
        }
    }
    return least;
}

double EdgeField::least() const
{
    double least = path_.points.empty() ? edge_ : path_.edge;
    for (const Ball& ball : balls_) least = std::min(least, ball.edge);
    return least;
}

namespace {

/// As many points as wanted, one for each equal share of the area; `place(triangle, points so far)` puts them.
template <class Place>
WallSamples by_area(const WallMesh& wall, int wanted, Place place)
{
    WallSamples samples;
    for (std::size_t t = 0; t < wall.triangles.size(); ++t) samples.area += 0.5 * double_area(triangle_of(wall, t)).norm();
    const double each = samples.area / wanted;
    double sum = 0.5 * each;
    for (std::size_t t = 0; t < wall.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(wall, t);
        sum += 0.5 * double_area(tri).norm();
        for (; sum >= each && samples.points.size() < static_cast<std::size_t>(wanted); sum -= each)
            samples.points.push_back(place(tri, samples.points.size()));
    }
    return samples;
}

}  // namespace

WallSamples sample_wall(const WallMesh& wall, int wanted)
{
    return by_area(wall, wanted, [](const Triangle3& tri, std::size_t) -> Vec3 { return (tri.a + tri.b + tri.c) / 3; });
}

WallSamples spread_over_wall(const WallMesh& wall, int wanted)
{
    return by_area(wall, wanted, [](const Triangle3& tri, std::size_t count) -> Vec3 {
        // the plastic number's sequence fills a square evenly; the half beyond the diagonal is folded back
        constexpr double step_u = 0.7548776662466927, step_v = 0.5698402909980532;
        const auto k = static_cast<double>(count);
        double u = k * step_u - std::floor(k * step_u), v = k * step_v - std::floor(k * step_v);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        return tri.a + u * (tri.b - tri.a) + v * (tri.c - tri.a);
    });
}

double expected_vertices(const WallSamples& wall, const EdgeField& field)
{
    double sum = 0;
    for (const Vec3& p : wall.points) {
        const double h = field.at(p);
        sum += 1 / (0.5 * std::sqrt(3.0) * h * h);
    }
    return wall.points.empty() ? 0 : sum * wall.area / static_cast<double>(wall.points.size());
}

}  // namespace seldinger
