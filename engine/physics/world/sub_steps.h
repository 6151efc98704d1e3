#pragma once
// How a step is divided. It is one sub-step where all goes well. A system that does not converge is put back and takes two halves
// instead, down to h/512. A wire of which more than an edge is fed goes in parts, split and merged in between. A step in which
// one instrument of a common centreline gets ahead of another is cut there. Systems are sub-stepped independently: every sub-step
// names the instruments that take part.

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// One flag per instrument. The bytes come from a pool of the thread and go back there: the step loop allocates nothing once it
/// is warm.
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
    [[nodiscard]] bool any() const;
    operator std::span<const std::uint8_t>() const { return bytes_; }

private:
    static std::vector<std::uint8_t> borrow();
    void give_back();
    std::vector<std::uint8_t> bytes_;
};

/// A stretch of time that some systems are to be taken through.
struct SubStep {
    /// What came before it, of the same step.
    enum class After { Nothing, Half, Part };

    double h;        // [s]
    WireMask wires;  // that take part
    int halvings = 0;
    int parts = 1;   // sub-steps like this one that are still to be taken, this one included
    After after = After::Nothing;
};

/// Into what a step is divided for one instrument before anything has failed.
struct StepParts {
    int count = 1;   // as long as each other
    double cut = 0;  // where the step is cut in two besides, each side in parts as short as these at least; 0: nowhere [s]
    bool operator==(const StepParts&) const = default;
};

/// An update moves no node by more than half a radius, so that 20 m/s at 1/60 s takes h/512.
inline constexpr int most_halvings = 9;

/// The remaining parts of a step: the last in the list is the next.
class SubSteps {
public:
    /// A new step for the wires of the mask. @param parts  per wire: in how many it goes, at least 1, and where it is cut
    void begin(double dt, const WireMask& wires, std::span<const StepParts> parts);
    /// The next sub-step without the wires that are lost; nullptr: the step is over. Valid until the next call.
    [[nodiscard]] const SubStep* next();
    /// These wires of the present sub-step have been put back: they go on in two halves.
    void halve(const WireMask& wires);
    /// These wires of the present sub-step have been put back: they take it again.
    void again(const WireMask& wires);
    /// These wires have failed for good: they stay where they are.
    void lose(const WireMask& wires);

private:
    void add(double length, const WireMask& wires, int parts, SubStep::After after);

    std::vector<SubStep> pending_;
    SubStep now_{0, WireMask(0)};
    WireMask lost_{0};
};

}  // namespace seldinger
