// The opposite wall of a narrow lumen, and the planes that the nearest facet of the own side is joined with (smooth_maximum.h).
//
// An axis distinguishes the facets of both sides: a facet whose normal points against it, by more than 0.2, is of the other side.
// The axis is the normal of contact point 0 when contact begins, and its last normal from then on. It is constant during a step, so
// that the forces of both sides are continuous even in a lumen as narrow as the wire, where walls all round push at once. A fifth:
// the walls of a box, at right angles, are of one side whatever rounding says.
#ifndef SEL_SHARED_OPPOSITE_WALL_H
#define SEL_SHARED_OPPOSITE_WALL_H
#include "shared/smooth_maximum.h"

SEL_BEGIN

#define SEL_SIDE ((real)0.2)  // cosine: see above

// Axis and limit of `first`, whose `side` is the last normal or zero.
SEL_FN void tell_side(ContactPoint* first)
{
    if (first->limit != 0) return;
    const int axis = dot3(first->side, first->side) > 0, own = !axis || dot3(first->normal, first->side) >= -SEL_SIDE;
    if (!axis) first->side = first->normal;
    if (!own) first->side = -first->side;
    first->limit = own ? -SEL_SIDE : SEL_SIDE;
}

// Planes among the listed triangles.
SEL_FN void join_listed(NeighbourPlanes* planes, const ContactPoint* first, ContactBall ball, WallView wall, const NearList* list)
{
    const real shell = shell_distance(ball.radius - first->depth, ball), shell2 = shell * shell;
    for (uint k = 0; k < list->count; ++k) {
        const uint t = list->triangle[k];
        if (t == first->triangle || list->d2[k] > shell2) continue;
        FacingTriangle facing;
        if (!faces(ball, load_triangle(wall.vertices, t, ball.origin), wall.boundary[t], &facing)) continue;
        if (dot3(facing.n, first->side) < first->limit) continue;
        join_plane(planes, first, ball, facing);
    }
}

SEL_FN void take_opposite(ContactPoint* second, ContactBall ball, uint t, FacingTriangle facing)
{
    const real depth = ball.radius - facing.d;
    if (!(depth > second->depth)) return;
    second->depth = depth;
    second->found = 1;
    second->triangle = t;
    second->normal = facing.n;
    second->to_wall = -facing.v;
}

// The other side is everything beyond this along `side`: a triangle so far on the own side, all of it, is within the limit as far
// as it is reached [m].
SEL_FN real surely_own_height(const ContactPoint* first, ContactBall ball)
{
    return max_r(first->limit, 0) * (1 + SEL_TIE) * (ball.radius + ball.reach);
}

// Walks to the triangles that may be of the other side; where the nearest ones were not listed, to those near the first as well.
SEL_FN WallQuery opposite_query(const ContactPoint* first, ContactBall ball, int listed)
{
    const real surely_own = surely_own_height(first, ball), rounding = SEL_WALK_MARGIN * ball.radius;
    const real shell = shell_distance(ball.radius - first->depth, ball);
    WallQuery query;
    query.p = ball.p - (rounding + surely_own) * first->side;
    query.origin = ball.origin;
    query.range = ball.radius + ball.reach + 2 * rounding + surely_own;
    query.shell = listed ? (real)0 : shell + rounding + surely_own;
    query.side = first->side;
    return query;
}

// The nearest triangle of the other side goes to `second`; planes of the own side to `planes`, unless they were listed.
SEL_FN void walk_opposite(NeighbourPlanes* planes, const ContactPoint* first, ContactPoint* second, ContactBall ball,
                          NearWallView near, int listed)
{
    const real surely_own = surely_own_height(first, ball);
    const real range2 = (ball.radius + ball.reach) * (ball.radius + ball.reach);
    const real shell = shell_distance(ball.radius - first->depth, ball), shell2 = shell * shell;
    const WallQuery query = opposite_query(first, ball, listed);
    Walk walk;
    start_walk(&walk);
    uint t;
    while (next_triangle(&walk, near, query, &t)) {
        if (t == first->triangle) continue;
        const Triangle tri = load_triangle(near.wall.vertices, t, ball.origin);
        const real box2 = triangle_box_distance2(ball.p, tri);
        if (box2 > range2 * (1 + SEL_TIE)) continue;
        if ((listed || box2 > shell2) && dot3(ball.p - tri.a, first->side) >= surely_own &&
            dot3(ball.p - tri.b, first->side) >= surely_own && dot3(ball.p - tri.c, first->side) >= surely_own)
            continue;
        FacingTriangle facing;
        if (!faces(ball, tri, near.wall.boundary[t], &facing)) continue;
        if (dot3(facing.n, first->side) < first->limit) take_opposite(second, ball, t, facing);
        else if (!listed) join_plane(planes, first, ball, facing);
    }
}

// Joins neighbouring facets to `first` and looks for the opposite wall. list: of nearest_contact_point for this contact point, or
// one with more than it holds.
SEL_FN ContactPoint smooth_and_oppose(ContactPoint* first, ContactBall ball, NearWallView near, const NearList* list)
{
    ContactPoint second = *first;
    second.found = 0;
    for (int k = 0; k < 6; ++k) second.hessian[k] = 0;
    if (!first->found || first->outside || first->depth < -ball.reach) return second;
    tell_side(first);
    second.side = -first->side;
    second.limit = -first->limit;
    second.depth = -ball.reach;
    NeighbourPlanes planes;
    planes.count = 0;
    planes.facet0 = triangle_normal(load_triangle(near.wall.vertices, first->triangle, ball.origin));
    const int listed = list->count <= SEL_NEAR_MOST;
    if (listed) join_listed(&planes, first, ball, near.wall, list);
    walk_opposite(&planes, first, &second, ball, near, listed);
    smooth_maximum(first, &planes);
    return second;
}

SEL_END
#endif
