#pragma once
// `capsule`, `swept` and `nodes`: quadrature points of the wire against the exact mesh. See contact_system.h for the order of
// calls. The stages of an evaluation: near_wall.h finds the near wall, active_set.h lists the points to evaluate, evaluation.h
// makes forces and their sums. point_states.h carries the state; multipliers.h and barrier_path.h serve their laws.

#include "contact/active_set.h"
#include "contact/barrier_path.h"
#include "contact/contact_storage.h"
#include "contact/contact_system.h"
#include "contact/evaluation.h"
#include "contact/multipliers.h"
#include "contact/near_wall.h"
#include "contact/point_states.h"
#include "contact/valleys.h"

#include <optional>

namespace seldinger {

class CapsuleContact final : public ContactMethod {
public:
    CapsuleContact(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree);

    void begin_step(RodArrays& rods) override;
    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    void evaluate(const TrialState& trial, double h, std::span<const std::uint8_t> active) override;
    [[nodiscard]] bool admissible(int wire) const override { return sums_.admissible(wire) && feasible_step(wire) == 1; }
    void take(int wire) override;
    void start_again(int wire) override;
    [[nodiscard]] KinksPassed crossed(int wire) override;
    void admit_crossings(int wire, std::span<double> residual) override
    {
        valleys_.admit(wire, rods_.node_begin(wire), residual);
    }
    [[nodiscard]] double feasible_step(int wire) const override { return barrier_ ? barrier_->feasible_step(wire) : 1.0; }
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) override;
    [[nodiscard]] double move_limit(int wire) const override;
    [[nodiscard]] bool never_overlaps() const override { return barrier_.has_value(); }
    [[nodiscard]] bool is_clear(RodArrays& rods, int wire) override;
    [[nodiscard]] double stored_energy(int wire) const override;
    void commit(std::span<const std::uint8_t> active) override;
    void set_exposure(int wire, double offset, double exposed) override
    {
        quadrature_.wires[wire].offset = offset;
        quadrature_.wires[wire].exposed = exposed;
    }
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) override;
    /// For those who look into a step: records of the last evaluation, two for each point; those of a wire that it wrote have this epoch.
    [[nodiscard]] std::span<const ContactState> at_trial() const { return states_.at_trial(); }
    [[nodiscard]] std::uint32_t epoch(int wire) const { return quadrature_.wires[static_cast<std::size_t>(wire)].epoch; }
    void add_loads(RodArrays& rods, std::span<WireLoads> loads) override;  // cheap enough for every step
    [[nodiscard]] double spacing(int wire) const override { return quadrature_.wires[static_cast<std::size_t>(wire)].spacing; }
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> describe() const override;
    void save(std::vector<std::uint8_t>& bytes) override;
    void save_wire(std::vector<std::uint8_t>& bytes, int wire) override;
    void restore(const std::uint8_t*& bytes, const std::uint8_t* end) override;
    void restore_wire(const std::uint8_t*& bytes, const std::uint8_t* end, int wire) override;

private:
    void set_limits();
    /// A barrier's path ends at no valley; a device with memory of its own would be asked for its records at every trial.
    [[nodiscard]] bool valleys_known() const { return !barrier_ && !states_.at_trial().empty(); }
    void warm_up();
    void find_near(std::span<const std::uint8_t> active);
    void set_wire_nodes(DeviceNodes& nodes, int wire, const RodView& rod) const;
    void evaluate_list(const ActiveList& list, bool part, double h);
    void start_barrier();
    [[nodiscard]] QuadratureBuffers buffers(const ActiveList& list) const;
    [[nodiscard]] QuadratureBuffers buffers() const { return buffers(active_.all()); }
    [[nodiscard]] const device::Buffer* multiplier_states() const { return multipliers_ ? &multipliers_->states() : nullptr; }
    [[nodiscard]] ContactRow row_of(int wire, int edge, int point, const ContactState& state) const;
    [[nodiscard]] std::string describe_law(const QuadratureModel& m) const;

    bool swept_;
    QuadratureSet quadrature_;
    std::vector<ContactStorage> storage_;  // [wires]
    PointStates states_;
    NearWall near_;
    ActiveSet active_;
    Evaluation evaluation_;
    Valleys valleys_;
    std::optional<Multipliers> multipliers_;  // augmented, constraint, impulse
    std::optional<BarrierPath> barrier_;      // barrier
    std::vector<double> move_limit_;          // [wires] [m]
    std::vector<std::uint32_t> narrow_;       // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
