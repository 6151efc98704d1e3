#pragma once
// Slots of contact between instruments with something near, and their results of the last search and of the trials after it.

#include <cstdint>
#include <vector>

namespace seldinger {

/// [first, end) of the nodes of all rods.
struct NodeRange {
    int first, end;
};
/// Nodes of the cell and of its neighbours: on a, on b.
struct NearNodes {
    NodeRange a, b;
};

struct FoundSlots {
    /// What the last trial knows of a slot. Touched: in a trial before it, whose record is still there.
    enum Touch : std::uint8_t { Apart, Touching, Touched };
    std::vector<std::uint32_t> slot;  // in increasing order
    std::vector<std::uint8_t> touch;  // a Touch: at its last evaluation
    std::vector<double> clear;        // InstrumentForce's, at the first evaluation [m]
    std::vector<NearNodes> near;
    std::vector<std::size_t> of;  // [systems + 1] their first

    void clear_all() { slot.clear(), touch.clear(), clear.clear(), near.clear(); }
    void add(std::uint32_t found, const NearNodes& nodes)
    {
        slot.push_back(found);
        touch.push_back(Apart);
        clear.push_back(0);
        near.push_back(nodes);
    }
    /// Adds those of another list, from `first` up to `end`.
    void keep(const FoundSlots& from, std::size_t first, std::size_t end)
    {
        const auto copy = [&](auto& to, const auto& list) {
            to.insert(to.end(), list.begin() + static_cast<std::ptrdiff_t>(first),
                      list.begin() + static_cast<std::ptrdiff_t>(end));
        };
        copy(slot, from.slot), copy(touch, from.touch), copy(clear, from.clear), copy(near, from.near);
    }
};

}  // namespace seldinger
