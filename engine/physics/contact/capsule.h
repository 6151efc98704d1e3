#pragma once
// `swept` and `nodes`: quadrature points of the wire against the exact mesh. See contact_system.h for the order of
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

    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void take(int wire, Base base, std::span<double> kinks) override;
    [[nodiscard]] std::span<const Kink> kinks(int wire) override { return valleys_.from_base(wire, rods_.node_begin(wire)); }
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) override;
    [[nodiscard]] bool is_clear(RodArrays& rods, int wire) override;
    void commit(std::span<const std::uint8_t> active) override;
    void set_exposure(int wire, double offset, double exposed) override
    {
        quadrature_.wires[wire].offset = offset;
        quadrature_.wires[wire].exposed = exposed;
    }
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) override;
    /// For those who look into a step: records of the last evaluation, two for each point; those of a wire that it wrote have
    /// this epoch.
    [[nodiscard]] std::span<const ContactState> at_trial() const { return states_.at_trial(); }
    [[nodiscard]] std::uint32_t epoch(int wire) const { return quadrature_.wires[static_cast<std::size_t>(wire)].epoch; }
    void add_loads(RodArrays& rods, std::span<WireLoads> loads) override;  // cheap enough for every step
    [[nodiscard]] double spacing(int wire) const override { return quadrature_.wires[static_cast<std::size_t>(wire)].spacing; }
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> describe() const override;
    void walk_state(StateWalk& walk, int wire) override;

private:
    void begin(RodArrays& rods) override;
    void evaluate_forces(const TermTrial& trial) override;
    void set_limits();
    /// A barrier's path ends at no valley, and a step of one iteration looks for none.
    [[nodiscard]] bool valleys_known() const { return !barrier_ && !params_.returns; }
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
    std::vector<std::uint32_t> narrow_;       // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
