// Sizes of control edges from the spheres of the centreline.
#include "wall/edge_field.h"

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

}  // namespace

EdgeField::EdgeField(double edge, double share, const Centreline& centreline) : edge_(edge), share_(share)
{
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
    for (const Ball& ball : balls_)
        least = std::min(least, ball.edge + grade * std::max(0.0, (p - ball.centre).norm() - ball.radius));
    return least;
}

double EdgeField::least() const
{
    double least = edge_;
    for (const Ball& ball : balls_) least = std::min(least, ball.edge);
    return least;
}

WallSamples sample_wall(const WallMesh& wall, int wanted)
{
    WallSamples samples;
    for (std::size_t t = 0; t < wall.triangles.size(); ++t) samples.area += 0.5 * double_area(triangle_of(wall, t)).norm();
    const double each = samples.area / wanted;
    double sum = 0.5 * each;
    for (std::size_t t = 0; t < wall.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(wall, t);
        sum += 0.5 * double_area(tri).norm();
        for (; sum >= each && samples.points.size() < static_cast<std::size_t>(wanted); sum -= each)
            samples.points.push_back((tri.a + tri.b + tri.c) / 3);
    }
    return samples;
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
