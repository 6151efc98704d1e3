// Continuous detection: the free path of a ball along a straight line before it meets a triangle. Closed forms for face, edges
// and vertices [Ericson05, sec. 5.5.6]; a ball that moves away from a feature in contact is free.
#ifndef SEL_SHARED_SWEEP_H
#define SEL_SHARED_SWEEP_H
#include "shared/contact_gap.h"

SEL_BEGIN

// Smallest t in [0, most) with |w + t m| = radius while that distance shrinks, from a A t^2 + 2 B t + C form; `most` if none.
SEL_FN real first_root(real A, real B, real C, real most)
{
    if (B >= 0) return most;
    if (C <= 0) return 0;
    const real root = B * B - A * C;
    if (root < 0) return most;
    return min_r(C / (sqrt(root) - B), most);
}

// p: the ball's centre, move: its path; relative to the same origin as tri. boundary features: see contact_gap.h. A facet does
// not stop a point behind it; its boundary feature does.
SEL_FN real sweep_triangle(vec3 p, vec3 move, real radius, Triangle tri, uint boundary)
{
    real most = 1;
    const vec3 n = triangle_normal(tri);
    const real height = dot3(n, p - tri.a), speed = dot3(n, move);
    const int behind = height < 0;
    if (!behind && speed < 0 && height >= radius && height + speed < radius) {
        const real t = (radius - height) / speed;
        const vec3 foot = p + t * move - radius * n;
        int feature;
        (void)closest_on_triangle(foot, tri, &feature);
        if (feature == SEL_FEATURE_FACE) return t;
    }
    for (int k = 0; k < 3; ++k) {
        const vec3 from = k == 0 ? tri.a : k == 1 ? tri.b : tri.c;
        const vec3 edge = (k == 0 ? tri.b : k == 1 ? tri.c : tri.a) - from;
        const vec3 w = p - from;
        const real m2 = dot3(move, move), wm = dot3(w, move), gap2 = dot3(w, w) - radius * radius;
        if (!behind || ((boundary >> (3 + k)) & 1u)) most = first_root(m2, wm, gap2, most);
        if (behind && !((boundary >> k) & 1u)) continue;
        // distance from the edge's line; a root counts where it lies between the ends
        const real e2 = dot3(edge, edge);
        if (!(e2 > 0)) continue;
        const real we = dot3(w, edge), me = dot3(move, edge);
        const real t = first_root(m2 - me * me / e2, wm - we * me / e2, gap2 - we * we / e2, most);
        const real along = we + t * me;
        if (t < most && along > 0 && along < e2) most = t;
    }
    return most;
}

// Fraction of the straight path of a quadrature point from `base` to `trial` that is free of the wall near it (1: all).
SEL_PART real sweep_point(AxisPoint base, AxisPoint trial, real radius, NearWallView near)
{
    const vec3 move = (trial.origin - base.origin) + (trial.offset - base.offset);
    real free_way = 1;
    if (!(dot3(move, move) > 0)) return free_way;
    // all that the ball can meet is within its radius and half the path of the path's middle
    const vec3 middle = base.offset + (real)0.5 * move;
    const real range = (1 + SEL_WALK_MARGIN) * (radius + (real)0.5 * sqrt(dot3(move, move)));
    Walk walk;
    start_walk(&walk);
    uint t;
    while (next_triangle(&walk, near, ball_query(middle, base.origin, range), &t)) {
        const Triangle tri = load_triangle(near.wall.vertices, t, base.origin);
        free_way = min_r(free_way, sweep_triangle(base.offset, move, radius, tri, near.wall.boundary[t]));
    }
    return free_way;
}

SEL_END
#endif
