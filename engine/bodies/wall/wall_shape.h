#pragma once
// The vessel's mesh as an elastic wall carries it along: vertices follow the nearest point of the wall's smooth surface.

#include "math/vec3.h"
#include "vessel/wall_mesh.h"
#include "wall/elastic_wall.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

class WallShape {
public:
    /// Finds every vertex's place on the surface: some microseconds each.
    WallShape(const ElasticWall& wall, const WallMesh& mesh);

    /// Displacement of the mesh's vertices. @param w  of the control vertices [3V] [m]
    [[nodiscard]] std::vector<Vec3> displacement(std::span<const double> w) const;
    /// Numbers at control vertices, at the mesh's vertices.
    [[nodiscard]] std::vector<double> spread(std::span<const double> at_control) const;

private:
    std::vector<std::uint32_t> begin_;   // [mesh vertices + 1] in the two below
    std::vector<std::int32_t> control_;  // control vertices
    std::vector<float> weight_;
};

}  // namespace seldinger
