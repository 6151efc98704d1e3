// Contact laws of one touch: normal force (D6b, D6c, D7), friction (D9) and rolling resistance (D10), with their tangents.
//
// Normal: per metre  f = k depth^n (1 + (beta / v-) d(depth)/dt) h(depth), clamped at 0, where the rate over the step is
// (depth - depth_t0) / dt: f is then a growing function of depth alone, so a step minimises a convex energy. The hardening
//     h = 1 / (1 - depth/depth_max)                              wall's own law: it stiffens from the surface on
//     h = 1                                                      to depth_exact: a law given by the user is what was given,
//       = 1 + depth_max/(depth_max - depth_exact) x^2/(1 - x),   x = (depth - depth_exact)/(depth_max - depth_exact), beyond
// makes the law a barrier: whatever pushes, there is an equilibrium short of depth_max. Both have the same pole,
// depth_max/(depth_max - depth) to first order; f and its slope are continuous. From 0.999 depth_max f goes on as its tangent, so
// that a start in overlap can be solved; `BLOCKED` says that a trial went beyond that and deeper than it was: with moves shorter
// than the lumen is wide no wall is ever passed.
//
// Friction acts at the wire's surface, at p = x - r n, where the section that x is the middle of has its material point. In the
// discrete rod a section turns with its edge w = x_b - x_a, of length l and direction t, and spins about it: with
// omega = t x dt + dtheta t
//
//   du = dx + omega x (-r n) = dx - r dtheta (t x n) + r (t (n . dt) - (t . n) dt),     dt = (1 - t t^T) dw / l
//      = dx - r dtheta (t x n) + (r / l) (t (n . dw) - (t . n) dw)
//
// of which only what lies in the wall's plane counts: the slip. Virtual work f . du makes of friction f on the surface a force f
// on the axis point, a torque -r f . (t x n) about the tangent, and a couple C = (r / l) ((f . t) n - (t . n) f), on node b and
// its negative on node a. Its moment l t x C = -r n x (f . t) t (for n across t) is that of the axial friction about the axis of
// bending: Kirchhoff's M' + t x N = r n x f_t t, which is why a rope slides round a drum with the exponent
// mu (1 - r/R) (1 - mu^2 r/R ...) of the axis' radius R instead of mu. The work is the same on both sides: friction takes
// -f . slip, no more and no less. The normal force points at the axis and has no moment.
//
// A linearised step (D5) takes the law at the start, x_0, with the velocity v_0 known there, and must get it as a linear function
// of the move D = x+ - x_0: with f(x, v) the law and v+ = D/h,
//   f + df/dx D + df/dv (D/h - v_0):   force f - df/dv v_0 at D = 0, slope df/dx + df/dv / h.
// For the damped normal law that is the elastic force, and a slope with the known damping factor. Friction that depends on the
// slip s is taken at the slip s_p = s_0 + h v_0 that the known velocity leads to: force f(s_p) - df/ds h v_0 at D = 0. Taken at
// D = 0 instead, where no slip is, stuck springs and sgn(v) would glue every contact for the step. `sign` is explicit as published:
// mu f_n sgn(v_0), without a slope.
#ifndef SEL_SHARED_CONTACT_LAW_H
#define SEL_SHARED_CONTACT_LAW_H
#include "shared/contact_gap.h"
#include "shared/contact_types.h"
#include "shared/hard_law.h"

SEL_BEGIN

#define SEL_HARDENING_END ((real)0.999)  // fraction of depth_max from which the law goes on as its tangent
#define SEL_BLOCKED_AT ((real)0.9995)    // fraction of depth_max beyond which a deepening trial is refused

SEL_FN real depth_power(real depth, real exponent)
{
    if (exponent == (real)1.5) return depth * sqrt(depth);
    if (exponent == 1) return depth;
    if (exponent == 2) return depth * depth;
    return pow(depth, exponent);
}

// h, and its growth h'/h.
SEL_FN real hardening(real depth, SampleModel m, real* growth)
{
    *growth = 0;
    if (m.depth_limit <= 0 || depth <= m.depth_exact) return 1;
    if (m.depth_exact <= 0) {
        const real h = 1 / (1 - depth / m.depth_limit);
        *growth = h / m.depth_limit;
        return h;
    }
    const real span = m.depth_limit - m.depth_exact, strength = m.depth_limit / span;
    const real x = (depth - m.depth_exact) / span, rest = 1 - x;
    const real h = 1 + strength * x * x / rest;
    *growth = strength * x * (2 - x) / (rest * rest * span * h);
    return h;
}

// Static normal law per metre and its derivative; depth > 0.
SEL_FN real elastic_normal(real depth, SampleModel m, real* slope)
{
    const real end = m.depth_limit > 0 ? SEL_HARDENING_END * m.depth_limit : depth;
    const real inside = depth < end ? depth : end;
    const real power = m.stiffness * depth_power(inside, m.exponent);
    real growth;
    const real force = power * hardening(inside, m, &growth);
    *slope = force * (m.exponent / inside + growth);
    return force + *slope * (depth - inside);
}

// Damped law per metre. rate = (depth - depth_t0) inv_dt.
SEL_FN real normal_law(real depth, real rate, real approach, real inv_dt, SampleModel m, real* slope)
{
    real k;
    const real f = elastic_normal(depth, m, &k);
    const real c = m.damping / approach;
    const real damp = 1 + c * rate;
    if (inv_dt == 0 || m.damping == 0) {
        *slope = k;
        return f;
    }
    if (damp <= 0) {
        *slope = 0;
        return 0;
    }
    *slope = k * damp + f * c * inv_dt;
    return f * damp;
}

// What the wire did over the step at this sample.
typedef struct SampleMove {
    vec3 tangent;  // of the edge, unit
    real length;   // of the edge [m]
    vec3 move;     // of the axis point [m]
    vec3 turn;     // of the tangent [-]
    real spin;     // of the edge about its tangent [rad]
    int fresh;     // no start position: no friction yet
    uint stamp;    // of this step for this wire
    real shrink;   // SamplePlace's [m]
} SampleMove;

// adds s * a a^T to the 4 x 4 symmetric block, a = (v, w)
SEL_FN void add_outer(real* sym, real s, vec3 v, real w)
{
    sym[0] += s * v.x * v.x;
    sym[1] += s * v.x * v.y;
    sym[2] += s * v.x * v.z;
    sym[3] += s * v.x * w;
    sym[4] += s * v.y * v.y;
    sym[5] += s * v.y * v.z;
    sym[6] += s * v.y * w;
    sym[7] += s * v.z * v.z;
    sym[8] += s * v.z * w;
    sym[9] += s * w * w;
}

// Slip over a step at which `smooth` and `sign` reach half of the cone [m].
SEL_FN real smooth_slip(ContactParams par)
{
    return par.inv_dt > 0 ? par.smooth_speed / par.inv_dt : par.smooth_speed * (real)1e-3;
}
SEL_FN real sign_slip(ContactParams par)
{
    const real speed = par.smooth_speed * (real)1e-6;
    return par.inv_dt > 0 ? speed / par.inv_dt : speed * (real)1e-3;
}

// Derivative of the slip along v, a direction in the wall's plane, with x, theta and w: also what a force v on the surface does.
typedef struct SlipRow {
    vec3 x;
    real theta;
    vec3 w;
} SlipRow;

SEL_FN SlipRow slip_row(vec3 v, vec3 n, real radius, SampleMove mv)
{
    SlipRow row;
    row.x = v;
    row.theta = -radius * dot3(cross3(mv.tangent, n), v);
    row.w = (radius / mv.length) * (dot3(mv.tangent, v) * n - dot3(mv.tangent, n) * v);
    return row;
}

// adds s * row row^T to the symmetric part
SEL_FN void add_slip(SampleForce* out, real s, SlipRow row)
{
    const real x[3] = {row.x.x, row.x.y, row.x.z}, w[3] = {row.w.x, row.w.y, row.w.z};
    add_outer(out->sym, s, row.x, row.theta);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) out->sym_xw[3 * i + j] += s * x[i] * w[j];
        out->sym_tw[i] += s * row.theta * w[i];
    }
    out->sym_ww[0] += s * w[0] * w[0];
    out->sym_ww[1] += s * w[0] * w[1];
    out->sym_ww[2] += s * w[0] * w[2];
    out->sym_ww[3] += s * w[1] * w[1];
    out->sym_ww[4] += s * w[1] * w[2];
    out->sym_ww[5] += s * w[2] * w[2];
}

// adds s * row g^T to what is unsymmetric
SEL_FN void add_skew(SampleForce* out, real s, SlipRow row, vec3 g)
{
    const real force[4] = {row.x.x, row.x.y, row.x.z, row.theta}, w[3] = {row.w.x, row.w.y, row.w.z};
    for (int i = 0; i < 4; ++i) {
        out->skew[3 * i] += s * force[i] * g.x;
        out->skew[3 * i + 1] += s * force[i] * g.y;
        out->skew[3 * i + 2] += s * force[i] * g.z;
    }
    for (int i = 0; i < 3; ++i) {
        out->skew_wx[3 * i] += s * w[i] * g.x;
        out->skew_wx[3 * i + 1] += s * w[i] * g.y;
        out->skew_wx[3 * i + 2] += s * w[i] * g.z;
    }
}

// A unit vector across n.
SEL_FN vec3 across_of(vec3 n)
{
    const vec3 axis = n.x * n.x < (real)0.5 ? make_vec3(1, 0, 0) : make_vec3(0, 1, 0);
    const vec3 v = cross3(n, axis);
    return (1 / sqrt(dot3(v, v))) * v;
}

// Friction of one touch: writes its state, adds force and tangent. See the top for the slip, and for what is
// taken from the start of the step (par.known).
// @param fn     normal force [N]     dfn  its derivative with depth [N/m]
SEL_FN void add_friction(Touch touch, vec3 n, SampleModel m, SampleMove mv, ContactParams par, TouchState old, int was_active,
                         real fn, real dfn, TouchState* now, SampleForce* out)
{
    if (mv.fresh || par.friction == SEL_FRICTION_NONE) return;
    const vec3 rolled = m.radius * (dot3(n, mv.turn) * mv.tangent - dot3(mv.tangent, n) * mv.turn);  // lies in the wall's plane
    const vec3 move = mv.move - dot3(mv.move, n) * n - (m.radius * mv.spin) * cross3(mv.tangent, n) + rolled;
    const int sticks = par.friction == SEL_FRICTION_STICK_SLIP;
    const int lagged = par.known && par.friction == SEL_FRICTION_SIGN;
    vec3 slip = move;
    if (sticks && par.known == SEL_KNOWN_FORCE) slip = make_vec3(0, 0, 0);  // an anchored spring pulls from where it is
    if (sticks && was_active) {
        // the anchor turns with the wall's tangent plane, keeping its length
        const vec3 s = make_vec3(old.slip[0], old.slip[1], old.slip[2]);
        const vec3 flat = s - dot3(s, n) * n;
        const real was = dot3(s, s), is = dot3(flat, flat);
        slip = slip + (is > 0 ? sqrt(was / is) : (real)0) * flat;
    }
    const real size = sqrt(dot3(slip, slip));
    // a stuck or new touch yields at mu_static, a sliding one at mu_sliding; fixed within the step, so the law is one cone
    const int was_sliding = was_active && !(old.flags & SEL_TOUCH_STUCK);
    const real cone = (sticks && !was_sliding && par.settling != SEL_SETTLE_SLIDING ? m.mu_static : m.mu_sliding) * fn;
    real along, across;  // d|f|/d|slip| along the slip and |f|/|slip| across it
    real force = cone;
    int stuck = 0;
    if (sticks) {
        const real kt = m.friction_stiffness * m.weight;
        stuck = par.settling == SEL_SETTLE_STUCK || kt * size <= cone;
        if (stuck) force = kt * size;
        along = stuck ? kt : 0;
        across = stuck ? kt : cone / size;
    } else {
        // |f| = cone |u| / (|u| + u_s): `smooth`; `sign` is the same with a millionth of the speed
        const real us = par.friction == SEL_FRICTION_SIGN ? sign_slip(par) : smooth_slip(par);
        across = cone / (size + us);
        force = across * size;
        along = across * us / (size + us);
    }
    // slip plane: d and e = n x d; without a slip any two directions
    const vec3 d = size > 0 ? (1 / size) * slip : across_of(n);
    vec3 f = -force * d;
    if (par.known == SEL_KNOWN_LINEAR && !lagged) {
        const real ahead = dot3(d, move);
        f = f + across * (move - ahead * d) + ((size > 0 ? along : across) * ahead) * d;
    }
    const SlipRow exerted = slip_row(f, n, m.radius, mv), row = slip_row(d, n, m.radius, mv);
    out->force[0] += f.x;
    out->force[1] += f.y;
    out->force[2] += f.z;
    out->force[3] += exerted.theta;
    out->couple[0] += exerted.w.x;
    out->couple[1] += exerted.w.y;
    out->couple[2] += exerted.w.z;
    out->flags |= SEL_SAMPLE_COUPLE;
    if (lagged) {
        dfn = 0;
    } else {
        add_slip(out, size > 0 ? along : across, row);
        add_slip(out, across, slip_row(cross3(n, d), n, m.radius, mv));
    }
    if (!stuck && size > 0 && dfn > 0) {
        // -df/dx = mu d (dfn/dx) = -mu dfn d n^T
        add_skew(out, -(cone > 0 ? force / fn : 0) * dfn, row, touch.normal);
        // How the normal turns between two facets is left out: it holds over the blend's micron, and taken for more it keeps Newton
        // from ending in a neck as narrow as the wire (F12), for a tenth fewer iterations round a drum
        out->flags |= SEL_SAMPLE_SLIDING;
    }
    // an elastic slip longer than the cone holds is drawn after the wire
    const real keep = sticks && !stuck && size > 0 ? cone / (m.friction_stiffness * m.weight * size) : 1;
    // a sliding touch sticks again when its trial force is inside the cone of mu_sliding: that is `stuck` above
    now->slip[0] = keep * slip.x;
    now->slip[1] = keep * slip.y;
    now->slip[2] = keep * slip.z;
    now->friction[0] = f.x;
    now->friction[1] = f.y;
    now->friction[2] = f.z;
    if (stuck) now->flags |= SEL_TOUCH_STUCK;
    out->friction_sum += force;
    if (!stuck) out->sliding_sum += force;
}

// A trial that the law does not allow, however the forces balance.
SEL_FN int blocked(real depth, real depth_t0, real shrink, SampleModel m, ContactParams par)
{
    if (par.normal_law == SEL_NORMAL_BARRIER) return depth >= shrink;
    return m.depth_limit > 0 && depth > SEL_BLOCKED_AT * m.depth_limit && depth > depth_t0;
}

// Force of a touch per metre of wire by the law that is asked for, and its slope with depth; 0 where it exerts none.
// @param rate  (depth - depth_t0) inv_dt     rate_t0  that of the last step     approach  v- of (D7)
SEL_FN real touch_force(real depth, real depth_t0, real rate, real approach, int fresh, real rate_t0, real shrink, SampleModel m,
                        ContactParams par, HardState hard, real* slope)
{
    *slope = 0;
    if (par.normal_law == SEL_NORMAL_DAMPED) {
        if (depth <= 0) return 0;
        const real force = normal_law(depth, rate, approach, par.inv_dt, m, slope);
        if (fresh && rate > m.speed_floor && !par.known) {  // v- is this step's own rate: the factor 1 + beta does not change with depth
            (void)elastic_normal(depth, m, slope);
            *slope *= 1 + m.damping;
        }
        return force;
    }
    if (par.normal_law == SEL_NORMAL_BARRIER) return barrier_law(shrink - depth, m.hard_length, m.hard_stiffness, slope);
    if (par.normal_law == SEL_NORMAL_IMPULSE && par.inv_dt > 0) {
        if (fresh || depth_t0 <= 0) return 0;
        depth -= impulse_goal(depth_t0, rate_t0, par.inv_dt, m);
    }
    return multiplier_law(depth, m, hard, slope);
}

// Rolling resistance (D10): an angle spring anchored at the contact that yields at M = roll_arm a fn.
// @param g  gradient of the gap     sunk, dsunk  depth that a is reckoned from, and its derivative with the touch's depth
// @param dfn  derivative of fn with depth [N/m]
SEL_FN void add_rolling(vec3 g, SampleModel m, SampleMove mv, ContactParams par, TouchState old, int was_active, real sunk,
                        real dsunk, real fn, real dfn, TouchState* now, SampleForce* out)
{
    if (m.roll_arm <= 0 || mv.fresh) return;
    const real half_width = sqrt(m.roll_depth * sunk + m.roll_force * fn / m.weight);
    const real most = m.roll_arm * half_width * fn;
    // the spring is as stiff as the surface's tangential one at the wire's radius, so that it adds no softer mode
    const real k = m.friction_stiffness * m.weight * m.radius * m.radius;
    if (par.known && par.friction == SEL_FRICTION_SIGN) {  // M sgn(omega) as published, regularised as sgn(v) is
        out->force[3] -= most * mv.spin / (fabs(mv.spin) + sign_slip(par) / m.radius);
        return;
    }
    const real angle = (was_active ? old.roll : 0) + (par.known == SEL_KNOWN_FORCE ? 0 : mv.spin);
    const real trial = k * fabs(angle);
    const real moment = trial < most ? trial : most;
    const real sign = angle < 0 ? (real)-1 : (real)1;
    out->force[3] -= sign * moment;
    if (trial < most) {
        out->sym[9] += k;
        if (par.known == SEL_KNOWN_LINEAR) out->force[3] += k * mv.spin;
    } else if (half_width > 0) {
        // -dM/dx = sign dM/d(depth) (-g)
        const real widening = (m.roll_depth * dsunk + m.roll_force * dfn / m.weight) / (2 * half_width);
        const real dmost = sign * m.roll_arm * (widening * fn + half_width * dfn);
        out->skew[9] -= dmost * g.x;
        out->skew[10] -= dmost * g.y;
        out->skew[11] -= dmost * g.z;
        out->flags |= SEL_SAMPLE_SLIDING;
    }
    now->roll = sign * moment / k;
    now->moment = -sign * moment;
    out->rolling_sum += moment;
}

// Sticking of `constraint`: the multiplier of this step instead of the elastic slip that the touch had (hard_law.h).
SEL_FN TouchState held_by_multiplier(TouchState old, HardState hard, real friction_stiffness, int was_active)
{
    for (int i = 0; i < 3; ++i) old.slip[i] = -hard.friction[i] / friction_stiffness;
    if (!was_active) old.flags |= SEL_TOUCH_STUCK;
    return old;
}

// One touch of one sample: normal law, friction, rolling. `old` is its state at the start of the step.
SEL_FN void add_touch(Touch touch, vec3 p_centre, SampleModel m, SampleMove mv, ContactParams par, TouchState old, HardState hard,
                      TouchState* now, SampleForce* out)
{
    const int fresh = old.stamp + 1 != mv.stamp;
    const int was_active = !fresh && (old.flags & SEL_TOUCH_ACTIVE);
    const real size = sqrt(dot3(touch.normal, touch.normal));
    const vec3 n = size > 0 ? (1 / size) * touch.normal : touch.normal;
    // without a last gap the rate follows from the move
    const real depth_t0 = fresh || par.known ? touch.depth + dot3(n, mv.move) : -old.gap;
    const real rate = (touch.depth - depth_t0) * par.inv_dt;
    real approach = was_active ? old.approach : (fresh ? rate : old.rate);
    approach = max_r(approach, m.speed_floor);
    now->stamp = mv.stamp;
    now->flags = touch.outside ? SEL_TOUCH_OUTSIDE : 0u;
    now->gap = -touch.depth;
    now->rate = rate;
    now->approach = approach;
    now->triangle = touch.triangle;
    now->normal[0] = n.x;
    now->normal[1] = n.y;
    now->normal[2] = n.z;
    now->point[0] = p_centre.x + touch.to_wall.x;
    now->point[1] = p_centre.y + touch.to_wall.y;
    now->point[2] = p_centre.z + touch.to_wall.z;
    out->depth = max_r(out->depth, touch.depth);
    if (touch.outside) out->flags |= SEL_SAMPLE_OUTSIDE;
    if (!par.known && blocked(touch.depth, depth_t0, mv.shrink, m, par)) out->flags |= SEL_SAMPLE_BLOCKED;
    real slope;
    const real per_metre = touch_force(touch.depth, depth_t0, rate, approach, fresh, old.rate, mv.shrink, m, par, hard, &slope);
    if (m.weight * per_metre <= 0) return;
    const int lagged = par.known == SEL_KNOWN_LINEAR && par.friction == SEL_FRICTION_SIGN;
    real ignored;
    const real fn = m.weight * (par.known == SEL_KNOWN_LINEAR ? elastic_normal(touch.depth, m, &ignored) : per_metre);
    const real dfn = m.weight * slope;
    const vec3 g = touch.normal;
    const real pushed = fn * size;  // |fn g|: between two facets the blended gradient g of the depth is a little shorter than 1
    now->flags |= SEL_TOUCH_ACTIVE;
    now->normal_force = pushed;
    out->force[0] += fn * g.x;
    out->force[1] += fn * g.y;
    out->force[2] += fn * g.z;
    add_outer(out->sym, dfn, g, 0);
    out->sym[0] += fn * touch.bend[0];
    out->sym[1] += fn * touch.bend[1];
    out->sym[2] += fn * touch.bend[2];
    out->sym[4] += fn * touch.bend[3];
    out->sym[5] += fn * touch.bend[4];
    out->sym[7] += fn * touch.bend[5];
    out->normal_sum += pushed;
    out->contacts += 1;
    const real dpushed = dfn * size;
    const real held = lagged ? m.weight * per_metre * size : pushed;  // the force that friction goes by
    if (par.normal_law == SEL_NORMAL_CONSTRAINT && hard.live) {
        SampleModel anchored = m;
        anchored.friction_stiffness = SEL_TANGENTIAL * hard.stiffness;
        add_friction(touch, n, anchored, mv, par, held_by_multiplier(old, hard, anchored.friction_stiffness, was_active), 1, pushed,
                     dpushed, now, out);
    } else {
        add_friction(touch, n, m, mv, par, old, was_active, held, dpushed, now, out);
    }
    const int soft = par.normal_law == SEL_NORMAL_DAMPED;
    const real sunk = soft ? touch.depth : depth_carrying(per_metre, m);
    const real dsunk = soft ? (real)1 : sunk * slope / (m.exponent * per_metre);
    add_rolling(g, m, mv, par, old, was_active, sunk, dsunk, held, dpushed, now, out);
}

SEL_END
#endif
