// The opposite wall of a narrow lumen, and the planes that the nearest facet of the own side is joined with (smooth_maximum.h).
//
// An axis distinguishes the facets of both sides: a facet whose normal points against it, by more than 0.2, is of the other side.
// The axis is the normal of contact point 0 when contact begins, and its last normal from then on. It is constant during a step,
// so that the forces of both sides are continuous even in a lumen as narrow as the wire, where walls all round push at once. A
// fifth: the walls of a box, at right angles, are of one side whatever rounding says.
#ifndef SEL_SHARED_OPPOSITE_WALL_H
#define SEL_SHARED_OPPOSITE_WALL_H
#include "shared/smooth_maximum.h"

SEL_BEGIN

#define SEL_SIDE ((real)0.2)  // cosine: see above

// Axis and limit of `first`, whose `side` is the last normal or zero.
SEL_FN void tell_side(SEL_OUT ContactPoint* first)
{
    if (first->limit != 0) return;
    const int axis = dot3(first->side, first->side) > 0, own = !axis || dot3(first->normal, first->side) >= -SEL_SIDE;
    if (!axis) first->side = first->normal;
    if (!own) first->side = -first->side;
    first->limit = own ? -SEL_SIDE : SEL_SIDE;
}

// Does triangle t have the closest point of `facing` too, and a nearer one?
SEL_FN int slopes_on(ContactBall ball, WallView wall, uint t, FacingTriangle facing)
{
    int feature;
    const Triangle tri = load_triangle(wall.vertices, t, ball.origin);
    const vec3 v = ball.p - closest_on_triangle(ball.p, tri, &feature);
    if (!(dot3(v, v) < facing.d * facing.d * (1 - SEL_TIE))) return 0;
    const vec3 q = ball.p - facing.v, off = q - closest_on_triangle(q, tri, &feature);
    const real same = (real)SEL_COPLANAR * ball.radius;
    return dot3(off, off) < same * same;
}

// The triangles round a ball: those of a list, or all within `shell` where it does not hold them.
typedef struct NearTriangles {
    SEL_OUT const NearList* list;
    real shell;
    int listed;
    uint next;
    Walk walk;
} NearTriangles;

SEL_FN NearTriangles near_triangles(SEL_OUT const NearList* list, real shell)
{
    NearTriangles near;
    near.list = list;
    near.shell = shell;
    near.listed = list->count <= SEL_NEAR_MOST;
    near.next = 0;
    start_walk(&near.walk);
    return near;
}

SEL_FN int next_near(NearTriangles* of, ContactBall ball, NearWallView near, uint* t)
{
    if (!of->listed) return next_triangle(&of->walk, near, ball_query(ball.p, ball.origin, of->shell), t);
    while (of->next < of->list->count) {
        const uint k = of->next++;
        if (of->list->d2[k] > of->shell * of->shell) continue;
        *t = of->list->triangle[k];
        return 1;
    }
    return 0;
}

// Does the wall go on towards the ball from the closest point of `facing`, on a triangle other than t?
SEL_FN int goes_on(ContactBall ball, NearWallView near, SEL_OUT const NearList* list, real shell, uint t, FacingTriangle facing)
{
    if (facing.feature == SEL_FEATURE_FACE) return 0;
    NearTriangles others = near_triangles(list, shell);
    uint other;
    SEL_ROLLED while (next_near(&others, ball, near, &other)) if (other != t &&
                                                                  slopes_on(ball, near.wall, other, facing)) return 1;
    return 0;
}

// Are facets beside the nearest to be joined with it, and an opposite wall to be looked for?
SEL_FN int has_sides(SEL_OUT const ContactPoint* first, ContactBall ball)
{
    return first->found && !first->outside && first->depth >= -ball.reach;
}

// Over a ridge or a corner of the wall, d = |v| from it to the axis, the normal v/d turns as the axis moves past:
//     d2(depth)/dp2 = -(1 - n n^T - t t^T)/d,       t along the ridge; none at a corner.
// Right above an edge the wall is still the facet, as on the diagonal of a flat floor.
// Adds that of a joined plane, with its share.
SEL_FN void add_ridge(SEL_OUT ContactPoint* contact, real share, Triangle tri, ContactBall ball)
{
    int feature;
    const vec3 v = ball.p - closest_on_triangle(ball.p, tri, &feature);
    const real d = sqrt(dot3(v, v)), bend = share / d;
    if (feature == SEL_FEATURE_FACE || d <= (real)1e-3 * ball.radius) return;
    const vec3 n = (1 / d) * v;
    if (is_same_direction(n, triangle_normal(tri))) return;
    vec3 t = make_vec3(0, 0, 0);
    if (feature < SEL_FEATURE_VERTEX) {
        const int k = feature - SEL_FEATURE_EDGE;
        t = (k == 0 ? tri.b : k == 1 ? tri.c : tri.a) - (k == 0 ? tri.a : k == 1 ? tri.b : tri.c);
        t = (1 / sqrt(dot3(t, t))) * t;
    }
    contact->hessian[0] -= bend * (1 - n.x * n.x - t.x * t.x);
    contact->hessian[1] += bend * (n.x * n.y + t.x * t.y);
    contact->hessian[2] += bend * (n.x * n.z + t.x * t.z);
    contact->hessian[3] -= bend * (1 - n.y * n.y - t.y * t.y);
    contact->hessian[4] += bend * (n.y * n.z + t.y * t.z);
    contact->hessian[5] -= bend * (1 - n.z * n.z - t.z * t.z);
}

// The planes of neighbouring facets of the own side that are joined with that of `first`, which has sides.
// @param list  of nearest_contact_point for this contact point, or one with more than it holds: then the triangles are walked to
SEL_FN void find_neighbours(SEL_OUT ContactPoint* first, SEL_OUT NeighbourPlanes* planes, ContactBall ball, NearWallView near,
                            SEL_OUT const NearList* list)
{
    tell_side(first);
    const real shell = shell_distance(ball.radius - first->depth, ball);
    const vec3 facet = triangle_normal(load_triangle(near.wall.vertices, first->triangle, ball.origin));
    planes->count = 1;
    planes->plane[0] = wall_plane(facet, make_vec3(0, 0, 0), 0, first->triangle);
    planes->plane[0].share = 1;
    NearTriangles round = near_triangles(list, shell);
    uint t;
    SEL_ROLLED while (next_near(&round, ball, near, &t))
    {
        FacingTriangle facing;
        WallPlane plane;
        if (t == first->triangle ||
            !faces(ball, load_triangle(near.wall.vertices, t, ball.origin), near.wall.boundary[t], &facing))
            continue;
        if (dot3(facing.n, first->side) < first->limit || !is_joined(planes, first, ball, t, facing, &plane)) continue;
        if (!goes_on(ball, near, list, shell, t, facing)) keep_plane(planes, plane);
    }
}

// The smooth maximum over these planes, with the ridges that have a share, in place of the nearest facet.
SEL_FN void share_neighbours(SEL_OUT ContactPoint* first, SEL_OUT NeighbourPlanes* planes, ContactBall ball, WallView wall)
{
    smooth_maximum(first, planes, ball);
    if (first->depth <= 0) return;
    SEL_ROLLED for (uint k = 0; k < planes->count; ++k)
    {
        const real share = planes->plane[k].share;
        if (share > 0) add_ridge(first, share, load_triangle(wall.vertices, planes->plane[k].triangle, ball.origin), ball);
    }
}

SEL_PART void join_neighbours(SEL_OUT ContactPoint* first, SEL_OUT NeighbourPlanes* planes, ContactBall ball, NearWallView near,
                            SEL_OUT const NearList* list)
{
    find_neighbours(first, planes, ball, near, list);
    share_neighbours(first, planes, ball, near.wall);
}

SEL_FN void take_opposite(SEL_OUT ContactPoint* second, SEL_OUT const ContactPoint* first, uint t, FacingTriangle facing,
                          real depth)
{
    second->found = 1;
    second->triangle = t;
    second->depth = depth;
    second->normal = facing.n;
    second->to_wall = -facing.v;
    second->side = -first->side;
    second->limit = -first->limit;
}

// Walks to the triangles that may be of the other side: everything beyond `surely_own` along `side`. A triangle so far on the own
// side, all of it, is within the limit as far as it is reached.
// @param room  the reach is longer by that
SEL_FN WallQuery opposite_query(SEL_OUT const ContactPoint* first, ContactBall ball, real surely_own, real room)
{
    const real rounding = SEL_WALK_MARGIN * ball.radius;
    WallQuery query;
    query.side = make_vec3(first->side.x, first->side.y, first->side.z);
    query.p = ball.p - (rounding + surely_own) * query.side;
    query.origin = ball.origin;
    query.range = ball.radius + ball.reach + room + 2 * rounding + surely_own;
    query.shell = 0;
    return query;
}

SEL_FN int is_behind_axis(ContactBall ball, Triangle tri, vec3 side, real by)
{
    return dot3(ball.p - tri.a, side) >= by && dot3(ball.p - tri.b, side) >= by && dot3(ball.p - tri.c, side) >= by;
}

// The nearest triangle of the other side goes to `second`, whose `found` is 0 without one. `first` has sides, and knows them.
// @param room  looks so much farther, and so much farther behind the axis [m]     @return all that is there is of the own side
SEL_FN int walk_opposite(SEL_OUT const ContactPoint* first, SEL_OUT ContactPoint* second, ContactBall ball, NearWallView near,
                         real room)
{
    *second = no_contact_point(ball.reach);
    const real surely_own = max_r(first->limit, 0) * (1 + SEL_TIE) * (ball.radius + ball.reach);
    const real range2 = (ball.radius + ball.reach) * (ball.radius + ball.reach);
    const real wider = ball.radius + ball.reach + room, wider2 = wider * wider;
    const WallQuery query = opposite_query(first, ball, surely_own + room, room);
    real deepest = -ball.reach;
    int clear = 1;
    Walk walk;
    start_walk(&walk);
    uint t;
    while (next_triangle(&walk, near, query, &t)) {
        if (!(room > 0) && t == first->triangle) continue;
        const Triangle tri = load_triangle(near.wall.vertices, t, ball.origin);
        const real box2 = triangle_box_distance2(ball.p, tri);
        if (box2 > wider2 * (1 + SEL_TIE) || is_behind_axis(ball, tri, query.side, surely_own + room)) continue;
        clear = 0;
        if (room > 0 &&
            (t == first->triangle || box2 > range2 * (1 + SEL_TIE) || is_behind_axis(ball, tri, query.side, surely_own)))
            continue;
        FacingTriangle facing;
        if (!faces(ball, tri, near.wall.boundary[t], &facing) || dot3(facing.n, query.side) >= first->limit) continue;
        const real depth = ball.radius - facing.d;
        if (!(depth > deepest)) continue;
        deepest = depth;
        take_opposite(second, first, t, facing, depth);
    }
    return clear;
}

SEL_END
#endif
