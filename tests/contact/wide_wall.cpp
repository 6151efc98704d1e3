// Builds the twin tests' wall as a wide tree, once.
#include "contact/wide_wall.h"

#include "vessel/tree.h"
#include "vessel/wide_tree.h"

namespace seldinger::test {

const WideWall& wide_wall()
{
    static const WideWall wall = [] {
        const TwinWall& from = twin_wall();
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
