// Friction of one contact point (D9), and its tangent.
//
// Friction acts at the wire's surface, at p = x - r n, where the section that x is the middle of has its material point. In the
// discrete rod a section turns with its edge w = x_b - x_a, of length l and direction t, and spins about it: with
// omega = t x dt + dtheta t
//
//   du = dx + omega x (-r n) = dx - r dtheta (t x n) + r (t (n . dt) - (t . n) dt),     dt = (1 - t t^T) dw / l
//      = dx - r dtheta (t x n) + (r / l) (t (n . dw) - (t . n) dw)
//
// of which only the part in the wall's plane counts: the slip. By virtual work f . du, friction f on the surface is a force f on
// the axis point and a torque -r f . (t x n) about the tangent. There is also a couple: C = (r / l) ((f . t) n - (t . n) f) on
// node b, -C on node a. Its moment l t x C = -r n x (f . t) t (for n across t) is that of the axial friction about the axis of
// bending: Kirchhoff's M' + t x N = r n x f_t t. So a rope slides round a drum with the exponent mu (1 - r/R) (1 - mu^2 r/R ...)
// of the axis' radius R instead of mu. The work is the same on both sides: friction takes -f . slip, no more and no less. The
// normal force points at the axis and has no moment.
//
// A linearised step (D5) takes the law at the start, x_0, with the velocity v_0 known there, and must get it as a linear function
// of the move D = x+ - x_0: with f(x, v) the law and v+ = D/h,
//   f + df/dx D + df/dv (D/h - v_0):   force f - df/dv v_0 at D = 0, slope df/dx + df/dv / h.
// For the damped normal law that is the elastic force, and a slope with the known damping factor. Friction that depends on the
// slip s is taken at the slip s_p = s_0 + h v_0 that the known velocity leads to: force f(s_p) - df/ds h v_0 at D = 0. Taken at
// D = 0 instead, where no slip is, stuck springs and sgn(v) would glue every contact for the step. `sign` is explicit as
// published: mu f_n sgn(v_0), without a slope.
#ifndef SEL_SHARED_FRICTION_LAW_H
#define SEL_SHARED_FRICTION_LAW_H
#include "shared/law_context.h"

SEL_BEGIN

// Derivative of the slip along v, a direction in the wall's plane, with x, theta and w: also what a force v on the surface does.
typedef struct SlipRow {
    vec3 x;
    real theta;
    vec3 w;
} SlipRow;

SEL_FN SlipRow slip_row(vec3 v, vec3 n, real radius, PointMotion mv)
{
    const SlipRow row = {v, -radius * dot3(cross3(mv.tangent, n), v),
                         (radius / mv.length) * (dot3(mv.tangent, v) * n - dot3(mv.tangent, n) * v)};
    return row;
}

// adds s * row row^T to the symmetric part
SEL_FN void add_slip(SEL_OUT ContactForce* out, real s, SlipRow row)
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

// adds s * row g^T to the unsymmetric part
SEL_FN void add_skew(SEL_OUT ContactForce* out, real s, SlipRow row, vec3 g)
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

// Move of the wire's surface over the step in the wall's plane: du above.
SEL_FN vec3 surface_move(vec3 n, const LawContext* c)
{
    const PointMotion mv = c->mv;
    // lies in the wall's plane
    const vec3 rolled = c->m.radius * (dot3(n, mv.turn) * mv.tangent - dot3(mv.tangent, n) * mv.turn);
    return mv.move - dot3(mv.move, n) * n - (c->m.radius * mv.spin) * cross3(mv.tangent, n) + rolled;
}

// The slip that friction goes by: the move, and with `stick-slip` what the contact carries elastically.
SEL_FN vec3 total_slip(vec3 move, vec3 n, CarriedState carried, const LawContext* c)
{
    const int sticks = c->par.friction == SEL_FRICTION_STICK_SLIP;
    vec3 slip = move;
    if (sticks && c->par.known == SEL_KNOWN_FORCE) slip = make_vec3(0, 0, 0);  // an anchored spring pulls from where it is
    if (!sticks || !carried.was_active) return slip;
    // the anchor turns with the wall's tangent plane, keeping its length
    const vec3 s = make_vec3(carried.old.slip[0], carried.old.slip[1], carried.old.slip[2]);
    const vec3 flat = s - dot3(s, n) * n;
    const real was = dot3(s, s), is = dot3(flat, flat);
    return slip + (is > 0 ? sqrt(was / is) : (real)0) * flat;
}

// Friction as a function of the slip's size.
typedef struct SlipLaw {
    real force, cone;    // magnitude; its bound [N]
    real along, across;  // d|f|/d|slip| along the slip and |f|/|slip| across it [N/m]
    int stuck;
} SlipLaw;

SEL_FN SlipLaw slip_law(real size, real fn, CarriedState carried, const LawContext* c)
{
    const QuadratureModel m = c->m;
    const ContactParams par = c->par;
    const int sticks = par.friction == SEL_FRICTION_STICK_SLIP;
    SlipLaw law;
    // a stuck or new contact yields at mu_static, a sliding one at mu_sliding; fixed within the step, so the law is one cone
    const int was_sliding = carried.was_active && !(carried.old.flags & SEL_CONTACT_STUCK);
    law.cone = (sticks && !was_sliding && par.settling != SEL_SETTLE_SLIDING ? m.mu_static : m.mu_sliding) * fn;
    law.force = law.cone;
    law.stuck = 0;
    if (sticks) {
        const real kt = m.friction_stiffness * m.weight;
        law.stuck = par.settling == SEL_SETTLE_STUCK || kt * size <= law.cone;
        if (law.stuck) law.force = kt * size;
        law.along = law.stuck ? kt : 0;
        law.across = law.stuck ? kt : law.cone / size;
    } else {
        // |f| = cone |u| / (|u| + u_s): `smooth`; `sign` is the same with a millionth of the speed
        const real us = par.friction == SEL_FRICTION_SIGN ? sign_slip(par) : smooth_slip(par);
        law.across = law.cone / (size + us);
        law.force = law.across * size;
        law.along = law.across * us / (size + us);
    }
    return law;
}

// State after the step. slip: of `size`
SEL_FN void write_friction(vec3 slip, real size, vec3 f, SlipLaw law, const LawContext* c, SEL_OUT ContactState* now)
{
    const int sticks = c->par.friction == SEL_FRICTION_STICK_SLIP;
    // an elastic slip longer than the cone holds is drawn after the wire
    const real keep = sticks && !law.stuck && size > 0 ? law.cone / (c->m.friction_stiffness * c->m.weight * size) : 1;
    // a sliding contact sticks again when its trial force is inside the cone of mu_sliding: that is `stuck` above
    store_vec(now->slip, keep * slip);
    store_vec(now->friction, f);
    if (law.stuck) now->flags |= SEL_CONTACT_STUCK;
}

SEL_FN void exert(SEL_OUT ContactForce* out, vec3 f, SlipRow row)
{
    add_vec(out->force, f);
    out->force[3] += row.theta;
    add_vec(out->couple, row.w);
    out->flags |= SEL_FORCE_COUPLE;
}

// What friction's tangent is made of.
typedef struct SlipTangent {
    vec3 along_slip;     // d: direction of the slip, in the wall's plane
    real size;           // of the slip [m]
    real along, across;  // stiffness along it and across [N/m]
    real skew;           // -df/dx = skew d g^T while the contact slides: the normal force changes [N/m]
    int acts, slides;
} SlipTangent;

SEL_FN SlipTangent no_slip_tangent(void)
{
    const SlipTangent none = {make_vec3(0, 0, 0), 0, 0, 0, 0, 0, 0};
    return none;
}

// Writes the contact's state and adds the force. See the top for the slip, and for values from the start of the step (par.known).
// @param n  unit normal     load  what friction goes by     @return its tangent
SEL_FN SlipTangent add_friction_force(vec3 n, NormalLoad load, CarriedState carried, const LawContext* c,
                                      SEL_OUT ContactState* now, SEL_OUT ContactForce* out)
{
    const ContactParams par = c->par;
    SlipTangent tangent = no_slip_tangent();
    if (c->mv.fresh || par.friction == SEL_FRICTION_NONE) return tangent;
    const int lagged = par.known && par.friction == SEL_FRICTION_SIGN;
    const vec3 move = surface_move(n, c), slip = total_slip(move, n, carried, c);
    const real size = sqrt(dot3(slip, slip));
    const SlipLaw law = slip_law(size, load.force, carried, c);
    // slip plane: d and e = n x d; without a slip any two directions
    const vec3 d = size > 0 ? (1 / size) * slip : across_of(n);
    vec3 f = -law.force * d;
    if (par.known == SEL_KNOWN_LINEAR && !lagged) {
        const real ahead = dot3(d, move);
        f = f + law.across * (move - ahead * d) + ((size > 0 ? law.along : law.across) * ahead) * d;
    }
    exert(out, f, slip_row(f, n, c->m.radius, c->mv));
    out->friction_work += dot3(f, move);
    write_friction(slip, size, f, law, c, now);
    out->friction_sum += law.force;
    if (!law.stuck) out->sliding_sum += law.force;
    tangent.along_slip = d;
    tangent.size = size;
    tangent.along = size > 0 ? law.along : law.across;
    tangent.across = law.across;
    tangent.acts = !lagged;
    tangent.slides = !law.stuck && size > 0 && load.slope > 0;
    // -df/dx = mu d (dfn/dx) = -mu dfn d n^T
    if (tangent.slides) tangent.skew = -(law.cone > 0 ? law.force / load.force : 0) * load.slope;
    return tangent;
}

// @param g  gradient of the gap
SEL_FN void add_friction_tangent(vec3 n, vec3 g, SlipTangent tangent, const LawContext* c, SEL_OUT ContactForce* out)
{
    if (!tangent.acts) return;
    const SlipRow row = slip_row(tangent.along_slip, n, c->m.radius, c->mv);
    add_slip(out, tangent.along, row);
    add_slip(out, tangent.across, slip_row(cross3(n, tangent.along_slip), n, c->m.radius, c->mv));
    if (!tangent.slides) return;
    add_skew(out, tangent.skew, row, g);
    out->flags |= SEL_FORCE_SLIDING;
}

SEL_END
#endif
