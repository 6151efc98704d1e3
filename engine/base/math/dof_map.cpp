// Order of a system's nodes.
#include "math/dof_map.h"

#include <algorithm>
#include <numeric>

namespace seldinger {

void DofMap::lay_out(std::span<const int> nodes, Order order, std::span<const double> from_hub)
{
    first_node_.assign(1, 0);
    for (const int count : nodes) first_node_.push_back(first_node_.back() + count);
    place_.clear();
    reach_ = RodDofs::reach;
    if (order == Order::Concatenated) return;

    SEL_ASSERT(static_cast<int>(from_hub.size()) == first_node_.back());
    std::vector<int> by_distance(from_hub.size());
    std::iota(by_distance.begin(), by_distance.end(), 0);
    std::stable_sort(by_distance.begin(), by_distance.end(), [&](int a, int b) { return from_hub[a] > from_hub[b]; });
    place_.resize(from_hub.size());
    for (std::size_t at = 0; at < by_distance.size(); ++at) place_[by_distance[at]] = static_cast<int>(at);
    for (int rod = 0; rod < rods(); ++rod)
        for (int i = first_node_[rod]; i < first_node_[rod + 1]; ++i) {
            const int last = std::min(i + RodDofs::reach, first_node_[rod + 1] - 1);
            reach_ = std::max(reach_, place_[last] - place_[i]);
        }
}

}  // namespace seldinger
