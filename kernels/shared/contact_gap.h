// From a point of the wire's axis and the triangles near it to at most two touches: gap and normal.
//
// The wall is the exact triangle mesh: the answer depends neither on how facets are subdivided in their own planes (a shared edge
// counts once, since only the nearest point counts) nor on triangle order.
//   * touch 0: the nearest point of the wall. Where two facets meet in a valley the nearest point jumps from one to the other;
//     there the depth is a smooth maximum over facets of different normals,
//         depth = depth_0 + sum_j max(0, eps_j - (depth_0 - depth_j))^2 / (4 eps_j),   eps_j = blend r |n_j - n_0|,
//     whose width vanishes with the angle between them. Bias at most eps/4 for each plane that is within eps. A plane counts once,
//     with the nearest of its triangles (else a valley would push with as many as it is cut into), and that of the nearest point
//     is never blended: there n_j would be tilted by nothing but the edge's offset.
//   * touch 1: the nearest point of the opposite wall of a narrow lumen. Which facets are of the one side and which of the other is
//     told by an axis: a facet whose normal looks against it is of the other side. The axis is the normal of touch 0 when contact
//     begins, and its last normal from then on: it stands still during a step, so that the forces of both sides are continuous even
//     where the lumen is as narrow as the wire and walls all round push at once.
//   * a facet seen from behind never pushes (the far side of a thin septum; the outside of the vessel, for a wire that has left
//     through an opening), unless it is the nearest of all and the sample touched the wall from inside in the last step: then
//     the axis has passed the wall, the depth is r + distance and the normal points back.
//   * a rim (the free edge at an opening) has no sides: it pushes like a bar, so that contact fades as the wire slides off it.
#ifndef SEL_SHARED_CONTACT_GAP_H
#define SEL_SHARED_CONTACT_GAP_H
#include "shared/triangle.h"

SEL_BEGIN

typedef struct Touch {
    vec3 normal;    // into the lumen; unit up to blending
    vec3 to_wall;   // from the axis point to the wall's [m]
    vec3 side;      // facets whose normal looks along it are of this side of the lumen, the others of the opposite one
    real depth;     // overlap [m], negative when apart
    real bend[6];   // d2(depth)/dp2 of the blend: xx xy xz yy yz zz [1/m]
    uint triangle;
    int found, outside;
} Touch;

#ifdef SEL_FLOAT32
    #define SEL_TIE 1e-6f
#else
    #define SEL_TIE 1e-9
#endif

#define SEL_COPLANAR 1e-5f  // normals nearer than this [rad] lie in one plane: float32 vertices of one, 1 mm apart, differ by 4e-6

#define SEL_BLEND_PLANES 8  // round one sample; beyond, the shallowest is left out: facets of a few um on a doubly curved wall

// A plane next to the nearest facet's, as the sample sees it.
typedef struct BlendPlane {
    vec3 facet;  // its normal
    vec3 turn;   // direction to the sample, less that of the nearest point
    real depth, eps, rest;  // see above; rest = eps_j - (depth_0 - depth_j) > 0
} BlendPlane;

SEL_FN int in_one_plane(vec3 a, vec3 b)
{
    const vec3 turn = a - b;
    return dot3(turn, turn) < (real)SEL_COPLANAR * (real)SEL_COPLANAR;
}

// Takes `found` into the list: in the place of its plane when it is nearer, else at the end, else for the shallowest.
SEL_FN uint keep_plane(BlendPlane* planes, uint count, BlendPlane found)
{
    uint at = count, shallowest = 0;
    for (uint k = 0; k < count; ++k) {
        if (in_one_plane(planes[k].facet, found.facet)) at = k;
        if (planes[k].depth < planes[shallowest].depth) shallowest = k;
    }
    const int is_new = at == count;
    if (at == SEL_BLEND_PLANES) at = shallowest;
    if (at == count || planes[at].depth < found.depth) planes[at] = found;
    return is_new && count < SEL_BLEND_PLANES ? count + 1 : count;
}

// rim bits of a triangle: bit k: edge k (v_k, v_{k+1}) lies on an opening; bit 3 + k: vertex k does
SEL_FN int on_rim(uint bits, int feature)
{
    return feature > 0 && (int)((bits >> (feature - 1)) & 1u);
}

// p, origin: see load_triangle. candidates: [count] triangle indices.
// front_only: walls seen from behind are not there.
SEL_FN Touch nearest_touch(vec3 p, vec3 origin, real radius, real reach, int front_only, SEL_GLOBAL const uint* candidates,
                           uint count, SEL_GLOBAL const float* vertices, SEL_GLOBAL const uint* rims)
{
    Touch touch;
    touch.normal = make_vec3(0, 0, 0);
    touch.to_wall = make_vec3(0, 0, 0);
    touch.side = make_vec3(0, 0, 0);
    touch.found = 0;
    touch.outside = 0;
    touch.triangle = 0;
    touch.depth = -reach;
    for (int k = 0; k < 6; ++k) touch.bend[k] = 0;
    // nothing beyond `reach` is ever reported: the answer must not depend on which far triangles happen to be in the list
    real best2 = (radius + reach) * (radius + reach), best_align = 0;
    for (uint k = 0; k < count; ++k) {
        const uint t = candidates[k];
        const Triangle tri = load_triangle(vertices, t, origin);
        if (triangle_box_distance2(p, tri) > best2 * (1 + SEL_TIE)) continue;
        int feature;
        const vec3 v = p - closest_on_triangle(p, tri, &feature);
        const real d2 = dot3(v, v);
        if (d2 > best2 * (1 + SEL_TIE)) continue;
        const int rim = on_rim(rims[t], feature);
        const vec3 facet = triangle_normal(tri);
        const real d = sqrt(d2);
        // on a shared edge or vertex the side is told by the facet that looks most along v [Baerentzen05]
        real align = d > (real)1e-3 * radius ? dot3(v, facet) / d : dot3(v, facet) >= 0 ? (real)1 : (real)-1;
        if (rim) align = fabs(align);
        if (front_only && align < 0) continue;
        if (d2 >= best2 * (1 - SEL_TIE) && fabs(align) <= fabs(best_align)) continue;
        best2 = d2;
        best_align = align;
        touch.found = 1;
        touch.triangle = t;
        touch.outside = align < 0;
        touch.depth = align < 0 ? radius + d : radius - d;
        touch.to_wall = -v;
        // near the wall the direction v/d is noise; on a face it is the facet's normal anyway
        touch.normal = (feature == SEL_FEATURE_FACE || d <= (real)1e-3 * radius) ? facet : ((align < 0 ? -1 : 1) / d) * v;
    }
    return touch;
}

// Blends neighbouring facets into `first` and looks for the opposite wall; see above.
SEL_FN Touch blend_and_oppose(Touch* first, vec3 p, vec3 origin, real radius, real reach, real blend,
                              SEL_GLOBAL const uint* candidates, uint count, SEL_GLOBAL const float* vertices,
                              SEL_GLOBAL const uint* rims)
{
    Touch second = *first;
    second.found = 0;
    for (int k = 0; k < 6; ++k) second.bend[k] = 0;
    if (!first->found || first->outside || first->depth < -reach) return second;
    const vec3 n0 = first->normal, facet0 = triangle_normal(load_triangle(vertices, first->triangle, origin));
    const real depth0 = first->depth;
    const real along = dot3(n0, first->side);
    first->side = along == 0 ? n0 : (along > 0 ? 1 : -1) * first->side;
    second.side = -first->side;
    real second_depth = -reach;
    BlendPlane planes[SEL_BLEND_PLANES];
    uint plane_count = 0;
    // beyond these nothing is found: of the other side; and of this one, where eps <= 2 blend r
    const real reached2 = (1 + SEL_TIE) * (radius + reach) * (radius + reach);
    const real blended = radius - depth0 + 2 * blend * radius, blended2 = (1 + SEL_TIE) * blended * blended;
    for (uint k = 0; k < count; ++k) {
        const uint t = candidates[k];
        if (t == first->triangle) continue;
        const Triangle tri = load_triangle(vertices, t, origin);
        const real box2 = triangle_box_distance2(p, tri);
        if (box2 > reached2) continue;
        if (box2 > blended2 && dot3(p - tri.a, first->side) >= 0 && dot3(p - tri.b, first->side) >= 0 && dot3(p - tri.c, first->side) >= 0)
            continue;
        int feature;
        const vec3 v = p - closest_on_triangle(p, tri, &feature);
        const real d2 = dot3(v, v);
        if (d2 > (radius + reach) * (radius + reach) || !(d2 > 0)) continue;
        const vec3 facet = triangle_normal(tri);
        if (dot3(v, facet) <= 0 && !on_rim(rims[t], feature)) continue;
        const real d = sqrt(d2);
        const vec3 n = (1 / d) * v;
        const real depth = radius - d;
        if (dot3(n, first->side) < 0) {
            if (depth > second_depth) {
                second_depth = depth;
                second.found = 1;
                second.triangle = t;
                second.depth = depth;
                second.normal = n;
                second.to_wall = -v;
            }
            continue;
        }
        if (in_one_plane(facet, facet0)) continue;
        BlendPlane plane;
        plane.facet = facet;
        plane.turn = n - n0;
        plane.depth = depth;
        plane.eps = blend * radius * sqrt(dot3(plane.turn, plane.turn));
        plane.rest = plane.eps - (depth0 - depth);
        if (plane.eps < (real)1e-7 * blend * radius || plane.rest <= 0) continue;
        plane_count = keep_plane(planes, plane_count, plane);
    }
    for (uint k = 0; k < plane_count; ++k) {
        const vec3 dn = planes[k].turn;
        const real eps = planes[k].eps, rest = planes[k].rest, bend = 1 / (2 * eps);
        first->depth += rest * rest / (4 * eps);
        first->normal = first->normal + (rest / (2 * eps)) * dn;
        first->bend[0] += bend * dn.x * dn.x;
        first->bend[1] += bend * dn.x * dn.y;
        first->bend[2] += bend * dn.x * dn.z;
        first->bend[3] += bend * dn.y * dn.y;
        first->bend[4] += bend * dn.y * dn.z;
        first->bend[5] += bend * dn.z * dn.z;
    }
    return second;
}

SEL_END
#endif
