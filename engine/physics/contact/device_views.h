#pragma once
// Wall and nodes of the wires on the device, as kernels read them. Each groups several arguments of a kernel:
// SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS in kernels/shared/views.h.

#include "device/device.h"
#include "math/vec3.h"
#include "vessel/tree.h"

#include <cstdint>
#include <vector>

namespace seldinger {

/// The wall, shared by all detection methods.
struct DeviceWall {
    DeviceWall(device::Context& context, const WallTree& tree, const WallMesh& mesh);
    device::Buffer nodes, vertices, boundary;
    Vec3 centre;                          // world position of the device's origin [m]
    std::vector<std::uint32_t> original;  // leaf order -> triangle of the mesh
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(nodes);
        f(vertices);
        f(boundary);
    }
};

/// Node positions of all wires as the kernels take them: hi + lo relative to the wall's centre. The buffers are the vectors' own
/// memory on a CPU (Buffer).
struct DeviceNodes {
    DeviceNodes(device::Context& context, int total_capacity);
    std::vector<float> hi;          // [nodes][3]
    std::vector<double> lo, theta;  // [nodes][3], [nodes]
    device::Buffer hi_buffer, lo_buffer, theta_buffer;
    std::vector<std::uint32_t> narrow_lo, narrow_theta;  // what goes up to a float32 context
    void set(int node, double x, double y, double z, double angle, const Vec3& centre);
    void upload(device::Context& context, device::Queue queue);
    [[nodiscard]] Vec3 position(std::size_t node) const
    {
        const std::size_t k = 3 * node;
        return {hi[k] + lo[k], hi[k + 1] + lo[k + 1], hi[k + 2] + lo[k + 2]};
    }
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(hi_buffer);
        f(lo_buffer);
        f(theta_buffer);
    }
};

}  // namespace seldinger
