// Planes that bound the wall below inner nodes too, for nearest points far from the wall.
#include "core/parallel.h"
#include "vessel/tree.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr std::uint32_t kMostBounded = 4096;  // triangles below a node; a larger piece of a vessel's wall is bent too far
// A plane's normal is this much shorter than 1, and its offset this much of the tree's extent larger than the vertices need. The
// rounded distance to the plane is then never more than the rounded distance to a triangle.
constexpr double kShorter = 1e-6, kFarther = 1e-13;

struct Below {  // of a node
    std::uint32_t first = 0, end = 0;  // triangles, leaf order
    Vec3 area = Vec3::Zero();          // sum of their vectors
};

/// Children stand behind their parent, and cover its triangles one after the other.
std::vector<Below> gather(const WallTree& tree)
{
    std::vector<Below> below(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        const TreeNode& node = tree.nodes[i];
        Below& here = below[i];
        if (node.count == 0) {
            const Below &left = below[node.left_or_first], &right = below[node.left_or_first + 1];
            here = {left.first, right.end, left.area + right.area};
            continue;
        }
        here.first = node.left_or_first;
        here.end = here.first + SEL_LEAF_TRIANGLES(node.count);
        for (std::uint32_t k = here.first; k < here.end; ++k) here.area += double_area(tree.triangle(k));
    }
    return below;
}

TreeSlab plane_over(const WallTree& tree, const Below& below, double farther)
{
    TreeSlab slab{{0, 0, 0}, 0};
    const double length = below.area.norm();
    if (below.end - below.first > kMostBounded || !(length > 0)) return slab;
    for (int d = 0; d < 3; ++d) slab.normal[d] = static_cast<float>(below.area[d] / length * (1 - kShorter));
    const double x = slab.normal[0], y = slab.normal[1], z = slab.normal[2];
    double highest = -std::numeric_limits<double>::infinity();
    for (const float *v = &tree.vertices[9 * below.first], *end = v + 9 * (below.end - below.first); v != end; v += 3)
        highest = std::max(highest, x * v[0] + y * v[1] + z * v[2]);
    slab.highest = std::nextafter(static_cast<float>(highest + farther), std::numeric_limits<float>::infinity());
    return slab;
}

}  // namespace

void add_slabs(WallTree& tree)
{
    if (tree.nodes.empty()) return;
    const std::vector<Below> below = gather(tree);
    const TreeNode& all = tree.nodes[0];
    double extent = 0;
    for (int d = 0; d < 3; ++d) extent += static_cast<double>(all.hi[d]) - all.lo[d];
    tree.slabs.resize(tree.nodes.size());
    for_each_item(static_cast<int>(tree.nodes.size()), 1024, [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        tree.slabs[k] = plane_over(tree, below[k], kFarther * extent);
    });
}

}  // namespace seldinger
