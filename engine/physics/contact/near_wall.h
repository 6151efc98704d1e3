#pragma once
// Caches the wall near every quadrature point: the nodes of the tree round it (kernels/shared/walk.h), or that no wall is near.
// An entry holds while the quadrature point stays near the place of the search, usually for many steps. Beside a rigid wall an
// entry also serves the neighbours of its point. Most of a wire is far from any wall: there one distance serves a stretch of it.

#include "contact/device_views.h"
#include "contact/point_states.h"
#include "contact/quadrature.h"
#include "shared/contact_types.h"

namespace seldinger {

class NearWall {
public:
    struct Lengths {
        double slack;     // a list serves while its quadrature point is within that of where it was found, or half of it [m]
        double margin;    // lists hold what is within radius + reach + margin; at least the slack [m]
        double farthest;  // no two points of the wall are farther apart [m]
    };

    /// All but the context must outlive this and stay where they are.
    NearWall(device::Context& context, const QuadratureSet& points, const DeviceWall& wall, DeviceNodes& nodes,
             const PointStates& states, const Lengths& lengths);

    /// Renews the lists of live quadrature points that have moved too far for them. @return whether any was renewed
    bool renew(const ContactParams& par);
    /// All of it.
    void forget();
    void forget(const WireQuadrature& wire);
    /// Launches each kernel once with nothing to do.
    void warm_up(device::Queue at, const ContactParams& none);

    [[nodiscard]] bool has_near_cells(int point) const { return counts_[point] > 0; }
    /// Nodes that a list has room for: ContactParams::slots of every launch that reads lists. Grows in renew().
    [[nodiscard]] uint slots() const { return slots_; }
    [[nodiscard]] const device::Buffer& near_cells() const { return near_cells_; }  // [points][slots]
    [[nodiscard]] const device::Buffer& counts() const { return count_buffer_; }    // [points]
    [[nodiscard]] const device::Buffer& clearances() const { return clearances_; }  // [points], kernels/shared/clearance.h

private:
    [[nodiscard]] bool mark(bool all);
    void mark_stale(int wire, bool all);
    void take_spheres(int wire);
    void probe(int stride);
    bool find_listed(const ContactParams& par);
    void launch_find(device::Queue at, std::size_t items, const ContactParams& par);
    void launch_distance(device::Queue at, std::size_t items);
    [[nodiscard]] device::Queue upload_list();
    [[nodiscard]] Vec3 node(uint i) const;         // relative to the wall's centre
    [[nodiscard]] Vec3 position(int point) const;  // likewise
    [[nodiscard]] double need(int point) const
    {
        return quadrature_.models[point].radius + quadrature_.models[point].reach + lengths_.margin - lengths_.slack;
    }

    device::Context& context_;
    const QuadratureSet& quadrature_;
    const DeviceWall& wall_;
    DeviceNodes& nodes_;
    const PointStates& states_;
    Lengths lengths_;
    uint slots_;
    // An entry is valid while the quadrature point is within keep_ of at_. It has either its cells (counts_ > 0) or no wall
    // within clear_ of at_ (clear_ > 0), which serves for the neighbours too.
    std::vector<Vec3> at_;                // [points] NaN: nothing is known
    std::vector<double> keep_, clear_;    // [points] [m]
    std::vector<std::uint32_t> counts_;   // [points]
    std::vector<std::uint32_t> stale_;    // [points] of wire w: stale_[begin ...], stale_count_[w] of them
    std::vector<int> stale_count_;        // [wires]
    std::vector<std::uint32_t> to_find_;  // quadrature points of a launch
    std::vector<std::uint32_t> found_;    // what it says of them
    std::vector<double> distances_;
    device::Kernel find_, distance_;
    device::Buffer near_cells_, count_buffer_, clearances_, list_, found_buffer_, distance_buffer_;
    std::vector<std::uint32_t> narrow_;  // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
