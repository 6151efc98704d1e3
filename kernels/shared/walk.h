// Walks through small subtrees of the wall's tree (below nodes not much larger than the wire is thick), leaf by leaf, in the
// tree's own order. A quadrature point keeps a list of the tree's nodes near it. Every evaluation walks through these alone, and
// leaves out distant ones. So the lists are as long for three million triangles as for thirty thousand, and an evaluation as many
// box tests deep (a few more levels). Results are the same as if every triangle below the listed nodes had been tested, in the
// same order.
#ifndef SEL_SHARED_WALK_H
#define SEL_SHARED_WALK_H
#include "shared/tree_types.h"
#include "shared/triangle.h"
#include "shared/views.h"

SEL_BEGIN

// Walk down and up the wall's tree without a stack, in the tree's own order. A stack would lie in a graphics card's memory, 192
// bytes of each work-item. Children stand in pairs, the left one at an odd index, and inner nodes know their parents
// (tree_types.h).

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

// A listed node is a leaf, or at most this many radii long in any direction.
#define SEL_NEAR_CELL_SIZE 2

// Leaves out boxes by rounded distances: by this fraction too few, so that none is left out that a triangle's own rounded
// distance admits.
#ifdef SEL_FLOAT32
    #define SEL_WALK_MARGIN ((real)1e-4)
#else
    #define SEL_WALK_MARGIN ((real)1e-6)
#endif

typedef struct Walk {
    Descent way;
    uint triangle, end;  // of the leaf that is looked at
    uint next;           // of the cells
} Walk;

SEL_FN void start_walk(Walk* walk)
{
    walk->way = descent_from(SEL_NO_NODE);
    walk->next = walk->triangle = walk->end = 0;
}

// Least squared distance from p to a box; p and the box relative to `origin`.
SEL_FN real box_near2(vec3 p, TreeNode box, vec3 origin)
{
    const real x = max_r(max_r(((real)box.lo[0] - origin.x) - p.x, p.x - ((real)box.hi[0] - origin.x)), 0);
    const real y = max_r(max_r(((real)box.lo[1] - origin.y) - p.y, p.y - ((real)box.hi[1] - origin.y)), 0);
    const real z = max_r(max_r(((real)box.lo[2] - origin.z) - p.z, p.z - ((real)box.hi[2] - origin.z)), 0);
    return x * x + y * y + z * z;
}

// How far a box reaches along `side` beyond p, at most.
SEL_FN real box_beyond(vec3 p, TreeNode box, vec3 origin, vec3 side)
{
    const real x = (side.x > 0 ? (real)box.hi[0] : (real)box.lo[0]) - origin.x - p.x;
    const real y = (side.y > 0 ? (real)box.hi[1] : (real)box.lo[1]) - origin.y - p.y;
    const real z = (side.z > 0 ? (real)box.hi[2] : (real)box.lo[2]) - origin.z - p.z;
    return x * side.x + y * side.y + z * side.z;
}

// Is everything in the leaf's slab, and within the half diagonal of its box from the box's centre, farther from p than `range`?
// With h the height of p over the slab's middle and l its distance from the centre along the slab: yes when
//     up^2 + aside^2 > range^2,   up = |h| - thickness/2,   aside = l - rho   (each not below 0).
// One division and no root.
SEL_FN int slab_beyond(vec3 p, TreeNode leaf, vec3 origin, real range)
{
    const real ex = (real)0.5 * ((real)leaf.hi[0] - (real)leaf.lo[0]), ey = (real)0.5 * ((real)leaf.hi[1] - (real)leaf.lo[1]),
               ez = (real)0.5 * ((real)leaf.hi[2] - (real)leaf.lo[2]);
    const vec3 q = make_vec3(p.x - ((real)leaf.lo[0] - origin.x) - ex, p.y - ((real)leaf.lo[1] - origin.y) - ey,
                             p.z - ((real)leaf.lo[2] - origin.z) - ez);
    const real a = SEL_SLAB_TURN((leaf.count >> 3) & 1023u), b = SEL_SLAB_TURN((leaf.count >> 13) & 1023u), c = a * a + b * b;
    const real h = (2 * (a * q.x + b * q.y) + (1 - c) * q.z) / (1 + c);
    const real up = max_r(fabs(h) - SEL_SLAB_HEIGHT(leaf.count, ex + ey + ez), 0), left2 = range * range - up * up;
    if (left2 < 0) return 1;
    const real rho2 = ex * ex + ey * ey + ez * ez, aside2 = dot3(q, q) - h * h - rho2 - left2;  // l > rho + sqrt(left2)?
    return aside2 > 0 && aside2 * aside2 > 4 * rho2 * left2;
}

// Target of the search: all within `range` of p that, unless it is within `shell`, reaches beyond p along `side`.
typedef struct WallQuery {
    vec3 p, origin;  // p relative to origin
    real range, shell;
    vec3 side;
} WallQuery;

// All within `range`.
SEL_FN WallQuery ball_query(vec3 p, vec3 origin, real range)
{
    const WallQuery query = {p, origin, range, range, make_vec3(0, 0, 0)};
    return query;
}

// The next leaf that the query asks for. @return found one
SEL_FN int next_leaf(Walk* walk, NearWallView near, WallQuery query, TreeNode* leaf)
{
    const real range2 = query.range * query.range, shell2 = query.shell * query.shell;
    for (;;) {
        if (walk->way.at == SEL_NO_NODE) {
            if (walk->next == near.count) return 0;
            walk->way = descent_from(near.list[walk->next++]);
        }
        const TreeNode node = near.wall.nodes[walk->way.at];
        const real d2 = box_near2(query.p, node, query.origin);
        int aside = 0, skip = d2 > range2;
        if (!skip) {
            aside = query.shell < query.range && box_beyond(query.p, node, query.origin, query.side) < 0;
            skip = aside && d2 > shell2;
        }
        if (!skip && SEL_IS_INNER(node.count)) {
            go_down(&walk->way, node);
            continue;
        }
        go_on(&walk->way, near.wall.nodes);
        if (skip || (SEL_HAS_SLAB(node.count) && slab_beyond(query.p, node, query.origin, aside ? query.shell : query.range)))
            continue;
        leaf->left_or_first = node.left_or_first;
        leaf->count = SEL_LEAF_TRIANGLES(node.count);
        return 1;
    }
}

// The next triangle of the leaves that the query needs, whose range may become narrower during the walk. @return found one
SEL_FN int next_triangle(Walk* walk, NearWallView near, WallQuery query, uint* t)
{
    if (walk->triangle == walk->end) {
        TreeNode leaf;
        if (!next_leaf(walk, near, query, &leaf)) return 0;
        walk->triangle = leaf.left_or_first;
        walk->end = leaf.left_or_first + leaf.count;
    }
    *t = walk->triangle++;
    return 1;
}

// Squared distance from p to triangle t, both relative to `origin`.
SEL_FN real triangle_distance2(vec3 p, vec3 origin, uint t, SEL_GLOBAL const float* vertices)
{
    int feature;
    const vec3 v = p - closest_on_triangle(p, load_triangle(vertices, t, origin), &feature);
    return dot3(v, v);
}

// Is there a triangle within `range` of p in the subtree below `node`?
SEL_FN int any_within(uint node, vec3 p, vec3 origin, real range, WallView wall)
{
    const real range2 = range * range;
    Descent way = descent_from(node);
    while (way.at != SEL_NO_NODE) {
        const TreeNode box = wall.nodes[way.at];
        const int skip = box_near2(p, box, origin) > range2;
        if (!skip && SEL_IS_INNER(box.count)) {
            go_down(&way, box);
            continue;
        }
        go_on(&way, wall.nodes);
        if (skip || (SEL_HAS_SLAB(box.count) && slab_beyond(p, box, origin, range))) continue;
        for (uint k = 0; k < SEL_LEAF_TRIANGLES(box.count); ++k)
            if (triangle_distance2(p, origin, box.left_or_first + k, wall.vertices) <= range2) return 1;
    }
    return 0;
}

SEL_FN int is_longer(TreeNode node, real size)
{
    const real x = (real)node.hi[0] - (real)node.lo[0], y = (real)node.hi[1] - (real)node.lo[1],
               z = (real)node.hi[2] - (real)node.lo[2];
    return x > size || y > size || z > size;
}

// Nodes of at most `size` that hold every triangle within `range` of p (relative to `origin`), in the tree's own order.
// Writes at most `slots` of them; @return how many there are; 0 where no triangle is within range, however near the boxes are
SEL_PART uint find_near_cells(AxisPoint at, real range, real size, WallView wall, uint slots, SEL_GLOBAL uint* found)
{
    const real range2 = range * range;
    Descent way = descent_from(0);
    uint count = 0;
    int any = 0;
    while (way.at != SEL_NO_NODE) {
        const uint index = way.at;
        const TreeNode node = wall.nodes[index];
        const int skip = box_near2(at.offset, node, at.origin) > range2;
        if (!skip && SEL_IS_INNER(node.count) && is_longer(node, size)) {
            go_down(&way, node);
            continue;
        }
        go_on(&way, wall.nodes);
        if (skip) continue;
        if (!any) any = any_within(index, at.offset, at.origin, range, wall);
        if (count < slots) found[count] = index;
        ++count;
    }
    return any ? count : 0;
}

SEL_END
#endif
