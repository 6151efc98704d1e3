#pragma once
// Walls that move: where each system's wall is, at the start of the step and now, brought to the device.
//
// Trees are refitted on the host, O(T) for each move, and uploaded whole.

#include "contact/device_views.h"
#include "wall/wall_model.h"

#include <span>
#include <vector>

namespace seldinger {

class MovingWall {
public:
    /// @param wall  on the device, made for as many systems; outlives this
    MovingWall(device::Context& context, DeviceWall& wall, const WallTree& tree, const WallMesh& mesh);

    /// @param displacement  [V] of the mesh's vertices [m]
    void move(int system, std::span<const Vec3> displacement);
    /// The next step of the system starts from where its wall is.
    void accept(int system);
    [[nodiscard]] const WallState& state(int system) const { return systems_[system].state; }

private:
    struct System {
        WallState state;
        WallTree tree;
    };
    device::Context& context_;
    DeviceWall& wall_;
    const WallMesh& mesh_;
    WallMesh moved_;  // scratch
    std::vector<System> systems_;
    std::vector<std::uint32_t> narrow_;  // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
