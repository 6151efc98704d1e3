#pragma once
// The vessel's mesh as an elastic wall carries it along: vertices follow the nearest point of the wall's smooth surface.

#include "contact/wall_body.h"
#include "math/vec3.h"
#include "vessel/wall_mesh.h"
#include "shell/elastic_wall.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

class WallShape final : public CarriedMesh {
public:
    /// Finds every vertex's place on the surface: some microseconds each.
    WallShape(const ElasticWall& wall, const WallMesh& mesh);

    [[nodiscard]] std::vector<Vec3> displacement(std::span<const double> w) const override;
    [[nodiscard]] std::vector<double> spread(std::span<const double> at_control) const override;

private:
    std::vector<std::uint32_t> begin_;   // [mesh vertices + 1] in the two below
    std::vector<std::int32_t> control_;  // control vertices
    std::vector<float> weight_;
};

}  // namespace seldinger
