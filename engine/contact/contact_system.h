#pragma once
// Contact of all wires with the wall, found and evaluated on the device (capsule detection and its bounded-move form, `swept`;
// `nodes` is the same with one quadrature point at each control node). Implements what the solver asks for.
//
// Per step: begin_step (start of the step is remembered), prepare (quadrature points are put on the edges, candidates renewed
// where a quadrature point has moved by its skin), then per Newton iteration evaluate: three small writes, two launches, one
// read-back of the edges' sums; commit makes the trial's anchors the state. The wall's geometry stays on the device.

#include "contact/contact_row.h"
#include "contact/contact_setup.h"
#include "contact/device_views.h"
#include "contact/edge_sums.h"
#include "contact/moving_wall.h"
#include "contact/quadrature.h"
#include "core/stage_times.h"
#include "device/device.h"
#include "solve/newton.h"
#include "vessel/tree.h"

#include <memory>
#include <optional>

namespace seldinger {

/// A detection method: what World needs of it beside what the solver needs. However contact is found, the device leaves sums per
/// edge (edge_sums.h), and what the solver asks is answered from those.
class ContactMethod : public ContactTerm {
public:
    /// Remembers node positions, angles and quadrature point places at the start of the step.
    virtual void begin_step(RodArrays& rods) = 0;
    /// Quadrature points on the present node set (after feeding); wires with live[w] == 0 have no contact (still in the guide).
    virtual void prepare(RodArrays& rods, std::span<const std::uint8_t> live) = 0;
    /// The last evaluated trial becomes the accepted state of wires with active[w] != 0.
    virtual void commit(std::span<const std::uint8_t> active) = 0;
    /// Whether the law allows no overlap at all, and so no change of nodes that makes one.
    [[nodiscard]] virtual bool never_overlaps() const { return false; }
    /// Whether a wire on its present nodes is clear of the wall; asked of laws that never overlap.
    [[nodiscard]] virtual bool is_clear(RodArrays&, int /*wire*/) { return true; }
    void evaluate_start(const TrialState& start, const TrialState& before, double h, bool linearised,
                        std::span<const std::uint8_t> active) final;
    /// Where the wall of a system is at the end of the step to come, as displacement of the mesh's vertices [m]. Asked of contact
    /// that was set up for a wall that moves; commit() makes it where the next step starts. A move must be small against the
    /// wire's radius: nothing looks for what the wall passes on its way.
    void move_wall(int system, std::span<const Vec3> displacement);
    /// @param settling  0 or SEL_SETTLE_*
    void set_settling(uint settling) { params_.settling = settling; }

    void add(int wire, std::span<double> gradient, BandMatrix* jacobian, bool symmetric) const final
    {
        sums_.add(wire, rods_.node_begin(wire), gradient, jacobian, symmetric);
    }
    [[nodiscard]] bool unsymmetric(int wire) const final { return sums_.unsymmetric(wire); }
    [[nodiscard]] double largest_force(int wire) const final { return sums_.largest_force(wire); }
    [[nodiscard]] double rounding(int wire) const final
    {
        return context_.float32() ? sums_.rounding(wire, rods_.node_begin(wire), rods_.view(wire)) : 0;
    }
    [[nodiscard]] ContactTotals totals(int wire) const { return sums_.totals(wire, rods_.view(wire).radius[0]); }
    /// The most energy that the contacts of the last evaluation can give back [J].
    [[nodiscard]] virtual double stored_energy(int wire) const
    {
        const ContactTotals t = totals(wire);
        return (t.normal + t.friction) * t.depth;
    }
    /// Adds contact forces on the nodes of a wire, [n].
    void add_nodal_forces(int wire, std::span<Vec3> forces) const
    {
        sums_.add_nodal_forces(wire, rods_.node_begin(wire), forces);
    }

    [[nodiscard]] virtual std::vector<ContactRow> rows(RodArrays& rods) = 0;
    /// Choices of this method, "name", "value (reason)", for summary.json.
    [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> describe() const = 0;
    virtual void save(std::vector<std::uint8_t>& bytes) = 0;
    /// What save() would write in a world of this wire alone.
    virtual void save_wire(std::vector<std::uint8_t>& bytes, int wire) = 0;
    virtual void restore(const std::uint8_t*& bytes, const std::uint8_t* end) = 0;

    StageTimes times;  // of detect, evaluate and reduce since it was last cleared [s]

protected:
    ContactMethod(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree);
    /// Where a trial's moves begin: the start of the step, or what stands before it.
    [[nodiscard]] const DeviceNodes& nodes_before() const { return params_.known ? *nodes_known_ : nodes_t0_; }
    void set_nodes(DeviceNodes& nodes, const TrialState& state) const;
    /// The wall of systems in which a wire took the step is accepted where it is.
    void accept_wall(std::span<const std::uint8_t> active);
    /// Positions that an evaluation needs.
    void upload_nodes(device::Queue queue);

    device::Context& context_;
    RodArrays& rods_;
    DeviceWall wall_;
    std::optional<MovingWall> moving_wall_;
    std::vector<int> system_;                 // [wires]
    DeviceNodes nodes_, nodes_t0_;            // at the trial, at the start of the step
    std::optional<DeviceNodes> nodes_known_;  // see evaluate_start; schemes that start from known velocities only
    ContactParams params_{};
    EdgeSums sums_;
};

/// @param setup  what it refers to must outlive the result
[[nodiscard]] std::unique_ptr<ContactMethod> make_contact(device::Context& context, const ContactSetup& setup, RodArrays& rods);

}  // namespace seldinger
