#pragma once
// Order of elimination of a sparse symmetric matrix's graph.

#include <cstdint>
#include <vector>

namespace seldinger {

/// Undirected graph: neighbours of v are adjacent[first[v] .. first[v + 1]), v itself not among them.
struct Graph {
    std::vector<std::int32_t> first, adjacent;
    [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(first.size()) - 1; }
};

/// Nested dissection by levels of a breadth-first search from a far end [George73], which on a tube are rings about it; pieces of
/// up to `leaf` vertices by minimum degree. @return old vertex of each new one
[[nodiscard]] std::vector<std::int32_t> nested_dissection(const Graph& graph, int leaf = 60);
/// Approximate minimum degree (Eigen's).
[[nodiscard]] std::vector<std::int32_t> minimum_degree(const Graph& graph);

}  // namespace seldinger
