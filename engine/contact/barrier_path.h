#pragma once
// What the barrier law needs beside its force: no sample ever passes through the wall between two states that Newton takes
// (continuous detection, kernels/shared/sweep.h), and samples that a step starts with in overlap are freed (barrier_start in
// kernels/shared/hard_step.h).

#include "contact/sample_buffers.h"

namespace seldinger {

class BarrierPath {
public:
    BarrierPath(device::Context& context, const SampleSet& samples, int node_capacity);

    /// Start of a step, candidates and `list` of the start known: sets SamplePlace::shrink, which the caller uploads.
    void begin(device::Lane at, ContactParams par, const SampleBuffers& buffers, SampleSet& samples,
               std::span<const std::uint32_t> list);
    /// Whether no sample of the wire, with the shrink that it has, overlaps where `buffers.nodes` are.
    [[nodiscard]] bool is_clear(device::Lane at, ContactParams par, const SampleBuffers& buffers, const SampleSet& samples,
                                std::span<const std::uint32_t> list, int wire);
    /// Nodes [from, to) of `nodes` are where the next trials start from.
    void take(const DeviceNodes& nodes, int from, int to);
    /// The way from the last state taken to `nodes`, for wires that have samples in `list`.
    void sweep(device::Lane at, ContactParams par, const SampleBuffers& buffers, const SampleSet& samples,
               std::span<const std::uint32_t> list);
    /// How much of that way is free, 1: all.
    [[nodiscard]] double feasible_step(int wire) const { return feasible_step_[wire]; }
    void commit(const SampleSet& samples, std::span<const std::uint8_t> active);

    void save(std::vector<std::uint8_t>& bytes) const;
    void save(std::vector<std::uint8_t>& bytes, const WireSamples& wire) const;
    void restore(const std::uint8_t*& bytes, const std::uint8_t* end);
    void warm_up(device::Lane at, ContactParams none, const SampleBuffers& buffers);

private:
    void measure_gaps(device::Lane at, ContactParams par, const SampleBuffers& buffers, std::size_t count);

    device::Context& context_;
    device::Kernel clearance_, sweep_;
    DeviceNodes base_;
    device::Buffer result_buffer_;
    std::vector<real> result_;      // [list]
    std::vector<real> shrink_t0_;   // [samples] of the accepted state [m]
    std::vector<double> feasible_step_;  // [wires]
};

}  // namespace seldinger
