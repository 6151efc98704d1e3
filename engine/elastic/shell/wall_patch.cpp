// Blocks of the wall's compliance, gathered as places are touched.
#include "shell/wall_patch.h"
#include "shell/wall_compliance.h"

#include <algorithm>

namespace seldinger {
namespace {

int least_room(int slots) { return std::max(64, 3 * slots / 2); }

}  // namespace

void WallPatch::use(std::shared_ptr<const WallFactor> factor)
{
    if (factor == factor_) return;
    factor_ = std::move(factor);
    for (const std::int32_t v : vertices_) slots_[static_cast<std::size_t>(v)] = -1;
    vertices_.clear();
    solved_.clear();
    asked_.clear();
}

void WallPatch::trim()
{
    std::vector<int> stay;
    for (std::size_t k = 0; k < vertices_.size(); ++k)
        if (asked_[k]) stay.push_back(static_cast<int>(k));
    if (2 * vertices_.size() <= 3 * stay.size()) {
        asked_.assign(asked_.size(), 0);
        return;
    }
    std::sort(stay.begin(), stay.end(), [&](int a, int b) {
        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
        return solved_[i] != solved_[j] ? solved_[i] > solved_[j] : vertices_[i] < vertices_[j];
    });
    const int room = least_room(static_cast<int>(stay.size()));
    std::vector<float> blocks(static_cast<std::size_t>(room) * static_cast<std::size_t>(room) * 9);
    std::vector<std::int32_t> vertices;
    std::vector<std::uint8_t> solved;
    for (const std::int32_t v : vertices_) slots_[static_cast<std::size_t>(v)] = -1;
    for (std::size_t at = 0; at < stay.size(); ++at) {
        for (std::size_t from = 0; from < stay.size(); ++from)
            std::copy_n(block(stay[at], stay[from]), 9, &blocks[(at * static_cast<std::size_t>(room) + from) * 9]);
        vertices.push_back(vertices_[static_cast<std::size_t>(stay[at])]);
        solved.push_back(solved_[static_cast<std::size_t>(stay[at])]);
        slots_[static_cast<std::size_t>(vertices.back())] = static_cast<int>(at);
    }
    vertices_ = std::move(vertices);
    solved_ = std::move(solved);
    blocks_ = std::move(blocks);
    asked_.assign(vertices_.size(), 0);
    room_ = room;
}

void WallPatch::copy_block(int at, int from)
{
    const std::span<const float> columns = factor_->columns(vertices_[static_cast<std::size_t>(at)]);
    const std::size_t size = columns.size() / 3, row = 3 * static_cast<std::size_t>(vertices_[static_cast<std::size_t>(from)]);
    float* to = &blocks_[place(at, from)];
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) to[3 * r + c] = columns[r * size + row + c];
}

int WallPatch::add(std::int32_t vertex)
{
    const int slot = static_cast<int>(vertices_.size());
    if (slot == room_) {
        const int room = least_room(room_);
        std::vector<float> larger(static_cast<std::size_t>(room) * static_cast<std::size_t>(room) * 9);
        for (int at = 0; at < room_; ++at)
            std::copy_n(block(at, 0), 9 * static_cast<std::size_t>(room_),
                        &larger[static_cast<std::size_t>(at) * static_cast<std::size_t>(room) * 9]);
        blocks_ = std::move(larger);
        room_ = room;
    }
    slots_[static_cast<std::size_t>(vertex)] = slot;
    vertices_.push_back(vertex);
    solved_.push_back(0);
    asked_.push_back(1);
    for (int at = 0; at < slot; ++at)
        if (solved_[static_cast<std::size_t>(at)]) copy_block(at, slot);
    return slot;
}

void WallPatch::fill(int slot)
{
    solved_[static_cast<std::size_t>(slot)] = 1;
    for (int from = 0; from < static_cast<int>(vertices_.size()); ++from) copy_block(slot, from);
}

}  // namespace seldinger
