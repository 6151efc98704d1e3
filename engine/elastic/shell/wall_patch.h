#pragma once
// The compliance (K + C/h)^-1 between the control vertices that one system touches, in one piece: gathered from columns of the
// inverse so that it fits the cache. In single precision, as the columns are: 6e-8 of what forces of one block of steps do.

#include <cstdint>
#include <memory>
#include <vector>

namespace seldinger {

class WallFactor;

class WallPatch {
public:
    explicit WallPatch(int vertices) : slots_(static_cast<std::size_t>(vertices), -1) {}

    /// Uses this factor from now on and forgets the columns of another one.
    void use(std::shared_ptr<const WallFactor> factor);
    [[nodiscard]] const WallFactor& factor() const { return *factor_; }
    /// Between steps: forgets vertices that have not been asked for since the last call, once they are more than a third. Those
    /// with columns come first then, in order, so that WallDynamics::now and wall_compliance read memory from one end to the
    /// other.
    void trim();
    /// Place of a vertex among those that have been asked for; holds until trim().
    [[nodiscard]] int slot(std::int32_t vertex)
    {
        int known = slots_[static_cast<std::size_t>(vertex)];
        if (known < 0) known = add(vertex);
        asked_[static_cast<std::size_t>(known)] = 1;
        return known;
    }
    /// Its column is solved for, if it has not been; the compliance is symmetric, so that it is its row too.
    void provide(int slot)
    {
        if (!solved_[static_cast<std::size_t>(slot)]) fill(slot);
    }
    /// Displacement of vertex `at` [3] per force on vertex `from` [3], row by row; provide(at) must have run. A row lies as it is
    /// read.
    [[nodiscard]] const float* block(int at, int from) const
    {
        return &blocks_[place(at, from)];
    }

private:
    [[nodiscard]] std::size_t place(int at, int from) const
    {
        return (static_cast<std::size_t>(at) * static_cast<std::size_t>(room_) + static_cast<std::size_t>(from)) * 9;
    }
    int add(std::int32_t vertex);
    void fill(int slot);
    void copy_block(int at, int from);

    std::shared_ptr<const WallFactor> factor_;
    std::vector<int> slots_;              // [V] -1: not asked for
    std::vector<std::int32_t> vertices_;  // [slots]
    std::vector<std::uint8_t> solved_;    // [slots]
    std::vector<std::uint8_t> asked_;     // [slots] since the last trim()
    int room_ = 0;
    std::vector<float> blocks_;  // [room][room][9]
};

}  // namespace seldinger
