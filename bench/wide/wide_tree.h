#pragma once
// The wall's tree with eight children to a node, for queries that test them side by side (bench/wide/wide_walk.h). Made from
// the binary tree where such queries are asked; its result is the same.

#include "wide/wide_types.h"

#include <vector>

namespace seldinger {

struct WallTree;

struct WideTree {
    std::vector<WideNode> nodes;  // root first, children behind their parent; empty without triangles
    std::vector<float> vertices;  // [9 T + 8], the triangles of the binary tree's leaf order, each leaf transposed
};

/// O(T), on two threads when the mesh is large enough to repay them. T < 2^28.
[[nodiscard]] WideTree build_wide_tree(const WallTree& tree);

}  // namespace seldinger
