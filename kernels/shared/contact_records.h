// Empty records, and how a force is written.
#ifndef SEL_SHARED_CONTACT_RECORDS_H
#define SEL_SHARED_CONTACT_RECORDS_H
#include "shared/contact_types.h"

SEL_BEGIN

SEL_FN MultiplierState no_multiplier(void)
{
    MultiplierState none;
    for (int i = 0; i < 3; ++i) none.normal[i] = none.friction[i] = 0;
    none.force = none.stiffness = none.miss = 0;
    none.live = none.pad = 0;
    return none;
}

SEL_FN ContactForce no_force(QuadratureModel m)
{
    ContactForce none;
    for (int k = 0; k < 4; ++k) none.force[k] = 0;
    for (int k = 0; k < 10; ++k) none.sym[k] = 0;
    for (int k = 0; k < 12; ++k) none.skew[k] = 0;
    for (int k = 0; k < 9; ++k) none.sym_xw[k] = none.skew_wx[k] = 0;
    for (int k = 0; k < 6; ++k) none.sym_ww[k] = 0;
    for (int k = 0; k < 3; ++k) none.couple[k] = none.sym_tw[k] = 0;
    none.depth = -(m.radius + m.reach);
    none.normal_sum = none.friction_sum = none.sliding_sum = none.rolling_sum = none.length = 0;
    none.normal_work = none.friction_work = none.rolling_work = 0;
    none.flags = 0;
    none.contacts = 0;
    return none;
}

SEL_FN ContactState no_contact_state(void)
{
    ContactState none;
    for (int i = 0; i < 3; ++i) none.slip[i] = none.normal[i] = none.point[i] = none.friction[i] = 0;
    none.gap = none.rate = none.approach = none.roll = none.normal_force = none.moment = 0;
    none.triangle = none.flags = none.epoch = none.pad = 0;
    return none;
}

// Where nothing touches, of 0.5 kB three words are read.
SEL_FN void write_force(ContactForce force, SEL_GLOBAL ContactForce* out)
{
    if (force.contacts > 0) {
        *out = force;
        return;
    }
    out->depth = force.depth;
    out->flags = force.flags;
    out->contacts = 0;
}

SEL_END
#endif
