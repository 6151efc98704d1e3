// Rolling resistance (D10) and its tangent: an angle spring anchored at the contact that yields at M = roll_arm a fn, with a the
// half-width of the contact.
#ifndef SEL_SHARED_ROLLING_LAW_H
#define SEL_SHARED_ROLLING_LAW_H
#include "shared/law_context.h"

SEL_BEGIN

// What the half-width is reckoned from.
typedef struct Footprint {
    real sunk, dsunk;  // depth [m], and its derivative with the contact's depth
} Footprint;

// @param g  gradient of the gap
SEL_FN void add_rolling(vec3 g, Footprint foot, NormalLoad load, CarriedState carried, const LawContext* c,
                        SEL_OUT ContactState* now, SEL_OUT ContactForce* out)
{
    const QuadratureModel m = c->m;
    const PointMotion mv = c->mv;
    const ContactParams par = c->par;
    if (m.roll_arm <= 0 || mv.fresh) return;
    const real half_width = sqrt(m.roll_depth * foot.sunk + m.roll_force * load.force / m.weight);
    const real most = m.roll_arm * half_width * load.force;
    // the spring is as stiff as the surface's tangential one at the wire's radius, so that it adds no softer mode
    const real k = m.friction_stiffness * m.weight * m.radius * m.radius;
    if (par.known && par.friction == SEL_FRICTION_SIGN) {  // M sgn(omega) as published, regularised as sgn(v) is
        out->force[3] -= most * mv.spin / (fabs(mv.spin) + sign_slip(par) / m.radius);
        return;
    }
    const real angle = (carried.was_active ? carried.old.roll : 0) + (par.known == SEL_KNOWN_FORCE ? 0 : mv.spin);
    const real trial = k * fabs(angle);
    const real moment = trial < most ? trial : most;
    const real sign = angle < 0 ? (real)-1 : (real)1;
    out->force[3] -= sign * moment;
    if (trial < most) {
        out->sym[9] += k;
        if (par.known == SEL_KNOWN_LINEAR) out->force[3] += k * mv.spin;
    } else if (half_width > 0) {
        // -dM/dx = sign dM/d(depth) (-g)
        const real widening = (m.roll_depth * foot.dsunk + m.roll_force * load.slope / m.weight) / (2 * half_width);
        const real dmost = sign * m.roll_arm * (widening * load.force + half_width * load.slope);
        out->skew[9] -= dmost * g.x;
        out->skew[10] -= dmost * g.y;
        out->skew[11] -= dmost * g.z;
        out->flags |= SEL_FORCE_SLIDING;
    }
    now->roll = sign * moment / k;
    now->moment = -sign * moment;
    out->rolling_work -= sign * moment * mv.spin;
    out->rolling_sum += moment;
}

SEL_END
#endif
