// Depth where facets meet in a valley. There the nearest point jumps from one facet to another; the depth is a smooth maximum
// over facets of different normals,
//     depth = depth_0 + sum_j max(0, eps_j - (depth_0 - depth_j))^2 / (4 eps_j),   eps_j = smoothing r |n_j - n_0|,
// whose width vanishes with the angle between them. Bias at most eps/4 for each plane that is within eps. A plane counts once, with
// the nearest of its triangles (else a valley would push as often as it is cut into triangles). The plane of the nearest point
// never counts: there only the edge's offset would tilt n_j.
#ifndef SEL_SHARED_SMOOTH_MAXIMUM_H
#define SEL_SHARED_SMOOTH_MAXIMUM_H
#include "shared/contact_gap.h"

SEL_BEGIN

#define SEL_COPLANAR \
    1e-5f  // normals nearer than this [rad] lie in one plane: float32 vertices of one, 1 mm apart, differ by 4e-6

#define SEL_SMOOTH_PLANES 8  // round one ball; beyond, the shallowest is left out: facets of a few um on a doubly curved wall

// A triangle in front of the ball.
typedef struct FacingTriangle {
    vec3 v, n, facet;  // from its closest point to the ball's centre; the same, unit; its normal
    real d;            // |v| [m]
} FacingTriangle;

// Does triangle t face the ball, within its reach?
SEL_FN int faces(ContactBall ball, Triangle tri, uint boundary, FacingTriangle* out)
{
    const real range2 = (ball.radius + ball.reach) * (ball.radius + ball.reach);
    int feature;
    out->v = ball.p - closest_on_triangle(ball.p, tri, &feature);
    const real d2 = dot3(out->v, out->v);
    if (d2 > range2 || !(d2 > 0)) return 0;
    out->facet = triangle_normal(tri);
    if (dot3(out->v, out->facet) <= 0 && !on_boundary(boundary, feature)) return 0;
    out->d = sqrt(d2);
    out->n = (1 / out->d) * out->v;
    return 1;
}

// A plane next to the nearest facet's, as the ball sees it.
typedef struct NeighbourPlane {
    vec3 facet;             // its normal
    vec3 turn;              // direction to the ball, less that of the nearest point
    real depth, eps, rest;  // see above; rest = eps_j - (depth_0 - depth_j) > 0
} NeighbourPlane;

typedef struct NeighbourPlanes {
    vec3 facet0;  // normal of the nearest point's facet
    uint count;
    NeighbourPlane plane[SEL_SMOOTH_PLANES];
} NeighbourPlanes;

SEL_FN int in_one_plane(vec3 a, vec3 b)
{
    const vec3 turn = a - b;
    return dot3(turn, turn) < (real)SEL_COPLANAR * (real)SEL_COPLANAR;
}

// Takes `found` into the list: in the place of its plane when it is nearer, else at the end, else for the shallowest.
SEL_FN void keep_plane(SEL_OUT NeighbourPlanes* planes, NeighbourPlane found)
{
    const uint count = planes->count;
    uint at = count, shallowest = 0;
    for (uint k = 0; k < count; ++k) {
        if (in_one_plane(planes->plane[k].facet, found.facet)) at = k;
        if (planes->plane[k].depth < planes->plane[shallowest].depth) shallowest = k;
    }
    const int is_new = at == count;
    if (at == SEL_SMOOTH_PLANES) at = shallowest;
    if (at == count || planes->plane[at].depth < found.depth) planes->plane[at] = found;
    if (is_new && count < SEL_SMOOTH_PLANES) planes->count = count + 1;
}

// Takes the plane of a facing triangle, if it is one beside the nearest point's and near enough to be joined with it.
SEL_FN void join_plane(SEL_OUT NeighbourPlanes* planes, SEL_OUT const ContactPoint* first, ContactBall ball,
                       FacingTriangle facing)
{
    if (in_one_plane(facing.facet, planes->facet0)) return;
    NeighbourPlane plane;
    plane.facet = facing.facet;
    plane.turn = facing.n - first->normal;
    plane.depth = ball.radius - facing.d;
    plane.eps = ball.smoothing * ball.radius * sqrt(dot3(plane.turn, plane.turn));
    plane.rest = plane.eps - (first->depth - plane.depth);
    if (plane.eps >= (real)1e-7 * ball.smoothing * ball.radius && plane.rest > 0) keep_plane(planes, plane);
}

// Depth, gradient and second derivatives of the smooth maximum in place of those of the nearest facet.
SEL_FN void smooth_maximum(SEL_OUT ContactPoint* first, SEL_OUT const NeighbourPlanes* planes)
{
    for (uint k = 0; k < planes->count; ++k) {
        const vec3 dn = planes->plane[k].turn;
        const real eps = planes->plane[k].eps, rest = planes->plane[k].rest, bend = 1 / (2 * eps);
        first->depth += rest * rest / (4 * eps);
        first->normal = first->normal + (rest / (2 * eps)) * dn;
        first->hessian[0] += bend * dn.x * dn.x;
        first->hessian[1] += bend * dn.x * dn.y;
        first->hessian[2] += bend * dn.x * dn.z;
        first->hessian[3] += bend * dn.y * dn.y;
        first->hessian[4] += bend * dn.y * dn.z;
        first->hessian[5] += bend * dn.z * dn.z;
    }
}

SEL_END
#endif
