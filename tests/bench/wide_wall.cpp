// The wall of the wide tree's tests.

#include "bench/wide_wall.h"

#include "vessel/tree.h"
#include "wide/bench_kernels.h"
#include "wide/wide_tree.h"

namespace seldinger::test {

const WideWall& wide_wall()
{
    static const WideWall wall = [] {
        add_bench_kernels();
        const ReferenceWall& from = reference_wall();
        WallTree tree;
        tree.nodes.resize(from.nodes.size() / sizeof(TreeNode));
        std::memcpy(tree.nodes.data(), from.nodes.data(), from.nodes.size());
        tree.vertices = from.vertices;
        tree.original.resize(from.triangles);
        const WideTree wide = build_wide_tree(tree);
        WideWall made;
        made.nodes.resize(wide.nodes.size() * sizeof(WideNode));
        std::memcpy(made.nodes.data(), wide.nodes.data(), made.nodes.size());
        made.vertices = wide.vertices;
        return made;
    }();
    return wall;
}

}  // namespace seldinger::test
