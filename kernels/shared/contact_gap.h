// From a point of the wire's axis and the triangles near it to at most two contact points: gap and normal.
//
// The wall is the exact triangle mesh. The result depends neither on triangle order nor on subdivision of facets in their own
// planes. A shared edge counts once, since only the nearest point counts.
//   * contact point 0: the nearest point of the wall. Where two facets meet in a valley the nearest point jumps from one to the
//     other; there the depth is a smooth maximum over facets (smooth_maximum.h).
//   * contact point 1: the nearest point of the opposite wall of a narrow lumen (opposite_wall.h).
//   * a facet seen from behind never pushes (the far side of a thin septum; the outside of the vessel, for a wire that has left
//     through an opening). An exception is the nearest facet of all, if the quadrature point touched the wall from inside in the
//     last step. Then the axis has passed the wall: the depth is r + distance, and the normal points back.
//   * a boundary feature (free edge or vertex at an opening) has no sides. It pushes like a bar, so that contact fades as the wire
//     slides off it.
#ifndef SEL_SHARED_CONTACT_GAP_H
#define SEL_SHARED_CONTACT_GAP_H
#include "shared/walk.h"

SEL_BEGIN

typedef struct ContactPoint {
    vec3 normal;      // into the lumen; unit but where facets are joined by the smooth maximum
    vec3 to_wall;     // from the axis point to the wall's [m]
    vec3 side;        // facets whose normal looks along it by more than `limit` are of this side of the lumen, the others of the
                      // opposite one
    real limit;       // -SEL_SIDE on the axis's own side, SEL_SIDE on the other; 0: not known yet
    real depth;       // overlap [m], negative when apart
    real hessian[6];  // d2(depth)/dp2 of the smooth maximum and of ridges: xx xy xz yy yz zz [1/m]
    uint triangle;
    int found, outside;
} ContactPoint;

// The ball round a point of the axis that asks for contact.
typedef struct ContactBall {
    vec3 p, origin;      // centre, relative to origin, see load_triangle
    real radius, reach;  // of the wire; beyond it, to where contact is looked for [m]
    real smoothing;      // width of the smooth maximum, as a fraction of the radius
} ContactBall;

SEL_FN ContactBall contact_ball(vec3 p, vec3 origin, real radius, real reach, real smoothing)
{
    const ContactBall ball = {p, origin, radius, reach, smoothing};
    return ball;
}

#ifdef SEL_FLOAT32
    #define SEL_TIE 1e-6f
#else
    #define SEL_TIE 1e-9
#endif

// boundary bits of a triangle: bit k: edge k (v_k, v_{k+1}) lies on an opening; bit 3 + k: vertex k does
SEL_FN int on_boundary(uint bits, int feature) { return feature > 0 && (int)((bits >> (feature - 1)) & 1u); }

// Triangles as near as the nearest, but for what the smooth maximum joins: noted while the nearest is looked for, so that the
// walls need not be walked again.
#define SEL_NEAR_MOST 12
typedef struct NearList {
    uint count;  // beyond SEL_NEAR_MOST: there are more, and the list is of no use
    uint triangle[SEL_NEAR_MOST];
    real d2[SEL_NEAR_MOST];
} NearList;

SEL_FN void note_near(SEL_OUT NearList* list, uint count, uint t, real d2)
{
    if (count < SEL_NEAR_MOST) {
        list->triangle[count] = t;
        list->d2[count] = d2;
    }
}

// Distance within which triangles are joined with a nearest one at the distance d: they turn by |n_i - n_j| <= 2
// (smooth_maximum.h).
SEL_FN real shell_distance(real d, ContactBall ball)
{
    return d + (2 * (1 + SEL_WALK_MARGIN) * ball.smoothing + SEL_WALK_MARGIN) * ball.radius;
}

SEL_FN ContactPoint no_contact_point(real reach)
{
    ContactPoint contact;
    contact.normal = contact.to_wall = contact.side = make_vec3(0, 0, 0);
    contact.limit = 0;
    contact.found = contact.outside = 0;
    contact.triangle = 0;
    contact.depth = -reach;
    for (int k = 0; k < 6; ++k) contact.hessian[k] = 0;
    return contact;
}

// The nearest triangle so far.
typedef struct Nearest {
    real d2;     // [m^2]
    real align;  // how much its normal looks at the ball: on a shared edge or vertex the side is told by the facet that looks
                 // most along the direction to the ball [Baerentzen05]
} Nearest;

// Takes triangle t for the contact point if it is nearer than the nearest so far. v: from its closest point to the ball's centre.
// @return it was taken
SEL_FN int take_nearer(SEL_OUT ContactPoint* contact, Nearest* nearest, uint t, ContactBall ball, Triangle tri, vec3 v,
                       int feature, int at_boundary, int front_only)
{
    const real d2 = dot3(v, v), d = sqrt(d2);
    const vec3 facet = triangle_normal(tri);
    const int is_near = d <= (real)1e-3 * ball.radius;
    real align = !is_near ? dot3(v, facet) / d : dot3(v, facet) >= 0 ? (real)1 : (real)-1;
    if (at_boundary) align = fabs(align);
    if (front_only && align < 0) return 0;
    if (d2 >= nearest->d2 * (1 - SEL_TIE) && fabs(align) <= fabs(nearest->align)) return 0;
    nearest->d2 = d2;
    nearest->align = align;
    contact->triangle = t;
    contact->found = 1;
    contact->outside = align < 0;
    contact->depth = align < 0 ? ball.radius + d : ball.radius - d;
    contact->to_wall = -v;
    // near the wall the direction v/d is noise; on a face it is the facet's normal anyway
    contact->normal = (feature == SEL_FEATURE_FACE || is_near) ? facet : ((align < 0 ? -1 : 1) / d) * v;
    return 1;
}

// A search for the nearest triangle.
typedef struct NearSearch {
    Nearest nearest;
    real shell;   // nothing beyond counts [m]
    uint listed;  // triangles so far that are as near as what is joined
} NearSearch;

// @param near2  squared distance of some triangle below the listed nodes, which the nearest cannot be beyond; anything larger
// than the reach: not known
SEL_FN NearSearch start_search(SEL_OUT ContactPoint* contact, ContactBall ball, int front_only, real near2)
{
    *contact = no_contact_point(ball.reach);
    NearSearch search;
    // nothing beyond `reach` is ever reported: the answer must not depend on which far triangles happen to be in the list
    search.nearest.d2 = (ball.radius + ball.reach) * (ball.radius + ball.reach);
    search.nearest.align = 0;
    const real known2 = front_only ? search.nearest.d2 : min_r(near2, search.nearest.d2);
    search.shell = shell_distance(sqrt(known2), ball);
    search.listed = 0;
    return search;
}

// @param beyond  distances up to that beyond the shell are wanted too [m]     @return squared distance; 1e30: it is farther
SEL_FN real look_at(SEL_OUT ContactPoint* contact, NearSearch* search, uint t, ContactBall ball, WallView wall, int front_only,
                    SEL_OUT NearList* list, real beyond)
{
    const Triangle tri = load_triangle(wall.vertices, t, ball.origin);
    const real farthest = search->shell + beyond;
    if (triangle_box_distance2(ball.p, tri) > farthest * farthest) return (real)1e30;
    int feature;
    const vec3 v = ball.p - closest_on_triangle(ball.p, tri, &feature);
    const real d2 = dot3(v, v);
    if (d2 <= search->shell * search->shell) note_near(list, search->listed++, t, d2);
    if (d2 > search->nearest.d2 * (1 + SEL_TIE)) return d2;
    const int at_boundary = on_boundary(wall.boundary[t], feature);
    if (take_nearer(contact, &search->nearest, t, ball, tri, v, feature, at_boundary, front_only))
        search->shell = min_r(search->shell, shell_distance(sqrt(d2), ball));
    return d2;
}

// @param front_only  walls seen from behind are not there
SEL_FN void find_nearest(SEL_OUT ContactPoint* contact, ContactBall ball, NearWallView near, int front_only, real near2,
                         SEL_OUT NearList* list)
{
    NearSearch search = start_search(contact, ball, front_only, near2);
    Walk walk;
    start_walk(&walk);
    uint t;
    while (next_triangle(&walk, near, ball_query(ball.p, ball.origin, search.shell), &t))
        (void)look_at(contact, &search, t, ball, near.wall, front_only, list, 0);
    list->count = search.listed;
}

SEL_END
#endif
