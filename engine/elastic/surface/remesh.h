#pragma once
// Isotropic remeshing of a wall: edges as long as a field asks for, triangles near to equilateral, vertices on the fine surface
// and on its rims [Botsch04].
//
// First the fine mesh is thinned out. Its short edges go in passes of growing length, and one end of each stays. This takes
// microseconds an edge whatever the size of the mesh. Then rounds of: split edges longer than 4/3 of the target, collapse those
// shorter than 4/5, turn edges towards six neighbours, move vertices to the middle of their triangles and back onto the wall.
// No change may turn a triangle against the wall's normals.

#include "surface/edge_field.h"
#include "surface/edit_mesh.h"
#include "surface/fine_surface.h"

#include <vector>

namespace seldinger {

/// Least angle of a triangle [rad].
[[nodiscard]] double least_angle(const Vec3& a, const Vec3& b, const Vec3& c);

class Remesher {
public:
    /// @param wall   must outlive this
    /// @param sheet  the same, to be changed
    /// @param field  sizes wanted; rims narrower than its edge / share are added
    Remesher(const WallMesh& wall, EditMesh sheet, EdgeField field);

    void run(int rounds);
    [[nodiscard]] WallMesh result() const;
    [[nodiscard]] std::size_t rim_count() const { return rims_.size(); }
    [[nodiscard]] const FineSurface& surface() const { return surface_; }
    [[nodiscard]] const EdgeField& field() const { return field_; }

private:
    struct Vertex {
        Vec3 place, normal;     // [m]; of the fine wall there, unit
        double target = 0;      // edge length asked for here [m]
        double s = 0;           // arc length along its rim [m]
        std::int32_t rim = -1;  // index of its rim, -1: inside
        bool corner = false;    // of a rim: stays
    };

    void find_rims();
    void set_targets();
    void thin_out();
    void thin_out_pass(double longest, double part);
    void compact();

    void split_long();
    void collapse_short();
    void remove_sparse();
    void turn_edges(bool for_angles);
    /// Triangles with a small angle: their shortest edge goes, or their longest is turned.
    void mend();
    void relax();
    void relax_inside(std::int32_t v);
    void relax_on_rim(std::int32_t v);

    [[nodiscard]] double length(std::int32_t h) const { return (at(mesh_.to(h)) - at(mesh_.from(h))).norm(); }
    [[nodiscard]] double target(std::int32_t h) const
    {
        return 0.5 * (vertex_[mesh_.from(h)].target + vertex_[mesh_.to(h)].target);
    }
    [[nodiscard]] const Vec3& at(std::int32_t v) const { return vertex_[v].place; }
    /// A vertex in the middle of the edge, on the rim or on the wall.
    [[nodiscard]] Vertex middle(std::int32_t h) const;
    /// The one that an edge is drawn into, or what `middle` of it would be; false where its rim forbids it.
    [[nodiscard]] bool merged(std::int32_t h, bool to_middle, Vertex& result) const;
    /// Draws the edge into `to`, unless triangles would turn, edges become longer than `longest` targets, or topology change.
    bool try_collapse(std::int32_t h, const Vertex& to, double longest);
    /// How well the triangle lies along the wall: least cosine between its normal and those at its corners.
    [[nodiscard]] double along_around(std::int32_t h) const;  // least of the triangles at either end of the edge
    [[nodiscard]] static double along_wall(const Vertex& a, const Vertex& b, const Vertex& c);
    [[nodiscard]] int best_valence(std::int32_t v) const;
    [[nodiscard]] double angle_of(std::int32_t h) const
    {
        return least_angle(at(mesh_.from(h)), at(mesh_.to(h)), at(mesh_.apex(h)));
    }
    [[nodiscard]] bool turn_helps(std::int32_t h, bool for_angles) const;

    FineSurface surface_;
    EditMesh mesh_;
    EdgeField field_;
    std::vector<Vertex> vertex_;  // [V]
    std::vector<RimCurve> rims_;
    std::vector<int> rim_edges_;  // [rims] edges left on each
};

}  // namespace seldinger
