#pragma once
// Two parts of the barrier law beside its force. No quadrature point ever passes through the wall between two states that Newton
// takes (continuous detection, kernels/shared/sweep.h). Quadrature points that a step starts with in overlap are freed
// (barrier_start in kernels/shared/barrier_path.h).

#include "contact/force_kernels.h"
#include "contact/quadrature.h"
#include "contact/quadrature_buffers.h"

namespace seldinger {

class StateWalk;  // core/state_walk.h

class BarrierPath {
public:
    BarrierPath(device::Context& context, const QuadratureSet& points, int node_capacity);

    /// Start of a step, candidates and `list` of the start known: sets QuadraturePlace::radius_reduction, which the caller
    /// uploads.
    void begin(device::Queue at, ContactParams par, const QuadratureBuffers& buffers, QuadratureSet& points,
               std::span<const std::uint32_t> list);
    /// Whether no quadrature point of the wire, with the radius_reduction that it has, overlaps where `buffers.nodes` are.
    [[nodiscard]] bool is_clear(device::Queue at, ContactParams par, const QuadratureBuffers& buffers,
                                const QuadratureSet& points, std::span<const std::uint32_t> list, int wire);
    /// Nodes [from, to) of `nodes` are where the next trials start from.
    void take(const DeviceNodes& nodes, int from, int to);
    /// The path from the last state taken to `nodes`, for wires that have quadrature points in `list`.
    void sweep(device::Queue at, ContactParams par, const QuadratureBuffers& buffers, const QuadratureSet& points,
               std::span<const std::uint32_t> list);
    /// How much of that path is free, 1: all.
    [[nodiscard]] double feasible_step(int wire) const { return feasible_step_[wire]; }
    void commit(const QuadratureSet& points, std::span<const std::uint8_t> active);

    void walk_state(StateWalk& walk, const WireQuadrature& wire);
    void warm_up(device::Queue at, ContactParams none, const QuadratureBuffers& buffers);

private:
    void measure_gaps(device::Queue at, ContactParams par, const QuadratureBuffers& buffers, std::size_t count);

    device::Context& context_;
    GapKernels gaps_;
    device::Kernel sweep_;
    DeviceNodes base_;
    device::Buffer result_buffer_;
    std::vector<real> result_;               // [list]
    std::vector<real> radius_reduction_t0_;  // [points] of the accepted state [m]
    std::vector<double> feasible_step_;      // [wires]
};

}  // namespace seldinger
