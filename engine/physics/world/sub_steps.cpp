// The list of sub-steps of a step, and the masks of the systems that take part.
#include "world/sub_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace seldinger {
namespace {

// A step holds some four masks, a halved one four more at each level.
constexpr std::size_t spare_masks = 8;  // for a step that is halved once

std::vector<std::vector<std::uint8_t>>& mask_pool()
{
    thread_local std::vector<std::vector<std::uint8_t>> pool;
    return pool;
}

}  // namespace

std::vector<std::uint8_t> WireMask::borrow()
{
    auto& pool = mask_pool();
    if (pool.empty()) return {};
    std::vector<std::uint8_t> bytes = std::move(pool.back());
    pool.pop_back();
    return bytes;
}

void WireMask::give_back()
{
    if (bytes_.capacity() > 0) mask_pool().push_back(std::move(bytes_));
}

bool WireMask::any() const { return std::find(bytes_.begin(), bytes_.end(), 1) != bytes_.end(); }

void SubSteps::add(double length, const WireMask& wires, int parts, SubStep::After after)
{
    pending_.push_back({length / parts, wires, 0, parts, after});
}

void SubSteps::begin(double dt, const WireMask& wires, std::span<const StepParts> parts)
{
    lost_ = WireMask(wires.size());
    pending_.clear();
    WireMask left = wires;
    for (std::size_t w = 0; w < wires.size(); ++w) {  // all that go in as many parts go together
        if (!left[w]) continue;
        WireMask together(wires.size());
        for (std::size_t other = w; other < wires.size(); ++other)
            if (left[other] && parts[other] == parts[w]) together[other] = 1, left[other] = 0;
        const auto [count, cut] = parts[w];
        if (!(cut > 0 && cut < dt)) {
            add(dt, together, count, SubStep::After::Nothing);
            continue;
        }
        const int before = std::clamp(static_cast<int>(std::ceil(count * cut / dt)), 1, count);
        add(cut, together, before, SubStep::After::Nothing);
        add(dt - cut, together, std::clamp(static_cast<int>(std::ceil(count * (dt - cut) / dt)), 1, count), SubStep::After::Part);
    }
    std::reverse(pending_.begin(), pending_.end());
    // a first halving may come after thousands of steps that went well
    pending_.reserve(pending_.size() + most_halvings + 1);
    auto& pool = mask_pool();
    pool.resize(std::max(pool.size(), spare_masks));
    for (auto& mask : pool) mask.reserve(wires.size());
}

const SubStep* SubSteps::next()
{
    while (!pending_.empty()) {
        now_ = std::move(pending_.back());
        pending_.pop_back();
        for (std::size_t w = 0; w < lost_.size(); ++w)
            if (lost_[w]) now_.wires[w] = 0;
        if (!now_.wires.any()) continue;
        if (now_.parts > 1) pending_.push_back({now_.h, now_.wires, 0, now_.parts - 1, SubStep::After::Part});
        return &now_;
    }
    return nullptr;
}

void SubSteps::halve(const WireMask& wires)
{
    if (!wires.any()) return;
    const int halvings = now_.halvings + 1;
    pending_.push_back({now_.h / 2, wires, halvings, 1, SubStep::After::Half});
    pending_.push_back({now_.h / 2, wires, halvings, 1, SubStep::After::Nothing});
}

void SubSteps::again(const WireMask& wires)
{
    if (wires.any()) pending_.push_back({now_.h, wires, now_.halvings, 1, SubStep::After::Nothing});
}

void SubSteps::lose(const WireMask& wires)
{
    for (std::size_t w = 0; w < lost_.size(); ++w) lost_[w] = lost_[w] || wires[w];
}

}  // namespace seldinger
