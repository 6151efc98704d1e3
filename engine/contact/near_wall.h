#pragma once
// What is known of the wall near every sample: the cells of the tree round it (kernels/shared/walk.h), or that no wall is near.
// Either holds while the sample stays near where it was found out, which is for many steps; and the wall not moving, what one
// sample knows serves its neighbours. Most of a wire is far from any wall: there one distance serves a stretch of it.

#include "contact/contact_system.h"
#include "contact/samples.h"

namespace seldinger {

class NearWall {
public:
    struct Lengths {
        double slack;     // a list serves while its sample is within that of where it was found, or half of it [m]
        double margin;    // lists hold what is within radius + reach + margin; at least the slack [m]
        double farthest;  // no two points of the wall are farther apart [m]
    };

    /// All but the context must outlive this and stay where they are. models, places: [samples] on the device
    NearWall(device::Context& context, const SampleSet& samples, const DeviceWall& wall, DeviceNodes& nodes,
             const device::Buffer& models, const device::Buffer& places, const Lengths& lengths);

    /// Finds anew what no longer holds, for live samples at their places on the nodes. @return whether anything was
    bool renew(const ContactParams& par);
    /// All of it.
    void forget();
    /// Launches each kernel once with nothing to do.
    void warm_up(device::Lane at, const ContactParams& none);

    [[nodiscard]] bool has_cells(int sample) const { return counts_[sample] > 0; }
    /// Cells that a list has room for: ContactParams::slots of every launch that reads lists. Grows in renew().
    [[nodiscard]] uint slots() const { return slots_; }
    [[nodiscard]] const device::Buffer& cells() const { return cells_; }            // [samples][slots]
    [[nodiscard]] const device::Buffer& counts() const { return count_buffer_; }    // [samples]
    [[nodiscard]] const device::Buffer& clearances() const { return clearances_; }  // [samples], kernels/shared/clearance.h

private:
    [[nodiscard]] bool mark(bool all);
    void mark_stale(int wire, bool all);
    void take_spheres(int wire);
    void probe(int stride);
    bool find_listed(const ContactParams& par);
    void launch_find(device::Lane at, std::size_t items, const ContactParams& par);
    void launch_distance(device::Lane at, std::size_t items);
    [[nodiscard]] device::Lane upload_list();
    [[nodiscard]] Vec3 position(int sample) const;  // relative to the wall's centre
    [[nodiscard]] double need(int sample) const
    {
        return samples_.models[sample].radius + samples_.models[sample].reach + lengths_.margin - lengths_.slack;
    }

    device::Context& context_;
    const SampleSet& samples_;
    const DeviceWall& wall_;
    DeviceNodes& nodes_;
    const device::Buffer &models_, &places_;
    Lengths lengths_;
    uint slots_;
    // What is known holds while the sample is within keep_ of at_: either its cells, counts_ > 0; or, clear_ > 0, that no wall is
    // within clear_ of at_, which serves for the neighbours too.
    std::vector<Vec3> at_;                // [samples] NaN: nothing is known
    std::vector<double> keep_, clear_;    // [samples] [m]
    std::vector<std::uint32_t> counts_;   // [samples]
    std::vector<std::uint32_t> stale_;    // [samples] of wire w: stale_[begin ...], stale_count_[w] of them
    std::vector<int> stale_count_;        // [wires]
    std::vector<std::uint32_t> to_find_;  // samples of a launch
    std::vector<std::uint32_t> found_;    // what it says of them
    std::vector<double> distances_;
    device::Kernel find_, distance_;
    device::Buffer cells_, count_buffer_, clearances_, list_, found_buffer_, distance_buffer_;
    std::vector<std::uint32_t> narrow_;  // scratch of a float32 context (device_records.h)
};

}  // namespace seldinger
