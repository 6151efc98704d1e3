#pragma once
// Position of a point: inside the lumen, in or beyond the wall, or out through an opening.

#include "vessel/shared_tree.h"
#include "vessel/wall_mesh.h"

#include <memory>
#include <utility>
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
    /// signed_distance of that point p; infinity where no wall is in the way: past an opening, and beside the border of a sheet.
    [[nodiscard]] double clearance(const Vec3& p) const;
};

/// Exact distances to the rounded wall (tree.h), signed by angle-weighted pseudonormals, which is right at edges and corners of
/// any orientable surface [Baerentzen & Aanaes 2005, doi:10.1109/TVCG.2005.49].
///
/// Little is prepared: the tree leads to the triangles around a vertex or an edge, too.
///
/// Openings: a point whose nearest wall is the rim of an opening and which lies beyond the opening's mean plane has left the
/// vessel there. A point on that plane, to within 1e-4 of the opening's radius, is still inside.
class LumenQuery {
public:
    enum class Expect { Many, Few };  // queries: many are worth preparing for

    /// @param openings  the mesh's boundary loops (RepairReport::loops)
    LumenQuery(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings, Expect queries = Expect::Many);

    /// @param visits  as of nearest_on_wall
    [[nodiscard]] LumenPlace locate(const Vec3& p, std::uint64_t* visits = nullptr) const;
    [[nodiscard]] double signed_distance(const Vec3& p) const { return locate(p).signed_distance; }
    [[nodiscard]] bool inside(const Vec3& p) const { return locate(p).inside(); }

    /// nearest_on_wall(tree(), ...)
    [[nodiscard]] TreeHit nearest(const Vec3& p, double limit = std::numeric_limits<double>::infinity(),
                                  std::uint64_t* visits = nullptr, std::int64_t guess = -1) const
    {
        return nearest_on_wall(*tree_, p, limit, visits, guess, quads_);
    }
    [[nodiscard]] const WallTree& tree() const { return *tree_; }
    /// Unit angle-weighted normal of a mesh vertex, into the lumen; 0 where its triangles face each other or have no area.
    /// @param visits  as of nearest_on_wall
    [[nodiscard]] Vec3 vertex_normal(std::int32_t vertex, std::uint64_t* visits = nullptr) const;

private:
    struct Rim {
        Vec3 centre, inward;
        double tolerance;  // [m]
    };
    struct Around {  // the nearest point: triangles that share its feature, increasing
        std::int32_t from = -1, to = -1;  // vertices of an edge; one vertex and -1; a face has neither
        std::vector<std::uint32_t> triangles;
        [[nodiscard]] bool is_edge() const { return to >= 0; }
    };
    [[nodiscard]] Around around(std::size_t triangle, TriangleFeature feature) const;
    [[nodiscard]] std::vector<std::uint32_t> triangles_at(std::int32_t vertex, std::uint64_t* visits = nullptr) const;
    [[nodiscard]] Vec3 facet_normal(std::size_t triangle) const;
    [[nodiscard]] Vec3 vertex_normal(std::int32_t vertex, const std::vector<std::uint32_t>& triangles) const;
    [[nodiscard]] Vec3 pseudonormal(std::size_t triangle, const Around& at) const;
    [[nodiscard]] int rim_of(const Around& at, bool border) const;
    [[nodiscard]] bool is_border(const Around& at) const;

    std::shared_ptr<const WallTree> tree_;
    std::vector<TreeQuad> quads_;  // where many queries are expected
    WallMesh mesh_;
    std::vector<std::pair<std::int32_t, std::int32_t>> vertex_rim_;  // vertices of openings, increasing, and their opening
    std::vector<Rim> rims_;
};

}  // namespace seldinger
