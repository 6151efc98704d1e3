#pragma once
// Each contact kernel alone, on a made-up load of realistic size, with its work counted: for `seldinger bench`.
//
// The load: wires of 300 quadrature points and 61 nodes along helices in the wall of a tube (radius 10 mm, length 0.3 m, about
// 30,000 triangles). They lie one radius apart and within a few micrometres of touching, so that about half of the points
// touch.
//
// Includes nothing of kernels/shared: those headers are compiled in double, in float and with numbers that count
// (kernel_bench_*.cpp).

#include "contact/force_kernels.h"
#include "device/device.h"

#include <string>
#include <vector>

namespace seldinger::kernel_bench {

using seldinger::ForceKernels;
using seldinger::GapKernels;

/// The tube, as DeviceWall holds it.
struct BenchWall {
    std::vector<unsigned char> nodes;  // TreeNode
    std::vector<float> vertices;
    std::vector<std::uint32_t> boundary;
    std::size_t triangles = 0;
    double radius = 0.01, length = 0.3;  // along x through the origin [m]
};
[[nodiscard]] BenchWall make_bench_wall(device::Context& context);

/// Work of one item on average. Operations: + - * / and roots, each one; comparisons are free.
struct KernelWork {
    std::string kernel;
    double flops = 0;
    double floats = 0;  // float32 values of the tree, the triangles and the nodes that it reads, however often
    double pairs = 0;   // see KernelTiming
};

struct KernelTiming {
    std::string kernel, queue;
    bool float32 = false;
    std::size_t items = 0;
    double time = 0;   // of a launch that is waited for, median [s]
    double pairs = 0;  // of a quadrature point and a cell of the tree (walk.h); reduce, start, multipliers: quadrature
                       // points; layer: pairs
    double flops = 0;  // of the launch
    double bytes = 0;  // read and written by the launch, however often: traffic between a core and its nearest cache
};

struct KernelBenchOptions {
    std::vector<std::size_t> light = {300, 4800}, heavy = {4800, 76800};  // quadrature points in a launch: 1, 16 and 256 wires
    int repeats = 5;
    double least = 2e-3;  // of one timing [s]
};

/// Counted with the host references on `quadrature points` quadrature points.
[[nodiscard]] std::vector<KernelWork> count_work(const BenchWall& wall, std::size_t points);

/// All kernels, in the precision of the context.
[[nodiscard]] std::vector<KernelTiming> time_kernels(device::Context& context, const BenchWall& wall,
                                                     const std::vector<KernelWork>& work, const KernelBenchOptions& options);
[[nodiscard]] std::vector<KernelTiming> time_kernels_double(device::Context& context, const BenchWall& wall,
                                                            const std::vector<KernelWork>& work,
                                                            const KernelBenchOptions& options);
[[nodiscard]] std::vector<KernelTiming> time_kernels_float32(device::Context& context, const BenchWall& wall,
                                                             const std::vector<KernelWork>& work,
                                                             const KernelBenchOptions& options);

}  // namespace seldinger::kernel_bench

// names that survive the renaming of the namespace in the other builds
namespace sel_bench = seldinger::kernel_bench;
namespace sel_device = seldinger::device;
