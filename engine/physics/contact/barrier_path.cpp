// Launches GapKernels and contact_sweep, and applies their results to a wire.
#include "contact/barrier_path.h"

#include "contact/programs.h"
#include "core/state_walk.h"
#include "shared/barrier_path.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace seldinger {

BarrierPath::BarrierPath(device::Context& context, const QuadratureSet& points, int node_capacity)
    : context_(context),
      gaps_(context, points.models.size()),
      sweep_(context, programs::barrier, "contact_sweep", device::Items::Branching),
      base_(context, node_capacity),
      result_buffer_(context, points.models.size() * sizeof(real)),
      result_(points.models.size()),
      radius_reduction_t0_(points.models.size(), 0),
      feasible_step_(points.wires.size(), 1)
{
}

void BarrierPath::warm_up(device::Queue at, ContactParams none, const QuadratureBuffers& b)
{
    gaps_.launch(at, 1, none, b.list, b.models, b.places, b.near_cells, b.counts, b.wall, b.nodes, b.states_t0, result_buffer_);
    sweep_.launch(at, 1, none, b.list, b.models, b.places, b.near_cells, b.counts, b.wall, base_, b.nodes, result_buffer_);
}

/// Gaps of the quadrature points in b.list, into result_.
void BarrierPath::measure_gaps(device::Queue at, ContactParams par, const QuadratureBuffers& b, std::size_t count)
{
    if (count == 0) return;
    par.item_count = static_cast<uint>(count);
    gaps_.launch(at, count, par, b.list, b.models, b.places, b.near_cells, b.counts, b.wall, b.nodes, b.states_t0,
                 result_buffer_);
    context_.read(at, result_buffer_, result_.data(), count * sizeof(real));
}

bool BarrierPath::is_clear(device::Queue at, ContactParams par, const QuadratureBuffers& b, const QuadratureSet& points,
                           std::span<const std::uint32_t> list, int wire)
{
    measure_gaps(at, par, b, list.size());
    const WireQuadrature& own = points.wires[wire];
    for (std::size_t k = 0; k < list.size(); ++k) {
        const int s = static_cast<int>(list[k]);
        if (s >= own.begin && s < own.begin + own.capacity && result_[k] + radius_reduction_t0_[s] <= 0) return false;
    }
    return true;
}

void BarrierPath::begin(device::Queue at, ContactParams par, const QuadratureBuffers& b, QuadratureSet& points,
                        std::span<const std::uint32_t> list)
{
    for (QuadraturePlace& place : points.places) place.radius_reduction = 0;
    measure_gaps(at, par, b, list.size());
    for (std::size_t k = 0; k < list.size(); ++k)
        points.places[list[k]].radius_reduction =
            barrier_start(result_[k], radius_reduction_t0_[list[k]], points.models[list[k]]);
}

void BarrierPath::take(const DeviceNodes& nodes, int from, int to)
{
    std::copy(nodes.hi.begin() + 3 * from, nodes.hi.begin() + 3 * to, base_.hi.begin() + 3 * from);
    std::copy(nodes.lo.begin() + 3 * from, nodes.lo.begin() + 3 * to, base_.lo.begin() + 3 * from);
}

void BarrierPath::sweep(device::Queue at, ContactParams par, const QuadratureBuffers& b, const QuadratureSet& points,
                        std::span<const std::uint32_t> list)
{
    std::fill(feasible_step_.begin(), feasible_step_.end(), 1.0);
    if (list.empty()) return;
    base_.upload(context_, at);
    par.item_count = static_cast<uint>(list.size());
    sweep_.launch(at, list.size(), par, b.list, b.models, b.places, b.near_cells, b.counts, b.wall, base_, b.nodes,
                  result_buffer_);
    context_.read(at, result_buffer_, result_.data(), list.size() * sizeof(real));
    std::size_t k = 0;
    for (std::size_t w = 0; w < points.wires.size(); ++w) {
        const std::uint32_t end = points.wires[w].begin + points.wires[w].capacity;
        for (; k < list.size() && list[k] < end; ++k) feasible_step_[w] = std::min(feasible_step_[w], double(result_[k]));
    }
}

void BarrierPath::commit(const QuadratureSet& points, std::span<const std::uint8_t> active)
{
    for (std::size_t w = 0; w < points.wires.size(); ++w)
        for (int s = points.wires[w].begin; active[w] && s < points.wires[w].begin + points.wires[w].capacity; ++s)
            radius_reduction_t0_[s] = points.places[s].radius_reduction;
}

void BarrierPath::walk_state(StateWalk& walk, const WireQuadrature& wire)
{
    walk({"a radius", "m", "accept", -1, 1},
         std::span(radius_reduction_t0_).subspan(static_cast<std::size_t>(wire.begin), static_cast<std::size_t>(wire.capacity)));
}

}  // namespace seldinger
