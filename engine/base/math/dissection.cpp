// Nested dissection: halves of a graph, a level of a breadth-first search between them, and so on.
#include "math/dissection.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstdlib>

namespace seldinger {

std::vector<std::int32_t> minimum_degree(const Graph& graph)
{
    std::vector<Eigen::Triplet<double>> entries;
    for (std::int32_t v = 0; v < graph.size(); ++v) {
        entries.emplace_back(v, v, 1);
        for (auto k = graph.first[static_cast<std::size_t>(v)]; k < graph.first[static_cast<std::size_t>(v) + 1]; ++k)
            entries.emplace_back(graph.adjacent[static_cast<std::size_t>(k)], v, 1);
    }
    Eigen::SparseMatrix<double> pattern(graph.size(), graph.size());
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), order);
    return {order.indices().data(), order.indices().data() + order.indices().size()};
}

namespace {

class Dissection {
public:
    Dissection(const Graph& graph, int leaf)
        : graph_(graph), leaf_(leaf), part_(static_cast<std::size_t>(graph.size()), 0), level_(part_)
    {
        std::vector<std::int32_t> all(part_.size());
        for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<std::int32_t>(v);
        split(all);
    }
    std::vector<std::int32_t> order;

private:
    /// Breadth-first levels of the component of `start` within part `part`; visited vertices in order.
    std::vector<std::int32_t> search(std::int32_t start, std::int32_t part)
    {
        std::vector<std::int32_t> seen = {start};
        level_[static_cast<std::size_t>(start)] = 0;
        const std::int32_t mark = ++parts_;
        part_[static_cast<std::size_t>(start)] = mark;
        for (std::size_t next = 0; next < seen.size(); ++next) {
            const auto v = static_cast<std::size_t>(seen[next]);
            for (auto k = graph_.first[v]; k < graph_.first[v + 1]; ++k) {
                const auto w = static_cast<std::size_t>(graph_.adjacent[static_cast<std::size_t>(k)]);
                if (part_[w] != part) continue;
                part_[w] = mark;
                level_[w] = level_[v] + 1;
                seen.push_back(static_cast<std::int32_t>(w));
            }
        }
        return seen;
    }
    void finish(const std::vector<std::int32_t>& piece)
    {
        Graph small{{0}, {}};
        for (std::size_t i = 0; i < piece.size(); ++i) level_[static_cast<std::size_t>(piece[i])] = static_cast<std::int32_t>(i);
        const std::int32_t mark = ++parts_;
        for (const std::int32_t v : piece) part_[static_cast<std::size_t>(v)] = mark;
        for (const std::int32_t v : piece) {
            for (auto k = graph_.first[static_cast<std::size_t>(v)]; k < graph_.first[static_cast<std::size_t>(v) + 1]; ++k) {
                const auto w = static_cast<std::size_t>(graph_.adjacent[static_cast<std::size_t>(k)]);
                if (part_[w] == mark) small.adjacent.push_back(level_[w]);
            }
            small.first.push_back(static_cast<std::int32_t>(small.adjacent.size()));
        }
        for (const std::int32_t i : minimum_degree(small)) order.push_back(piece[static_cast<std::size_t>(i)]);
        for (const std::int32_t v : piece) part_[static_cast<std::size_t>(v)] = -1;
    }
    void split(const std::vector<std::int32_t>& piece)
    {
        if (piece.empty()) return;
        if (static_cast<int>(piece.size()) <= leaf_) return finish(piece);
        const std::int32_t mark = ++parts_;
        for (const std::int32_t v : piece) part_[static_cast<std::size_t>(v)] = mark;
        // a far end: two searches, each from where the one before ended
        std::vector<std::int32_t> seen = search(piece.front(), mark);
        if (seen.size() < piece.size()) {  // several components: one after another
            std::vector<std::int32_t> rest;
            for (const std::int32_t v : piece)
                if (part_[static_cast<std::size_t>(v)] == mark) rest.push_back(v);
            split(seen), split(rest);
            return;
        }
        for (int again = 0; again < 2; ++again) seen = search(seen.back(), part_[static_cast<std::size_t>(seen.back())]);
        // the thinnest level between 1/3 and 2/3, those in the middle first
        const std::int32_t last = level_[static_cast<std::size_t>(seen.back())];
        std::vector<std::int32_t> count(static_cast<std::size_t>(last) + 1, 0);
        for (const std::int32_t v : seen) ++count[static_cast<std::size_t>(level_[static_cast<std::size_t>(v)])];
        std::int32_t best = -1, before = 0;
        double cost = 0;
        for (std::int32_t l = 0; l <= last; ++l) {
            const std::int32_t here = count[static_cast<std::size_t>(l)],
                               after = static_cast<std::int32_t>(seen.size()) - before - here;
            const double uneven = std::abs(before - after) / static_cast<double>(seen.size());
            const double c = here * (1 + uneven);
            if (before > 0 && after > 0 && uneven < 0.5 && (best < 0 || c < cost)) best = l, cost = c;
            before += here;
        }
        if (best < 0) return finish(piece);
        std::vector<std::int32_t> low, high, between;
        for (const std::int32_t v : seen) {
            const std::int32_t l = level_[static_cast<std::size_t>(v)];
            (l < best ? low : l > best ? high : between).push_back(v);
        }
        split(low), split(high);
        order.insert(order.end(), between.begin(), between.end());
    }

    const Graph& graph_;
    int leaf_;
    std::int32_t parts_ = 0;
    std::vector<std::int32_t> part_, level_;
};

}  // namespace

std::vector<std::int32_t> nested_dissection(const Graph& graph, int leaf) { return Dissection(graph, leaf).order; }

}  // namespace seldinger
