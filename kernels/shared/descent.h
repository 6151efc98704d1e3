// Walk down and up the wall's tree without a stack, in the tree's own order. A stack would lie in a graphics card's memory, 192
// bytes of each work-item. Children stand in pairs, the left one at an odd index, and inner nodes know their parents
// (tree_types.h).
#ifndef SEL_SHARED_DESCENT_H
#define SEL_SHARED_DESCENT_H
#include "shared/tree_types.h"

SEL_BEGIN

#define SEL_NO_NODE 0xffffffffu

typedef struct Descent {
    uint root;    // of the subtree
    uint at;      // the node to look at; SEL_NO_NODE: all have been seen
    uint parent;  // of `at`, unless that is the root
} Descent;

SEL_FN Descent descent_from(uint root)
{
    Descent way;
    way.root = way.at = root;
    way.parent = 0;
    return way;
}

SEL_FN void go_down(Descent* way, TreeNode node)
{
    way->parent = way->at;
    way->at = node.left_or_first;
}

// To the next node that is not below this one, in the tree's order.
SEL_FN void go_on(Descent* way, SEL_GLOBAL const TreeNode* nodes)
{
    while (way->at != way->root && SEL_IS_RIGHT(way->at)) {
        way->at = way->parent;
        way->parent = SEL_PARENT(nodes[way->at].count);
    }
    way->at = way->at == way->root ? SEL_NO_NODE : way->at + 1;
}

SEL_END
#endif
