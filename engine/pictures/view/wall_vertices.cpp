// Vertices of the wall with their normals.
#include "view/wall_vertices.h"

namespace seldinger {

namespace {

/// Area-weighted; upwards where a vertex has no triangle.
std::vector<Vec3> vertex_normals(const std::vector<Vec3>& vertices, const std::vector<std::array<std::int32_t, 3>>& triangles)
{
    std::vector<Vec3> normals(vertices.size(), Vec3::Zero());
    for (const auto& t : triangles) {
        const Vec3& a = vertices[t[0]];
        const Vec3 area = (vertices[t[1]] - a).cross(vertices[t[2]] - a);
        for (int k : t) normals[k] += area;
    }
    for (Vec3& n : normals) n = n.squaredNorm() > 0 ? Vec3(n.normalized()) : Vec3::UnitZ();
    return normals;
}

}  // namespace

std::vector<float> interleaved_wall(const std::vector<Vec3>& vertices, const std::vector<std::array<std::int32_t, 3>>& triangles,
                                    std::span<const float> share, const Vec3& origin)
{
    const std::vector<Vec3> normals = vertex_normals(vertices, triangles);
    std::vector<float> list(7 * vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3 p = vertices[i] - origin;
        for (int k = 0; k < 3; ++k) {
            list[7 * i + k] = static_cast<float>(p[k]);
            list[7 * i + 3 + k] = static_cast<float>(normals[i][k]);
        }
        if (!share.empty()) list[7 * i + 6] = share[i];
    }
    return list;
}

}  // namespace seldinger
