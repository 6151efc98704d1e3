// Rays from a point to wall and openings.
#include "vessel/enclosure.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr int directions = 16;

/// Evenly spread over the sphere, none along an axis.
Vec3 direction(int k)
{
    const double z = 1 - (2 * k + 1) / static_cast<double>(directions), r = std::sqrt(1 - z * z), turn = 2.4 * k + 0.3;
    return {r * std::cos(turn), r * std::sin(turn), z};
}

bool faces(const WallTree& tree, std::int64_t triangle, const Vec3& ray)
{
    return triangle >= 0 && double_area(tree.triangle(static_cast<std::size_t>(triangle))).dot(ray) < 0;
}

}  // namespace

Enclosure::Enclosure(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings, const LumenQuery& lumen)
    : openings_(openings), lumen_(lumen)
{
    WallMesh lids;
    for (const BoundaryLoop& loop : openings) {
        const auto centre = static_cast<std::int32_t>(lids.vertices.size());
        const auto count = static_cast<std::int32_t>(loop.vertices.size());
        lids.vertices.push_back(loop.centre);
        for (const std::int32_t v : loop.vertices) lids.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
        for (std::int32_t i = 0; i < count; ++i) lids.triangles.push_back({centre, centre + 1 + (i + 1) % count, centre + 1 + i});
    }
    if (!lids.triangles.empty()) lids_ = build_wall_tree(lids, 1);
}

bool Enclosure::is_at_opening(const Vec3& p) const
{
    return std::any_of(openings_.begin(), openings_.end(), [&](const BoundaryLoop& loop) {
        const Vec3 to = p - loop.centre;
        return std::abs(to.dot(loop.inward)) < 0.5 * loop.radius && to.norm() < 1.5 * loop.radius;
    });
}

bool Enclosure::holds(const Vec3& p, std::uint64_t* visits) const
{
    int within = 0;
    for (int k = 0; k < directions; ++k) {
        std::int64_t wall = -1, lid = -1;
        const Vec3 ray = direction(k);
        const double to_wall = first_hit(lumen_.tree(), p, ray, 0, visits, &wall);
        const double to_lid = first_hit(lids_, p, ray, 0, visits, &lid);
        within += to_lid < to_wall ? faces(lids_, lid, ray) : faces(lumen_.tree(), wall, ray);
    }
    return 2 * within > directions;
}

}  // namespace seldinger
