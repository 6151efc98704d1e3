// Contact of one quadrature point: its contact points with the wall near it, and the forces of the laws. The kernel of
// evaluation.cl calls contact_force once per work-item, the host reference in a loop.
#ifndef SEL_SHARED_CONTACT_POINT_H
#define SEL_SHARED_CONTACT_POINT_H
#include "shared/clearance.h"
#include "shared/contact_law.h"
#include "shared/contact_records.h"
#include "shared/opposite_wall.h"
#include "shared/point_motion.h"
#include "shared/wall_crossing.h"

// Before a loop of two rounds whose body is long: once in the program, not once a round.
#ifdef __cplusplus
    #define SEL_ROLLED
#else
    #define SEL_ROLLED _Pragma("unroll 1")
#endif

SEL_BEGIN

// The two records of a quadrature point, and which of them belong to the last step.
typedef struct StatePair {
    ContactState a, b;
    int a_lives, b_lives;
} StatePair;

// Whether this record belongs to the wall with this normal.
SEL_FN int same_side(ContactState state, vec3 normal)
{
    return state.normal[0] * normal.x + state.normal[1] * normal.y + state.normal[2] * normal.z > 0;
}

typedef struct ContactPointPair {
    ContactPoint first, second;  // the nearer side of the lumen, and the opposite one
    int behind;                  // the nearest facet is seen from behind, and was not touched in the last step
} ContactPointPair;

SEL_FN ContactPointPair contact_points_of(ContactBall ball, NearWallView near, const StatePair* was)
{
    ContactPointPair out;
    // the last touched triangles are near: nothing farther away needs a test
    real near2 = (real)1e30;
    SEL_ROLLED for (int k = 0; k < 2; ++k)
        if (k == 0 ? was->a_lives : was->b_lives) {
            const uint touched = k == 0 ? was->a.triangle : was->b.triangle;
            near2 = min_r(near2, triangle_distance2(ball.p, ball.origin, touched, near.wall.vertices));
        }
    NearList list;
    ContactPoint first = no_contact_point(ball.reach);
    out.behind = 0;
    SEL_ROLLED for (int front_only = 0; front_only <= out.behind; ++front_only) {
        first = nearest_contact_point(ball, near, front_only, near2, &list);
        if (front_only) break;
        out.behind =
            first.outside && !(was->a_lives && same_side(was->a, first.normal)) && !(was->b_lives && same_side(was->b, first.normal));
    }
    if (was->a_lives) first.side = make_vec3(was->a.normal[0], was->a.normal[1], was->a.normal[2]);
    else if (was->b_lives) first.side = make_vec3(was->b.normal[0], was->b.normal[1], was->b.normal[2]);
    // the smooth maximum is taken on both sides: which of them is nearer may change without a jump
    ContactPoint side = first, second = first;
    SEL_ROLLED for (int k = 0; k < 2; ++k) {
        const ContactPoint opposite = smooth_and_oppose(&side, ball, near, &list);
        if (k == 0) first = side;
        else second = side;
        if (k == 0) side = second = opposite;
        if (!side.found) break;
        list.count = SEL_NEAR_MOST + 1;  // it was of the first
    }
    out.first = first;
    out.second = second;
    return out;
}

// How well a record fits a wall: the cosine between its last normal and the wall's.
SEL_FN real fit(ContactState state, MultiplierState multiplier, int lives, vec3 normal)
{
    if (!lives && multiplier.live)
        return normal.x * multiplier.normal[0] + normal.y * multiplier.normal[1] + normal.z * multiplier.normal[2];
    return normal.x * state.normal[0] + normal.y * state.normal[1] + normal.z * state.normal[2];
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
    PointView point;
    point.index = index;
    point.model = model;
    point.place = place;
    point.near = near;
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
    StateView view;
    view.states_t0 = states_t0;
    view.states = states;
    view.multipliers = multipliers;
    return view;
}

// Both records of a quadrature point; most second ones are empty, before and after.
SEL_FN void write_states(uint s, const ContactState* now, SEL_GLOBAL ContactState* states)
{
    for (uint k = 0; k < 2; ++k)
        if (now[k].epoch != 0 || states[2 * s + k].epoch != 0) states[2 * s + k] = now[k];
}

SEL_FN StatePair states_before(uint s, uint epoch, SEL_GLOBAL const ContactState* states_t0)
{
    StatePair was;
    was.a_lives = states_t0[2 * s].epoch + 1 == epoch;
    was.b_lives = states_t0[2 * s + 1].epoch + 1 == epoch;
    was.a = was.a_lives ? states_t0[2 * s] : no_contact_state();
    was.b = was.b_lives ? states_t0[2 * s + 1] : no_contact_state();
    return was;
}

// Over a ridge or a corner of the wall, d = |v| from it to the axis, the normal v/d turns as the axis moves past:
//     d2(depth)/dp2 = -(1 - n n^T - t t^T)/d,       t along the ridge; none at a corner.
// What the smooth maximum leaves to neighbours of this is not counted.
SEL_FN void add_ridge(ContactPoint* contact, ContactBall ball, NearWallView near)
{
    if (contact->depth <= 0 || contact->outside) return;
    const Triangle tri = load_triangle(near.wall.vertices, contact->triangle, ball.origin);
    int feature;
    const vec3 v = ball.p - closest_on_triangle(ball.p, tri, &feature);
    const real d = sqrt(dot3(v, v));
    if (feature == SEL_FEATURE_FACE || d <= (real)1e-3 * ball.radius) return;
    const vec3 n = (1 / d) * v;
    vec3 t = make_vec3(0, 0, 0);
    if (feature < SEL_FEATURE_VERTEX) {
        const int k = feature - SEL_FEATURE_EDGE;
        t = (k == 0 ? tri.b : k == 1 ? tri.c : tri.a) - (k == 0 ? tri.a : k == 1 ? tri.b : tri.c);
        t = (1 / sqrt(dot3(t, t))) * t;
    }
    contact->hessian[0] -= (1 - n.x * n.x - t.x * t.x) / d;
    contact->hessian[1] += (n.x * n.y + t.x * t.y) / d;
    contact->hessian[2] += (n.x * n.z + t.x * t.z) / d;
    contact->hessian[3] -= (1 - n.y * n.y - t.y * t.y) / d;
    contact->hessian[4] += (n.y * n.z + t.y * t.z) / d;
    contact->hessian[5] -= (1 - n.z * n.z - t.z * t.z) / d;
}

// Contact of one quadrature point.
SEL_FN ContactForce evaluate_point(PointView point, ContactParams par, NodeView nodes, NodeView nodes_t0, StateView view)
{
    const uint s = point.index;
    LawContext c;
    c.m = point.model;
    c.par = par;
    ContactForce out = no_force(c.m);
    const AxisPoint at = axis_point(point.place.edge, point.place.bary, nodes);
    c.mv = motion_of(point.place, at, nodes, nodes_t0);
    const StatePair was = states_before(s, point.place.epoch, view.states_t0);
    uint written = 0;  // bit b: the record b
    const ContactBall ball = contact_ball(at.offset, at.origin, c.m.radius, c.m.reach, par.smoothing);
    ContactPointPair touching = contact_points_of(ball, point.near, &was);
    if (touching.behind && !par.known && gone_through(at.offset, c.mv.move, at.origin, point.near)) out.flags |= SEL_FORCE_BLOCKED;
    if (touching.first.found) {
        // the record that belongs to this side of the lumen: the one whose last normal is nearer
        const int plain = par.normal_law == SEL_NORMAL_DAMPED || par.normal_law == SEL_NORMAL_BARRIER;
        const MultiplierState ma = plain ? no_multiplier() : view.multipliers[2 * s],
                              mb = plain ? no_multiplier() : view.multipliers[2 * s + 1];
        const real to_a = fit(was.a, ma, was.a_lives, touching.first.normal),
                   to_b = fit(was.b, mb, was.b_lives, touching.first.normal);
        const int swap = (was.b_lives || mb.live) && (!(was.a_lives || ma.live) || to_b > to_a);
        const vec3 axis = at.origin + at.offset;
        // records are read where they are used: both of them for the whole evaluation are 40 registers
        ContactPoint touch = touching.first;
        SEL_ROLLED for (uint k = 0; k < 2; ++k) {
            if (!touch.found) break;
            if (c.m.ridges > 0) add_ridge(&touch, ball, point.near);
            const uint b = k == 0 ? (uint)swap : (uint)!swap;
            ContactState state = no_contact_state();
            const ContactState old = (b ? was.b_lives : was.a_lives) ? view.states_t0[2 * s + b] : no_contact_state();
            const MultiplierState multiplier = plain ? no_multiplier() : view.multipliers[2 * s + b];
            add_contact_point(touch, axis, old, multiplier, &c, &state, &out);
            if (state.epoch != 0 || view.states[2 * s + b].epoch != 0) view.states[2 * s + b] = state;
            written |= 1u << b;
            touch = touching.second;
        }
        if (out.contacts > 0) out.length = c.m.length;
    }
    SEL_ROLLED for (uint b = 0; b < 2; ++b)
        if (!(written >> b & 1u) && view.states[2 * s + b].epoch != 0) view.states[2 * s + b] = no_contact_state();
    return out;
}

// A quadrature point that touched nothing in the last step and touches nothing now, without more ado. @return 0: it has to be
// evaluated
SEL_FN int is_clear(PointView point, NodeView nodes, StateView view, SEL_GLOBAL Clearance* clearance)
{
    for (uint k = 2 * point.index; k < 2 * point.index + 2; ++k)
        if (view.states_t0[k].epoch + 1 == point.place.epoch) return 0;
    const AxisPoint at = axis_point(point.place.edge, point.place.bary, nodes);
    if (!is_clear_of_wall(at, point.model, point.near, clearance)) return 0;
    ContactState now[2];
    now[0] = now[1] = no_contact_state();
    write_states(point.index, now, view.states);
    return 1;
}

// What contact_evaluate does for one quadrature point: see is_clear and evaluate_point.
SEL_FN ContactForce contact_force(PointView point, ContactParams par, NodeView nodes, NodeView nodes_t0, StateView view,
                                  SEL_GLOBAL Clearance* clearance)
{
    if (is_clear(point, nodes, view, clearance)) return no_force(point.model);
    return evaluate_point(point, par, nodes, nodes_t0, view);
}

SEL_END
#endif
