#pragma once
// `capsule`, `swept` and `nodes`: samples of the wire against the exact mesh. See contact_system.h for the order of calls.

#include "contact/barrier_path.h"
#include "contact/contact_storage.h"
#include "contact/multipliers.h"
#include "contact/near_wall.h"

#include <chrono>
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
    [[nodiscard]] double feasible_step(int wire) const override { return barrier_ ? barrier_->feasible_step(wire) : 1.0; }
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) override;
    [[nodiscard]] double move_limit(int wire) const override;
    [[nodiscard]] bool never_overlaps() const override { return barrier_.has_value(); }
    [[nodiscard]] bool is_clear(RodArrays& rods, int wire) override;
    [[nodiscard]] double stored_energy(int wire) const override;
    void commit(std::span<const std::uint8_t> active) override;
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) override;
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> describe() const override;
    void save(std::vector<std::uint8_t>& bytes) override;
    void save_wire(std::vector<std::uint8_t>& bytes, int wire) override;
    void restore(const std::uint8_t*& bytes, const std::uint8_t* end) override;

private:
    void find_near(std::span<const std::uint8_t> active);
    void rebuild_active_list(std::span<const std::uint8_t> active);
    [[nodiscard]] std::vector<TouchState> living_touches(int first_wire, int end_wire);
    void warm_up();
    void launch_evaluate(device::Lane at, std::size_t items, const ContactParams& par, const device::Buffer& list);
    [[nodiscard]] bool pick_some(std::span<const std::uint8_t> active);
    void spread_sums(std::span<const std::uint8_t> active);
    [[nodiscard]] device::Lane lane(std::size_t samples) const;
    [[nodiscard]] SampleBuffers sample_buffers() const;
    void write_places(device::Lane at);
    [[nodiscard]] std::string describe_law(const SampleModel& m) const;
    void upload_places();
    void start_barrier();

    bool swept_;
    SampleSet samples_;
    std::vector<ContactStorage> storage_;             // [wires]
    std::vector<std::uint32_t> active_, edge_first_;  // samples that have cells, by edges
    std::vector<std::uint32_t> listed_;               // [samples] stamp of the last step in which the sample was evaluated
    std::vector<std::uint32_t> some_, some_first_;    // as active_, edge_first_, of the wires that are evaluated now
    std::vector<EdgeForce> last_edges_;               // scratch
    std::vector<int> last_wire_edges_;
    device::Buffer models_, places_;
    NearWall near_;
    device::Kernel evaluate_, reduce_;
    device::Buffer active_list_, first_buffer_, some_list_, some_first_buffer_, forces_, barys_, edge_buffer_, last_edge_buffer_;
    device::Buffer touches_t0_, touches_;
    device::Buffer no_multipliers_;           // for the laws that have none
    std::optional<Multipliers> multipliers_;  // augmented, constraint, impulse
    std::optional<BarrierPath> barrier_;      // barrier
    std::vector<double> move_limit_;          // [wires] [m]
    bool list_stale_ = true;
    std::vector<std::uint32_t> narrow_places_, narrow_;  // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
