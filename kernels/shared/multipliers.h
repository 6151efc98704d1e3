// What surrounds the Newton solve of a step with the laws of multiplier_law.h: multipliers at its start and between solves.
#ifndef SEL_SHARED_MULTIPLIERS_H
#define SEL_SHARED_MULTIPLIERS_H
#include "shared/contact_records.h"
#include "shared/multiplier_law.h"

SEL_BEGIN

#define SEL_STIFFER ((real)4)          // factor on k of a contact point whose miss shrinks too slowly
#define SEL_STIFFEST ((real)1e4)       // k is at most this many times its least
#define SEL_SHRINKS_WELL ((real)0.25)  // factor on the miss that a round should bring

#define SEL_SPEED_LEFT ((real)1e-3)  // that a miss may leave [m/s]

// Overlap, or speed times step, that is allowed [m].
SEL_FN real miss_allowed(QuadratureModel m, ContactParams par)
{
    if (par.normal_law == SEL_NORMAL_IMPULSE) return par.inv_dt > 0 ? m.law_length / par.inv_dt : m.law_length * (real)1e-3;
    return par.inv_dt > 0 ? min_r(m.law_length, SEL_SPEED_LEFT / par.inv_dt) : m.law_length;
}

SEL_FN real least_stiffness(QuadratureModel m, ContactParams par, real force)
{
    const real fades = m.reach > 0 ? 2 * force / m.reach : (real)0;  // without a reach no contact point is ever lost sight of
    return max_r(max_r(m.penalty_stiffness, 10 * m.line_mass * par.inv_dt * par.inv_dt), fades);
}

// State of a contact point at the start of a step, from its force at the end of the last one.
SEL_PART MultiplierState multiplier_start(ContactState state, uint epoch, QuadratureModel m, ContactParams par)
{
    MultiplierState multiplier = no_multiplier();
    multiplier.live = state.epoch + 1 == epoch && (state.flags & SEL_CONTACT_ACTIVE) && m.weight > 0;
    if (multiplier.live) {
        multiplier.force = min_r(state.normal_force / m.weight, m.multiplier_most);
        for (int i = 0; i < 3; ++i) {
            multiplier.normal[i] = state.normal[i];
            multiplier.friction[i] = state.friction[i] / m.weight;
        }
    }
    multiplier.stiffness = least_stiffness(m, par, multiplier.force);
    multiplier.miss = (real)1e30;
    return multiplier;
}

// Multipliers after a solve. @param touch  as the converged trial left it     was  at the start of the step
// @param ratio  largest miss over the one allowed
SEL_PART MultiplierState multiplier_update(MultiplierState last, ContactState state, ContactState was, uint epoch,
                                         QuadratureModel m, ContactParams par, real* ratio)
{
    MultiplierState next = last;
    const int active = state.epoch == epoch && (state.flags & SEL_CONTACT_ACTIVE) && m.weight > 0;
    const real goal =
        par.normal_law == SEL_NORMAL_IMPULSE && par.inv_dt > 0 ? impulse_goal(-was.gap, was.rate, par.inv_dt, m) : 0;
    real slope;
    const real force = active ? min_r(multiplier_law(-state.gap - goal, m, last, &slope), m.multiplier_most) : 0;
    next.miss = fabs(force - last.force) / last.stiffness;
    next.force = force;
    real slip2 = 0;
    for (int i = 0; i < 3; ++i) {
        next.friction[i] = active ? state.friction[i] / m.weight : 0;
        const real change = next.friction[i] - last.friction[i];
        slip2 += change * change;
        if (active) next.normal[i] = state.normal[i];
    }
    if (par.normal_law == SEL_NORMAL_CONSTRAINT) next.miss = max_r(next.miss, sqrt(slip2) / (SEL_TANGENTIAL * last.stiffness));
    next.live = active ? 1 : 0;
    const real allowed = miss_allowed(m, par), least = least_stiffness(m, par, force);
    *ratio = max_r(*ratio, next.miss / allowed);
    if (next.miss > allowed && next.miss > SEL_SHRINKS_WELL * last.miss)
        next.stiffness = min_r(SEL_STIFFER * last.stiffness, max_r(last.stiffness, SEL_STIFFEST * least));
    next.stiffness = max_r(next.stiffness, least);
    return next;
}

SEL_END
#endif
