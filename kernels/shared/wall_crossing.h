// Tests whether a point of the axis has gone through the wall since the step began.
//
// A quadrature point may enter a sharp fold of a mesh, narrower than its move in a step, without a trial that touches it from the
// front. The nearest facet is then seen from behind, pushes nobody, and the point would stay inside. Its path since the start of
// the step tells it from one that left through an opening or never was in this lumen: that path crosses the wall from front to
// back, net.
#ifndef SEL_SHARED_WALL_CROSSING_H
#define SEL_SHARED_WALL_CROSSING_H
#include "shared/walk.h"

SEL_BEGIN

// Does the line from a along d pass edge (u, v) on its left? The sign is of the edge, not of the triangle: neighbours agree about
// it.
SEL_FN real passes_left(vec3 a, vec3 d, vec3 u, vec3 v) { return dot3(d, cross3(u - a, v - a)); }

// 1: from front to back, -1: from back to front, 0: not through it.
SEL_FN int crossing(vec3 from, vec3 to, Triangle tri)
{
    const vec3 n = triangle_normal(tri);
    const int before = dot3(n, from - tri.a) >= 0, after = dot3(n, to - tri.a) >= 0;
    if (before == after) return 0;
    const vec3 d = to - from;
    const real ab = passes_left(from, d, tri.a, tri.b), bc = passes_left(from, d, tri.b, tri.c),
               ca = passes_left(from, d, tri.c, tri.a);
    if (!((ab <= 0 && bc <= 0 && ca <= 0) || (ab >= 0 && bc >= 0 && ca >= 0))) return 0;
    return before ? 1 : -1;
}

// @param to  relative to `origin`, where the point is now   @param move  since the start of the step
SEL_FN int gone_through(vec3 to, vec3 move, vec3 origin, NearWallView near)
{
    const real far = sqrt(dot3(move, move));
    int net = 0;
    Walk walk;
    start_walk(&walk);
    uint t;
    while (next_triangle(&walk, near, ball_query(to, origin, (1 + SEL_WALK_MARGIN) * far), &t))
        net += crossing(to - move, to, load_triangle(near.wall.vertices, t, origin));
    return net > 0;
}

SEL_END
#endif
