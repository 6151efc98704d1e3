// All laws of one contact point: which normal law acts, then friction and rolling under the load that it carries.
#ifndef SEL_SHARED_CONTACT_LAW_H
#define SEL_SHARED_CONTACT_LAW_H
#include "shared/normal_law.h"
#include "shared/contact_gap.h"
#include "shared/contact_sides.h"
#include "shared/friction_law.h"
#include "shared/multiplier_law.h"
#include "shared/rolling_law.h"

SEL_BEGIN

// How a contact point closes: depth now and at the start of the step, and how fast.
typedef struct Closing {
    real depth, depth_t0;  // [m]
    real rate, rate_t0;    // (depth - depth_t0) inv_dt, and that of the last step [m/s]
    real approach;         // v- of (D7) [m/s]
    int fresh;             // there was no contact point in the last step
    int deepens;           // it was less deep at the start of the step
} Closing;

SEL_FN Closing closing_of(ContactPoint contact, vec3 n, ContactState old, const LawContext* c)
{
    Closing closing;
    closing.fresh = old.epoch + 1 != c->mv.epoch;
    const int was_active = !closing.fresh && (old.flags & SEL_CONTACT_ACTIVE);
    closing.depth = contact.depth;
    // without a last gap the rate follows from the move
    closing.depth_t0 = closing.fresh || c->par.known ? contact.depth + dot3(n, c->mv.move) : -old.gap;
    closing.deepens = contact.depth > closing.depth_t0;
    if (closing.fresh) {
        // along the normal a move past an edge or a corner reads as one away from it; by the wall's point it does not
        const vec3 before = contact.to_wall + c->mv.move;
        closing.deepens = closing.deepens || dot3(before, before) > dot3(contact.to_wall, contact.to_wall);
    }
    closing.rate = (contact.depth - closing.depth_t0) * c->par.inv_dt;
    closing.rate_t0 = old.rate;
    closing.approach = was_active ? old.approach : (closing.fresh ? closing.rate : old.rate);
    closing.approach = max_r(closing.approach, c->m.speed_floor);
    return closing;
}

// A trial that the law does not allow, however the forces balance.
SEL_FN int blocked(Closing closing, const LawContext* c)
{
    if (c->par.normal_law == SEL_NORMAL_BARRIER) return closing.depth >= c->mv.radius_reduction;
    const real limit = c->m.depth_limit;
    return limit > 0 && closing.depth > SEL_BLOCKED_AT * limit && closing.deepens;
}

SEL_FN real damped_force(Closing closing, const LawContext* c, real* slope)
{
    if (closing.depth <= 0) return 0;
    const real force = normal_law(closing.depth, closing.rate, closing.approach, c->par.inv_dt, c->m, slope);
    if (closing.fresh && closing.rate > c->m.speed_floor && !c->par.known) {
        // v- is this step's own rate: the factor 1 + beta does not change with depth
        (void)elastic_normal(closing.depth, c->m, slope);
        *slope *= 1 + c->m.damping;
    }
    return force;
}

// Force of a contact point per metre of wire by the law that is asked for, and its slope with depth; 0 where it exerts none.
SEL_FN real normal_force_per_metre(Closing closing, MultiplierState multiplier, const LawContext* c, real* slope)
{
    *slope = 0;
    real depth = closing.depth;
    if (c->par.normal_law == SEL_NORMAL_DAMPED) return damped_force(closing, c, slope);
    if (c->par.normal_law == SEL_NORMAL_BARRIER)
        return barrier_law(c->mv.radius_reduction - depth, c->m.law_length, c->m.penalty_stiffness, slope);
    if (c->par.normal_law == SEL_NORMAL_IMPULSE && c->par.inv_dt > 0) {
        if (closing.fresh || closing.depth_t0 <= 0) return 0;
        depth -= impulse_goal(closing.depth_t0, closing.rate_t0, c->par.inv_dt, c->m);
    }
    return multiplier_law(depth, c->m, multiplier, slope);
}

// Sticking of `constraint`: the multiplier of this step instead of the elastic slip that the contact had (multiplier_law.h).
SEL_FN CarriedState held_by_multiplier(CarriedState carried, MultiplierState multiplier, real friction_stiffness)
{
    for (int i = 0; i < 3; ++i) carried.old.slip[i] = -multiplier.friction[i] / friction_stiffness;
    if (!carried.was_active) carried.old.flags |= SEL_CONTACT_STUCK;
    carried.was_active = 1;
    return carried;
}

// Data of a contact point before its force.
// @param axis  the point of the axis, relative to the mesh centre
SEL_FN void write_contact(ContactPoint contact, vec3 n, vec3 axis, Closing closing, uint epoch, SEL_OUT ContactState* now)
{
    now->epoch = epoch;
    now->flags = contact.outside ? SEL_CONTACT_OUTSIDE : 0u;
    now->gap = -contact.depth;
    now->rate = closing.rate;
    now->approach = closing.approach;
    now->triangle = contact.triangle;
    store_vec(now->normal, n);
    store_vec(now->point, axis + contact.to_wall);
}

// fn along g, the gradient of the gap, and how both change.
SEL_FN void add_normal(ContactPoint contact, NormalLoad load, SEL_OUT ContactForce* out)
{
    const vec3 g = contact.normal;
    const real fn = load.force;
    add_vec(out->force, fn * g);
    add_outer(out->sym, load.slope, g, 0);
    out->sym[0] += fn * contact.hessian[0];
    out->sym[1] += fn * contact.hessian[1];
    out->sym[2] += fn * contact.hessian[2];
    out->sym[4] += fn * contact.hessian[3];
    out->sym[5] += fn * contact.hessian[4];
    out->sym[7] += fn * contact.hessian[5];
    out->contacts += 1;
}

SEL_FN Footprint footprint(real depth, real per_metre, real slope, const LawContext* c)
{
    const int soft = c->par.normal_law == SEL_NORMAL_DAMPED;
    Footprint foot;
    foot.sunk = soft ? depth : depth_carrying(per_metre, c->m);
    foot.dsunk = soft ? (real)1 : foot.sunk * slope / (c->m.exponent * per_metre);
    return foot;
}

#define SEL_FACING ((real)0.7)  // |g| below which facets face each other: a square corner's is 0.707 between its two walls

// Unit normal of the wall at a contact point: that of g, the gradient of the gap. In a lumen as narrow as the wire the facets of
// one side face each other, and g is their common part: it may point along the wire, away from all of them. Then the axis of the
// side takes the place of the parts that have cancelled (opposite_wall.h).
SEL_FN vec3 wall_normal(ContactPoint contact, vec3 tangent)
{
    const vec3 g = contact.normal;
    const real size = sqrt(dot3(g, g));
    if (size >= SEL_FACING) return (1 / size) * g;
    const vec3 across = contact.side - dot3(contact.side, tangent) * tangent;
    const real wide = sqrt(dot3(across, across));
    const vec3 n = wide > 0 ? g + ((SEL_FACING - size) / wide) * across : g;
    const real all = sqrt(dot3(n, n));
    return all > 0 ? (1 / all) * n : n;
}

// The normal force of a contact point, as friction and rolling need it.
typedef struct Pressure {
    NormalLoad held;        // what they go by
    real pushed;            // [N]
    real per_metre, slope;  // [N/m], [N/m^2]
    int acts, was_active;   // was_active: it was in contact at the start of the step
} Pressure;

// Normal law of one contact point. `old` is its state at the start of the step.
SEL_FN Pressure add_pressure(ContactPoint contact, vec3 axis, ContactState old, MultiplierState multiplier, const LawContext* c,
                             SEL_OUT ContactState* now, SEL_OUT ContactForce* out)
{
    const ContactParams par = c->par;
    const vec3 n = wall_normal(contact, c->mv.tangent);
    const Closing closing = closing_of(contact, n, old, c);
    Pressure pressure;
    pressure.acts = 0;
    write_contact(contact, n, axis, closing, c->mv.epoch, now);
    out->depth = max_r(out->depth, contact.depth);
    if (contact.outside) out->flags |= SEL_FORCE_OUTSIDE;
    if (!par.known && blocked(closing, c)) out->flags |= SEL_FORCE_BLOCKED;
    real slope;
    const real per_metre = normal_force_per_metre(closing, multiplier, c, &slope);
    if (c->m.weight * per_metre <= 0) return pressure;
    real ignored;
    NormalLoad load = {c->m.weight * (par.known == SEL_KNOWN_LINEAR ? elastic_normal(contact.depth, c->m, &ignored) : per_metre),
                       c->m.weight * slope};
    add_normal(contact, load, out);
    out->normal_work += load.force * dot3(contact.normal, c->mv.move);
    pressure.pushed = load.force;  // of all facets together, each with its share; their resultant fn g may be smaller
    now->flags |= SEL_CONTACT_ACTIVE;
    now->normal_force = pressure.pushed;
    out->normal_sum += pressure.pushed;
    const int lagged = par.known == SEL_KNOWN_LINEAR && par.friction == SEL_FRICTION_SIGN;
    pressure.held.force = lagged ? c->m.weight * per_metre : pressure.pushed;
    pressure.held.slope = load.slope;
    pressure.per_metre = per_metre;
    pressure.slope = slope;
    pressure.acts = 1;
    pressure.was_active = !closing.fresh && (old.flags & SEL_CONTACT_ACTIVE);
    return pressure;
}

SEL_FN CarriedState carried_state(ContactState old, Pressure pressure)
{
    const CarriedState carried = {old, pressure.was_active};
    return carried;
}

// Friction under that load. @param n  unit normal     @return its tangent, which add_friction_tangent adds
SEL_FN SlipTangent add_rubbing(vec3 n, Pressure pressure, ContactState old, MultiplierState multiplier, const LawContext* c,
                               SEL_OUT ContactState* now, SEL_OUT ContactForce* out)
{
    LawContext holding = *c;
    NormalLoad load = pressure.held;
    CarriedState held_from = carried_state(old, pressure);
    if (c->par.normal_law == SEL_NORMAL_CONSTRAINT && multiplier.live) {
        holding.m.friction_stiffness = SEL_TANGENTIAL * multiplier.stiffness;
        load.force = pressure.pushed;
        held_from = held_by_multiplier(held_from, multiplier, holding.m.friction_stiffness);
    }
    return add_friction_force(n, load, held_from, &holding, now, out);
}

// Friction turns with the normal n, over a ridge of the wall and in a valley between its facets. With the normal's change by a
// move of the axis point, dn = -(1 - n n^T) hessian dx / |g|,
//   d(slip) = -((move + anchor).dn) n - (move.n) dn - r spin t x dn + r ((dn.turn) t - (t.dn) turn)
// (friction_law.h), d(f) = -across d(slip) - (along - across) d (d.d(slip)), and torque and couple change with f and with n.
SEL_FN void add_friction_turn(ContactPoint contact, vec3 n, SlipTangent tangent, const LawContext* c, SEL_OUT ContactForce* out)
{
    const real* h = contact.hessian;
    const vec3 g = contact.normal;
    const real size2 = dot3(g, g);
    const int turns = h[0] != 0 || h[3] != 0 || h[5] != 0;
    if (!tangent.acts || c->par.known || !turns || size2 < SEL_FACING * SEL_FACING) return;
    const PointMotion mv = c->mv;
    const real r = c->m.radius, lever = r / mv.length, shrink = 1 / sqrt(size2);
    const vec3 t = mv.tangent, d = tangent.along_slip, slip = tangent.size * d, f = -tangent.across * slip;
    const vec3 carried = mv.move + (slip - surface_move(n, c));
    for (int j = 0; j < 3; ++j) {
        const vec3 column = j == 0   ? make_vec3(h[0], h[1], h[2])
                            : j == 1 ? make_vec3(h[1], h[3], h[4])
                                     : make_vec3(h[2], h[4], h[5]);
        const vec3 dn = -shrink * (column - dot3(column, n) * n);
        const vec3 du = -dot3(carried, dn) * n - dot3(mv.move, n) * dn - (r * mv.spin) * cross3(t, dn) +
                        r * (dot3(dn, mv.turn) * t - dot3(t, dn) * mv.turn);
        const vec3 df = -tangent.across * du - ((tangent.along - tangent.across) * dot3(d, du)) * d;
        const vec3 dc = lever * (dot3(df, t) * n + dot3(f, t) * dn - dot3(t, dn) * f - dot3(t, n) * df);
        out->skew[j] -= df.x;
        out->skew[3 + j] -= df.y;
        out->skew[6 + j] -= df.z;
        out->skew[9 + j] += r * (dot3(df, cross3(t, n)) + dot3(f, cross3(t, dn)));
        out->skew_wx[j] -= dc.x;
        out->skew_wx[3 + j] -= dc.y;
        out->skew_wx[6 + j] -= dc.z;
    }
    out->flags |= SEL_FORCE_SLIDING;
}

SEL_FN void add_resistance(ContactPoint contact, Pressure pressure, ContactState old, const LawContext* c,
                           SEL_OUT ContactState* now, SEL_OUT ContactForce* out)
{
    add_rolling(contact.normal, footprint(contact.depth, pressure.per_metre, pressure.slope, c), pressure.held,
                carried_state(old, pressure), c, now, out);
}

// One contact point of one quadrature point: normal law, friction, rolling. `old` is its state at the start of the step.
SEL_FN void add_contact_point(ContactPoint contact, vec3 axis, ContactState old, MultiplierState multiplier,
                                const LawContext* c, SEL_OUT ContactState* now, SEL_OUT ContactForce* out)
{
    const Pressure pressure = add_pressure(contact, axis, old, multiplier, c, now, out);
    if (!pressure.acts) return;
    const vec3 n = make_vec3(now->normal[0], now->normal[1], now->normal[2]);
    const SlipTangent rubbing = add_rubbing(n, pressure, old, multiplier, c, now, out);
    add_friction_tangent(n, contact.normal, rubbing, c, out);
    add_friction_turn(contact, n, rubbing, c, out);
    add_resistance(contact, pressure, old, c, now, out);
}

SEL_END
#endif
