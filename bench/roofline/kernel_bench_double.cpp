// The kernels in double, and all code that does not depend on precision.
#include "roofline/kernel_bench.h"
#include "roofline/peaks.h"

#include "contact/contact_system.h"
#include "roofline/kernel_bench_time.h"
#include "shapes/shapes.h"

namespace seldinger::kernel_bench {

BenchWall make_bench_wall(device::Context& context)
{
    BenchWall wall;
    VesselSpec spec;
    spec.shape = VesselShape::Tube;
    spec.radius = wall.radius;
    spec.length = wall.length;
    spec.triangles = 30000;
    const WallMesh mesh = make_tube(spec).mesh;
    const WallTree tree = build_wall_tree(mesh);
    const DeviceWall on_device(context, tree, mesh);
    wall.triangles = tree.triangle_count();
    wall.nodes.resize(tree.nodes.size() * sizeof(TreeNode));
    std::memcpy(wall.nodes.data(), tree.nodes.data(), wall.nodes.size());
    wall.vertices = tree.vertices;
    wall.boundary.resize(wall.triangles);
    context.read(device::Queue::Inline, on_device.boundary, wall.boundary.data(), wall.triangles * sizeof(std::uint32_t));
    return wall;
}

std::vector<KernelTiming> time_kernels_double(device::Context& context, const BenchWall& wall,
                                              const std::vector<KernelWork>& work, const KernelBenchOptions& options)
{
    return time_all(context, wall, work, options);
}

std::vector<KernelTiming> time_kernels(device::Context& context, const BenchWall& wall, const std::vector<KernelWork>& work,
                                       const KernelBenchOptions& options)
{
    return context.float32() ? time_kernels_float32(context, wall, work, options)
                             : time_kernels_double(context, wall, work, options);
}

}  // namespace seldinger::kernel_bench
