// How the wall's own point at a contact moves over a step. Kernels for a wall that stands still are built without it.
#ifndef SEL_SHARED_WALL_MOTION_H
#define SEL_SHARED_WALL_MOTION_H
#include "shared/contact_gap.h"

SEL_BEGIN

#ifdef SEL_WALL_MOVES

// Weights of a point q in the triangle's plane: q = w.x a + w.y b + w.z c. A triangle without area is its longest edge.
SEL_FN vec3 barycentric(Triangle tri, vec3 q)
{
    const vec3 ab = tri.b - tri.a, bc = tri.c - tri.b, ca = tri.a - tri.c, n = cross3(ab, tri.c - tri.a);
    const real n2 = dot3(n, n), ab2 = dot3(ab, ab), bc2 = dot3(bc, bc), ca2 = dot3(ca, ca);
    if (n2 > SEL_FLAT * ab2 * ca2) {
        const real a = dot3(cross3(bc, q - tri.b), n) / n2, b = dot3(cross3(ca, q - tri.c), n) / n2;
        return make_vec3(a, b, 1 - a - b);
    }
    if (ab2 >= bc2 && ab2 >= ca2) {
        const real t = ab2 > 0 ? clamp_r(dot3(q - tri.a, ab) / ab2, 0, 1) : 0;
        return make_vec3(1 - t, t, 0);
    }
    if (bc2 >= ca2) {
        const real t = clamp_r(dot3(q - tri.b, bc) / bc2, 0, 1);
        return make_vec3(0, 1 - t, t);
    }
    const real t = clamp_r(dot3(q - tri.c, ca) / ca2, 0, 1);
    return make_vec3(t, 0, 1 - t);
}

// Move of vertex k of triangle t over the step.
SEL_FN vec3 vertex_move(WallView wall, uint t, uint k)
{
    SEL_GLOBAL const float* now = wall.vertices + 9 * t + 3 * k;
    SEL_GLOBAL const float* was = wall.vertices_t0 + 9 * t + 3 * k;
    return make_vec3((real)now[0] - (real)was[0], (real)now[1] - (real)was[1], (real)now[2] - (real)was[2]);
}

// The wall's point is of one material: what it moves by is interpolated on its triangle.
SEL_FN void take_wall_motion(ContactPoint* contact, ContactBall ball, WallView wall)
{
    if (!contact->found) return;
    const uint t = contact->triangle;
    const vec3 w = barycentric(load_triangle(wall.vertices, t, ball.origin), ball.p + contact->to_wall);
    contact->wall_move = w.x * vertex_move(wall, t, 0) + w.y * vertex_move(wall, t, 1) + w.z * vertex_move(wall, t, 2);
}

#else

SEL_FN void take_wall_motion(ContactPoint* contact, ContactBall ball, WallView wall)
{
    (void)contact;
    (void)ball;
    (void)wall;
}

#endif

SEL_END
#endif
