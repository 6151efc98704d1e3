#pragma once
// Chooses the quadrature points to evaluate: those near the wall, by their edges; and the places of these edges' sums.

#include "contact/edge_sums.h"
#include "contact/near_wall.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// Quadrature points of one evaluation, by edges; on the host and on the device.
struct ActiveList {
    ActiveList(device::Context& context, std::size_t points, std::size_t edges);
    std::vector<std::uint32_t> points;      // ordered by wire and edge
    std::vector<std::uint32_t> edge_first;  // [edges + 1] of each edge its first in `points`
    device::Buffer point_buffer, first_buffer;
    [[nodiscard]] std::size_t edges() const { return edge_first.size() - 1; }
    void upload(device::Context& context, device::Queue queue) const;
};

class ActiveSet {
public:
    /// Both must outlive this.
    ActiveSet(device::Context& context, const QuadratureSet& quadrature, EdgeSums& sums, std::size_t edges);

    /// Places have changed: the list is made anew before it is read again, and no wire keeps its sums.
    void set_stale() { stale_ = true; }
    [[nodiscard]] bool stale() const { return stale_; }
    /// @param active  wires that are evaluated next, the others keep their sums; empty: not said
    void rebuild(const NearWall& near, std::span<const std::uint8_t> active);
    /// Forgets evaluations of earlier steps.
    void forget(const WireQuadrature& wire);

    [[nodiscard]] const ActiveList& all() const { return all_; }
    /// The points and edges of the wires that are evaluated now, when those are not all: a world of many wires solves on until
    /// its last one has converged. @return nullptr: all are
    [[nodiscard]] const ActiveList* pick(std::span<const std::uint8_t> active);

    /// Where a launch over all() leaves its sums, which read back are EdgeSums::edges; and where one over a part does.
    [[nodiscard]] const device::Buffer& sums_buffer(bool part) const { return part ? last_edge_buffer_ : edge_buffer_; }
    [[nodiscard]] EdgeForce* sums_target(bool part) { return part ? last_edges_.data() : sums_.edges.data(); }
    /// Copies the sums read back for a part into the sums of these wires.
    void spread(std::span<const std::uint8_t> active);

private:
    void list_wire(std::size_t wire, const NearWall& near);
    void keep_sums(std::span<const std::uint8_t> active);

    device::Context& context_;
    const QuadratureSet& quadrature_;
    EdgeSums& sums_;
    bool stale_ = true;
    ActiveList all_, some_;
    std::vector<std::uint32_t> listed_;              // [points] epoch of the last step in which the point was evaluated
    std::vector<EdgeForce> last_edges_;              // scratch
    std::vector<int> last_wire_edges_;               // scratch
    device::Buffer edge_buffer_, last_edge_buffer_;  // of sums_.edges, last_edges_
};

/// Below some count the caller's thread is faster than waking the pool (15 us). The choice depends on the item count only, so it
/// is the same on every machine.
[[nodiscard]] device::Queue queue_for(std::size_t points);

}  // namespace seldinger
