#pragma once
// Meshes made by hand for tests of the vessel.

#include "shapes/shapes.h"
#include "vessel/triangle_geometry.h"
#include "vessel/wall_mesh.h"

#include <random>
#include <string>

namespace seldinger::test {

inline VesselSpec tube_spec(double radius, double length, int triangles)
{
    return {.shape = VesselShape::Tube, .radius = radius, .length = length, .triangles = triangles};
}

/// Closed sphere about `centre`, normals outwards as most files have them: an octahedron, subdivided.
inline WallMesh sphere(double radius, const Vec3& centre, int levels)
{
    WallMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::vector<std::array<std::int32_t, 3>> finer;
        for (const auto& t : mesh.triangles) {
            std::array<std::int32_t, 3> middle;  // doubled along edges; weld() joins them
            for (std::size_t e = 0; e < 3; ++e) {
                middle[e] = static_cast<std::int32_t>(mesh.vertices.size());
                mesh.vertices.push_back(
                    (mesh.vertices[static_cast<std::size_t>(t[e])] + mesh.vertices[static_cast<std::size_t>(t[(e + 1) % 3])])
                        .normalized());
            }
            finer.push_back({t[0], middle[0], middle[2]});
            finer.push_back({middle[0], t[1], middle[1]});
            finer.push_back({middle[2], middle[1], t[2]});
            finer.push_back(middle);
        }
        mesh.triangles = std::move(finer);
    }
    for (Vec3& v : mesh.vertices) v = centre + radius * v;
    return mesh;
}

inline void append(WallMesh& mesh, const WallMesh& other)
{
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

inline void flip(WallMesh& mesh, std::size_t t) { std::swap(mesh.triangles[t][1], mesh.triangles[t][2]); }

/// Every triangle has three separate vertices, as in an STL.
inline WallMesh as_soup(const WallMesh& mesh)
{
    WallMesh soup;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        const auto first = static_cast<std::int32_t>(soup.vertices.size());
        soup.vertices.insert(soup.vertices.end(), {tri.a, tri.b, tri.c});
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

/// Triangles whose normal does not point towards the x axis, for tubes along it.
inline int facing_out_of_x_tube(const WallMesh& mesh)
{
    int count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        Vec3 from_axis = (tri.a + tri.b + tri.c) / 3;
        from_axis.x() = 0;
        count += double_area(tri).dot(from_axis) >= 0;
    }
    return count;
}

}  // namespace seldinger::test
