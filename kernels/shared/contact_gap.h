// From a point of the wire's axis and the triangles near it to at most two touches: gap and normal.
//
// The wall is the exact triangle mesh: the answer depends neither on how facets are subdivided in their own planes (a shared edge
// counts once, since only the nearest point counts) nor on triangle order.
//   * touch 0: the nearest point of the wall. Where two facets meet in a valley the nearest point jumps from one to the other;
//     there the depth is a smooth maximum over facets of different normals,
//         depth = depth_0 + sum_j max(0, eps_j - (depth_0 - depth_j))^2 / (4 eps_j),   eps_j = blend r |n_j - n_0|,
//     whose width vanishes with the angle between them. Bias at most eps/4 for each plane that is within eps. A plane counts
//     once, with the nearest of its triangles (else a valley would push with as many as it is cut into), and that of the nearest
//     point is never blended: there n_j would be tilted by nothing but the edge's offset.
//   * touch 1: the nearest point of the opposite wall of a narrow lumen. Which facets are of the one side and which of the other
//   is
//     told by an axis: a facet whose normal looks against it, by more than a fifth, is of the other side. The axis is the normal
//     of touch 0 when contact begins, and its last normal from then on: it stands still during a step, so that the forces of both
//     sides are continuous even where the lumen is as narrow as the wire and walls all round push at once. A fifth: the walls of
//     a box, at right angles, are of one side whatever rounding says.
//   * a facet seen from behind never pushes (the far side of a thin septum; the outside of the vessel, for a wire that has left
//     through an opening), unless it is the nearest of all and the sample touched the wall from inside in the last step: then
//     the axis has passed the wall, the depth is r + distance and the normal points back.
//   * a rim (the free edge at an opening) has no sides: it pushes like a bar, so that contact fades as the wire slides off it.
#ifndef SEL_SHARED_CONTACT_GAP_H
#define SEL_SHARED_CONTACT_GAP_H
#include "shared/walk.h"

SEL_BEGIN

typedef struct Touch {
    vec3 normal;   // into the lumen; unit up to blending
    vec3 to_wall;  // from the axis point to the wall's [m]
    vec3 side;     // facets whose normal looks along it by more than `limit` are of this side of the lumen, the others of the
                   // opposite one
    real limit;    // -SEL_SIDE on the axis's own side, SEL_SIDE on the other; 0: not known yet
    real depth;    // overlap [m], negative when apart
    real bend[6];  // d2(depth)/dp2 of the blend: xx xy xz yy yz zz [1/m]
    uint triangle;
    int found, outside;
} Touch;

#ifdef SEL_FLOAT32
    #define SEL_TIE 1e-6f
#else
    #define SEL_TIE 1e-9
#endif

#define SEL_SIDE ((real)0.2)  // cosine: see above

#define SEL_COPLANAR \
    1e-5f  // normals nearer than this [rad] lie in one plane: float32 vertices of one, 1 mm apart, differ by 4e-6

#define SEL_BLEND_PLANES 8  // round one sample; beyond, the shallowest is left out: facets of a few um on a doubly curved wall

// A plane next to the nearest facet's, as the sample sees it.
typedef struct BlendPlane {
    vec3 facet;             // its normal
    vec3 turn;              // direction to the sample, less that of the nearest point
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
SEL_FN int on_rim(uint bits, int feature) { return feature > 0 && (int)((bits >> (feature - 1)) & 1u); }

// Triangles as near as the nearest, but for what is blended: noted while the nearest is looked for, so that the walls need not be
// walked again.
#define SEL_NEAR_MOST 12
typedef struct NearList {
    uint count;  // beyond SEL_NEAR_MOST: there are more, and the list is of no use
    uint triangle[SEL_NEAR_MOST];
    real d2[SEL_NEAR_MOST];
} NearList;

// Distance within which triangles are blended with a nearest one at the distance d: eps <= 2 blend r.
SEL_FN real shell_distance(real d, real radius, real blend)
{
    return d + (2 * (1 + SEL_WALK_MARGIN) * blend + SEL_WALK_MARGIN) * radius;
}

// p, origin: see load_triangle. cells: [count] nodes of the tree (walk.h).
// front_only: walls seen from behind are not there.
// near2: squared distance of some triangle of the cells, which the nearest cannot be beyond; anything larger than the reach: not
// known
SEL_FN Touch nearest_touch(vec3 p, vec3 origin, real radius, real reach, real blend, int front_only, real near2,
                           SEL_GLOBAL const uint* cells, uint count, SEL_GLOBAL const TreeNode* nodes,
                           SEL_GLOBAL const float* vertices, SEL_GLOBAL const uint* rims, NearList* list)
{
    Touch touch;
    touch.normal = make_vec3(0, 0, 0);
    touch.to_wall = make_vec3(0, 0, 0);
    touch.side = make_vec3(0, 0, 0);
    touch.limit = 0;
    touch.found = 0;
    touch.outside = 0;
    touch.triangle = 0;
    touch.depth = -reach;
    for (int k = 0; k < 6; ++k) touch.bend[k] = 0;
    // nothing beyond `reach` is ever reported: the answer must not depend on which far triangles happen to be in the list
    real best2 = (radius + reach) * (radius + reach), best_align = 0;
    const real known2 = front_only ? best2 : min_r(near2, best2);
    real shell = shell_distance(sqrt(known2), radius, blend);
    list->count = 0;
    Walk walk;
    walk.top = walk.next = 0;
    TreeNode leaf;
    uint t = 0, end = 0;
    for (;; ++t) {
        if (t == end) {
            if (!next_leaf(&walk, cells, count, nodes, p, origin, shell, shell, touch.side, &leaf)) break;
            t = leaf.left_or_first;
            end = t + leaf.count;
        }
        const Triangle tri = load_triangle(vertices, t, origin);
        if (triangle_box_distance2(p, tri) > shell * shell) continue;
        int feature;
        const vec3 v = p - closest_on_triangle(p, tri, &feature);
        const real d2 = dot3(v, v);
        if (d2 <= shell * shell) {
            if (list->count < SEL_NEAR_MOST) {
                list->triangle[list->count] = t;
                list->d2[list->count] = d2;
            }
            ++list->count;
        }
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
        shell = min_r(shell, shell_distance(d, radius, blend));
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

// A plane beside the nearest's, and whether it is blended with it. v: from the triangle's closest point to p, d its length.
SEL_FN int is_blended(const Touch* first, vec3 facet0, vec3 facet, vec3 v, real d, real radius, real blend, BlendPlane* plane)
{
    if (in_one_plane(facet, facet0)) return 0;
    plane->facet = facet;
    plane->turn = (1 / d) * v - first->normal;
    plane->depth = radius - d;
    plane->eps = blend * radius * sqrt(dot3(plane->turn, plane->turn));
    plane->rest = plane->eps - (first->depth - plane->depth);
    return plane->eps >= (real)1e-7 * blend * radius && plane->rest > 0;
}

// Blends neighbouring facets into `first` and looks for the opposite wall; see above. list: of nearest_touch for this touch, or
// one with more than it holds.
SEL_FN Touch blend_and_oppose(Touch* first, vec3 p, vec3 origin, real radius, real reach, real blend,
                              SEL_GLOBAL const uint* cells, uint count, SEL_GLOBAL const TreeNode* nodes,
                              SEL_GLOBAL const float* vertices, SEL_GLOBAL const uint* rims, const NearList* list)
{
    Touch second = *first;
    second.found = 0;
    for (int k = 0; k < 6; ++k) second.bend[k] = 0;
    if (!first->found || first->outside || first->depth < -reach) return second;
    const vec3 n0 = first->normal, facet0 = triangle_normal(load_triangle(vertices, first->triangle, origin));
    const real depth0 = first->depth;
    if (first->limit == 0) {
        const int axis = dot3(first->side, first->side) > 0, own = !axis || dot3(n0, first->side) >= -SEL_SIDE;
        if (!axis) first->side = n0;
        if (!own) first->side = -first->side;
        first->limit = own ? -SEL_SIDE : SEL_SIDE;
    }
    second.side = -first->side;
    second.limit = -first->limit;
    real second_depth = -reach;
    BlendPlane planes[SEL_BLEND_PLANES];
    uint plane_count = 0;
    const int listed = list->count <= SEL_NEAR_MOST;
    const real range2 = (radius + reach) * (radius + reach), shell = shell_distance(radius - depth0, radius, blend),
               shell2 = shell * shell;
    for (uint k = 0; listed && k < list->count; ++k) {
        const uint t = list->triangle[k];
        if (t == first->triangle || list->d2[k] > shell2) continue;
        const Triangle tri = load_triangle(vertices, t, origin);
        int feature;
        const vec3 v = p - closest_on_triangle(p, tri, &feature);
        const real d2 = dot3(v, v);
        if (d2 > range2 || !(d2 > 0)) continue;
        const vec3 facet = triangle_normal(tri);
        if (dot3(v, facet) <= 0 && !on_rim(rims[t], feature)) continue;
        const real d = sqrt(d2);
        BlendPlane plane;
        if (dot3((1 / d) * v, first->side) < first->limit || !is_blended(first, facet0, facet, v, d, radius, blend, &plane))
            continue;
        plane_count = keep_plane(planes, plane_count, plane);
    }
    // a triangle so far on this side, all of it, is within the limit as far as it is reached
    const real surely_own = max_r(first->limit, 0) * (1 + SEL_TIE) * (radius + reach);
    // of the other side is only what lies beyond that along `side`; what is listed has been blended already
    const real rounding = SEL_WALK_MARGIN * radius, range = radius + reach + 2 * rounding + surely_own;
    const vec3 p_side = p - (rounding + surely_own) * first->side;
    const real walked = listed ? (real)0 : shell + rounding + surely_own;
    Walk walk;
    walk.top = walk.next = 0;
    TreeNode leaf;
    uint t = 0, end = 0;
    for (;; ++t) {
        if (t == end) {
            if (!next_leaf(&walk, cells, count, nodes, p_side, origin, range, walked, first->side, &leaf)) break;
            t = leaf.left_or_first;
            end = t + leaf.count;
        }
        if (t == first->triangle) continue;
        const Triangle tri = load_triangle(vertices, t, origin);
        const real box2 = triangle_box_distance2(p, tri);
        if (box2 > range2 * (1 + SEL_TIE)) continue;
        if ((listed || box2 > shell2) && dot3(p - tri.a, first->side) >= surely_own &&
            dot3(p - tri.b, first->side) >= surely_own && dot3(p - tri.c, first->side) >= surely_own)
            continue;
        int feature;
        const vec3 v = p - closest_on_triangle(p, tri, &feature);
        const real d2 = dot3(v, v);
        if (d2 > range2 || !(d2 > 0)) continue;
        const vec3 facet = triangle_normal(tri);
        if (dot3(v, facet) <= 0 && !on_rim(rims[t], feature)) continue;
        const real d = sqrt(d2);
        const vec3 n = (1 / d) * v;
        const real depth = radius - d;
        if (dot3(n, first->side) < first->limit) {
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
        BlendPlane plane;
        if (listed || !is_blended(first, facet0, facet, v, d, radius, blend, &plane)) continue;
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
