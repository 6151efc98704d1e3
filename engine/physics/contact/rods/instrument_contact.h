#pragma once
// Contact between instruments (D13), a force term: wires side by side, crossing, a wire with itself, an instrument in the lumen
// of another and at its mouth. Geometry: kernels/shared/instrument_gap.h; laws: instrument_law.h; integration: instrument_cell.h.
//
// Per step: begin_step remembers nodes; prepare takes the node set and searches the neighbours of cells, on the host: it takes
// less time than a launch, and where nothing is near, nothing is sent to the device. At each trial instruments_evaluate makes the
// forces of all neighbours, and the host sums their records (instrument_sums.h). If a node has moved by half of the skin since
// the last search, the trial is searched anew, so neighbours always belong to the trial. A trial in which one has sunk deeper
// into another than the law's pole is refused, and no node moves by more than 0.45 of the smaller radius at once. So axes that
// are 1.5 radii apart do not pass each other.
//
// Arc lengths from the hub decide whether an instrument is inside another. The last point of the search is where the next one
// begins. Distance in space does not matter. Instruments fed at one inlet lie on each other there, in the middle of the
// lumen.

#include "contact/contact_row.h"
#include "contact/force_kernels.h"
#include "contact/force_per_length.h"
#include "contact/rods/found_slots.h"
#include "contact/rods/instrument_cells.h"
#include "contact/rods/instrument_sums.h"
#include "device/device.h"
#include "shared/instrument_near.h"
#include "solve/force_term.h"

#include <memory>
#include <vector>

namespace seldinger {

class InstrumentContact final : public ForceTerm {
public:
    /// @param context  in double precision      @param rods  of the world; both outlive this
    InstrumentContact(device::Context& context, const InstrumentSetup& setup, RodArrays& rods);

    void begin_step(RodArrays& rods, Settling how) override;
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    void evaluate(const TermTrial& trial) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const override
    {
        sums_of(wire).add(wire, residual, tangent, symmetric);
    }
    void couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent, bool symmetric) const override;
    void commit(std::span<const std::uint8_t> active) override;
    void walk_state(StateWalk& walk, int wire) override;

    [[nodiscard]] const ContactTotals& totals(int wire) const { return sums_of(wire).totals(wire); }
    /// Adds the forces on the nodes of a wire, [n].
    void add_nodal_forces(int wire, std::span<Vec3> forces) const { sums_of(wire).add_nodal_forces(wire, forces); }
    /// Contacts of the accepted state.
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods);
    /// What these rows bear, on both of their instruments: cheap enough for every step. @param loads  [wires]
    void add_loads(std::span<WireLoads> loads);

private:
    /// Nodes of all rods on host and device.
    struct Nodes {
        Nodes(device::Context& context, int capacity);
        std::size_t count;        // of nodes
        std::vector<double> all;  // the next three, in one piece
        std::span<double> position, material, theta;
        device::Buffer buffer;
        /// As kernels see them.
        [[nodiscard]] InstrumentNodes view() const { return instrument_nodes(all.data(), static_cast<uint>(count)); }
        void upload(device::Context& context, device::Queue queue);
        /// What a trial changes, of the nodes [begin, end).
        void upload_moved(device::Context& context, device::Queue queue, int begin, int end);
    };
    [[nodiscard]] const InstrumentSums& sums_of(int wire) const { return sums_[static_cast<std::size_t>(system_of_[wire])]; }
    void set_nodes(Nodes& nodes, const RodView& rod, int begin) const;
    void set_trial(const TrialState& trial);
    void measure_rod(int wire);
    [[nodiscard]] SplineView spline(int wire) const;
    void set_axes(int wire);
    [[nodiscard]] bool search_is_stale(std::size_t system) const;
    struct CellRange {
        std::uint32_t first = 0, count = 0;
    };
    [[nodiscard]] CellRange searched_cells(std::size_t system) const;
    void search();
    void find_slots(std::size_t system);
    void list_found();
    void upload(device::Queue queue);
    void pick(std::span<const std::uint8_t> active);
    [[nodiscard]] NodeRange nodes_between(const InstrumentRod& rod, double from, double until, int near) const;
    [[nodiscard]] NearNodes near_nodes(std::uint32_t slot, int near) const;
    [[nodiscard]] double most_moved(NodeRange nodes) const;
    [[nodiscard]] double moved_together(std::size_t found) const;
    void measure_moves(int wire);
    void note_clear();
    void launch(device::Queue queue, const device::Buffer& forces);
    void follow(std::span<const std::uint8_t> active);
    void provide_records(std::size_t slots);
    void take_records();
    [[nodiscard]] std::vector<InstrumentState> living(int wire);
    void check_state(const InstrumentState& state, const InstrumentRod& rod) const;
    void take_states(int wire, std::span<const InstrumentState> states);
    void note_touching(std::span<const std::uint8_t> active);
    template <class F>
    void for_each_contact(int wire, const F& f);

    device::Context& context_;
    RodArrays& rods_;
    InstrumentCells cells_;
    std::vector<int> system_of_, first_wire_;  // [wires], [systems + 1]
    std::vector<InstrumentSums> sums_;         // [systems]
    InstrumentKernels evaluate_, evaluate_self_;
    Nodes nodes_, nodes_t0_;
    device::Buffer rods_buffer_, pairs_, surfaces_, rod_of_;
    std::vector<std::uint8_t> straight_;  // [wires] at the search, so much that it cannot touch itself
    std::vector<double> axes_;  // [cells][SEL_AXIS_POINTS][3] at the search [m]
    bool uploaded_ = false;     // the device has the nodes of this step and what the last search has found
    device::Buffer slots_;
    std::vector<InstrumentState> host_t0_, host_;       // the memory of the next two on a CPU
    std::vector<std::vector<std::uint32_t>> touching_;  // [wires] slots whose cells exerted something at the end of the last step
    device::Buffer states_t0_, states_;
    device::Buffer list_buffer_, forces_buffer_, points_buffer_, followed_buffer_;
    InstrumentParams params_{};
    std::vector<std::uint8_t> searching_;    // [systems] that are searched
    std::vector<double> searched_position_;  // at the last search
    std::vector<InstrumentSlot> slots_host_;
    std::vector<InstrumentState> no_states_;
    FoundSlots found_, found_before_;  // by the last search, by the one before
    // of these the ones evaluated: of systems that are, and not known to be clear
    std::vector<std::uint32_t> picked_;
    std::vector<std::size_t> picked_of_;  // [systems + 1] their first
    std::vector<std::uint32_t> place_;    // [picked] in found_
    std::vector<std::uint8_t> cleared_;              // [systems] whether that is known
    std::vector<double> cleared_position_;           // where nodes were then
    std::vector<double> moved_;                      // [nodes] since [m]
    std::vector<std::uint8_t> written_;              // [systems] whether trials have written states that no step has taken
    std::vector<int> with_states_;  // [wires] cells whose states the last step may have written, the first of them
    std::vector<InstrumentForce> forces_;            // [picked], at least
    std::vector<InstrumentPoint> points_;            // [picked][SEL_INSTRUMENT_POINTS], at least
};

}  // namespace seldinger
