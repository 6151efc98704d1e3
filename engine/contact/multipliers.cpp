#include "contact/multipliers.h"

#include <algorithm>

namespace seldinger {

Multipliers::Multipliers(device::Context& context, int samples)
    : context_(context),
      samples_(samples),
      start_(context, "contact/hard.cl", "contact_start"),
      next_(context, "contact/hard.cl", "contact_multipliers"),
      states_(context, 2 * samples_ * sizeof(HardState)),
      next_states_(context, 2 * samples_ * sizeof(HardState)),
      ratio_buffer_(context, samples_ * sizeof(real)),
      ratios_(samples_)
{
}

void Multipliers::warm_up(device::Lane at, ContactParams none, const SampleBuffers& b)
{
    start_.launch(at, 1, none, b.models, b.places, b.touches_t0, states_);
    next_.launch(at, 1, none, b.models, b.places, b.counts, b.touches_t0, b.touches, states_, next_states_, ratio_buffer_);
}

void Multipliers::before_evaluation(device::Lane at, ContactParams par, const SampleBuffers& b)
{
    if (!fresh_) return;
    fresh_ = false;
    par.item_count = static_cast<uint>(samples_);
    start_.launch(at, samples_, par, b.models, b.places, b.touches_t0, states_);
}

bool Multipliers::update(device::Lane at, ContactParams par, const SampleBuffers& b, const SampleSet& samples,
                         std::span<const std::uint8_t> solved, std::span<std::uint8_t> again)
{
    context_.enter(at);
    par.item_count = static_cast<uint>(samples_);
    next_.launch(at, samples_, par, b.models, b.places, b.counts, b.touches_t0, b.touches, states_, next_states_, ratio_buffer_);
    context_.read(at, ratio_buffer_, ratios_.data(), ratios_.size() * sizeof(real));
    bool any = false;
    for (std::size_t w = 0; w < samples.wires.size(); ++w) {
        const WireSamples& wire = samples.wires[w];
        const auto first = ratios_.begin() + wire.begin;
        if (!(solved[w] && wire.live > 0 && *std::max_element(first, first + wire.live) > 1)) continue;
        again[w] = 1;
        any = true;
        // the other wires keep what they were solved with: what one does has no say in what they do
        const std::size_t record = 2 * sizeof(HardState);
        context_.copy(at, next_states_, states_, wire.capacity * record, wire.begin * record);
    }
    return any;
}

}  // namespace seldinger
