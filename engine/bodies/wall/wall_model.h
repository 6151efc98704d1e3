#pragma once
// The vessel's undeformed wall, and constants that follow from its shape.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

namespace seldinger {

/// All systems of a world share it. Refers to what the world's setup owns.
struct WallModel {
    WallModel(const VesselSpec& made_of, const WallMesh& shape, const Centreline& axis);

    const VesselSpec& spec;        // of what the wall is made
    const WallMesh& mesh;          // the shape that contact sees where the wall has not moved [m]
    const Centreline& centreline;  // may be empty
    /// Half of the lumen is wider than this [m]; infinite without a centreline. The effective radius of (D6b) needs one number
    /// for the law to be a function of depth alone. A change of 25 % in it changes the stiffness of a 0.035 inch wire in a 10 mm
    /// lumen by 0.5 %.
    double typical_lumen_radius;
};

/// Radius of the lumen at a point of its wall: of the widest inscribed sphere that all but touches it, as no sphere of a branch
/// beside it does. A plane is as wide as it is long; where no sphere is known there is no limit [m].
[[nodiscard]] double lumen_radius_at(const WallModel& wall, const Vec3& place);

}  // namespace seldinger
