#pragma once
// Length of the edges of a control mesh, place by place: as requested, but short in a narrow lumen.

#include "vessel/centreline.h"
#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

/// Where instruments go: edges of `edge` up to `reach` from each point, longer ones farther off.
struct EdgePath {
    std::vector<Vec3> points;    // of the wall, in the order of the path [m]; empty: not known
    double edge = 0, reach = 0;  // [m]
};

/// target(p) = min(edge, min over spheres of max(share * radius, edge / 15) + grade * distance of p from the sphere). Spheres are
/// the largest ones inside the lumen and the rims' own circles. So a narrow branch makes edges short on itself, and neighbouring
/// edges differ by about the grade. Along a path they are min(that, path.edge + grade * distance of p from where it reaches).
class EdgeField {
public:
    /// @param edge   wanted [m]
    /// @param share  of the local lumen radius that an edge may have at most [-]
    /// @param path   where edges are shorter still
    EdgeField(double edge, double share, const Centreline& centreline, const EdgePath& path = {});
    void add_circle(const Vec3& centre, double radius);
    [[nodiscard]] double at(const Vec3& p) const;
    [[nodiscard]] double edge() const { return edge_; }
    [[nodiscard]] double least() const;  // lower bound of at() [m]

private:
    struct Ball {
        Vec3 centre;
        double radius, edge;  // [m]
    };
    /// Points of the path that follow each other.
    struct Stretch {
        Vec3 centre;
        double radius;  // [m]
        std::size_t begin, end;
    };
    [[nodiscard]] double along_path(const Vec3& p, double least) const;

    double edge_, share_;
    std::vector<Ball> balls_;  // only those that ask for less than edge_
    EdgePath path_;
    std::vector<Stretch> stretches_;
};

/// Points of a wall, each of which represents the same area.
struct WallSamples {
    std::vector<Vec3> points;  // centroids [m]
    double area = 0;           // of the whole wall [m^2]
};
[[nodiscard]] WallSamples sample_wall(const WallMesh& wall, int wanted = 20'000);

/// The same, spread over the triangles: for sizes that change within one of them.
[[nodiscard]] WallSamples spread_over_wall(const WallMesh& wall, int wanted = 60'000);

/// Vertices of an isotropic mesh with these edges: equilateral triangles of side h have a vertex per sqrt(3)/2 h^2.
[[nodiscard]] double expected_vertices(const WallSamples& wall, const EdgeField& field);

}  // namespace seldinger
