// Blocks filled by the factors of band and far entries, in a given order of elimination.
#include "math/dissection.h"
#include "math/node_factors.h"

#include <algorithm>

namespace seldinger {
namespace {

std::uint64_t key_of(const FarEntries::Block& block)
{
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(block.row)) << 32 | static_cast<std::uint32_t>(block.col);
}

}  // namespace

/// Where one rod ends and the next begins the band has nothing.
void NodeFactors::find_joined(const BandRows& band)
{
    const int count = band.size() / width;
    joined_.assign(static_cast<std::size_t>(RodDofs::reach) * count, 0);
    for (int node = 0; node < count; ++node)
        for (int r = 0; r < width; ++r) {
            const double* diagonal = band.row(width * node + r) + BandRows::half_bandwidth - r;
            for (int ahead = 1; ahead <= RodDofs::reach; ++ahead)
                for (int c = 0; c < width; ++c) {
                    if (node + ahead < count && diagonal[width * ahead + c] != 0) joined_[RodDofs::reach * node + ahead - 1] = 1;
                    const bool inside = c - width * ahead >= r - BandRows::half_bandwidth;
                    if (node >= ahead && inside && diagonal[c - width * ahead] != 0)
                        joined_[RodDofs::reach * (node - ahead) + ahead - 1] = 1;
                }
        }
}

/// Whether the pattern is that of the last time.
bool NodeFactors::is_known(const FarEntries& far, std::span<const int> order) const
{
    const std::span<const FarEntries::Block> blocks = far.blocks();
    const bool same_order =
        order.empty() ? chosen_ : !chosen_ && std::equal(order.begin(), order.end(), order_.begin(), order_.end());
    return same_order && joined_ == known_joined_ &&
           std::equal(blocks.begin(), blocks.end(), known_.begin(), known_.end(),
                      [&](const FarEntries::Block& block, std::uint64_t known) { return key_of(block) == known; });
}

/// Minimum degree on the graph of joined nodes.
std::vector<int> NodeFactors::chosen_order(const FarEntries& far) const
{
    const int count = static_cast<int>(joined_.size()) / RodDofs::reach;
    std::vector<std::vector<std::int32_t>> beside(static_cast<std::size_t>(count));
    const auto join = [&](int a, int b) {
        if (a == b) return;
        beside[static_cast<std::size_t>(a)].push_back(b);
        beside[static_cast<std::size_t>(b)].push_back(a);
    };
    for (int node = 0; node < count; ++node)
        for (int ahead = 1; ahead <= RodDofs::reach; ++ahead)
            if (joined_[RodDofs::reach * node + ahead - 1]) join(node, node + ahead);
    for (const FarEntries::Block& block : far.blocks()) join(block.row, block.col);
    Graph graph;
    for (const auto& nodes : beside) {
        graph.first.push_back(static_cast<std::int32_t>(graph.adjacent.size()));
        graph.adjacent.insert(graph.adjacent.end(), nodes.begin(), nodes.end());
    }
    graph.first.push_back(static_cast<std::int32_t>(graph.adjacent.size()));
    return minimum_degree(graph);
}

/// Which blocks fill, unless that is known.
void NodeFactors::lay_out(const BandRows& band, const FarEntries& far, std::span<const int> order)
{
    find_joined(band);
    if (is_known(far, order)) return;
    const int count = band.size() / width;
    SEL_ASSERT(order.empty() || static_cast<int>(order.size()) == count);
    chosen_ = order.empty();
    if (chosen_) order_ = chosen_order(far);
    else order_.assign(order.begin(), order.end());
    place_.resize(count);
    for (int at = 0; at < count; ++at) place_[order_[at]] = at;
    known_.clear();
    for (const FarEntries::Block& block : far.blocks()) known_.push_back(key_of(block));
    known_joined_ = joined_;
    structure_.resize(std::max<std::size_t>(structure_.size(), count));
    for (auto& columns : structure_) columns.clear();
    const auto join = [&](int a, int b) {
        const auto [row, col] = std::minmax(place_[a], place_[b]);
        if (row != col) structure_[row].push_back(col);
    };
    for (int node = 0; node < count; ++node)
        for (int ahead = 1; ahead <= RodDofs::reach; ++ahead)
            if (joined_[RodDofs::reach * node + ahead - 1]) join(node, node + ahead);
    for (const FarEntries::Block& block : far.blocks()) join(block.row, block.col);
    find_pattern();
    find_targets();
}

/// Elimination tree: a row leaves its columns to the row of the first of them.
void NodeFactors::find_pattern()
{
    const int count = nodes();
    begin_.assign(1, 0);
    cols_.clear();
    for (int row = 0; row < count; ++row) {
        std::vector<int>& own = structure_[row];
        std::sort(own.begin(), own.end());
        own.erase(std::unique(own.begin(), own.end()), own.end());
        if (!own.empty()) structure_[own.front()].insert(structure_[own.front()].end(), own.begin() + 1, own.end());
        cols_.insert(cols_.end(), own.begin(), own.end());
        begin_.push_back(cols_.size());
    }
    diagonal_.resize(count);
    upper_.resize(cols_.size());
    scale_.resize(static_cast<std::size_t>(width) * count);
    x_.resize((count + width - 1) / width);
}

int NodeFactors::place_of(int row, int col) const
{
    const auto first = cols_.begin() + begin_[row], last = cols_.begin() + begin_[row + 1];
    return static_cast<int>(std::lower_bound(first, last, col) - cols_.begin());
}

/// Where the product of two columns of a row goes: the block of the row of the first of them and the column of the second.
void NodeFactors::find_targets()
{
    targets_.clear();
    target_begin_.clear();
    std::size_t most = 0;
    for (int row = 0; row < nodes(); ++row) {
        target_begin_.push_back(targets_.size());
        most = std::max(most, begin_[row + 1] - begin_[row]);
        for (std::size_t k = begin_[row]; k < begin_[row + 1]; ++k) {
            int at = static_cast<int>(begin_[cols_[k]]);
            for (std::size_t l = k + 1; l < begin_[row + 1]; ++l) {
                while (cols_[at] != cols_[l]) ++at;
                targets_.push_back(at);
            }
        }
    }
    scaled_.resize(most);
}

}  // namespace seldinger
