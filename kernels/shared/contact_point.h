// Contact of one quadrature point: its contact points with the wall near it, and the forces of the laws. The kernel of
// evaluation.cl calls contact_force once per work-item, the host reference in a loop.
#ifndef SEL_SHARED_CONTACT_POINT_H
#define SEL_SHARED_CONTACT_POINT_H
#include "shared/clearance.h"
#include "shared/contact_law.h"
#include "shared/contact_records.h"
#include "shared/opposite_wall.h"
#include "shared/point_motion.h"
#include "shared/walk.h"
#include "shared/wall_memory.h"

SEL_BEGIN

// Tests whether a point of the axis has gone through the wall since the step began.
//
// A quadrature point may enter a sharp fold of a mesh, narrower than its move in a step, without a trial that touches it from the
// front. The nearest facet is then seen from behind, pushes nobody, and the point would stay inside. Its path since the start of
// the step tells it from one that left through an opening or never was in this lumen: that path crosses the wall from front to
// back, net.

// Does the line from a along d pass edge (u, v) on its left? The sign is of the edge, not of the triangle: neighbours agree about
// it.
SEL_FN real passes_left(vec3 a, vec3 d, vec3 u, vec3 v) { return dot3(d, cross3(u - a, v - a)); }

// 1: from front to back, -1: from back to front, 0: not through it.
SEL_FN int crossing(vec3 from, vec3 to, Triangle tri)
{
    const vec3 n = triangle_normal(tri);
    const int before = dot3(n, from - tri.a) >= 0, after = dot3(n, to - tri.a) >= 0;
    if (before == after) return 0;
    const vec3 d = to - from;
    const real ab = passes_left(from, d, tri.a, tri.b), bc = passes_left(from, d, tri.b, tri.c),
               ca = passes_left(from, d, tri.c, tri.a);
    if (!((ab <= 0 && bc <= 0 && ca <= 0) || (ab >= 0 && bc >= 0 && ca >= 0))) return 0;
    return before ? 1 : -1;
}

// @param to  relative to `origin`, where the point is now   @param move  since the start of the step
SEL_FN int gone_through(vec3 to, vec3 move, vec3 origin, NearWallView near)
{
    const real far = sqrt(dot3(move, move));
    int net = 0;
    Walk walk;
    start_walk(&walk);
    uint t;
    while (next_triangle(&walk, near, ball_query(to, origin, (1 + SEL_WALK_MARGIN) * far), &t))
        net += crossing(to - move, to, load_triangle(near.wall.vertices, t, origin));
    return net > 0;
}

// The two records of a quadrature point at the start of the step, and which of them belong to the last one. They are read where
// they are used: both of them for the whole evaluation are 40 registers.
typedef struct LastTouch {
    SEL_GLOBAL const ContactState* states;  // [2]
    int a_lives, b_lives;
} LastTouch;

SEL_FN LastTouch last_touch(uint s, uint epoch, SEL_GLOBAL const ContactState* states_t0)
{
    LastTouch was;
    was.states = states_t0 + 2 * s;
    was.a_lives = was.states[0].epoch + 1 == epoch;
    was.b_lives = was.states[1].epoch + 1 == epoch;
    return was;
}

SEL_FN int lives(LastTouch was, uint k) { return k == 0 ? was.a_lives : was.b_lives; }

SEL_FN ContactState last_state(LastTouch was, uint k) { return lives(was, k) ? was.states[k] : no_contact_state(); }

SEL_FN vec3 last_normal(LastTouch was, uint k)
{
    SEL_GLOBAL const real* n = was.states[k].normal;
    return make_vec3(n[0], n[1], n[2]);
}

// Squared distance of the nearest of the triangles that were touched last; 1e30 where none was.
SEL_FN real touched_distance2(ContactBall ball, WallView wall, LastTouch was)
{
    real near2 = (real)1e30;
    SEL_ROLLED for (uint k = 0; k < 2; ++k) if (lives(was, k)) near2 =
        min_r(near2, triangle_distance2(ball.p, ball.origin, was.states[k].triangle, wall.vertices));
    return near2;
}

// Is the nearest facet seen from behind, and was it not touched in the last step?
SEL_FN int is_behind(SEL_OUT const ContactPoint* first, LastTouch was)
{
    const vec3 n = first->normal;
    return first->outside && !(was.a_lives && dot3(last_normal(was, 0), n) > 0) &&
           !(was.b_lives && dot3(last_normal(was, 1), n) > 0);
}

// Axis of the side of the lumen, from the last step; zero without one.
SEL_FN vec3 last_side(LastTouch was)
{
    return was.a_lives ? last_normal(was, 0) : was.b_lives ? last_normal(was, 1) : make_vec3(0, 0, 0);
}

#if !SEL_SUMS_IN_MEMORY
typedef struct ContactPointPair {
    ContactPoint first, second;  // the nearer side of the lumen, and the opposite one
    int behind;                  // see is_behind
} ContactPointPair;

// The nearest facet.
SEL_FN void nearest_of_all(ContactPoint* side, ContactBall ball, NearWallView near, int front_only, LastTouch was, Recall* recall,
                           NearList* list)
{
    real near2 = (real)1e30;
    if (!front_only) {
        if (recall->kept) near2 = kept_distance2(recall);
        if (recall->kept && find_kept(side, ball, near, near2, list, recall)) return;
        // the last touched triangles are near: nothing farther away needs a test
        near2 = min_r(near2, touched_distance2(ball, near.wall, was));
    }
    if (recall->memory && !front_only) find_and_keep(side, ball, near, near2, list, recall);
    else find_nearest(side, ball, near, front_only, near2, list);
}

SEL_FN ContactPointPair contact_points_of(ContactBall ball, NearWallView near, LastTouch was, Recall recall)
{
    ContactPointPair out;
    NearList list;
    NeighbourPlanes planes;
    ContactPoint side;
    out.behind = 0;
    out.second.found = 0;
    if (find_touch(&out.first, ball, last_side(was), &recall)) return out;
    SEL_ROLLED for (int front_only = 0; front_only <= out.behind; ++front_only) {
        nearest_of_all(&side, ball, near, front_only, was, &recall, &list);
        if (front_only) break;
        out.behind = is_behind(&side, was);
    }
    side.side = last_side(was);
    out.first = side;
    // the smooth maximum is taken on both sides: which of them is nearer may change without a jump
    SEL_ROLLED for (int k = 0; k < 2; ++k) {
        const int joins = has_sides(&side, ball);
        if (joins) join_neighbours(&side, &planes, ball, near, &list);
        if (k == 0) out.first = side;
        else out.second = side;
        if (k == 1 || !joins) break;
        find_opposite(&out.first, &side, ball, near, &recall);
        if (!side.found) {
            keep_touch(&out.first, ball, &recall);
            break;
        }
        list.count = SEL_NEAR_MOST + 1;  // it was of the first
    }
    return out;
}
#endif

// How well a record fits a wall: the cosine between its last normal and the wall's.
SEL_FN real fit(LastTouch was, uint k, MultiplierState multiplier, vec3 normal)
{
    if (lives(was, k)) return dot3(normal, last_normal(was, k));
    return multiplier.live ? normal.x * multiplier.normal[0] + normal.y * multiplier.normal[1] + normal.z * multiplier.normal[2]
                           : (real)0;
}

// Data of a quadrature point when contact is evaluated.
typedef struct PointView {
    uint index;
    QuadratureModel model;
    QuadraturePlace place;
    NearWallView near;
} PointView;

SEL_FN PointView point_view(uint index, QuadratureModel model, QuadraturePlace place, NearWallView near)
{
    const PointView point = {index, model, place, near};
    return point;
}

// Records, two for each quadrature point.
typedef struct StateView {
    SEL_GLOBAL const ContactState* states_t0;       // at the start of the step
    SEL_GLOBAL ContactState* states;                // at its end
    SEL_GLOBAL const MultiplierState* multipliers;  // read by augmented, constraint and impulse alone
} StateView;

SEL_FN StateView state_view(SEL_GLOBAL const ContactState* states_t0, SEL_GLOBAL ContactState* states,
                            SEL_GLOBAL const MultiplierState* multipliers)
{
    const StateView view = {states_t0, states, multipliers};
    return view;
}

// Most second records are empty, before and after.
SEL_FN void clear_state(SEL_GLOBAL ContactState* state)
{
    if (state->epoch != 0) *state = no_contact_state();
}

// Multipliers of record k of quadrature point s, for the laws that have any.
SEL_FN MultiplierState multiplier_of(uint s, uint k, ContactParams par, StateView view)
{
    const int plain = par.normal_law == SEL_NORMAL_DAMPED || par.normal_law == SEL_NORMAL_BARRIER;
    return plain ? no_multiplier() : view.multipliers[2 * s + k];
}

// The record that belongs to this side of the lumen, the first contact point's: the one whose last normal is nearer.
SEL_FN uint record_of(vec3 normal, LastTouch was, uint s, ContactParams par, StateView view)
{
    const MultiplierState a = multiplier_of(s, 0, par, view), b = multiplier_of(s, 1, par, view);
    return (was.b_lives || b.live) && (!(was.a_lives || a.live) || fit(was, 1, b, normal) > fit(was, 0, a, normal));
}

#if !SEL_SUMS_IN_MEMORY
// Contact of one quadrature point.
SEL_FN ContactForce evaluate_point(PointView point, ContactParams par, NodeView nodes, NodeView nodes_t0, StateView view,
                                   SEL_GLOBAL WallMemory* memory, SEL_GLOBAL const Clearance* clearance)
{
    const uint s = point.index;
    LawContext c;
    c.m = point.model;
    c.par = par;
    ContactForce out = no_force(c.m);
    const AxisPoint at = axis_point(point.place.edge, point.place.bary, nodes);
    c.mv = motion_of(point.place, at, nodes, nodes_t0);
    const LastTouch was = last_touch(s, point.place.epoch, view.states_t0);
    uint written = 0;  // bit b: the record b
    const ContactBall ball = contact_ball(at.offset, at.origin, c.m.radius, c.m.reach, par.smoothing);
    ContactPointPair touching = contact_points_of(ball, point.near, was, recall_wall(memory, clearance, ball, par.returns));
    if (touching.behind && !par.known && gone_through(at.offset, c.mv.move, at.origin, point.near))
        out.flags |= SEL_FORCE_BLOCKED;
    if (touching.first.found) {
        const uint first = record_of(touching.first.normal, was, s, par, view);
        const vec3 axis = at.origin + at.offset;
        ContactPoint touch = touching.first;
        SEL_ROLLED for (uint k = 0; k < 2; ++k) {
            if (!touch.found) break;
            const uint b = first ^ k;
            ContactState state = no_contact_state();
            add_contact_point(touch, axis, last_state(was, b), multiplier_of(s, b, par, view), &c, &state, &out);
            if (state.epoch != 0 || view.states[2 * s + b].epoch != 0) view.states[2 * s + b] = state;
            written |= 1u << b;
            touch = touching.second;
        }
        if (out.contacts > 0) out.length = c.m.length;
    }
    SEL_ROLLED for (uint b = 0; b < 2; ++b) if (!(written >> b & 1u)) clear_state(view.states + 2 * s + b);
    return out;
}
#endif

// A quadrature point that touched nothing in the last step and touches nothing now, without more ado. @return 0: it has to be
// evaluated
SEL_FN int is_clear(PointView point, NodeView nodes, StateView view, SEL_GLOBAL Clearance* clearance)
{
    for (uint k = 2 * point.index; k < 2 * point.index + 2; ++k)
        if (view.states_t0[k].epoch + 1 == point.place.epoch) return 0;
    const AxisPoint at = axis_point(point.place.edge, point.place.bary, nodes);
    if (!is_clear_of_wall(at, point.model, point.near, clearance)) return 0;
    for (uint k = 2 * point.index; k < 2 * point.index + 2; ++k) clear_state(view.states + k);
    return 1;
}

#if !SEL_SUMS_IN_MEMORY
// What contact_evaluate does for one quadrature point: see is_clear and evaluate_point.
SEL_FN ContactForce contact_force(PointView point, ContactParams par, NodeView nodes, NodeView nodes_t0, StateView view,
                                  SEL_GLOBAL Clearance* clearance, SEL_GLOBAL WallMemory* memory)
{
    if (is_clear(point, nodes, view, clearance)) return no_force(point.model);
    return evaluate_point(point, par, nodes, nodes_t0, view, memory, clearance);
}
#endif

SEL_END
#endif
