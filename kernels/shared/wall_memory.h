// Memory of the wall that a quadrature point keeps from one evaluation to the next, on devices that evaluate a point in one item.
// Between two trials, and from step to step, a point moves by a small part of the radius. Meanwhile the same few triangles can be
// the nearest, and there is the same room beyond the axis. A walk through the tree notes them, with their distances:
//   * every triangle within `range` of `at`. At p, moved by m, a triangle at the distance d is between d - m and d + m away, and
//     what was not noted is beyond range - m. The search looks at those alone that can count. If the shell in which
//     triangles count ends before range - m, its result is that of a walk; else it walks.
//   * `clear`: within radius + reach + clear of `clear_at` the wall keeps, along clear_side, that distance behind the axis:
//     (clear_at - x) . clear_side >= clear for all its points x. At p, with another side, a point within the reach that counts has
//     (p - x) . side >= clear - m - |side - clear_side| (radius + reach + m). While that is not below 0 there is no opposite wall.
//   * `touch`: the contact point at one place, where there was no opposite wall. A linearised step (D5) begins where the last one has
//     ended, and finds the same point there (par.returns). Its side is another one by then. If the room is known for that side too, all
//     facets within reach have (p - x) . side >= 0 with both, and are of the own side.
// Triangles are noted in the tree's order, and tested again in that order. Holds knowledge of the wall only: results have the
// same bits with it and without (tests/contact/test_wall_memory.cpp).
#ifndef SEL_SHARED_WALL_MEMORY_H
#define SEL_SHARED_WALL_MEMORY_H
#include "shared/clearance.h"
#include "shared/opposite_wall.h"

SEL_BEGIN

#define SEL_KEPT_MOST 12
// How far beyond what counts triangles are noted, in radii: 1/10 lasts for some steps of 20 um; less where they are small, and
// many.
#define SEL_KEPT_BEYOND ((real)0.1)
#define SEL_KEPT_BEYOND_CROWDED ((real)0.01)
#define SEL_KEPT_CLEAR ((real)0.3)
#define SEL_TOUCH_DEEPEST ((real)0.9)  // of the radius: with its axis on a facet a point's normal is the facet's, not p - x

// Contact of a point at one place; `known` 0: none.
typedef struct TouchMemory {
    real offset[3], origin[3];  // of the ball: the same bits
    real normal[3], to_wall[3], depth, hessian[6];
    uint triangle, known;
} TouchMemory;

// Zeros: nothing is known. Positions are relative to the mesh centre [m].
typedef struct WallMemory {
    real at[3], range;
    real clear_at[3], clear_side[3], clear;  // clear 0: not known; below 0: it was looked for at clear_at, and is not so
    real distance[SEL_KEPT_MOST];            // of `triangle`, from `at` [m]
    uint triangle[SEL_KEPT_MOST];
    uint count;
    uint crowded;  // how often they were too many near `at`: 1: less is noted, 2: nothing
    TouchMemory touch;  // last: only who returns reads it
} WallMemory;

#if !SEL_SUMS_IN_MEMORY

// How far the listed nodes hold the whole wall round p.
SEL_FN real listed_range(vec3 p, real radius, SEL_GLOBAL const Clearance* known)
{
    return known->range - distance_from(p, known->list_at) - SEL_CLEARANCE_MARGIN * radius;
}

// A point at an evaluation, and its memory.
typedef struct Recall {
    SEL_GLOBAL WallMemory* memory;  // 0: none
    SEL_GLOBAL const Clearance* known;
    real moved;  // since triangles were noted, at most [m]
    int kept;    // they may serve
    int returns;  // ContactParams'
} Recall;

SEL_FN Recall no_recall(void)
{
    const Recall recall = {0, 0, 0, 0, 0};
    return recall;
}

// @param memory  0: none     returns  ContactParams'
SEL_FN Recall recall_wall(SEL_GLOBAL WallMemory* memory, SEL_GLOBAL const Clearance* known, ContactBall ball, uint returns)
{
    Recall recall = no_recall();
    if (!memory) return recall;
    recall.memory = memory;
    recall.known = known;
    recall.returns = returns != 0;
    recall.moved = distance_from(ball.origin + ball.p, memory->at) + SEL_CLEARANCE_MARGIN * ball.radius;
    recall.kept = recall.moved < memory->range;
    return recall;
}

// Squared distance that the nearest triangle is not beyond, by the kept ones; they do not serve where none of them can be the
// nearest.
SEL_FN real kept_distance2(Recall* recall)
{
    real least = (real)1e15;
    for (uint k = 0; k < recall->memory->count; ++k) least = min_r(least, recall->memory->distance[k]);
    recall->kept = recall->moved <= recall->memory->range - least;
    return (least + recall->moved) * (least + recall->moved);
}

// The nearest of the kept triangles. @return it is the nearest of all
SEL_FN int find_kept(ContactPoint* contact, ContactBall ball, NearWallView near, real near2, NearList* list,
                       const Recall* recall)
{
    NearSearch search = start_search(contact, ball, 0, near2);
    SEL_GLOBAL const WallMemory* memory = recall->memory;
    for (uint k = 0; k < memory->count; ++k)
        if (memory->distance[k] - recall->moved <= search.shell)
            (void)look_at(contact, &search, memory->triangle[k], ball, near.wall, 0, list, 0);
    list->count = search.listed;
    return search.shell + recall->moved <= memory->range;
}

// find_nearest of both sides of the wall, noting triangles.
SEL_FN void find_and_keep(ContactPoint* contact, ContactBall ball, NearWallView near, real near2, NearList* list,
                            const Recall* recall)
{
    SEL_GLOBAL WallMemory* memory = recall->memory;
    if (recall->moved > ball.radius) memory->crowded = 0;
    const real beyond = (memory->crowded == 0   ? SEL_KEPT_BEYOND
                         : memory->crowded == 1 ? SEL_KEPT_BEYOND_CROWDED
                                                : (real)0) *
                        ball.radius;
    const vec3 p = ball.origin + ball.p;
    NearSearch search = start_search(contact, ball, 0, near2);
    Walk walk;
    start_walk(&walk);
    uint t, kept = 0;
    while (next_triangle(&walk, near, ball_query(ball.p, ball.origin, search.shell + beyond), &t)) {
        const real d2 = look_at(contact, &search, t, ball, near.wall, 0, list, beyond), farthest = search.shell + beyond;
        if (!(beyond > 0) || d2 > farthest * farthest) continue;
        if (kept < SEL_KEPT_MOST) {
            memory->triangle[kept] = t;
            memory->distance[kept] = sqrt(d2);
        }
        ++kept;
    }
    list->count = search.listed;
    const int serves = beyond > 0 && kept <= SEL_KEPT_MOST;
    store_vec(memory->at, p);
    memory->range = serves ? min_r(search.shell + beyond, listed_range(p, ball.radius, recall->known)) : (real)0;
    memory->count = serves ? kept : 0;
    if (!serves && memory->crowded < 2) memory->crowded += 1;
}

// How far the axis has moved, and its side turned, since there was room beyond it.
SEL_FN real room_lost(const ContactPoint* first, ContactBall ball, SEL_GLOBAL const WallMemory* memory)
{
    const real moved = distance_from(ball.origin + ball.p, memory->clear_at) + SEL_CLEARANCE_MARGIN * ball.radius;
    return moved + distance_from(first->side, memory->clear_side) * (ball.radius + ball.reach + moved);
}

// Is it known that there is no opposite wall?
SEL_FN int is_known_clear(const ContactPoint* first, ContactBall ball, SEL_GLOBAL const WallMemory* memory)
{
    return memory->clear > 0 && room_lost(first, ball, memory) <= memory->clear;
}

// walk_opposite, unless it is known to find nothing.
SEL_FN void find_opposite(const ContactPoint* first, ContactPoint* second, ContactBall ball, NearWallView near,
                            const Recall* recall)
{
    SEL_GLOBAL WallMemory* memory = recall->memory;
    const vec3 p = ball.origin + ball.p;
    real room = 0;
    if (memory && first->limit < 0) {
        if (is_known_clear(first, ball, memory)) {
            second->found = 0;
            return;
        }
        const int was_tight = memory->clear < 0 && distance_from(p, memory->clear_at) < (real)0.5 * ball.radius;
        if (!was_tight)
            room = min_r(SEL_KEPT_CLEAR * ball.radius, listed_range(p, ball.radius, recall->known) - ball.radius - ball.reach);
    }
    const int clear = walk_opposite(first, second, ball, near, max_r(room, 0));
    if (!(room > 0)) return;
    memory->clear = clear ? room : (real)-1;
    store_vec(memory->clear_at, p);
    store_vec(memory->clear_side, first->side);
}

SEL_FN vec3 vec3_at(SEL_GLOBAL const real* from) { return make_vec3(from[0], from[1], from[2]); }

SEL_FN int is_at(vec3 v, SEL_GLOBAL const real* at) { return v.x == at[0] && v.y == at[1] && v.z == at[2]; }

// Keeps what a point with sides has found, if it is known that there is no opposite wall.
SEL_FN void keep_touch(const ContactPoint* first, ContactBall ball, const Recall* recall)
{
    if (!recall->returns || !(first->limit < 0) || first->depth > SEL_TOUCH_DEEPEST * ball.radius) return;
    if (!is_known_clear(first, ball, recall->memory)) return;
    SEL_GLOBAL TouchMemory* touch = &recall->memory->touch;
    store_vec(touch->offset, ball.p);
    store_vec(touch->origin, ball.origin);
    store_vec(touch->normal, first->normal);
    store_vec(touch->to_wall, first->to_wall);
    touch->depth = first->depth;
    for (int k = 0; k < 6; ++k) touch->hessian[k] = first->hessian[k];
    touch->triangle = first->triangle;
    touch->known = 1;
}

// The contact point that was found at this very place, if its side has room there too. @return it is that
SEL_FN int find_touch(ContactPoint* first, ContactBall ball, vec3 side, const Recall* recall)
{
    if (!recall->returns || !(dot3(side, side) > 0)) return 0;
    SEL_GLOBAL const TouchMemory* touch = &recall->memory->touch;
    if (!touch->known || !is_at(ball.p, touch->offset) || !is_at(ball.origin, touch->origin)) return 0;
    *first = no_contact_point(ball.reach);
    first->side = side;
    if (!is_known_clear(first, ball, recall->memory)) return 0;
    first->limit = -SEL_SIDE;
    first->found = 1;
    first->normal = vec3_at(touch->normal);
    first->to_wall = vec3_at(touch->to_wall);
    first->depth = touch->depth;
    for (int k = 0; k < 6; ++k) first->hessian[k] = touch->hessian[k];
    first->triangle = touch->triangle;
    return 1;
}

#endif

SEL_END
#endif
