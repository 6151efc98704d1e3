#pragma once
// The stages of step.cpp. Each opens the timer of its name.

#include "world.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// One flag per wire. The bytes come from a pool of the thread and go back there: the step loop allocates nothing once it is
/// warm.
class WireMask {
public:
    explicit WireMask(std::size_t wires, std::uint8_t value = 0) : bytes_(borrow()) { bytes_.assign(wires, value); }
    WireMask(const WireMask& other) : bytes_(borrow()) { bytes_ = other.bytes_; }
    WireMask(WireMask&& other) noexcept { bytes_.swap(other.bytes_); }
    WireMask& operator=(const WireMask& other) = default;
    WireMask& operator=(WireMask&& other) noexcept { return bytes_.swap(other.bytes_), *this; }
    ~WireMask() { give_back(); }
    [[nodiscard]] std::uint8_t& operator[](std::size_t wire) { return bytes_[wire]; }
    [[nodiscard]] std::uint8_t operator[](std::size_t wire) const { return bytes_[wire]; }
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }
    [[nodiscard]] auto begin() const { return bytes_.begin(); }
    [[nodiscard]] auto end() const { return bytes_.end(); }
    operator std::span<const std::uint8_t>() const { return bytes_; }

private:
    static std::vector<std::uint8_t> borrow();
    void give_back();
    std::vector<std::uint8_t> bytes_;
};

/// All wires but the retired ones.
[[nodiscard]] WireMask everyone(const World::Impl& state);
void clear_timers(World::Impl& state);
void collect_timers(World::Impl& state, StepReport& report);

/// Nothing of the last step is needed any more.
void begin_step(World::Impl& state);

/// Advances the wires of the mask by h. A wire that does not converge is put back and advanced by two half steps instead, down to
/// h / 512; a wire that misses the tolerance even then takes the best state found (the report says so), and one that finds none
/// stays at the start of that sub-step. A wire of which more than an edge is fed goes in parts, split and merged in between. What
/// one wire does has no say in what the others do, and is noted in its own report and in `report`, the worst of all.
/// @return wires that failed for good
WireMask advance(World::Impl& state, double h, const WireMask& mask, StepReport& report);

/// Static equilibrium with contact (scheme "static", start "settled").
void find_equilibrium(World::Impl& state, StepReport& report);

/// Splits and merges edges where the shape asks for it, after a step of dt [s]; wires of a given node number at the hub only.
void adapt_nodes(World::Impl& state, double dt);
void check_state(World::Impl& state, StepReport& report);

}  // namespace seldinger
