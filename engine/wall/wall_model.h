#pragma once
// The vessel's wall as a body: what is constant about it, and what changes.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

#include <cstdint>
#include <vector>

namespace seldinger {

/// What is constant; all systems of a world share it. Refers to what the world's setup owns.
struct WallModel {
    WallModel(const VesselSpec& made_of, const WallMesh& shape, const Centreline& axis);

    const VesselSpec& spec;        // of what the wall is made
    const WallMesh& mesh;          // the shape that contact sees where the wall has not moved [m]
    const Centreline& centreline;  // may be empty
    /// Half of the lumen is wider than this [m]; infinite without a centreline. The effective radius of (D6b) needs one number for
    /// the law to be a function of depth alone; a quarter more or less of it changes the stiffness of a 0.035 inch wire in a
    /// 10 mm lumen by half a percent.
    double typical_lumen_radius;
};

/// What changes, one per system. Of a rigid wall it is empty.
struct WallState {
    std::vector<Vec3> displacement;  // [V] of the mesh's vertices [m]; empty: none of them moves
    std::uint64_t epoch = 0;         // raised with every change of `displacement`
    double moved = 0;                // how far any vertex has gone since the caches near the wall were made, at most [m]
    [[nodiscard]] bool rigid() const { return displacement.empty(); }
};

}  // namespace seldinger
