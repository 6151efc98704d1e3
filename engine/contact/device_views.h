#pragma once
// What kernels read of the wall and of the wires' nodes, as it lies on the device. Either stands for several arguments of a
// kernel: SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS in kernels/shared/views.h.

#include "device/device.h"
#include "math/vec3.h"
#include "vessel/tree.h"

#include <cstdint>
#include <vector>

namespace seldinger {

/// The wall, shared by all detection methods. One that moves is there once for each system.
struct DeviceWall {
    /// @param moving_systems  that have a wall of their own; 0: one wall, which stands still
    DeviceWall(device::Context& context, const WallTree& tree, const WallMesh& mesh, int moving_systems);
    device::Buffer nodes, vertices, boundary;
    device::Buffer vertices_t0, moved;    // of a wall that moves; kernels/shared/views.h
    std::vector<double> path;             // [systems] what `moved` says [m]
    Vec3 centre;                          // world position of the device's origin [m]
    std::vector<std::uint32_t> original;  // leaf order -> triangle of the mesh
    std::uint32_t node_count, triangle_count;

    [[nodiscard]] bool moves() const { return !path.empty(); }
    /// Path of the vertex of a system's wall that has gone farthest, at most [m].
    [[nodiscard]] double moved_by(int system) const { return path.empty() ? 0.0 : path[system]; }
    /// What kernels that read it are built with.
    [[nodiscard]] const char* defines() const { return moves() ? " -DSEL_WALL_MOVES" : ""; }
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(nodes);
        f(vertices);
        f(boundary);
        if (!moves()) return;
        f(vertices_t0);
        f(moved);
        f(node_count);
        f(triangle_count);
    }
};

/// Node positions of all wires as the kernels take them: hi + lo relative to the wall's centre.
struct DeviceNodes {
    DeviceNodes(device::Context& context, int total_capacity);
    std::vector<float> hi;          // [nodes][3]
    std::vector<double> lo, theta;  // [nodes][3], [nodes]
    device::Buffer hi_buffer, lo_buffer, theta_buffer;
    std::vector<std::uint32_t> narrow_lo, narrow_theta;  // what goes up to a float32 context
    void set(int node, double x, double y, double z, double angle, const Vec3& centre);
    void upload(device::Context& context, device::Queue queue);
    template <class F>
    void for_each_argument(const F& f) const
    {
        f(hi_buffer);
        f(lo_buffer);
        f(theta_buffer);
    }
};

}  // namespace seldinger
