#pragma once
// Which instruments of a world are solved together, and which are still stepped. System s has the instruments begin[s] to
// begin[s + 1].

#include "world/sub_steps.h"

#include <numeric>

namespace seldinger {

class SystemList {
public:
    /// @param sizes  instruments of each system; empty: each instrument is a separate system
    SystemList(int wires, std::span<const int> sizes) : wires_(wires), of_(wires), retired_(wires, 0)
    {
        std::iota(wires_.begin(), wires_.end(), 0);
        for (int s = 0; begin_.back() < wires; ++s) {
            const int size = sizes.empty() ? 1 : sizes[s];
            std::fill_n(of_.begin() + begin_.back(), size, s);
            begin_.push_back(begin_.back() + size);
        }
    }
    [[nodiscard]] int count() const { return static_cast<int>(begin_.size()) - 1; }
    [[nodiscard]] int of(int wire) const { return of_[wire]; }
    [[nodiscard]] std::span<const int> of_each() const { return of_; }
    /// All instruments in the order of their systems: 0, 1, 2, ...
    [[nodiscard]] std::span<const int> all() const { return wires_; }
    [[nodiscard]] std::span<const int> wires_of(int system) const
    {
        return all().subspan(begin_[system], begin_[system + 1] - begin_[system]);
    }

    /// Every later step leaves the system out, or takes it in again.
    void retire(int system, bool out)
    {
        for (const int w : wires_of(system)) retired_[w] = out;
    }
    [[nodiscard]] bool is_retired(int wire) const { return retired_[wire] != 0; }
    /// All instruments but those of retired systems.
    [[nodiscard]] WireMask running() const
    {
        WireMask mask(wires_.size());
        for (const int w : wires_) mask[w] = !retired_[w];
        return mask;
    }
    /// A system with one instrument in the mask is in it with all of them, as far as it takes part.
    void spread(const WireMask& part, WireMask& mask) const
    {
        for (int s = 0; s < count(); ++s) {
            bool any = false;
            for (const int w : wires_of(s)) any = any || mask[w];
            for (const int w : wires_of(s)) mask[w] = any && part[w];
        }
    }

private:
    std::vector<int> wires_, begin_{0}, of_;
    std::vector<std::uint8_t> retired_;  // [wires]
};

}  // namespace seldinger
