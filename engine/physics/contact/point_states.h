#pragma once
// State of quadrature points from step to step, and their places, on the device.

#include "contact/quadrature.h"
#include "device/device.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

class StateWalk;  // core/state_walk.h

/// Checks a saved state: finite numbers, existing triangles. @throws Error BadFile
void check_contact_states(std::span<const ContactState> states, std::size_t triangles);

class PointStates {
public:
    /// The quadrature must outlive this.
    PointStates(device::Context& context, QuadratureSet& quadrature);

    /// All places; and those of the points that are inside, which change with every step.
    void write_places(device::Queue queue);
    void upload_places();
    /// What the last evaluation wrote is the state of wires with active[w] != 0.
    /// @param evaluated  f(w): the points that were
    template <class F>
    void commit(std::span<const std::uint8_t> active, const F& evaluated)
    {
        for (std::size_t w = 0; w < active.size(); ++w)
            if (active[w]) {
                const std::span<const std::uint32_t> points = evaluated(w);
                evaluated_[w].assign(points.begin(), points.end());
            }
        commit(active);
    }
    /// Calls f(point, state) with each record of a wire that a contact of the last step wrote, in the order of its points.
    template <class F>
    void for_each_contact(int wire, const F& f) const
    {
        for (const std::uint32_t point : evaluated_[static_cast<std::size_t>(wire)])
            for (std::uint32_t side = 0; side < 2; ++side) {
                const ContactState& state = host_t0_[2 * point + side];
                if (state.epoch + 1 == quadrature_.wires[static_cast<std::size_t>(wire)].epoch &&
                    (state.flags & SEL_CONTACT_ACTIVE))
                    f(static_cast<int>(point), state);
            }
    }
    /// Brings what an evaluation of these points, in rising order, has written to the host: on a CPU it is there in
    /// double precision.
    void bring_trial(device::Queue queue, std::span<const std::uint32_t> points);
    /// What evaluations since the last commit wrote, two records for each point; others are older.
    [[nodiscard]] std::span<const ContactState> at_trial() const { return host_; }
    /// @param triangles  of the wall. @throws Error BadFile: a state that was read is none of a contact
    void walk_state(StateWalk& walk, int wire, std::size_t triangles);

    [[nodiscard]] const device::Buffer& models() const { return models_; }        // [points]
    [[nodiscard]] const device::Buffer& places() const { return places_; }        // [points]
    [[nodiscard]] const device::Buffer& states_t0() const { return states_t0_; }  // [points][2]
    [[nodiscard]] const device::Buffer& states() const { return states_; }        // [points][2]

private:
    void commit(std::span<const std::uint8_t> active);
    /// Two records for each point of a wire. States that no contact of the last step wrote are zeros: leftovers must neither
    /// affect later steps nor the saved bytes.
    [[nodiscard]] std::vector<ContactState> living(int wire);
    void note_living(int wire, std::span<const ContactState> states);

    device::Context& context_;
    QuadratureSet& quadrature_;
    // The same as states_t0_ and states_, where a step has written: on a CPU in double precision their memory, elsewhere copies.
    std::vector<ContactState> host_t0_, host_;
    bool copied_;
    std::vector<std::vector<std::uint32_t>> evaluated_;  // [wires] points that the last step has evaluated
    device::Buffer models_, places_, states_t0_, states_;
    std::vector<std::uint32_t> narrow_places_, narrow_;  // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
