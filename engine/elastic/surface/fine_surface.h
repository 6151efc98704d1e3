#pragma once
// The fine wall for a control mesh: a surface to lie on, and its rims as curves with an arc length.

#include "vessel/shared_tree.h"
#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

/// Nearest points of a wall, with smooth normals.
class FineSurface {
public:
    explicit FineSurface(const WallMesh& mesh);

    struct Place {
        Vec3 point;   // [m]
        Vec3 normal;  // unit, between those of the triangle's corners
    };
    /// Nearest point of the wall.
    [[nodiscard]] Place nearest(const Vec3& p) const;
    /// Unit normal at a vertex, triangles weighted by their area.
    [[nodiscard]] const Vec3& normal(std::size_t vertex) const { return normals_[vertex]; }

private:
    const WallMesh& mesh_;
    std::shared_ptr<const WallTree> tree_;
    std::vector<Vec3> normals_;  // [V]
};

/// A closed polyline, run through by its arc length.
class RimCurve {
public:
    explicit RimCurve(std::vector<Vec3> points);

    [[nodiscard]] double length() const { return length_; }
    [[nodiscard]] const Vec3& centre() const { return centre_; }
    [[nodiscard]] double arc_length_of(std::size_t point) const { return arc_[point]; }
    [[nodiscard]] Vec3 at(double s) const;  // any s, modulo length()
    /// The path from s0 forward to s1, in [0, length()).
    [[nodiscard]] double way(double s0, double s1) const;
    /// Points at which the curve turns by more than 60 degrees within a window [m] either side, and nowhere near by more.
    [[nodiscard]] std::vector<std::size_t> corners(double window) const;

private:
    std::vector<Vec3> points_;
    std::vector<double> arc_;  // [points]
    double length_ = 0;
    Vec3 centre_ = Vec3::Zero();  // weighted by length
};

}  // namespace seldinger
