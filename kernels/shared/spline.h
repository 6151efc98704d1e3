// The axis of a rod as a smooth curve: the quadratic B-spline of its nodes. Instruments slide along each other; over the corners
// of a polygon a wire would run as over a ratchet, on a curve with a continuous tangent it does not.
//
// The curve goes through the middles of the edges, along the edges there; between the middles of edges i - 1 and i it is
//
//     c(t) = (1 - t)^2/2 x_{i-1} + (1/2 + t - t^2) x_i + t^2/2 x_{i+1},       t in [0, 1],
//
// and from the ends of the rod to the first and last middle it is straight. One coordinate, `at`, runs along it: at = i at node
// i, i + 1/2 at the middle of edge i, t = at - i + 1/2. Material coordinates of the curve are the same spline of those of the
// nodes. So a point of the curve is a point of the material, with constant weights while the nodes do not change.
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

// sum of weight times node. Nodes without weight are skipped.
SEL_STAGE_CALL vec3 weighted_nodes(SEL_GLOBAL const real* position, uint node, real w0, real w1, real w2)
{
    const real weight[3] = {w0, w1, w2};
    vec3 sum = make_vec3(0, 0, 0);
    for (uint k = 0; k < 3; ++k) {
        SEL_GLOBAL const real* x = position + 3 * (node + k);
        if (weight[k] != 0) sum = sum + weight[k] * make_vec3(x[0], x[1], x[2]);
    }
    return sum;
}

SEL_FN vec3 spline_sum(SplineView rod, uint node, const real* weight)
{
    return weighted_nodes(rod.position, node, weight[0], weight[1], weight[2]);
}

SEL_STAGE_CALL real material_at(SEL_GLOBAL const real* material, uint count, real at)
{
    const SplinePlace p = spline_place(at, count);
    real s = 0;
    for (uint k = 0; k < 3; ++k)
        if (p.w[k] != 0) s += p.w[k] * material[p.node + k];
    return s;
}

SEL_FN real spline_material(SplineView rod, real at) { return material_at(rod.material, rod.count, at); }

// Spins of the first two of a place's nodes, those of the two edges whose middles it lies between. Their weights, by the position
// between these, are the derivative's. (The spin of the edge that a point lies on would jump as the point slides from one to the
// next.)
SEL_FN real first_spin(const real* d) { return -d[0]; }
SEL_FN real second_spin(const real* d) { return d[2]; }

SEL_FN real spline_spin(SplineView rod, SplinePlace p)
{
    const real first = first_spin(p.d), second = second_spin(p.d);
    return (first != 0 ? first * rod.theta[p.node] : (real)0) + (second != 0 ? second * rod.theta[p.node + 1] : (real)0);
}

// The edge that holds a material point.
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

// The same, looked for from an edge that is near.
SEL_FN uint edge_near(SplineView rod, real s, uint from)
{
    uint edge = from < rod.count - 1 ? from : rod.count - 2;
    while (edge > 0 && s < rod.material[edge]) --edge;
    while (edge + 2 < rod.count && s >= rod.material[edge + 1]) ++edge;
    return edge;
}

// `at` of a material point on an edge; of the ends beyond them.
SEL_FN real spline_at_edge(SplineView rod, real s, uint edge)
{
    const real from = rod.material[edge], to = rod.material[edge + 1], middle = (real)0.5 * (from + to);
    const int left = s < middle;
    if ((left && edge == 0) || (!left && edge + 2 >= rod.count)) return (real)edge + clamp_r((s - from) / (to - from), 0, 1);
    const uint node = left ? edge : edge + 1;  // whose piece it is
    const real before = rod.material[node] - rod.material[node - 1], after = rod.material[node + 1] - rod.material[node];
    const real way = s - (real)0.5 * (rod.material[node - 1] + rod.material[node]);
    const real root = sqrt(max_r(before * before + 2 * (after - before) * way, 0));
    return (real)node - (real)0.5 + clamp_r(2 * way / (before + root), 0, 1);
}

SEL_STAGE_CALL real place_of_material(SEL_GLOBAL const real* material, uint count, real s)
{
    SplineView rod;
    rod.material = material;
    rod.count = count;
    return spline_at_edge(rod, s, edge_of_material(rod, s));
}

SEL_STAGE_CALL real place_of_material_near(SEL_GLOBAL const real* material, uint count, real s, uint from)
{
    SplineView rod;
    rod.material = material;
    rod.count = count;
    return spline_at_edge(rod, s, edge_near(rod, s, from));
}

SEL_FN real spline_at(SplineView rod, real s) { return place_of_material(rod.material, rod.count, s); }
SEL_FN real spline_at_near(SplineView rod, real s, uint from) { return place_of_material_near(rod.material, rod.count, s, from); }

// Where on the curve a point's distance is least, near where it is looked for.
typedef struct Closest {
    real at;
    int bound;  // -1, 1: at the lower, the upper end of what was allowed, and it would go on; 0: a minimum
} Closest;

#define SEL_CLOSEST_STEPS 40
#define SEL_CLOSEST_ENOUGH ((real)1e-12)  // of an edge
#define SEL_CLOSEST_NEAR ((real)1e-7)  // of an edge: its square, which a Newton step within a piece leaves, is less than enough

// One piece of the curve seen from a point x: with c = c_0 + c_1 t + c_2 t^2 and r = x - c_0
//     slope   -(x - c) . c'  = -r.c_1 + (c_1.c_1 - 2 r.c_2) t + 3 c_1.c_2 t^2 + 2 c_2.c_2 t^3,    t = at - origin,
//     square  c' . c'        = c_1.c_1 + 4 c_1.c_2 t + 4 c_2.c_2 t^2
typedef struct SeenPiece {
    real low, high, origin;                    // holds for low <= at < high
    real first, linear, c1_c1, c1_c2, c2_c2;  // first, linear: of the slope
    real r_r;                                 // r . r: with the slope's coefficients |x - c|^2
} SeenPiece;

SEL_FN SeenPiece seen_piece(SplineView rod, vec3 x, real at)
{
    SeenPiece piece;
    const real end = (real)rod.count - (real)1.5;
    vec3 c0, c1, c2 = make_vec3(0, 0, 0);
    if (rod.count < 3 || at <= (real)0.5 || at >= end) {
        const int begins = rod.count < 3 || at <= (real)0.5;
        const uint node = begins ? 0 : rod.count - 2;
        piece.low = begins ? (real)-1 : end;
        piece.high = begins && rod.count > 2 ? (real)0.5 : (real)rod.count;
        piece.origin = (real)node;
        c0 = node_at(rod, node);
        c1 = node_at(rod, node + 1) - c0;
    } else {
        const uint node = (uint)(at + (real)0.5);
        const vec3 before = node_at(rod, node - 1), x_i = node_at(rod, node), after = node_at(rod, node + 1);
        piece.low = piece.origin = (real)node - (real)0.5;
        piece.high = (real)node + (real)0.5;
        c0 = (real)0.5 * (before + x_i);
        c1 = x_i - before;
        c2 = (real)0.5 * (after - x_i - c1);
    }
    const vec3 r = x - c0;
    piece.c1_c1 = dot3(c1, c1);
    piece.c1_c2 = dot3(c1, c2);
    piece.c2_c2 = dot3(c2, c2);
    piece.r_r = dot3(r, r);
    piece.first = -dot3(r, c1);
    piece.linear = piece.c1_c1 - 2 * dot3(r, c2);
    return piece;
}

#define SEL_CLOSEST_PLAIN 4  // steps

// Newton's method alone, while it stays on one piece: most searches begin near the place, and take two steps.
// @return 0: it does not lead there, and nothing is found
SEL_FN int closest_on_piece(SeenPiece piece, real low, real high, real* place)
{
    const real from = max_r(low, piece.low), until = min_r(high, piece.high);
    real at = *place;
    for (int k = 0; k < SEL_CLOSEST_PLAIN; ++k) {
        const real t = at - piece.origin, bulge = piece.c1_c2 + piece.c2_c2 * t;
        const real slope = piece.first + (piece.linear + (bulge + 2 * piece.c1_c2 + piece.c2_c2 * t) * t) * t;
        const real curved = piece.linear + 6 * bulge * t, moved = slope / curved;
        at -= moved;
        if (!(curved > (real)0.05 * (piece.c1_c1 + 4 * bulge * t) && at > from && at < until)) return 0;
        if (fabs(moved) < SEL_CLOSEST_NEAR) {
            *place = at;
            return 1;
        }
    }
    return 0;
}

// Newton's method on -(x - c) . c' = 0, downhill from `start`, by at most an edge at once. Known signs bracket the solution, so
// it cannot run in circles where the curvature jumps. @param low, high  of the permitted range
SEL_FN Closest closest_on(SplineView rod, vec3 x, real start, real low, real high)
{
    Closest found;
    real least = low, most = high;
    found.at = clamp_r(start, low, high);
    found.bound = 0;
    SeenPiece piece = seen_piece(rod, x, found.at);
    if (closest_on_piece(piece, low, high, &found.at)) return found;
    for (int k = 0; k < SEL_CLOSEST_STEPS; ++k) {
        if (found.at < piece.low || found.at >= piece.high) piece = seen_piece(rod, x, found.at);
        const real t = found.at - piece.origin, bulge = piece.c1_c2 + piece.c2_c2 * t;
        const real slope = piece.first + (piece.linear + (bulge + 2 * piece.c1_c2 + piece.c2_c2 * t) * t) * t;
        const real square = piece.c1_c1 + 4 * bulge * t;
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
        const real curved = piece.linear + 6 * bulge * t;
        const int newton = curved > (real)0.05 * square;
        real step = -slope / (newton ? curved : square);
        step = clamp_r(step, -1, 1);
        real next = found.at + step;
        if (next >= most && most < high) next = (real)0.5 * (found.at + most);
        if (next <= least && least > low) next = (real)0.5 * (found.at + least);
        next = clamp_r(next, low, high);
        const real moved = fabs(next - found.at);
        found.at = next;
        const int within = newton && next >= piece.low && next < piece.high;
        if (moved < (within ? SEL_CLOSEST_NEAR : SEL_CLOSEST_ENOUGH) && next > low && next < high) return found;
    }
    return found;
}

SEL_END
#endif
