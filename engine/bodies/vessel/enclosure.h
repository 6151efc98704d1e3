#pragma once
// Whether a point is in the lumen, whatever the rims of its openings are like. The nearest wall (LumenQuery) cannot tell in front
// of a flap that stands out of a rim: there the flap's own front is nearest.

#include "vessel/inside.h"

namespace seldinger {

class Enclosure {
public:
    /// @param lumen  of the same mesh and openings
    Enclosure(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings, const LumenQuery& lumen);

    /// Most of 16 directions from p meet the lumen's side of the wall first, or an opening from within. An opening is the cone
    /// from its centre to its rim. @param visits  as of nearest_on_wall
    [[nodiscard]] bool holds(const Vec3& p, std::uint64_t* visits = nullptr) const;

    /// Near the plane of an opening, and not farther aside than its rim: what lies there is neither in nor out.
    [[nodiscard]] bool is_at_opening(const Vec3& p) const;

private:
    const std::vector<BoundaryLoop>& openings_;
    const LumenQuery& lumen_;
    WallTree lids_;  // of all openings; empty without
};

}  // namespace seldinger
