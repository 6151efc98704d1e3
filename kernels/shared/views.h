// What kernels read many arrays of, under one name each: the wall, the part of it near a quadrature point, the wires' nodes.
// Pointers in a struct that is passed by value to inlined functions cost nothing: the compiler takes it apart.
#ifndef SEL_SHARED_VIEWS_H
#define SEL_SHARED_VIEWS_H
#include "shared/tree_types.h"

SEL_BEGIN

// The wall, and the tree (bounding-volume hierarchy) over it.
typedef struct WallView {
    SEL_GLOBAL const TreeNode* nodes;  // of the tree, root first
    SEL_GLOBAL const float* vertices;  // [T][9] leaf order, relative to the mesh centre [m]
    SEL_GLOBAL const uint* boundary;   // [T] which edges and vertices lie on an opening, see on_boundary()
} WallView;

// Nodes of the tree that hold all of the wall near a quadrature point (walk.h).
typedef struct NearWallView {
    WallView wall;
    SEL_GLOBAL const uint* list;
    uint count;
} NearWallView;

SEL_FN NearWallView near_wall_view(WallView wall, SEL_GLOBAL const uint* list, uint count)
{
    const NearWallView near = {wall, list, count};
    return near;
}

// Positions of all wires' nodes as hi (float) + lo relative to the mesh centre, and the angle of the edge that begins at each.
typedef struct NodeView {
    SEL_GLOBAL const float* hi;    // [nodes][3] [m]
    SEL_GLOBAL const real* lo;     // [nodes][3] [m]
    SEL_GLOBAL const real* theta;  // [nodes] [rad]
} NodeView;

SEL_FN NodeView node_view(SEL_GLOBAL const float* hi, SEL_GLOBAL const real* lo, SEL_GLOBAL const real* theta)
{
    const NodeView nodes = {hi, lo, theta};
    return nodes;
}

// A point on an edge relative to the float position of the edge's first node, `origin`.
typedef struct AxisPoint {
    vec3 origin, offset, edge;  // [m]; edge: from node a to node b
} AxisPoint;

SEL_FN AxisPoint axis_point(uint node, real bary, NodeView nodes)
{
    AxisPoint point;
    const uint a = 3 * node;
    SEL_GLOBAL const float* hi = nodes.hi;
    SEL_GLOBAL const real* lo = nodes.lo;
    point.origin = make_vec3((real)hi[a], (real)hi[a + 1], (real)hi[a + 2]);
    const vec3 from = make_vec3(lo[a], lo[a + 1], lo[a + 2]);
    // as reals: a difference of floats would be rounded to 6e-8 of the edge, 0.3 nm that jump each time a node passes a float
    const vec3 to = make_vec3(((real)hi[a + 3] - (real)hi[a]) + lo[a + 3], ((real)hi[a + 4] - (real)hi[a + 1]) + lo[a + 4],
                              ((real)hi[a + 5] - (real)hi[a + 2]) + lo[a + 5]);
    point.edge = to - from;
    point.offset = from + bary * point.edge;
    return point;
}

// Arguments of a kernel that make a view, and the view: DeviceWall and DeviceNodes in engine/physics/contact set them in this
// order.
#ifndef __cplusplus
    #define SEL_WALL_ARGUMENTS                                                                      \
        __global const TreeNode *restrict wall_nodes, __global const float *restrict wall_vertices, \
            __global const uint *restrict wall_boundary
    #define SEL_WALL wall_view(wall_nodes, wall_vertices, wall_boundary)
    #define SEL_NODE_ARGUMENTS(at) \
        __global const float *restrict at##_hi, __global const real *restrict at##_lo, __global const real *restrict at##_theta
    #define SEL_NODES(at) node_view(at##_hi, at##_lo, at##_theta)
#endif

SEL_FN WallView wall_view(SEL_GLOBAL const TreeNode* nodes, SEL_GLOBAL const float* vertices, SEL_GLOBAL const uint* boundary)
{
    const WallView wall = {nodes, vertices, boundary};
    return wall;
}

SEL_END
#endif
