// Closest point of a triangle to a point, and its feature.
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
    const Triangle tri = {make_vec3((real)v[0] - origin.x, (real)v[1] - origin.y, (real)v[2] - origin.z),
                          make_vec3((real)v[3] - origin.x, (real)v[4] - origin.y, (real)v[5] - origin.z),
                          make_vec3((real)v[6] - origin.x, (real)v[7] - origin.y, (real)v[8] - origin.z)};
    return tri;
}

// Vertex k, or k - 3.
SEL_FN vec3 corner(Triangle tri, int k)
{
    const int at = k % 3;
    const vec3 first = at == 0 ? tri.a : tri.b;
    return at == 2 ? tri.c : first;
}

// (sin of the angle at vertex a)^2 below which a triangle is its three edges: the signs that tell face from edge are rounding
// there
#ifdef SEL_FLOAT32
    #define SEL_FLAT 1e-5f
#else
    #define SEL_FLAT 1e-12
#endif

// Nearest point of the three edges, for degenerate triangles without a face.
SEL_FN vec3 closest_on_edges(vec3 p, Triangle tri, int* feature)
{
    real best2 = dot3(p - tri.a, p - tri.a), part = 0;
    int edge = 0;
    *feature = SEL_FEATURE_VERTEX;
    SEL_ROLLED for (int k = 0; k < 3; ++k)
    {
        const vec3 from = corner(tri, k), along = corner(tri, k + 1) - from;
        const real way = dot3(p - from, along), length2 = dot3(along, along);
        const int end = way <= 0 ? 0 : way >= length2 ? 1 : -1;
        const real at = end < 0 ? way / length2 : (real)end;
        const vec3 v = p - (from + at * along);
        const real d2 = dot3(v, v);
        if (d2 >= best2) continue;
        best2 = d2;
        part = at;
        edge = k;
        *feature = end < 0 ? SEL_FEATURE_EDGE + k : SEL_FEATURE_VERTEX + (k + end) % 3;
    }
    const vec3 from = corner(tri, edge);
    return from + part * (corner(tri, edge + 1) - from);
}

// Closest point by Voronoi regions [Ericson05, sec. 5.1.5]. Slivers are safe: edges are tested through their own parameters.
// feature: -1 where the triangle has no area.
SEL_FN vec3 voronoi_point(vec3 p, Triangle tri, int* feature)
{
    const vec3 ab = tri.b - tri.a, ac = tri.c - tri.a, ap = p - tri.a;
    const real d1 = dot3(ab, ap), d2 = dot3(ac, ap);
    if (d1 <= 0 && d2 <= 0) {
        *feature = SEL_FEATURE_VERTEX;
        return tri.a;
    }
    const vec3 bp = p - tri.b;
    const real d3 = dot3(ab, bp), d4 = dot3(ac, bp);
    if (d3 >= 0 && d4 <= d3) {
        *feature = SEL_FEATURE_VERTEX + 1;
        return tri.b;
    }
    const real vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) {
        *feature = SEL_FEATURE_EDGE;
        return tri.a + (d1 / (d1 - d3)) * ab;
    }
    const vec3 cp = p - tri.c;
    const real d5 = dot3(ab, cp), d6 = dot3(ac, cp);
    if (d6 >= 0 && d5 <= d6) {
        *feature = SEL_FEATURE_VERTEX + 2;
        return tri.c;
    }
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
    const real sum = va + vb + vc;  // = |ab x ac|^2
    const int flat = !(sum > SEL_FLAT * dot3(ab, ab) * dot3(ac, ac));
    *feature = -flat;
    const real inv = 1 / sum;
    return tri.a + (vb * inv) * ab + (vc * inv) * ac;
}

// Closest point on the triangle to p. A triangle without area answers with its edges' closest point: here, where what
// voronoi_point works with is no longer kept (14 registers of a graphics card).
SEL_FN vec3 closest_on_triangle(vec3 p, Triangle tri, int* feature)
{
    const vec3 q = voronoi_point(p, tri, feature);
    return *feature < 0 ? closest_on_edges(p, tri, feature) : q;
}

// Squared distance from p to the triangle's box: no more than that to the triangle, at 1/3 of the work.
SEL_FN real triangle_box_distance2(vec3 p, Triangle tri)
{
    const real x = max_r(max_r(min_r(min_r(tri.a.x, tri.b.x), tri.c.x) - p.x, p.x - max_r(max_r(tri.a.x, tri.b.x), tri.c.x)), 0);
    const real y = max_r(max_r(min_r(min_r(tri.a.y, tri.b.y), tri.c.y) - p.y, p.y - max_r(max_r(tri.a.y, tri.b.y), tri.c.y)), 0);
    const real z = max_r(max_r(min_r(min_r(tri.a.z, tri.b.z), tri.c.z) - p.z, p.z - max_r(max_r(tri.a.z, tri.b.z), tri.c.z)), 0);
    return x * x + y * y + z * z;
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
