// contact_force (contact_point.h) in stages, one kernel each, for devices that run many items at once on few registers. Between
// two stages a quadrature point's record lies in memory. The functions are those of contact_force, in its order, so the results
// have the same bits.
//
//   clear     is_clear; the others go on a list, so that the later stages run over those alone
//   nearest   the nearest facet; behind: once more without walls seen from behind, and whether the point has gone through one
//   join      neighbouring facets of one side of the lumen; share: their smooth maximum; oppose: the opposite wall
//   press, rub, tangent, roll   of one side: normal law, friction, its tangent, rolling resistance
#ifndef SEL_SHARED_CONTACT_STAGES_H
#define SEL_SHARED_CONTACT_STAGES_H
#include "shared/contact_point.h"

SEL_BEGIN

typedef struct ContactStage {
    ContactPoint side[2];  // the nearer side of the lumen, and the opposite one
    NeighbourPlanes planes;
    NearList list;
    Pressure pressure;
    SlipTangent tangent;
    uint flags;   // SEL_FORCE_*
    uint record;  // of side[0]
    int behind;
} ContactStage;

// Room for a record, in reals. Its size differs from device to device: a vec3 of the host has three reals, of OpenCL four.
#define SEL_STAGE_REALS 424
typedef char stage_has_room[sizeof(ContactStage) <= SEL_STAGE_REALS * sizeof(real) ? 1 : -1];

// A quadrature point in a stage, and its movement.
typedef struct StagedPoint {
    PointView point;
    ContactParams par;
    AxisPoint at;
    ContactBall ball;
    LastTouch was;
    StateView view;
} StagedPoint;

SEL_FN StagedPoint staged_point(PointView point, ContactParams par, NodeView nodes, StateView view)
{
    StagedPoint staged;
    staged.point = point;
    staged.par = par;
    staged.at = axis_point(point.place.edge, point.place.bary, nodes);
    staged.ball = contact_ball(staged.at.offset, staged.at.origin, point.model.radius, point.model.reach, par.smoothing);
    staged.was = last_touch(point.index, point.place.epoch, view.states_t0);
    staged.view = view;
    return staged;
}

SEL_FN LawContext staged_context(StagedPoint of, NodeView nodes, NodeView nodes_t0)
{
    const LawContext c = {of.point.model, motion_of(of.point.place, of.at, nodes, nodes_t0), of.par};
    return c;
}

SEL_FN void stage_nearest(StagedPoint of, SEL_OUT ContactStage* stage)
{
    SEL_OUT ContactPoint* first = &stage->side[0];
    find_nearest(first, of.ball, of.point.near, 0, touched_distance2(of.ball, of.point.near.wall, of.was), &stage->list);
    first->side = last_side(of.was);
    stage->behind = is_behind(first, of.was);
    stage->flags = 0;
}

SEL_FN void stage_behind(StagedPoint of, NodeView nodes, NodeView nodes_t0, SEL_OUT ContactStage* stage)
{
    if (!stage->behind) return;
    find_nearest(&stage->side[0], of.ball, of.point.near, 1, (real)1e30, &stage->list);  // walls seen from behind are not there
    stage->side[0].side = last_side(of.was);
    const vec3 move = motion_of(of.point.place, of.at, nodes, nodes_t0).move;
    if (!of.par.known && gone_through(of.at.offset, move, of.at.origin, of.point.near)) stage->flags |= SEL_FORCE_BLOCKED;
}

SEL_FN void stage_join(StagedPoint of, uint side, SEL_OUT ContactStage* stage)
{
    if (!has_sides(&stage->side[side], of.ball)) return;
    find_neighbours(&stage->side[side], &stage->planes, of.ball, of.point.near, &stage->list);
}

SEL_FN void stage_share(StagedPoint of, uint side, SEL_OUT ContactStage* stage)
{
    if (has_sides(&stage->side[side], of.ball))
        share_neighbours(&stage->side[side], &stage->planes, of.ball, of.point.near.wall);
}

SEL_FN void stage_oppose(StagedPoint of, SEL_OUT ContactStage* stage)
{
    stage->list.count = SEL_NEAR_MOST + 1;  // it was of the first
    if (has_sides(&stage->side[0], of.ball)) (void)walk_opposite(&stage->side[0], &stage->side[1], of.ball, of.point.near, 0);
    else stage->side[1].found = 0;
}

// Clears the records and the force before either side adds to them.
SEL_FN void start_force(StagedPoint of, SEL_OUT ContactStage* stage, SEL_GLOBAL ContactState* states, SEL_OUT ContactForce* out)
{
    const int found = stage->side[0].found;
    stage->record = found ? record_of(stage->side[0].normal, of.was, of.point.index, of.par, of.view) : 0u;
    if (found) *out = no_force(of.point.model);
    out->depth = -(of.point.model.radius + of.point.model.reach);
    out->flags = stage->flags;
    out->contacts = 0;
    for (uint k = 0; k < 2; ++k)
        if (!found || !stage->side[k].found) clear_state(states + (stage->record ^ k));
}

// @param states  the point's two records at the end of the step
SEL_FN void stage_press(StagedPoint of, uint side, NodeView nodes, NodeView nodes_t0, SEL_OUT ContactStage* stage,
                        SEL_OUT ContactState* states, SEL_OUT ContactForce* out)
{
    stage->pressure.acts = 0;
    if (!stage->side[0].found || !stage->side[side].found) return;
    const uint b = stage->record ^ side;
    const LawContext c = staged_context(of, nodes, nodes_t0);
    states[b] = no_contact_state();
    stage->pressure = add_pressure(stage->side[side], of.at.origin + of.at.offset, last_state(of.was, b),
                                   multiplier_of(of.point.index, b, of.par, of.view), &c, states + b, out);
    if (out->contacts > 0) out->length = c.m.length;
}

SEL_FN vec3 staged_normal(SEL_OUT const ContactState* state)
{
    return make_vec3(state->normal[0], state->normal[1], state->normal[2]);
}

SEL_FN void stage_rub(StagedPoint of, uint side, NodeView nodes, NodeView nodes_t0, SEL_OUT ContactStage* stage,
                      SEL_OUT ContactState* states, SEL_OUT ContactForce* out)
{
    stage->tangent.acts = 0;
    if (!stage->pressure.acts) return;
    const uint b = stage->record ^ side;
    const LawContext c = staged_context(of, nodes, nodes_t0);
    stage->tangent = add_rubbing(staged_normal(states + b), stage->pressure, last_state(of.was, b),
                                 multiplier_of(of.point.index, b, of.par, of.view), &c, states + b, out);
}

SEL_FN void stage_tangent(StagedPoint of, uint side, NodeView nodes, NodeView nodes_t0, SEL_OUT ContactStage* stage,
                          SEL_OUT const ContactState* states, SEL_OUT ContactForce* out)
{
    if (!stage->pressure.acts || !stage->tangent.acts) return;
    const LawContext c = staged_context(of, nodes, nodes_t0);
    const vec3 n = staged_normal(states + (stage->record ^ side));
    add_friction_tangent(n, stage->side[side].normal, stage->tangent, &c, out);
    add_friction_turn(stage->side[side], n, stage->tangent, &c, out);
}

SEL_FN void stage_roll(StagedPoint of, uint side, NodeView nodes, NodeView nodes_t0, SEL_OUT ContactStage* stage,
                       SEL_OUT ContactState* states, SEL_OUT ContactForce* out)
{
    if (!stage->pressure.acts) return;
    const uint b = stage->record ^ side;
    const LawContext c = staged_context(of, nodes, nodes_t0);
    add_resistance(stage->side[side], stage->pressure, last_state(of.was, b), &c, states + b, out);
}

SEL_END
#endif
