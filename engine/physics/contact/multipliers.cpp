// Launches of contact_start and contact_multipliers.
#include "contact/multipliers.h"

#include "contact/programs.h"

#include <algorithm>

namespace seldinger {

Multipliers::Multipliers(device::Context& context, int points)
    : context_(context),
      points_(points),
      start_(context, programs::multipliers, "contact_start"),
      next_(context, programs::multipliers, "contact_multipliers"),
      states_(context, 2 * points_ * sizeof(MultiplierState)),
      next_states_(context, 2 * points_ * sizeof(MultiplierState)),
      ratio_buffer_(context, points_ * sizeof(real)),
      ratios_(points_)
{
}

void Multipliers::warm_up(device::Queue at, ContactParams none, const QuadratureBuffers& b)
{
    start_.launch(at, 1, none, b.models, b.places, b.states_t0, states_);
    next_.launch(at, 1, none, b.models, b.places, b.counts, b.states_t0, b.states, states_, next_states_, ratio_buffer_);
}

void Multipliers::before_evaluation(device::Queue at, ContactParams par, const QuadratureBuffers& b)
{
    if (!fresh_) return;
    fresh_ = false;
    par.item_count = static_cast<uint>(points_);
    start_.launch(at, points_, par, b.models, b.places, b.states_t0, states_);
}

bool Multipliers::update(device::Queue at, ContactParams par, const QuadratureBuffers& b, const QuadratureSet& points,
                         std::span<const std::uint8_t> solved, std::span<std::uint8_t> again)
{
    context_.enter(at);
    par.item_count = static_cast<uint>(points_);
    next_.launch(at, points_, par, b.models, b.places, b.counts, b.states_t0, b.states, states_, next_states_, ratio_buffer_);
    context_.read(at, ratio_buffer_, ratios_.data(), ratios_.size() * sizeof(real));
    bool any = false;
    for (std::size_t w = 0; w < points.wires.size(); ++w) {
        const WireQuadrature& wire = points.wires[w];
        const auto first = ratios_.begin() + wire.begin;
        if (!(solved[w] && wire.live > 0 && *std::max_element(first, first + wire.live) > 1)) continue;
        again[w] = 1;
        any = true;
        // the other wires keep the multipliers that they were solved with: systems are independent
        const std::size_t record = 2 * sizeof(MultiplierState);
        context_.copy(at, next_states_, states_, wire.capacity * record, wire.begin * record);
    }
    return any;
}

}  // namespace seldinger
