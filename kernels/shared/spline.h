// The axis of a rod as a smooth curve: the quadratic B-spline of its nodes. Instruments slide along each other; over the corners
// of a polygon a wire would run as over a ratchet, on a curve with a continuous tangent it does not.
//
// The curve goes through the middles of the edges, along the edges there; between the middles of edges i - 1 and i it is
//
//     c(t) = (1 - t)^2/2 x_{i-1} + (1/2 + t - t^2) x_i + t^2/2 x_{i+1},       t in [0, 1],
//
// and from the ends of the rod to the first and last middle it is straight. One coordinate, `at`, runs along it: at = i at node
// i, i + 1/2 at the middle of edge i, t = at - i + 1/2. Material coordinates of the curve are the same spline of those of the
// nodes, so that a point of the curve is a point of the material, with weights that do not change while the nodes stand.
#ifndef SEL_SHARED_SPLINE_H
#define SEL_SHARED_SPLINE_H
#include "shared/portable.h"

SEL_BEGIN

// Nodes of one rod at one time, first node at the tip.
typedef struct SplineView {
    SEL_GLOBAL const real* position;  // [count][3] [m]
    SEL_GLOBAL const real* material;  // [count] [m]
    SEL_GLOBAL const real* theta;     // [count] of the edge that begins at each [rad]
    uint count;
} SplineView;

// Three nodes and their weights: of the point, its derivative and its second derivative with `at`.
typedef struct SplinePlace {
    uint node;  // the first of the three; a weight of 0 may stand for a node that is not there
    real w[3], d[3], c[3];
} SplinePlace;

SEL_FN SplinePlace straight_place(uint node, uint from, real t)
{
    SplinePlace p;
    p.node = node;
    for (uint k = 0; k < 3; ++k) p.w[k] = p.d[k] = p.c[k] = 0;
    p.w[from] = 1 - t;
    p.w[from + 1] = t;
    p.d[from] = -1;
    p.d[from + 1] = 1;
    return p;
}

SEL_FN SplinePlace spline_place(real at, uint count)
{
    if (count < 3 || at <= (real)0.5) return straight_place(0, 0, at);
    const real end = (real)count - (real)1.5;
    if (at >= end) return straight_place(count - 3, 1, at - (real)(count - 2));
    const uint node = (uint)(at + (real)0.5);
    const real t = at - ((real)node - (real)0.5);
    SplinePlace p;
    p.node = node - 1;
    p.w[0] = (real)0.5 * (1 - t) * (1 - t);
    p.w[1] = (real)0.5 + t * (1 - t);
    p.w[2] = (real)0.5 * t * t;
    p.d[0] = t - 1;
    p.d[1] = 1 - 2 * t;
    p.d[2] = t;
    p.c[0] = p.c[2] = 1;
    p.c[1] = -2;
    return p;
}

SEL_FN vec3 node_at(SplineView rod, uint i)
{
    return make_vec3(rod.position[3 * i], rod.position[3 * i + 1], rod.position[3 * i + 2]);
}

// sum of weight times node. Nodes without weight are not looked at.
SEL_FN vec3 spline_sum(SplineView rod, uint node, const real* weight)
{
    vec3 sum = make_vec3(0, 0, 0);
    for (uint k = 0; k < 3; ++k)
        if (weight[k] != 0) sum = sum + weight[k] * node_at(rod, node + k);
    return sum;
}

SEL_FN real spline_material(SplineView rod, real at)
{
    const SplinePlace p = spline_place(at, rod.count);
    real s = 0;
    for (uint k = 0; k < 3; ++k)
        if (p.w[k] != 0) s += p.w[k] * rod.material[p.node + k];
    return s;
}

// The edge that holds a material point: of what turns about its tangent there.
SEL_FN uint edge_of_material(SplineView rod, real s)
{
    uint low = 0, high = rod.count - 1;
    while (high - low > 1) {
        const uint middle = (low + high) / 2;
        if (s < rod.material[middle]) high = middle;
        else low = middle;
    }
    return low;
}

// `at` of a material point; of the ends beyond them.
SEL_FN real spline_at(SplineView rod, real s)
{
    const uint edge = edge_of_material(rod, s);
    const real from = rod.material[edge], to = rod.material[edge + 1], middle = (real)0.5 * (from + to);
    const int left = s < middle;
    if ((left && edge == 0) || (!left && edge + 2 >= rod.count)) return (real)edge + clamp_r((s - from) / (to - from), 0, 1);
    const uint node = left ? edge : edge + 1;  // whose piece it is
    const real before = rod.material[node] - rod.material[node - 1], after = rod.material[node + 1] - rod.material[node];
    const real way = s - (real)0.5 * (rod.material[node - 1] + rod.material[node]);
    const real root = sqrt(max_r(before * before + 2 * (after - before) * way, 0));
    return (real)node - (real)0.5 + clamp_r(2 * way / (before + root), 0, 1);
}

// Where on the curve a point's distance is least, near where it is looked for.
typedef struct Closest {
    real at;
    int bound;  // -1, 1: at the lower, the upper end of what was allowed, and it would go on; 0: a minimum
} Closest;

#define SEL_CLOSEST_STEPS 40
#define SEL_CLOSEST_ENOUGH ((real)1e-12)  // of an edge

// Newton's method on -(x - c) . c' = 0, downhill from `start`, no farther than an edge at once; what it has seen of the sign
// holds it, so that it cannot go round in circles where the curvature jumps. @param low, high  of what is allowed
SEL_FN Closest closest_on(SplineView rod, vec3 x, real start, real low, real high)
{
    Closest found;
    real least = low, most = high;
    found.at = clamp_r(start, low, high);
    found.bound = 0;
    for (int k = 0; k < SEL_CLOSEST_STEPS; ++k) {
        const SplinePlace p = spline_place(found.at, rod.count);
        const vec3 away = x - spline_sum(rod, p.node, p.w), along = spline_sum(rod, p.node, p.d);
        const real slope = -dot3(away, along), square = dot3(along, along);
        if (slope > 0) most = found.at;
        else least = found.at;
        if (slope > 0 && found.at <= low) {
            found.bound = -1;
            return found;
        }
        if (slope < 0 && found.at >= high) {
            found.bound = 1;
            return found;
        }
        const real curved = square - dot3(away, spline_sum(rod, p.node, p.c));
        real step = -slope / (curved > (real)0.05 * square ? curved : square);
        step = clamp_r(step, -1, 1);
        real next = found.at + step;
        if (next >= most && most < high) next = (real)0.5 * (found.at + most);
        if (next <= least && least > low) next = (real)0.5 * (found.at + least);
        next = clamp_r(next, low, high);
        const real moved = fabs(next - found.at);
        found.at = next;
        if (moved < SEL_CLOSEST_ENOUGH && next > low && next < high) return found;
    }
    return found;
}

SEL_END
#endif
