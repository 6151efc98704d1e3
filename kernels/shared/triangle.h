// Closest point of a triangle to a point, and what feature it lies on.
#ifndef SEL_SHARED_TRIANGLE_H
#define SEL_SHARED_TRIANGLE_H
#include "shared/portable.h"

SEL_BEGIN

// Feature of the closest point: face, edge k = (v_k, v_{k+1}), vertex k.
#define SEL_FEATURE_FACE 0
#define SEL_FEATURE_EDGE 1    // 1, 2, 3: edges 0, 1, 2
#define SEL_FEATURE_VERTEX 4  // 4, 5, 6: vertices 0, 1, 2

typedef struct Triangle {
    vec3 a, b, c;
} Triangle;

// Triangle t of the soup relative to `origin`. vertices: [T][9] float, leaf order, relative to the mesh centre [m]
SEL_FN Triangle load_triangle(SEL_GLOBAL const float* vertices, uint t, vec3 origin)
{
    SEL_GLOBAL const float* v = vertices + 9 * t;
    Triangle tri;
    tri.a = make_vec3((real)v[0] - origin.x, (real)v[1] - origin.y, (real)v[2] - origin.z);
    tri.b = make_vec3((real)v[3] - origin.x, (real)v[4] - origin.y, (real)v[5] - origin.z);
    tri.c = make_vec3((real)v[6] - origin.x, (real)v[7] - origin.y, (real)v[8] - origin.z);
    return tri;
}

// Closest point on the triangle to p by Voronoi regions [Ericson05, sec. 5.1.5]. Exact for slivers: edges are tested
// through their own parameters. A triangle of no area answers with its longest edges' closest point.
SEL_FN vec3 closest_on_triangle(vec3 p, Triangle tri, int* feature)
{
    const vec3 ab = tri.b - tri.a, ac = tri.c - tri.a, ap = p - tri.a;
    const real d1 = dot3(ab, ap), d2 = dot3(ac, ap);
    if (d1 <= 0 && d2 <= 0) { *feature = SEL_FEATURE_VERTEX; return tri.a; }
    const vec3 bp = p - tri.b;
    const real d3 = dot3(ab, bp), d4 = dot3(ac, bp);
    if (d3 >= 0 && d4 <= d3) { *feature = SEL_FEATURE_VERTEX + 1; return tri.b; }
    const real vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) {
        *feature = SEL_FEATURE_EDGE;
        return tri.a + (d1 / (d1 - d3)) * ab;
    }
    const vec3 cp = p - tri.c;
    const real d5 = dot3(ab, cp), d6 = dot3(ac, cp);
    if (d6 >= 0 && d5 <= d6) { *feature = SEL_FEATURE_VERTEX + 2; return tri.c; }
    const real vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) {
        *feature = SEL_FEATURE_EDGE + 2;
        return tri.a + (d2 / (d2 - d6)) * ac;
    }
    const real va = d3 * d6 - d5 * d4;
    const real e1 = d4 - d3, e2 = d5 - d6;
    if (va <= 0 && e1 >= 0 && e2 >= 0 && e1 + e2 > 0) {
        *feature = SEL_FEATURE_EDGE + 1;
        return tri.b + (e1 / (e1 + e2)) * (tri.c - tri.b);
    }
    const real sum = va + vb + vc;
    *feature = SEL_FEATURE_FACE;
    if (!(sum > 0)) return tri.a;  // no area at all: a point
    const real inv = 1 / sum;
    return tri.a + (vb * inv) * ab + (vc * inv) * ac;
}

// Unit normal by the right-hand rule; zero vector for a triangle of no area.
SEL_FN vec3 triangle_normal(Triangle tri)
{
    const vec3 n = cross3(tri.b - tri.a, tri.c - tri.a);
    const real length = sqrt(dot3(n, n));
    return length > 0 ? (1 / length) * n : make_vec3(0, 0, 0);
}

SEL_END
#endif
