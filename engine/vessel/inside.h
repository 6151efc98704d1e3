#pragma once
// Position of a point: inside the lumen, in or beyond the wall, or out through an opening.

#include "vessel/tree.h"
#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

struct LumenPlace {
    double signed_distance = 0;   // to the wall [m], > 0 on the lumen's side
    Vec3 nearest = Vec3::Zero();  // on the wall [m]
    Vec3 normal = Vec3::UnitZ();  // unit pseudonormal there, into the lumen
    std::int64_t triangle = -1;   // index in WallMesh::triangles
    int opening = -1;             // >= 0: beyond the plane of that opening, left through it
    bool border = false;          // `nearest` lies where the wall ends
    [[nodiscard]] bool inside() const { return opening < 0 && signed_distance >= 0; }
};

/// Exact distances to the rounded wall (tree.h), signed by angle-weighted pseudonormals, which is right at edges and corners of
/// any orientable surface [Baerentzen & Aanaes 2005, doi:10.1109/TVCG.2005.49].
///
/// Openings: a point whose nearest wall is the rim of an opening and which lies beyond the opening's mean plane has left the
/// vessel there. A point on that plane, to within 1e-4 of the opening's radius, is still inside.
class LumenQuery {
public:
    /// @param openings  the mesh's boundary loops (RepairReport::loops)
    LumenQuery(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings);

    /// @param visits  as of nearest_on_wall
    [[nodiscard]] LumenPlace locate(const Vec3& p, std::uint64_t* visits = nullptr) const;
    [[nodiscard]] double signed_distance(const Vec3& p) const { return locate(p).signed_distance; }
    [[nodiscard]] bool inside(const Vec3& p) const { return locate(p).inside(); }

    [[nodiscard]] const WallTree& tree() const { return tree_; }
    /// Unit angle-weighted normal of a mesh vertex, into the lumen; 0 where its triangles face each other or have no area.
    [[nodiscard]] const Vec3& vertex_normal(std::size_t vertex) const { return vertex_normal_[vertex]; }

private:
    struct Rim {
        Vec3 centre, inward;
        double tolerance;  // [m]
    };
    [[nodiscard]] Vec3 pseudonormal(std::size_t triangle, TriangleFeature feature) const;
    [[nodiscard]] int rim_of(std::size_t triangle, TriangleFeature feature) const;
    [[nodiscard]] bool on_border(std::size_t triangle, TriangleFeature feature) const;

    WallTree tree_;
    std::vector<std::array<std::int32_t, 3>> triangles_;  // [T]
    std::vector<Vec3> facet_normal_;                      // [T] unit, or 0 without area
    std::vector<Vec3> vertex_normal_;                     // [V] unit, or 0
    std::vector<std::int32_t> opposite_;                  // [3 T] half-edge across, -1: none
    std::vector<std::int32_t> vertex_rim_;                // [V] opening that the vertex lies on, -1: none
    std::vector<std::uint8_t> vertex_border_;             // [V] on an edge of one triangle
    std::vector<Rim> rims_;
};

}  // namespace seldinger
