// Clearance of quadrature points that touch nothing. Along a wire that merely runs near the wall, 80 % of the quadrature points
// with a list of cells touch nothing. Each of these keeps a clearance sphere, within which it cannot touch anything: that
// costs one distance now and then in place of an evaluation every time. Holds knowledge of the wall only, never of
// the wire: results are the same with it and without.
#ifndef SEL_SHARED_CLEARANCE_H
#define SEL_SHARED_CLEARANCE_H
#include "shared/contact_types.h"
#include "shared/walk.h"

SEL_BEGIN

// Zeros: nothing is known.
typedef struct Clearance {
    real list_at[3];  // where the list was found, relative to the mesh centre [m]
    real range;       // every triangle within that of list_at is in the list [m]
    real at[3];       // centre of the sphere
    real clear;       // its radius: within it, no wall is within radius + reach [m]
} Clearance;

// Margin for lengths near the wire's radius, positions relative to the mesh centre being rounded (to 30 nm in float).
#define SEL_CLEARANCE_MARGIN ((real)1e-3)

// A macro, since `at` may be in any memory.
#define distance_from(p, at) length_of((p)-make_vec3((at)[0], (at)[1], (at)[2]))
SEL_FN real length_of(vec3 d) { return sqrt(dot3(d, d)); }

// What contact_find knows: the list, and that it is empty only if nothing is within `range`.
SEL_FN Clearance found_clearance(vec3 p, real range, real slack, real radius, uint count)
{
    Clearance known;
    store_vec(known.list_at, p);
    store_vec(known.at, p);
    known.range = range;
    known.clear = count > 0 ? (real)0 : slack - SEL_CLEARANCE_MARGIN * radius;
    return known;
}

// The part of the room that a clearance sphere takes at least. A whole one would need boxes and triangles that shorten it by a
// little.
#define SEL_CLEARANCE_PART ((real)0.8)

// How far the triangles below the listed nodes are beyond `touching`, at least SEL_CLEARANCE_PART of it and of `most`; 0: one is
// not.
SEL_FN real near_room(AxisPoint at, real touching, real most, NearWallView near)
{
    real room = most, closed = SEL_CLEARANCE_PART * room;
    Walk walk;
    start_walk(&walk);
    TreeNode leaf;
    while (next_leaf(&walk, near, ball_query(at.offset, at.origin, touching + closed), &leaf))
        for (uint k = 0; k < leaf.count; ++k) {
            const real d = sqrt(triangle_distance2(at.offset, at.origin, leaf.left_or_first + k, near.wall.vertices));
            room = min_r(room, d - touching);
            if (!(room > 0)) return 0;
            closed = SEL_CLEARANCE_PART * room;
        }
    return closed;
}

// Is it known, or can it be known from the list, that a quadrature point touches nothing? Renews the sphere.
SEL_FN int is_clear_of_wall(AxisPoint at, QuadratureModel m, NearWallView near, SEL_GLOBAL Clearance* clearance)
{
    Clearance known = *clearance;
    const vec3 p = at.origin + at.offset;
    if (distance_from(p, known.at) < known.clear) return 1;
    const real margin = SEL_CLEARANCE_MARGIN * m.radius, touching = m.radius + m.reach + margin;
    const real listed = known.range - distance_from(p, known.list_at) - margin;
    if (!(listed > touching)) return 0;
    const real room = near_room(at, touching, listed - touching, near);
    if (!(room > 0)) return 0;
    store_vec(known.at, p);
    known.clear = room;
    *clearance = known;
    return 1;
}

SEL_END
#endif
