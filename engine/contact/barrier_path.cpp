#include "contact/barrier_path.h"

#include "core/bytes.h"
#include "shared/hard_step.h"

#include <algorithm>

namespace seldinger {

BarrierPath::BarrierPath(device::Context& context, const SampleSet& samples, int node_capacity)
    : context_(context),
      clearance_(context, "contact/hard.cl", "contact_clearance"),
      sweep_(context, "contact/hard.cl", "contact_sweep"),
      base_(context, node_capacity),
      result_buffer_(context, samples.models.size() * sizeof(real)),
      result_(samples.models.size()),
      shrink_t0_(samples.models.size(), 0),
      feasible_step_(samples.wires.size(), 1)
{
}

void BarrierPath::warm_up(device::Lane at, ContactParams none, const SampleBuffers& b)
{
    clearance_.launch(at, 1, none, b.list, b.models, b.places, b.candidates, b.counts, b.wall.nodes, b.wall.vertices, b.wall.rims,
                      b.nodes.hi_buffer, b.nodes.lo_buffer, b.touches_t0, result_buffer_);
    sweep_.launch(at, 1, none, b.list, b.models, b.places, b.candidates, b.counts, b.wall.nodes, b.wall.vertices, b.wall.rims,
                  base_.hi_buffer, base_.lo_buffer, b.nodes.hi_buffer, b.nodes.lo_buffer, result_buffer_);
}

/// Of the samples in b.list, into result_.
void BarrierPath::measure_gaps(device::Lane at, ContactParams par, const SampleBuffers& b, std::size_t count)
{
    if (count == 0) return;
    par.item_count = static_cast<uint>(count);
    clearance_.launch(at, count, par, b.list, b.models, b.places, b.candidates, b.counts, b.wall.nodes, b.wall.vertices,
                      b.wall.rims, b.nodes.hi_buffer, b.nodes.lo_buffer, b.touches_t0, result_buffer_);
    context_.read(at, result_buffer_, result_.data(), count * sizeof(real));
}

bool BarrierPath::is_clear(device::Lane at, ContactParams par, const SampleBuffers& b, const SampleSet& samples,
                           std::span<const std::uint32_t> list, int wire)
{
    measure_gaps(at, par, b, list.size());
    const WireSamples& own = samples.wires[wire];
    for (std::size_t k = 0; k < list.size(); ++k) {
        const int s = static_cast<int>(list[k]);
        if (s >= own.begin && s < own.begin + own.capacity && result_[k] + shrink_t0_[s] <= 0) return false;
    }
    return true;
}

void BarrierPath::begin(device::Lane at, ContactParams par, const SampleBuffers& b, SampleSet& samples,
                        std::span<const std::uint32_t> list)
{
    for (SamplePlace& place : samples.places) place.shrink = 0;
    measure_gaps(at, par, b, list.size());
    for (std::size_t k = 0; k < list.size(); ++k)
        samples.places[list[k]].shrink = barrier_start(result_[k], shrink_t0_[list[k]], samples.models[list[k]]);
}

void BarrierPath::take(const DeviceNodes& nodes, int from, int to)
{
    std::copy(nodes.hi.begin() + 3 * from, nodes.hi.begin() + 3 * to, base_.hi.begin() + 3 * from);
    std::copy(nodes.lo.begin() + 3 * from, nodes.lo.begin() + 3 * to, base_.lo.begin() + 3 * from);
}

void BarrierPath::sweep(device::Lane at, ContactParams par, const SampleBuffers& b, const SampleSet& samples,
                        std::span<const std::uint32_t> list)
{
    std::fill(feasible_step_.begin(), feasible_step_.end(), 1.0);
    if (list.empty()) return;
    base_.upload(context_, at);
    par.item_count = static_cast<uint>(list.size());
    sweep_.launch(at, list.size(), par, b.list, b.models, b.places, b.candidates, b.counts, b.wall.nodes, b.wall.vertices,
                  b.wall.rims, base_.hi_buffer, base_.lo_buffer, b.nodes.hi_buffer, b.nodes.lo_buffer, result_buffer_);
    context_.read(at, result_buffer_, result_.data(), list.size() * sizeof(real));
    std::size_t k = 0;
    for (std::size_t w = 0; w < samples.wires.size(); ++w) {
        const std::uint32_t end = samples.wires[w].begin + samples.wires[w].capacity;
        for (; k < list.size() && list[k] < end; ++k) feasible_step_[w] = std::min(feasible_step_[w], double(result_[k]));
    }
}

void BarrierPath::commit(const SampleSet& samples, std::span<const std::uint8_t> active)
{
    for (std::size_t w = 0; w < samples.wires.size(); ++w)
        for (int s = samples.wires[w].begin; active[w] && s < samples.wires[w].begin + samples.wires[w].capacity; ++s)
            shrink_t0_[s] = samples.places[s].shrink;
}

void BarrierPath::save(std::vector<std::uint8_t>& bytes) const { put_bytes(bytes, shrink_t0_.data(), shrink_t0_.size()); }

void BarrierPath::save(std::vector<std::uint8_t>& bytes, const WireSamples& wire) const
{
    put_bytes(bytes, shrink_t0_.data() + wire.begin, wire.capacity);
}

void BarrierPath::restore(const std::uint8_t*& bytes, const std::uint8_t* end)
{
    take_bytes(bytes, end, shrink_t0_.data(), shrink_t0_.size());
}

}  // namespace seldinger
