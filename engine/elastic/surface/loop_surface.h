#pragma once
// Smooth limit surface of Loop subdivision over a control mesh: place, derivatives, closest point. The wall's mechanics and the
// wire's contact with an elastic wall live on it.

#include "surface/loop_basis.h"
#include "surface/loop_topology.h"
#include "vessel/tree.h"

#include <array>
#include <span>
#include <vector>

namespace seldinger {

/// Control vertices of a point with their weights: place = sum n[k] x[vertex[k]]. Derivatives are by (u, v), the weights of
/// corners 1 and 2 of a triangle (corner 0: 1 - u - v).
struct LoopStencil {
    static constexpr int capacity = 3 * LoopTopology::max_valence;
    int size = 0;
    std::array<std::int32_t, capacity> vertex;  // [size]
    std::array<double, capacity> n, n_u, n_v;   // [size]
};

/// And second derivatives: they exist wherever subdivision makes the patch regular, that is all but at irregular vertices.
struct LoopCurvedStencil : LoopStencil {
    std::array<double, capacity> n_uu, n_uv, n_vv;  // [size]
};

/// A point of the surface and its data.
struct LoopFoot {
    std::int32_t triangle = -1;  // -1: none yet
    double u = 0, v = 0;
    Vec3 position = Vec3::Zero(), tangent_u = Vec3::Zero(), tangent_v = Vec3::Zero();  // [m]
    Vec3 normal = Vec3::Zero();  // unit, on the side the control mesh's triangles face (the lumen's)
    double distance = 0;         // of the point asked for [m], >= 0
    bool rim = false;            // on a rim: the point lies beyond it or right across
};

/// Where three corners are regular (six triangles about them; three on a rim) the surface is a quartic box spline of twelve
/// control vertices [Cirak00, doi:10.1002/(SICI)1097-0207(20000430)47:12<2039::AID-NME872>3.0.CO;2-1]; elsewhere triangles are
/// divided until it is [Stam98]. Rims are cubic B-splines of their own vertices; a rim's corner (one triangle about it, or a turn
/// of more than 75 degrees) is interpolated.
class LoopSurface {
public:
    /// @param control  a mesh of any valence up to LoopTopology::max_valence, open or closed. Throws Error when it is not a
    ///                 manifold, is not oriented alike throughout, or has a triangle of no area.
    explicit LoopSurface(WallMesh control);

    [[nodiscard]] const WallMesh& control() const { return control_; }
    [[nodiscard]] const LoopTopology& topology() const { return topology_; }
    /// Mean edge of the control mesh as given [m].
    [[nodiscard]] double mean_edge() const { return edge_; }

    /// Weights at (u, v) of a triangle; u, v >= 0, u + v <= 1. No allocation.
    void basis(std::int32_t triangle, double u, double v, LoopStencil& stencil) const;
    /// And of the second derivatives. Within 2^-16 of an irregular vertex they are those of a plane.
    void basis(std::int32_t triangle, double u, double v, LoopCurvedStencil& stencil) const;

    /// The surface's point, tangents, normal there. @return foot with `distance` 0
    [[nodiscard]] LoopFoot at(std::int32_t triangle, double u, double v) const;

    /// Closest point of the surface to p. Starts from where `foot` lies (triangle >= 0) and walks downhill over triangles, or
    /// searches everywhere (triangle < 0). A walk finds the closest point nearby, which is what a wire that slides wants.
    void closest(const Vec3& p, LoopFoot& foot) const;

    /// Where vertex v of the control mesh ends up. @return weights; n_u, n_v of one of the triangles about it
    void limit_of_vertex(std::int32_t vertex, LoopStencil& stencil) const;
    /// Moves control vertices until the surface passes through `points` at their limits, rims included.
    /// @param points  [V] [m]   @return the remaining largest distance [m]
    double interpolate(std::span<const Vec3> points, int sweeps = 60);

private:
    /// Control vertices that matter to a triangle, and how its points come from them.
    struct Patch {
        std::int32_t first_vertex, vertex_count;  // in patch_vertices_
        std::int32_t first_child;                 // -1: its twelve vertices are the points; else in children_
        bool divided;                             // four children, or one that is the triangle itself (beside a rim)
    };
    /// A regular patch of twelve points, or a corner's. Each point is a row of weights on the patch's vertices.
    struct Child {
        std::int32_t corner;       // in corners_, -1: regular
        std::int32_t first_point;  // in rows_
    };
    template <bool curved>
    struct Weights;
    template <bool curved>
    void weigh(std::int32_t triangle, double u, double v, Weights<curved>& weights) const;

    template <bool curved>
    void fill(std::int32_t triangle, const Weights<curved>& weights, LoopStencil& stencil) const;

    void build_patch(std::int32_t triangle, const LoopRefinement& fine);
    void add_point(Patch& patch, const LoopPoint& point, const LoopRefinement* fine);
    std::int32_t corner_index(LoopVertex kind, int triangles, int place);
    void build_start();

    void descend(const Vec3& p, LoopFoot& foot) const;

    WallMesh control_;
    LoopTopology topology_;
    double edge_ = 0;             // mean length [m]
    std::vector<Patch> patches_;  // [T]
    std::vector<std::int32_t> patch_vertices_;
    std::vector<Child> children_;
    std::vector<std::int32_t> rows_;    // first entry of each point's row, and one past the last
    std::vector<unsigned char> slots_;  // of an entry: which of the patch's vertices
    std::vector<double> row_weights_;   // of an entry
    std::vector<LoopCorner> corners_;
    WallTree start_;  // flat pieces of the surface, start_pieces^2 a triangle, for searches from nowhere
};

}  // namespace seldinger
