#pragma once
// Contact of all wires with the wall, found and evaluated on the device (`swept`;
// `nodes` is the same with one quadrature point at each control node). Implements what the solver asks for.
//
// Per step: begin_step remembers the start of the step. prepare puts quadrature points on the edges and renews candidates if a
// quadrature point has moved by its skin. Each Newton iteration calls evaluate: three small writes, two launches, one read-back
// of the edges' sums. commit makes the trial's anchors the state. The wall's geometry stays on the device.

#include "contact/contact_setup.h"
#include "contact/device_views.h"
#include "contact/edge_sums.h"
#include "contact/force_per_length.h"
#include "contact/quadrature.h"
#include "contact/wall_contact.h"
#include "device/device.h"
#include "vessel/tree.h"

#include <memory>
#include <optional>

namespace seldinger {

/// A detection method: what World needs of it beside what the solver needs. However contact is found, the device leaves sums per
/// edge (edge_sums.h), and what the solver asks is answered from those.
class ContactMethod : public WallContact {
public:
    void begin_step(RodArrays& rods, Settling how) final
    {
        params_.settling = settling_flag(how);
        begin(rods);
    }
    /// Quadrature points on the present node set.
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override = 0;
    void commit(std::span<const std::uint8_t> active) override = 0;
    void evaluate(const TermTrial& trial) final;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;

    void add(int wire, std::span<double> gradient, BandRows* jacobian, bool symmetric) const final
    {
        sums_.add(wire, rods_.node_begin(wire), gradient, jacobian, symmetric);
    }
    void make_positive(int wire) final { sums_.make_positive(wire, rods_.view(wire).radius[0]); }
    [[nodiscard]] ContactTotals totals(int wire) const
    {
        ContactTotals sum = sums_.totals(wire, rods_.view(wire).radius[0]);
        if (sum.deepest >= 0) sum.deepest -= rods_.node_begin(wire);
        return sum;
    }
    void add_nodal_forces(int wire, std::span<Vec3> forces) const override
    {
        sums_.add_nodal_forces(wire, rods_.node_begin(wire), forces);
    }
    /// The wall's force on what slides along a wire's line, + towards the tip [N].
    [[nodiscard]] double along(int wire) const { return sums_.along(wire, rods_.node_begin(wire), rods_.view(wire)); }

    /// Exposure of a wire that shares its nodes with others: see WireQuadrature. Before begin_step and again before prepare.
    virtual void set_exposure(int /*wire*/, double /*offset*/, double /*exposed*/) {}
    /// What rows() bears, in its order. @param loads  [wires], to which it is added
    virtual void add_loads(RodArrays& rods, std::span<WireLoads> loads);
    /// Spacing of a wire's samples [m]; 0: its contacts represent no length.
    [[nodiscard]] virtual double spacing(int /*wire*/) const { return 0; }
    /// Choices of this method, "name", "value (reason)", for summary.json.
    [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> describe() const = 0;
    void walk_state(StateWalk& walk, int wire) override = 0;

protected:
    ContactMethod(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree);
    /// Node positions, angles and the places of quadrature points at the start of the step.
    virtual void begin(RodArrays& rods) = 0;
    virtual void evaluate_forces(const TermTrial& trial) = 0;
    /// Where a trial's moves begin: the start of the step, or what stands before it.
    [[nodiscard]] const DeviceNodes& nodes_before() const { return params_.known ? *nodes_known_ : nodes_t0_; }
    void set_nodes(DeviceNodes& nodes, const TrialState& state) const;
    /// Positions that an evaluation needs.
    void upload_nodes(device::Queue queue);

    device::Context& context_;
    RodArrays& rods_;
    DeviceWall wall_;
    DeviceNodes nodes_, nodes_t0_;            // at the trial, at the start of the step
    std::optional<DeviceNodes> nodes_known_;  // TermTrial::before; schemes that start from known velocities only
    ContactParams params_{};
    EdgeSums sums_;
};

/// @param setup  objects that it refers to must outlive the result
[[nodiscard]] std::unique_ptr<ContactMethod> make_contact(device::Context& context, const ContactSetup& setup, RodArrays& rods);

}  // namespace seldinger
