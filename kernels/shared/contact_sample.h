// The three items of capsule contact: find the cells near a sample, evaluate a sample, reduce an edge. Kernels call them once per
// work-item, host twins in a loop.
//
// Node positions come as hi (float) + lo (real) relative to the mesh centre; see portable.h.
#ifndef SEL_SHARED_CONTACT_SAMPLE_H
#define SEL_SHARED_CONTACT_SAMPLE_H
#include "shared/clearance.h"
#include "shared/contact_law.h"

SEL_BEGIN

// A point on an edge relative to the float position of the edge's first node, `origin`.
typedef struct AxisPoint {
    vec3 origin, offset, edge;  // [m]; edge: from node a to node b
} AxisPoint;

SEL_FN AxisPoint axis_point(uint node, real bary, SEL_GLOBAL const float* hi, SEL_GLOBAL const real* lo)
{
    AxisPoint point;
    const uint a = 3 * node;
    point.origin = make_vec3((real)hi[a], (real)hi[a + 1], (real)hi[a + 2]);
    const vec3 from = make_vec3(lo[a], lo[a + 1], lo[a + 2]);
    // as reals: a difference of floats would be rounded to 6e-8 of the edge, 0.3 nm that jump each time a node passes a float
    const vec3 to = make_vec3(((real)hi[a + 3] - (real)hi[a]) + lo[a + 3], ((real)hi[a + 4] - (real)hi[a + 1]) + lo[a + 4],
                              ((real)hi[a + 5] - (real)hi[a + 2]) + lo[a + 5]);
    point.edge = to - from;
    point.offset = from + bary * point.edge;
    return point;
}

// Least squared distance from p to a box.
SEL_FN real box_distance2(vec3 p, TreeNode box)
{
    const real x = max_r(max_r((real)box.lo[0] - p.x, p.x - (real)box.hi[0]), 0);
    const real y = max_r(max_r((real)box.lo[1] - p.y, p.y - (real)box.hi[1]), 0);
    const real z = max_r(max_r((real)box.lo[2] - p.z, p.z - (real)box.hi[2]), 0);
    return x * x + y * y + z * z;
}

// Distance from p to the nearest triangle, or `most` if none is nearer.
SEL_FN real wall_distance(vec3 p, real most, SEL_GLOBAL const TreeNode* nodes, SEL_GLOBAL const float* vertices)
{
    const vec3 zero = make_vec3(0, 0, 0);
    real best2 = most * most;
    uint stack[SEL_TREE_STACK];
    real away2[SEL_TREE_STACK];  // of the boxes on the stack
    uint top = 0;
    stack[0] = 0;
    away2[top++] = box_distance2(p, nodes[0]);
    while (top > 0) {
        --top;
        if (away2[top] >= best2) continue;
        const TreeNode node = nodes[stack[top]];
        if (node.count == 0) {  // the nearer child is looked at first
            const uint left = node.left_or_first;
            const real to_left = box_distance2(p, nodes[left]), to_right = box_distance2(p, nodes[left + 1]);
            const uint right_first = to_right < to_left;
            stack[top] = right_first ? left : left + 1;
            away2[top++] = right_first ? to_left : to_right;
            stack[top] = right_first ? left + 1 : left;
            away2[top++] = right_first ? to_right : to_left;
            continue;
        }
        for (uint k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k) {
            int feature;
            const vec3 v = p - closest_on_triangle(p, load_triangle(vertices, node.left_or_first + k, zero), &feature);
            best2 = min_r(best2, dot3(v, v));
        }
    }
    return sqrt(best2);
}

// Did this record speak of the wall that has this normal?
SEL_FN int same_side(TouchState touch, vec3 normal)
{
    return touch.normal[0] * normal.x + touch.normal[1] * normal.y + touch.normal[2] * normal.z > 0;
}

typedef struct TouchPair {
    Touch first, second;  // the nearer side of the lumen, and the opposite one
} TouchPair;

// What a sample touches. a, b: its records; lives: of the last step
SEL_FN TouchPair touches_of(AxisPoint at, SampleModel m, ContactParams par, TouchState a, int a_lives, TouchState b, int b_lives,
                            SEL_GLOBAL const uint* cells, uint count, SEL_GLOBAL const TreeNode* nodes,
                            SEL_GLOBAL const float* vertices, SEL_GLOBAL const uint* rims)
{
    TouchPair out;
    // the triangles that were touched last are near: nothing farther away needs to be looked at
    real near2 = (real)1e30;
    if (a_lives) near2 = triangle_distance2(at.offset, at.origin, a.triangle, vertices);
    if (b_lives) near2 = min_r(near2, triangle_distance2(at.offset, at.origin, b.triangle, vertices));
    NearList list;
    Touch first =
        nearest_touch(at.offset, at.origin, m.radius, m.reach, par.blend, 0, near2, cells, count, nodes, vertices, rims, &list);
    if (first.outside && !(a_lives && same_side(a, first.normal)) && !(b_lives && same_side(b, first.normal)))
        first = nearest_touch(at.offset, at.origin, m.radius, m.reach, par.blend, 1, near2, cells, count, nodes, vertices, rims,
                              &list);
    if (a_lives) first.side = make_vec3(a.normal[0], a.normal[1], a.normal[2]);
    else if (b_lives) first.side = make_vec3(b.normal[0], b.normal[1], b.normal[2]);
    Touch second =
        blend_and_oppose(&first, at.offset, at.origin, m.radius, m.reach, par.blend, cells, count, nodes, vertices, rims, &list);
    list.count = SEL_NEAR_MOST + 1;  // it was of the first
    // both sides are blended alike: which of them is nearer may change without a jump
    if (second.found)
        (void)blend_and_oppose(&second, at.offset, at.origin, m.radius, m.reach, par.blend, cells, count, nodes, vertices, rims,
                               &list);
    out.first = first;
    out.second = second;
    return out;
}

SEL_FN HardState no_hard_state(void)
{
    HardState none;
    for (int i = 0; i < 3; ++i) none.normal[i] = none.friction[i] = 0;
    none.force = none.stiffness = none.miss = 0;
    none.live = none.pad = 0;
    return none;
}

// How well a record fits a wall: the cosine between its last normal and the wall's.
SEL_FN real fit(TouchState touch, HardState hard, int lives, vec3 normal)
{
    if (!lives && hard.live) return normal.x * hard.normal[0] + normal.y * hard.normal[1] + normal.z * hard.normal[2];
    return normal.x * touch.normal[0] + normal.y * touch.normal[1] + normal.z * touch.normal[2];
}

SEL_FN SampleForce no_force(SampleModel m)
{
    SampleForce none;
    for (int k = 0; k < 4; ++k) none.force[k] = 0;
    for (int k = 0; k < 10; ++k) none.sym[k] = 0;
    for (int k = 0; k < 12; ++k) none.skew[k] = 0;
    for (int k = 0; k < 9; ++k) none.sym_xw[k] = none.skew_wx[k] = 0;
    for (int k = 0; k < 6; ++k) none.sym_ww[k] = 0;
    for (int k = 0; k < 3; ++k) none.couple[k] = none.sym_tw[k] = 0;
    none.depth = -(m.radius + m.reach);
    none.normal_sum = none.friction_sum = none.sliding_sum = none.rolling_sum = none.length = 0;
    none.flags = 0;
    none.contacts = 0;
    return none;
}

SEL_FN TouchState no_touch(void)
{
    TouchState none;
    for (int i = 0; i < 3; ++i) none.slip[i] = none.normal[i] = none.point[i] = none.friction[i] = 0;
    none.gap = none.rate = none.approach = none.roll = none.normal_force = none.moment = 0;
    none.triangle = none.flags = none.stamp = none.pad = 0;
    return none;
}

// Both records of a sample; most second ones are empty, before and after.
SEL_FN void write_touches(uint s, const TouchState* now, SEL_GLOBAL TouchState* touches)
{
    for (uint k = 0; k < 2; ++k)
        if (now[k].stamp != 0 || touches[2 * s + k].stamp != 0) touches[2 * s + k] = now[k];
}

// Contact of one sample. touches_t0, touches: two records for each sample, at the start and at the end of the step; so is `hard`,
// which only augmented, constraint and impulse read.
SEL_FN SampleForce evaluate_sample(uint s, ContactParams par, SampleModel m, SamplePlace place, SEL_GLOBAL const uint* cells,
                                   uint count, SEL_GLOBAL const TreeNode* nodes, SEL_GLOBAL const float* vertices,
                                   SEL_GLOBAL const uint* rims, SEL_GLOBAL const float* hi, SEL_GLOBAL const real* lo,
                                   SEL_GLOBAL const real* theta, SEL_GLOBAL const float* hi_t0, SEL_GLOBAL const real* lo_t0,
                                   SEL_GLOBAL const real* theta_t0, SEL_GLOBAL const TouchState* touches_t0,
                                   SEL_GLOBAL TouchState* touches, SEL_GLOBAL const HardState* hard)
{
    SampleForce out = no_force(m);
    const AxisPoint at = axis_point(place.edge, place.bary, hi, lo);
    SampleMove mv;
    mv.length = sqrt(dot3(at.edge, at.edge));
    mv.tangent = (1 / mv.length) * at.edge;
    mv.stamp = place.stamp;
    mv.shrink = place.shrink;
    mv.fresh = place.edge_t0 == SEL_NO_EDGE;
    mv.move = mv.turn = make_vec3(0, 0, 0);
    mv.spin = 0;
    if (!mv.fresh) {
        const AxisPoint was = axis_point(place.edge_t0, place.bary_t0, hi_t0, lo_t0);
        mv.move = (at.origin - was.origin) + (at.offset - was.offset);
        mv.turn = mv.tangent - (1 / sqrt(dot3(was.edge, was.edge))) * was.edge;
        mv.spin = theta[place.edge] - theta_t0[place.edge_t0];
    }

    const int a_lives = touches_t0[2 * s].stamp + 1 == place.stamp, b_lives = touches_t0[2 * s + 1].stamp + 1 == place.stamp;
    const TouchState a = a_lives ? touches_t0[2 * s] : no_touch(), b = b_lives ? touches_t0[2 * s + 1] : no_touch();
    TouchState now[2];
    now[0] = now[1] = no_touch();
    const TouchPair touching = touches_of(at, m, par, a, a_lives, b, b_lives, cells, count, nodes, vertices, rims);
    const Touch first = touching.first, second = touching.second;
    if (first.found) {
        // which of the two records speaks of this side of the lumen: the one whose last normal is nearer
        const int plain = par.normal_law == SEL_NORMAL_DAMPED || par.normal_law == SEL_NORMAL_BARRIER;
        const HardState ha = plain ? no_hard_state() : hard[2 * s], hb = plain ? no_hard_state() : hard[2 * s + 1];
        const real to_a = fit(a, ha, a_lives, first.normal), to_b = fit(b, hb, b_lives, first.normal);
        const int swap = (b_lives || hb.live) && (!(a_lives || ha.live) || to_b > to_a);
        const vec3 centre = at.origin + at.offset;
        add_touch(first, centre, m, mv, par, swap ? b : a, swap ? hb : ha, &now[swap ? 1 : 0], &out);
        if (second.found) add_touch(second, centre, m, mv, par, swap ? a : b, swap ? ha : hb, &now[swap ? 0 : 1], &out);
        if (out.contacts > 0) out.length = m.length;
    }
    write_touches(s, now, touches);
    return out;
}

// A sample that touched nothing in the last step and touches nothing now, without more ado. @return 0: it has to be evaluated
SEL_FN int is_clear(uint s, SampleModel m, SamplePlace place, SEL_GLOBAL const uint* cells, uint count,
                    SEL_GLOBAL const TreeNode* nodes, SEL_GLOBAL const float* vertices, SEL_GLOBAL const float* hi,
                    SEL_GLOBAL const real* lo, SEL_GLOBAL const TouchState* touches_t0, SEL_GLOBAL TouchState* touches,
                    SEL_GLOBAL Clearance* clearance)
{
    for (uint k = 2 * s; k < 2 * s + 2; ++k)
        if (touches_t0[k].stamp + 1 == place.stamp) return 0;
    const AxisPoint at = axis_point(place.edge, place.bary, hi, lo);
    if (!touches_nothing(at.offset, at.origin, m, cells, count, nodes, vertices, clearance)) return 0;
    TouchState now[2];
    now[0] = now[1] = no_touch();
    write_touches(s, now, touches);
    return 1;
}

// What contact_evaluate does for one sample: see is_clear and evaluate_sample.
SEL_FN SampleForce sample_force(uint s, ContactParams par, SampleModel m, SamplePlace place, SEL_GLOBAL const uint* cells,
                                uint count, SEL_GLOBAL const TreeNode* nodes, SEL_GLOBAL const float* vertices,
                                SEL_GLOBAL const uint* rims, SEL_GLOBAL const float* hi, SEL_GLOBAL const real* lo,
                                SEL_GLOBAL const real* theta, SEL_GLOBAL const float* hi_t0, SEL_GLOBAL const real* lo_t0,
                                SEL_GLOBAL const real* theta_t0, SEL_GLOBAL const TouchState* touches_t0,
                                SEL_GLOBAL TouchState* touches, SEL_GLOBAL const HardState* hard, SEL_GLOBAL Clearance* clearance)
{
    if (is_clear(s, m, place, cells, count, nodes, vertices, hi, lo, touches_t0, touches, clearance)) return no_force(m);
    return evaluate_sample(s, par, m, place, cells, count, nodes, vertices, rims, hi, lo, theta, hi_t0, lo_t0, theta_t0,
                           touches_t0, touches, hard);
}

// Where nothing touches, of 0.5 kB three words are read.
SEL_FN void write_force(SampleForce force, SEL_GLOBAL SampleForce* out)
{
    if (force.contacts > 0) {
        *out = force;
        return;
    }
    out->depth = force.depth;
    out->flags = force.flags;
    out->contacts = 0;
}

// Adds what a sample's couple does: q = (x_a, x_b, theta), x = a x_a + b x_b, w = x_b - x_a.
SEL_FN void add_couple(SampleForce f, real a, real b, EdgeForce* out)
{
    const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};  // of (i, j) among xx xy xz yy yz zz
    for (int i = 0; i < 3; ++i) {
        out->force_a[i] -= f.couple[i];
        out->force_b[i] += f.couple[i];
        out->st_a[i] -= f.sym_tw[i];
        out->st_b[i] += f.sym_tw[i];
        for (int j = 0; j < 3; ++j) {
            const real xw = f.sym_xw[3 * i + j], wx = f.sym_xw[3 * j + i], ww = f.sym_ww[place[3 * i + j]];
            out->s_ab[3 * i + j] += a * xw - b * wx - ww;
            if (j < i) continue;
            out->s_aa[place[3 * i + j]] += ww - a * (xw + wx);
            out->s_bb[place[3 * i + j]] += ww + b * (xw + wx);
        }
    }
    if (!(f.flags & SEL_SAMPLE_SLIDING)) return;
    for (int i = 0; i < 9; ++i) {
        out->u_aa[i] -= a * f.skew_wx[i];
        out->u_ab[i] -= b * f.skew_wx[i];
        out->u_ba[i] += a * f.skew_wx[i];
        out->u_bb[i] += b * f.skew_wx[i];
    }
}

// Sums the samples items[first..last) (consecutive on one edge) in order. barys: of those samples.
SEL_FN EdgeForce reduce_edge(SEL_GLOBAL const SampleForce* forces, SEL_GLOBAL const real* barys, uint first, uint last)
{
    EdgeForce out;
    for (int k = 0; k < 3; ++k) out.force_a[k] = out.force_b[k] = out.st_a[k] = out.st_b[k] = out.ut_a[k] = out.ut_b[k] = 0;
    for (int k = 0; k < 6; ++k) out.s_aa[k] = out.s_bb[k] = 0;
    for (int k = 0; k < 9; ++k) out.s_ab[k] = out.u_aa[k] = out.u_ab[k] = out.u_ba[k] = out.u_bb[k] = 0;
    out.torque = out.s_tt = 0;
    out.depth = (real)-1e30;
    out.normal_sum = out.friction_sum = out.sliding_sum = out.rolling_sum = out.length = 0;
    out.flags = out.contacts = 0;
    const int block[6] = {0, 1, 2, 4, 5, 7};  // xx xy xz yy yz zz among the ten of `sym`
    const int spin[3] = {3, 6, 8};            // xt yt zt
    const int full[9] = {0, 1, 2, 1, 4, 5, 2, 5, 7};
    for (uint k = first; k < last; ++k) {
        const SampleForce f = forces[k];
        out.depth = max_r(out.depth, f.depth);
        out.flags |= f.flags;
        if (f.contacts == 0) continue;
        const real b = barys[k], a = 1 - b;
        for (int i = 0; i < 3; ++i) {
            out.force_a[i] += a * f.force[i];
            out.force_b[i] += b * f.force[i];
            out.st_a[i] += a * f.sym[spin[i]];
            out.st_b[i] += b * f.sym[spin[i]];
        }
        for (int i = 0; i < 6; ++i) {
            out.s_aa[i] += a * a * f.sym[block[i]];
            out.s_bb[i] += b * b * f.sym[block[i]];
        }
        for (int i = 0; i < 9; ++i) out.s_ab[i] += a * b * f.sym[full[i]];
        if (f.flags & SEL_SAMPLE_COUPLE) add_couple(f, a, b, &out);
        if (f.flags & SEL_SAMPLE_SLIDING) {
            for (int i = 0; i < 9; ++i) {
                out.u_aa[i] += a * a * f.skew[i];
                out.u_ab[i] += a * b * f.skew[i];
                out.u_ba[i] += a * b * f.skew[i];
                out.u_bb[i] += b * b * f.skew[i];
            }
            for (int i = 0; i < 3; ++i) {
                out.ut_a[i] += a * f.skew[9 + i];
                out.ut_b[i] += b * f.skew[9 + i];
            }
        }
        out.torque += f.force[3];
        out.s_tt += f.sym[9];
        out.normal_sum += f.normal_sum;
        out.friction_sum += f.friction_sum;
        out.sliding_sum += f.sliding_sum;
        out.rolling_sum += f.rolling_sum;
        out.length += f.length;
        out.contacts += f.contacts;
    }
    return out;
}

SEL_END
#endif
