// Tests whether a triangle is within a distance of a segment, and which boxes can be skipped.
#ifndef SEL_WIDE_SEGMENT_TRIANGLE_H
#define SEL_WIDE_SEGMENT_TRIANGLE_H
#include "shared/segment.h"
#include "shared/tree_types.h"
#include "shared/triangle.h"

SEL_BEGIN

typedef struct CapsuleQuery {
    real a[3], b[3];  // ends of the axis, relative to the mesh centre [m]
    real radius;      // [m]
    real pad;
} CapsuleQuery;

// Does the segment a + s u pass through the triangle?
SEL_FN int segment_crosses(vec3 a, vec3 u, Triangle tri)
{
    const vec3 ab = tri.b - tri.a, ac = tri.c - tri.a, h = cross3(u, ac);
    const real det = dot3(ab, h);
    if (det == 0) return 0;
    const real inv = 1 / det;
    const vec3 s = a - tri.a, q = cross3(s, ab);
    const real x = dot3(s, h) * inv, y = dot3(u, q) * inv, t = dot3(ac, q) * inv;
    return x >= 0 && y >= 0 && x + y <= 1 && t >= 0 && t <= 1;
}

// Squared distance of the segment a + s u and a triangle.
SEL_FN real segment_triangle_distance2(vec3 a, vec3 u, Triangle tri)
{
    if (segment_crosses(a, u, tri)) return 0;
    int feature;
    const vec3 b = a + u, at_a = a - closest_on_triangle(a, tri, &feature), at_b = b - closest_on_triangle(b, tri, &feature);
    real best = min_r(dot3(at_a, at_a), dot3(at_b, at_b));
    best = min_r(best, segments_distance2(a, u, tri.a, tri.b - tri.a));
    best = min_r(best, segments_distance2(a, u, tri.b, tri.c - tri.b));
    return min_r(best, segments_distance2(a, u, tri.c, tri.a - tri.c));
}

// The same question against `within2`, cheapest answers first.
SEL_FN int segment_within(vec3 a, vec3 u, Triangle tri, real within2)
{
    // apart by the triangle's plane: both ends on one side of it, farther than the distance
    const vec3 n = cross3(tri.b - tri.a, tri.c - tri.a);
    const real at_a = dot3(n, a - tri.a), at_b = at_a + dot3(n, u), n2 = within2 * dot3(n, n) * (1 + (real)1e-6);
    if (at_a * at_b > 0 && at_a * at_a > n2 && at_b * at_b > n2) return 0;
    if (segments_distance2(a, u, tri.a, tri.b - tri.a) <= within2) return 1;
    if (segments_distance2(a, u, tri.b, tri.c - tri.b) <= within2) return 1;
    if (segments_distance2(a, u, tri.c, tri.a - tri.c) <= within2) return 1;
    int feature;
    const vec3 d = a - closest_on_triangle(a, tri, &feature);
    if (dot3(d, d) <= within2) return 1;
    const vec3 e = a + u - closest_on_triangle(a + u, tri, &feature);
    if (dot3(e, e) <= within2) return 1;
    return segment_crosses(a, u, tri);
}

// What of a capsule the box test needs.
typedef struct CapsuleBox {
    vec3 middle, arm, reach;  // arm: from the middle to an end; reach: its extent along x, y, z and the radius
    vec3 cross_reach;         // radius times the length of e_i x half
} CapsuleBox;

SEL_FN CapsuleBox capsule_box(vec3 a, vec3 b, real radius)
{
    CapsuleBox c;
    c.middle = (real)0.5 * (a + b);
    c.arm = (real)0.5 * (b - a);
    const real x = fabs(c.arm.x), y = fabs(c.arm.y), z = fabs(c.arm.z);
    c.reach = make_vec3(x + radius, y + radius, z + radius);
    c.cross_reach = make_vec3(radius * sqrt(y * y + z * z), radius * sqrt(x * x + z * z), radius * sqrt(x * x + y * y));
    return c;
}

// Segment, inflated by its radius, against a box by six axes: the box's faces and their cross products with the segment
// [Ericson05, sec. 5.3.3]. May say yes too often (round corners count as square), never no.
SEL_FN int capsule_meets_box(CapsuleBox c, TreeNode box)
{
    const real hx = ((real)box.hi[0] - (real)box.lo[0]) / 2, hy = ((real)box.hi[1] - (real)box.lo[1]) / 2,
               hz = ((real)box.hi[2] - (real)box.lo[2]) / 2;
    const real x = c.middle.x - ((real)box.lo[0] + hx), y = c.middle.y - ((real)box.lo[1] + hy),
               z = c.middle.z - ((real)box.lo[2] + hz);
    if (fabs(x) > c.reach.x + hx || fabs(y) > c.reach.y + hy || fabs(z) > c.reach.z + hz) return 0;
    const real ax = fabs(c.arm.x), ay = fabs(c.arm.y), az = fabs(c.arm.z);
    if (fabs(y * c.arm.z - z * c.arm.y) > hy * az + hz * ay + c.cross_reach.x) return 0;
    if (fabs(z * c.arm.x - x * c.arm.z) > hx * az + hz * ax + c.cross_reach.y) return 0;
    return !(fabs(x * c.arm.y - y * c.arm.x) > hx * ay + hy * ax + c.cross_reach.z);
}

SEL_END
#endif
