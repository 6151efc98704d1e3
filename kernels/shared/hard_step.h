// What surrounds the Newton solve of a step with the laws of hard_law.h: multipliers at its start and between solves, and the
// barrier's start. One call per sample; its two touches have records 2 s and 2 s + 1.
#ifndef SEL_SHARED_HARD_STEP_H
#define SEL_SHARED_HARD_STEP_H
#include "shared/contact_sample.h"

SEL_BEGIN

#define SEL_STIFFER ((real)4)          // factor on k of a touch whose miss shrinks too slowly
#define SEL_STIFFEST ((real)1e4)       // k is at most this many times its least
#define SEL_SHRINKS_WELL ((real)0.25)  // factor on the miss that a round should bring

#define SEL_SPEED_LEFT ((real)1e-3)  // that a miss may leave [m/s]

// Overlap, or speed times step, that is allowed [m].
SEL_FN real miss_allowed(SampleModel m, ContactParams par)
{
    if (par.normal_law == SEL_NORMAL_IMPULSE) return par.inv_dt > 0 ? m.hard_length / par.inv_dt : m.hard_length * (real)1e-3;
    return par.inv_dt > 0 ? min_r(m.hard_length, SEL_SPEED_LEFT / par.inv_dt) : m.hard_length;
}

SEL_FN real least_stiffness(SampleModel m, ContactParams par, real force)
{
    const real fades = m.reach > 0 ? 2 * force / m.reach : (real)0;  // without a reach no touch is ever lost sight of
    return max_r(max_r(m.hard_stiffness, 10 * m.line_mass * par.inv_dt * par.inv_dt), fades);
}

// State of a touch at the start of a step, from what it exerted at the end of the last one.
SEL_FN HardState hard_start(TouchState touch, uint stamp, SampleModel m, ContactParams par)
{
    HardState hard = no_hard_state();
    hard.live = touch.stamp + 1 == stamp && (touch.flags & SEL_TOUCH_ACTIVE) && m.weight > 0;
    if (hard.live) {
        hard.force = min_r(touch.normal_force / m.weight, m.hard_most);
        for (int i = 0; i < 3; ++i) {
            hard.normal[i] = touch.normal[i];
            hard.friction[i] = touch.friction[i] / m.weight;
        }
    }
    hard.stiffness = least_stiffness(m, par, hard.force);
    hard.miss = (real)1e30;
    return hard;
}

// Multipliers after a solve. @param touch  as the converged trial left it     was  at the start of the step
// @param ratio  largest miss over the one allowed
SEL_FN HardState hard_next(HardState last, TouchState touch, TouchState was, uint stamp, SampleModel m, ContactParams par,
                           real* ratio)
{
    HardState next = last;
    const int active = touch.stamp == stamp && (touch.flags & SEL_TOUCH_ACTIVE) && m.weight > 0;
    const real goal =
        par.normal_law == SEL_NORMAL_IMPULSE && par.inv_dt > 0 ? impulse_goal(-was.gap, was.rate, par.inv_dt, m) : 0;
    real slope;
    const real force = active ? min_r(multiplier_law(-touch.gap - goal, m, last, &slope), m.hard_most) : 0;
    next.miss = fabs(force - last.force) / last.stiffness;
    next.force = force;
    real slip2 = 0;
    for (int i = 0; i < 3; ++i) {
        next.friction[i] = active ? touch.friction[i] / m.weight : 0;
        const real change = next.friction[i] - last.friction[i];
        slip2 += change * change;
        if (active) next.normal[i] = touch.normal[i];
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

// Nearest gap of a sample [m], as contact has it; its reach when nothing is nearer. a, b: its records
SEL_FN real sample_gap(AxisPoint at, SampleModel m, ContactParams par, TouchState a, TouchState b, uint stamp,
                       SEL_GLOBAL const uint* cells, uint count, SEL_GLOBAL const TreeNode* nodes,
                       SEL_GLOBAL const float* vertices, SEL_GLOBAL const uint* rims)
{
    const TouchPair touching =
        touches_of(at, m, par, a, a.stamp + 1 == stamp, b, b.stamp + 1 == stamp, cells, count, nodes, vertices, rims);
    real depth = -m.reach;
    if (touching.first.found) depth = max_r(depth, touching.first.depth);
    if (touching.second.found) depth = max_r(depth, touching.second.depth);
    return -depth;
}

// A barrier has no force to push out what overlaps, and a wire may be placed, fed or remeshed into the wall. Such a sample is
// taken to be thinner by as much as leaves it a thousandth of the activation distance; that `shrink` then is given back, half of
// the gap it makes in each step, and never grows while the law holds: what overlaps is pushed out and does not sink deeper.
SEL_FN real barrier_start(real gap, real shrink_t0, SampleModel m)
{
    const real left = gap + shrink_t0;
    return left > 0 ? max_r(shrink_t0 - left / 2, 0) : (real)1e-3 * m.hard_length - gap;
}

SEL_END
#endif
