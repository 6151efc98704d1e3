// State of quadrature points from step to step: places, records, saving.
#include "contact/point_states.h"

#include "contact/device_records.h"
#include "core/state_walk.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace seldinger {
namespace {

/// Joins ranges of points, given in rising order, that lie close together: f(first, end) copies each run at once.
template <class F>
class Runs {
public:
    Runs(const device::Context& context, const F& f) : gap_(context.on_cpu() ? 0 : bus_gap), copy_(f) {}
    void add(std::size_t first, std::size_t end)
    {
        if (end_ == 0 || first > end_ + gap_) {
            close();
            first_ = first;
        }
        end_ = end;
    }
    void close()
    {
        if (end_ > 0) copy_(first_, end_);
        end_ = 0;
    }

private:
    // A copy over the bus costs about 10 us to begin, in which 250 kB go over it: the records of so many points.
    static constexpr std::size_t bus_gap = 800;
    std::size_t gap_, first_ = 0, end_ = 0;
    const F& copy_;
};

}  // namespace

PointStates::PointStates(device::Context& context, QuadratureSet& quadrature)
    : context_(context),
      quadrature_(quadrature),
      host_t0_(2 * quadrature.models.size()),
      host_(host_t0_.size()),
      copied_(context.float32() || !context.on_cpu()),
      evaluated_(quadrature.wires.size()),
      models_(context, quadrature.models.size() * device_size<QuadratureModel>(context)),
      places_(record_buffer(context, quadrature.places, quadrature.places.size())),
      states_t0_(record_buffer(context, host_t0_, host_t0_.size())),
      states_(record_buffer(context, host_, host_t0_.size()))
{
    for (std::size_t w = 0; w < evaluated_.size(); ++w)
        evaluated_[w].reserve(static_cast<std::size_t>(quadrature.wires[w].capacity));
    write_records(context_, device::Queue::Inline, models_, quadrature.models, narrow_);
    context_.finish(device::Queue::Inline);
}

void PointStates::write_places(device::Queue queue)
{
    write_records(context_, queue, places_, quadrature_.places, narrow_places_);
}

void PointStates::upload_places()
{
    if (context_.float32()) return write_places(device::Queue::Inline);
    const auto copy = [&](std::size_t first, std::size_t end) {
        context_.write(device::Queue::Inline, places_, &quadrature_.places[first], (end - first) * sizeof(QuadraturePlace),
                       first * sizeof(QuadraturePlace));
    };
    Runs runs(context_, copy);
    for (const WireQuadrature& wire : quadrature_.wires)
        if (wire.live > 0) runs.add(wire.begin, wire.begin + wire.live);
    runs.close();
}

void PointStates::commit(std::span<const std::uint8_t> active)
{
    if (std::all_of(active.begin(), active.end(), [](std::uint8_t on) { return on != 0; })) {
        std::swap(states_t0_, states_);
        host_t0_.swap(host_);
    } else {
        context_.enter(device::Queue::Inline);
        const std::size_t record = 2 * device_size<ContactState>(context_);
        for (std::size_t w = 0; w < active.size();) {  // neighbours go together
            const std::size_t first = w;
            std::size_t points = 0;
            for (; w < active.size() && active[w]; ++w) points += quadrature_.wires[w].capacity;
            const auto begin = static_cast<std::size_t>(quadrature_.wires[first].begin);
            context_.copy(device::Queue::Inline, states_, states_t0_, points * record, begin * record);
            if (copied_) std::copy_n(host_.begin() + 2 * begin, 2 * points, host_t0_.begin() + 2 * begin);
            while (w < active.size() && !active[w]) ++w;
        }
        context_.finish(device::Queue::Inline);
    }
    for (std::size_t w = 0; w < active.size(); ++w)
        if (active[w]) quadrature_.wires[w].epoch++;
}

std::vector<ContactState> PointStates::living(int wire)
{
    const WireQuadrature& own = quadrature_.wires[static_cast<std::size_t>(wire)];
    std::vector<ContactState> states(2 * static_cast<std::size_t>(own.capacity));
    context_.enter(device::Queue::Inline);
    read_records(context_, device::Queue::Inline, states_t0_, states.data(), states.size(),
                 2 * static_cast<std::size_t>(own.begin), narrow_);
    for (ContactState& state : states)
        if (state.epoch + 1 != own.epoch) std::memset(&state, 0, sizeof state);
    return states;
}

void PointStates::bring_trial(device::Queue queue, std::span<const std::uint32_t> points)
{
    if (!copied_) return;
    const auto copy = [&](std::size_t first, std::size_t end) {
        read_records(context_, queue, states_, &host_[2 * first], 2 * (end - first), 2 * first, narrow_);
    };
    Runs runs(context_, copy);
    for (const std::uint32_t point : points) runs.add(point, point + 1);
    runs.close();
}

/// Marks the points in contact of a restored state. @param states  two records for each point of the wire
void PointStates::note_living(int wire, std::span<const ContactState> states)
{
    std::vector<std::uint32_t>& list = evaluated_[static_cast<std::size_t>(wire)];
    list.clear();
    for (std::size_t k = 0; 2 * k < states.size(); ++k)
        if ((states[2 * k].flags | states[2 * k + 1].flags) & SEL_CONTACT_ACTIVE)
            list.push_back(static_cast<std::uint32_t>(quadrature_.wires[static_cast<std::size_t>(wire)].begin + k));
}

void check_contact_states(std::span<const ContactState> states, std::size_t triangles)
{
    constexpr double most = 1e18;  // in any unit
    static_assert(offsetof(ContactState, triangle) == 18 * sizeof(real) && std::is_same_v<real, double>);
    for (const ContactState& state : states) {
        const double* numbers = state.slip;  // the first of them
        const bool sound = std::all_of(numbers, numbers + 18, [](double x) { return std::abs(x) <= most; });
        if (!sound || state.triangle >= triangles)
            throw Error(ErrorKind::BadFile, "the saved state is damaged: a contact is out of bounds");
    }
}

void PointStates::walk_state(StateWalk& walk, int wire, std::size_t triangles)
{
    WireQuadrature& own = quadrature_.wires[static_cast<std::size_t>(wire)];
    std::vector<ContactState> states =
        walk.reads() ? std::vector<ContactState>(2 * static_cast<std::size_t>(own.capacity)) : living(wire);
    walk({"a contact", "", "accept"}, std::span(states));
    walk({"the number of a step", "", "accept"}, own.epoch);
    if (!walk.reads()) return;
    check_contact_states(states, triangles);
    note_living(wire, states);
    context_.enter(device::Queue::Inline);
    write_records(context_, device::Queue::Inline, states_t0_, states, narrow_, 2 * static_cast<std::size_t>(own.begin));
    context_.finish(device::Queue::Inline);
    if (copied_) std::copy(states.begin(), states.end(), host_t0_.begin() + 2 * own.begin);
}

}  // namespace seldinger
