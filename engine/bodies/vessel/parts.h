#pragma once
// The separate parts of a vessel's surface: a segmentation often has one vessel and many crumbs.

#include "vessel/wall_mesh.h"

#include <string>
#include <vector>

namespace seldinger {

struct VesselPart {
    double share = 0;  // of the whole surface's area
    int openings = 0;
    bool obstacle = false;  // inside another part: its surface faces outwards
    Box3 box;               // [m]
};

/// Parts that hang together by edges, the largest area first.
class VesselParts {
public:
    /// @param mesh  repaired
    VesselParts(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings);
    [[nodiscard]] const std::vector<VesselPart>& parts() const { return parts_; }
    /// The part whose wall is nearest to a point. O(V)
    [[nodiscard]] int part_at(const Vec3& p) const;
    /// How many parts there are, what share of the surface a wire that enters `part` cannot reach, and whether another part is
    /// larger; one line each. Empty for one part.
    [[nodiscard]] std::vector<std::string> describe_choice(int part) const;

private:
    const WallMesh& mesh_;
    std::vector<int> part_of_vertex_;  // -1: no triangle has it
    std::vector<VesselPart> parts_;
};

}  // namespace seldinger
