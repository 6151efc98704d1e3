#pragma once
// The published layer method (kernels/shared/layer.h): pairs are found once per step, at its start, and evaluated per Newton
// iteration. A pair's friction anchor is carried on by (edge, triangle), since the method has no material quadrature points.

#include "contact/contact_system.h"
#include "shared/layer.h"

namespace seldinger {

/// w of the layer: in [r/4, 2r], smaller where the lumen is larger [m].
[[nodiscard]] double layer_width(double radius, double lumen_radius);

class LayerContact final : public ContactMethod {
public:
    LayerContact(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree);

    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void commit(std::span<const std::uint8_t> active) override;
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) override;
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> describe() const override;
    void walk_state(StateWalk& walk, int wire) override;

private:
    // a pair by what survives the step: wire, edge of the wire, triangle
    struct Key {
        std::uint32_t wire, edge, triangle;
        auto operator<=>(const Key&) const = default;
    };
    void warm_up();
    void begin(RodArrays& rods) override;
    void evaluate_forces(const TermTrial& trial) override;
    void list_edges(std::span<const std::uint8_t> live);
    void list_pairs();
    void merge_records(std::span<const std::uint8_t> active);
    /// Checks a saved state: ordered, with existing edges and triangles. @throws Error BadFile
    void check_keys(std::span<const Key> keys, int wire) const;
    [[nodiscard]] double lumen_radius_at(const Vec3& p);

    const ContactSetup setup_;
    double typical_radius_;
    std::vector<std::uint32_t> epochs_;  // [wires] of the step being solved; commit raises it
    int centreline_hint_ = -1;
    std::vector<LayerEdge> edges_;          // of this step
    std::vector<std::uint32_t> edge_wire_;  // [edges]
    std::vector<std::uint32_t> counts_, candidates_host_, first_;
    std::vector<double> touching_;             // [edges] L' [m]
    std::vector<std::uint32_t> paired_edges_;  // [active edges] index among edges_
    std::vector<LayerPair> pairs_;
    std::vector<Key> keys_, last_keys_;  // [pairs], of this and of the last accepted step, both ordered
    device::Kernel find_, evaluate_, reduce_;
    device::Buffer edge_list_, candidates_, count_buffer_, touching_buffer_, pair_list_, first_buffer_, forces_, barys_,
        edge_sums_, states_t0_, states_;
};

}  // namespace seldinger
