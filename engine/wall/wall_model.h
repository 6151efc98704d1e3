#pragma once
// The vessel's wall as a body: what is constant about it, and what changes.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// What is constant; all systems of a world share it. Refers to what the world's setup owns.
struct WallModel {
    WallModel(const VesselSpec& made_of, const WallMesh& shape, const Centreline& axis);

    const VesselSpec& spec;        // of what the wall is made
    const WallMesh& mesh;          // the shape that contact sees where the wall has not moved [m]
    const Centreline& centreline;  // may be empty
    /// Half of the lumen is wider than this [m]; infinite without a centreline. The effective radius of (D6b) needs one number
    /// for the law to be a function of depth alone; a quarter more or less of it changes the stiffness of a 0.035 inch wire in a
    /// 10 mm lumen by half a percent.
    double typical_lumen_radius;
};

/// What changes, one per system. Of a rigid wall it is empty.
struct WallState {
    std::vector<Vec3> displacement;     // [V] of the mesh's vertices [m]; empty: none of them has moved
    std::vector<Vec3> displacement_t0;  // at the start of the step [m]
    std::uint64_t epoch = 0;            // raised with every change of `displacement`
    std::uint64_t epoch_t0 = 0;         // of `displacement_t0`
    /// Path of the vertex that has gone farthest, at most [m]. What is known of distances from the wall is kept with this added,
    /// and read with what it has become taken off: no vertex has come nearer by more than the difference.
    double moved = 0;

    [[nodiscard]] bool rigid() const { return displacement.empty(); }
    /// Where the vertices are at the end of the step. @param vertices  how many the mesh has; finite displacements are asked for
    void move_to(std::span<const Vec3> to, std::size_t vertices);
    /// The next step starts from here. @return whether anything had moved since the last one started
    bool accept();
};

}  // namespace seldinger
