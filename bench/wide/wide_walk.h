// Walks through the wide tree: eight boxes, and then eight triangles, side by side.
//
// Boxes are tested in float relative to the query, with a margin that outweighs every rounding on the way: they leave out too
// little, never too much. The result is decided on the triangles alone, in `real`, by the same operations as one triangle at a
// time (kernels/shared/triangle.h, segment_triangle.h).
#ifndef SEL_SHARED_WIDE_WALK_H
#define SEL_SHARED_WIDE_WALK_H
#include "wide/segment_triangle.h"
#include "wide/wide_lanes.h"
#include "wide/wide_types.h"

SEL_BEGIN

#define SEL_LANE_NUMBERS mask_bits8(SEL_MASK8(0, -1, -2, -3, -4, -5, -6, -7))

// Children still to be visited: the parent, and the squared distance with the child's number in its last three bits (the bits
// of floats that are not negative are in order like the floats).
typedef struct WideStack {
    uint key[SEL_WIDE_STACK], parent[SEL_WIDE_STACK];
    uint top;
} WideStack;

SEL_LANES_FN int8 used_children(SEL_GLOBAL const WideNode* node) { return load8(node->child) != uint8_of(SEL_WIDE_NONE); }

// The nearest of the hit ones comes to lie on top.
SEL_LANES_FN void push_children(WideStack* stack, uint node, float8 distance2, int8 hit)
{
    const uint8 none = uint8_of(0);
    const uint8 keys = hit ? ((bits8(distance2) & uint8_of(0xfffffff8u)) | SEL_LANE_NUMBERS) : none;
    store8(sort_lanes(keys), stack->key + stack->top);
    store8(uint8_of(node), stack->parent + stack->top);
    stack->top += count_lanes(hit);
}

// The topmost that is no farther than `limit`; SEL_WIDE_NONE: nothing is left.
SEL_FN uint pop_child(WideStack* stack, SEL_GLOBAL const WideNode* nodes, uint limit)
{
    while (stack->top > 0) {
        const uint key = stack->key[--stack->top];
        if (key <= limit) return nodes[stack->parent[stack->top]].child[key & 7u];
    }
    return SEL_WIDE_NONE;
}

// Rounding of everything that is computed in float about a query at distances up to `size` from the mesh's centre.
SEL_FN float wide_margin(SEL_GLOBAL const WideNode* nodes, real size)
{
    real extent = 0;
    for (int d = 0; d < 3; ++d) {
        const real lo = fabs((real)nodes[0].origin[d]), hi = fabs((real)nodes[0].origin[d] + 255 * (real)nodes[0].step[d]);
        extent = max_r(extent, max_r(lo, hi));
    }
    return (float)((size + extent) * (real)4.8e-7);  // 2^-21, where 2^-22 is what adds up
}

// Squared distance at least, from p to the eight boxes of a node.
SEL_LANES_FN float8 wide_distance2(SEL_GLOBAL const WideNode* node, float px, float py, float pz, float margin)
{
    const float8 zero = float8_of(0);
    const float ox = node->origin[0] - px, oy = node->origin[1] - py, oz = node->origin[2] - pz;
    const float8 lx = node->step[0] * float8_of_bytes(node->lo[0]) + (ox - margin),
                 ly = node->step[1] * float8_of_bytes(node->lo[1]) + (oy - margin),
                 lz = node->step[2] * float8_of_bytes(node->lo[2]) + (oz - margin),
                 hx = node->step[0] * float8_of_bytes(node->hi[0]) + (ox + margin),
                 hy = node->step[1] * float8_of_bytes(node->hi[1]) + (oy + margin),
                 hz = node->step[2] * float8_of_bytes(node->hi[2]) + (oz + margin);
    const float8 x = lx > zero ? lx : (hx < zero ? hx : zero), y = ly > zero ? ly : (hy < zero ? hy : zero),
                 z = lz > zero ? lz : (hz < zero ? hz : zero);
    return x * x + y * y + z * z;
}

typedef struct Triangles8 {
    Lanes3 a, b, c;
} Triangles8;

// The triangles of a leaf; lanes beyond its count hold whatever numbers follow.
SEL_LANES_FN Triangles8 load_triangles8(SEL_GLOBAL const float* vertices, uint child)
{
    const uint n = SEL_WIDE_COUNT(child);
    SEL_GLOBAL const float* v = vertices + 9 * SEL_WIDE_FIRST(child);
    Triangles8 tri;
    tri.a = make_lanes3(widen8(load8(v)), widen8(load8(v + n)), widen8(load8(v + 2 * n)));
    tri.b = make_lanes3(widen8(load8(v + 3 * n)), widen8(load8(v + 4 * n)), widen8(load8(v + 5 * n)));
    tri.c = make_lanes3(widen8(load8(v + 6 * n)), widen8(load8(v + 7 * n)), widen8(load8(v + 8 * n)));
    return tri;
}

SEL_FN Triangle load_wide_triangle(SEL_GLOBAL const float* vertices, uint child, uint lane)
{
    const uint n = SEL_WIDE_COUNT(child);
    SEL_GLOBAL const float* v = vertices + 9 * SEL_WIDE_FIRST(child) + lane;
    Triangle tri;
    tri.a = make_vec3((real)v[0], (real)v[n], (real)v[2 * n]);
    tri.b = make_vec3((real)v[3 * n], (real)v[4 * n], (real)v[5 * n]);
    tri.c = make_vec3((real)v[6 * n], (real)v[7 * n], (real)v[8 * n]);
    return tri;
}

// closest_on_triangle(), the last of its answers first; `flat`: triangles that it would take for their edges, whose answer here
// is any.
SEL_LANES_FN Lanes3 closest_on_triangles8(Lanes3 p, Triangles8 tri, mask8* flat)
{
    const real8 zero = real8_of(0), one = real8_of(1);
    const Lanes3 ab = sub_lanes(tri.b, tri.a), ac = sub_lanes(tri.c, tri.a), ap = sub_lanes(p, tri.a), bp = sub_lanes(p, tri.b),
                 cp = sub_lanes(p, tri.c);
    const real8 d1 = dot_lanes(ab, ap), d2 = dot_lanes(ac, ap), d3 = dot_lanes(ab, bp), d4 = dot_lanes(ac, bp),
                d5 = dot_lanes(ab, cp), d6 = dot_lanes(ac, cp);
    const real8 vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    const real8 e1 = d4 - d3, e2 = d5 - d6, sum = va + vb + vc;
    const mask8 at_a = (d1 <= zero) & (d2 <= zero), at_b = (d3 >= zero) & (d4 <= d3), at_c = (d6 >= zero) & (d5 <= d6),
                on_ab = (vc <= zero) & (d1 >= zero) & (d3 <= zero) & (d1 - d3 > zero),
                on_ac = (vb <= zero) & (d2 >= zero) & (d6 <= zero) & (d2 - d6 > zero),
                on_bc = (va <= zero) & (e1 >= zero) & (e2 >= zero) & (e1 + e2 > zero);
    const mask8 edge_bc = on_bc & ~(at_a | at_b | on_ab | at_c | on_ac), edge_ac = on_ac & ~(at_a | at_b | on_ab | at_c),
                edge_ab = on_ab & ~(at_a | at_b), corner_c = at_c & ~(at_a | at_b | on_ab), corner_b = at_b & ~at_a;
    const mask8 corner = at_a | corner_b | corner_c, edge = edge_ab | edge_ac | edge_bc;
    *flat = ~(corner | edge) & ~(sum > (real)SEL_FLAT * dot_lanes(ab, ab) * dot_lanes(ac, ac));
    const real8 over = edge_ab ? d1 : (edge_ac ? d2 : (edge_bc ? e1 : one)),
                under = edge_ab ? d1 - d3 : (edge_ac ? d2 - d6 : (edge_bc ? e1 + e2 : (corner ? one : sum))), q = over / under;
    // base + s along + t ac
    const real8 s = (corner | edge_ac) ? zero : (edge ? q : vb * q), t = edge_ac ? q : ((corner | edge) ? zero : vc * q);
    const Lanes3 base = choose_lanes(corner_c, tri.c, choose_lanes(corner_b | edge_bc, tri.b, tri.a)),
                 along = choose_lanes(edge_bc, sub_lanes(tri.c, tri.b), ab);
    return add_lanes(add_lanes(base, scale_lanes(s, along)), scale_lanes(t, ac));
}

// Squared distances of p to the triangles of a leaf; 1e30 in lanes beyond its count.
SEL_LANES_FN real8 leaf_distances2(vec3 p, SEL_GLOBAL const float* vertices, uint child)
{
    mask8 flat;
    const Lanes3 point = lanes3_of(p);
    const Lanes3 v = sub_lanes(point, closest_on_triangles8(point, load_triangles8(vertices, child), &flat));
    const mask8 used = wide_mask8(SEL_LANE_NUMBERS < uint8_of(SEL_WIDE_COUNT(child)));
    const real8 far = real8_of((real)1e30);
    real8 d2 = used ? dot_lanes(v, v) : far;
    if (any8(flat & used)) {
        const uint8 lanes = SEL_LANE_NUMBERS;
        for (uint k = 0; k < SEL_WIDE_COUNT(child); ++k) {
            int feature;
            const vec3 w = p - closest_on_triangle(p, load_wide_triangle(vertices, child, k), &feature);
            const real8 exact = real8_of(dot3(w, w));
            d2 = wide_mask8(lanes == uint8_of(k)) ? exact : d2;
        }
    }
    return d2;
}

// What of a capsule the test of eight boxes needs, in float: capsule_box() and its margins.
typedef struct WideCapsule {
    float middle[3], arm[3], reach[3], cross_reach[3];
} WideCapsule;

SEL_FN WideCapsule wide_capsule(SEL_GLOBAL const WideNode* nodes, CapsuleBox box)
{
    const real size = max_r(max_r(fabs(box.middle.x), fabs(box.middle.y)), fabs(box.middle.z)) +
                      max_r(max_r(box.reach.x, box.reach.y), box.reach.z);
    const float margin = wide_margin(nodes, size);
    const float arm = (float)(fabs(box.arm.x) + fabs(box.arm.y) + fabs(box.arm.z));
    WideCapsule c;
    c.middle[0] = (float)box.middle.x, c.middle[1] = (float)box.middle.y, c.middle[2] = (float)box.middle.z;
    c.arm[0] = (float)box.arm.x, c.arm[1] = (float)box.arm.y, c.arm[2] = (float)box.arm.z;
    c.reach[0] = (float)box.reach.x + margin, c.reach[1] = (float)box.reach.y + margin, c.reach[2] = (float)box.reach.z + margin;
    c.cross_reach[0] = (float)box.cross_reach.x + margin * arm, c.cross_reach[1] = (float)box.cross_reach.y + margin * arm,
    c.cross_reach[2] = (float)box.cross_reach.z + margin * arm;
    return c;
}

// capsule_meets_box() of the eight boxes of a node.
SEL_LANES_FN int8 capsule_meets_wide(WideCapsule c, SEL_GLOBAL const WideNode* node)
{
    const float8 lx = float8_of_bytes(node->lo[0]), ly = float8_of_bytes(node->lo[1]), lz = float8_of_bytes(node->lo[2]),
                 gx = float8_of_bytes(node->hi[0]), gy = float8_of_bytes(node->hi[1]), gz = float8_of_bytes(node->hi[2]);
    const float sx = 0.5f * node->step[0], sy = 0.5f * node->step[1], sz = 0.5f * node->step[2];
    const float8 hx = sx * (gx - lx), hy = sy * (gy - ly), hz = sz * (gz - lz);
    const float8 x = sx * (gx + lx) + (node->origin[0] - c.middle[0]), y = sy * (gy + ly) + (node->origin[1] - c.middle[1]),
                 z = sz * (gz + lz) + (node->origin[2] - c.middle[2]);
    const float ax = fabs(c.arm[0]), ay = fabs(c.arm[1]), az = fabs(c.arm[2]);
    return (fabs8(x) <= hx + c.reach[0]) & (fabs8(y) <= hy + c.reach[1]) & (fabs8(z) <= hz + c.reach[2]) &
           (fabs8(y * c.arm[2] - z * c.arm[1]) <= hy * az + hz * ay + c.cross_reach[0]) &
           (fabs8(z * c.arm[0] - x * c.arm[2]) <= hx * az + hz * ax + c.cross_reach[1]) &
           (fabs8(x * c.arm[1] - y * c.arm[0]) <= hx * ay + hy * ax + c.cross_reach[2]);
}

// The nearest points of a segment and of an edge of each triangle.
typedef struct SegmentPair {
    Lanes3 apart;  // from the edge's point to the segment's
    real8 d2;
} SegmentPair;

// segments_distance2() of p + s u and the edges q + t v; r = p - q, inv_a = 1 / u.u
SEL_LANES_FN SegmentPair nearest_pair8(Lanes3 r, vec3 u, real inv_a, Lanes3 v)
{
    const real8 zero = real8_of(0), one = real8_of(1);
    const Lanes3 along = lanes3_of(u);
    const real a = dot3(u, u);
    const real8 e = dot_lanes(v, v), f = dot_lanes(v, r), c = dot_lanes(along, r), b = dot_lanes(along, v), det = a * e - b * b;
    const mask8 skew = det > zero;
    const real8 free = skew ? clamp01_lanes((b * f - c * e) / (skew ? det : one)) : zero;
    const real8 t = b * free + f;
    const mask8 before = (t < zero) | ~(e > zero), behind = t > e;
    const real8 s = (before | behind) ? clamp01_lanes((before ? -c : b - c) * inv_a) : free,
                on = before ? zero : (behind ? one : t / (before ? one : e));
    SegmentPair pair;
    pair.apart = sub_lanes(add_lanes(r, scale_lanes(s, along)), scale_lanes(on, v));
    pair.d2 = dot_lanes(pair.apart, pair.apart);
    return pair;
}

SEL_LANES_FN real8 min_lanes(real8 a, real8 b) { return a < b ? a : b; }

// segment_within() of the triangles of a leaf.
SEL_LANES_FN int8 leaf_within(vec3 a, vec3 u, real within2, SEL_GLOBAL const float* vertices, uint child)
{
    const int8 used = SEL_LANE_NUMBERS < uint8_of(SEL_WIDE_COUNT(child));
    const Triangles8 tri = load_triangles8(vertices, child);
    const Lanes3 p = lanes3_of(a), along = lanes3_of(u);
    const Lanes3 ab = sub_lanes(tri.b, tri.a), bc = sub_lanes(tri.c, tri.b), ca = sub_lanes(tri.a, tri.c);
    const Lanes3 ap = sub_lanes(p, tri.a), bp = sub_lanes(p, tri.b), cp = sub_lanes(p, tri.c);
    const real8 zero = real8_of(0), limit = real8_of(within2);
    const real more2 = within2 * (1 + (real)1e-6);
    // apart by the triangle's plane
    const Lanes3 n = cross_lanes(ab, ca);
    const real8 at_a = dot_lanes(n, ap), at_b = at_a + dot_lanes(n, along), n2 = more2 * dot_lanes(n, n);
    mask8 open = wide_mask8(used) & ~((at_a * at_b > zero) & (at_a * at_a > n2) & (at_b * at_b > n2));
    if (!any8(open)) return narrow_mask8(open);

    const real a2 = dot3(u, u), inv_a = a2 > 0 ? 1 / a2 : (real)0;
    SegmentPair best = nearest_pair8(ap, u, inv_a, ab), other = nearest_pair8(bp, u, inv_a, bc);
    best.apart = choose_lanes(other.d2 < best.d2, other.apart, best.apart);
    best.d2 = min_lanes(best.d2, other.d2);
    other = nearest_pair8(cp, u, inv_a, ca);
    best.apart = choose_lanes(other.d2 < best.d2, other.apart, best.apart);
    best.d2 = min_lanes(best.d2, other.d2);
    const mask8 in = open & (best.d2 <= limit);
    // apart along the line between the nearest points
    const real8 gap = min_lanes(min_lanes(dot_lanes(best.apart, ap), dot_lanes(best.apart, bp)), dot_lanes(best.apart, cp)) +
                      min_lanes(dot_lanes(best.apart, along), zero);
    open = open & ~in & ~((gap > zero) & (gap * gap > more2 * best.d2));
    int8 result = narrow_mask8(in);
    if (any8(open)) {  // within reach of the face alone, or very near the limit
        const uint8 lanes = SEL_LANE_NUMBERS;
        uint left[8];
        store8(mask_bits8(narrow_mask8(open)), left);
        for (uint k = 0; k < SEL_WIDE_COUNT(child); ++k)
            if (left[k] && segment_within(a, u, load_wide_triangle(vertices, child, k), within2))
                result = result | (lanes == uint8_of(k));
    }
    return result;
}

// All triangles within a distance of a capsule's axis. Writes at most `slots` of them; @return how many there are
SEL_FN uint find_within(CapsuleQuery query, SEL_GLOBAL const WideNode* nodes, SEL_GLOBAL const float* vertices, uint slots,
                        SEL_GLOBAL uint* found)
{
    const vec3 a = make_vec3(query.a[0], query.a[1], query.a[2]), b = make_vec3(query.b[0], query.b[1], query.b[2]);
    const WideCapsule capsule = wide_capsule(nodes, capsule_box(a, b, query.radius));
    WideStack stack;
    stack.top = 0;
    uint at = 0, count = 0;
    while (at != SEL_WIDE_NONE) {
        if (SEL_WIDE_IS_LEAF(at)) {
            const uint first = SEL_WIDE_FIRST(at);
            uint in[8];
            store8(mask_bits8(leaf_within(a, b - a, query.radius * query.radius, vertices, at)), in);
            for (uint k = 0; k < SEL_WIDE_COUNT(at); ++k) {
                if (count < slots) found[count] = first + k;  // written over unless it is in
                count += in[k] & 1u;
            }
        } else {
            push_children(&stack, at, float8_of(0), capsule_meets_wide(capsule, nodes + at) & used_children(nodes + at));
        }
        at = pop_child(&stack, nodes, 0xffffffffu);
    }
    return count;
}

// The triangle nearest to p, and its nearest point.
SEL_FN uint find_nearest(vec3 p, SEL_GLOBAL const WideNode* nodes, SEL_GLOBAL const float* vertices, vec3* point)
{
    const float px = (float)p.x, py = (float)p.y, pz = (float)p.z;
    const float margin = wide_margin(nodes, max_r(max_r(fabs(p.x), fabs(p.y)), fabs(p.z)));
    WideStack stack;
    stack.top = 0;
    uint at = 0, limit = bits_of(1e30f);
    real8 best2 = real8_of((real)1e30);  // in each lane, and in which leaf
    uint8 leaves = uint8_of(0);
    while (at != SEL_WIDE_NONE) {
        if (SEL_WIDE_IS_LEAF(at)) {
            const real8 here2 = leaf_distances2(p, vertices, at);
            const mask8 nearer = here2 < best2;
            best2 = nearer ? here2 : best2;
            leaves = narrow_mask8(nearer) ? uint8_of(at) : leaves;
            limit = bits_of((float)least_lane(best2) * 1.000004f);  // more than rounding and the number in a key take away
        } else {
            const float8 d2 = wide_distance2(nodes + at, px, py, pz, margin);
            push_children(&stack, at, d2, (bits8(d2) <= uint8_of(limit)) & used_children(nodes + at));
        }
        at = pop_child(&stack, nodes, limit);
    }
    uint is_least[8], leaf[8], lane = 0;
    store8(mask_bits8(narrow_mask8(best2 <= real8_of(least_lane(best2)))), is_least);
    store8(leaves, leaf);
    while (lane < 7 && !is_least[lane]) ++lane;
    int feature;
    *point = closest_on_triangle(p, load_wide_triangle(vertices, leaf[lane], lane), &feature);
    return SEL_WIDE_FIRST(leaf[lane]) + lane;
}

SEL_END
#endif
