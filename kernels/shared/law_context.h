// Input of the laws of one contact point: constants and motion of its quadrature point, and the launch.
#ifndef SEL_SHARED_LAW_CONTEXT_H
#define SEL_SHARED_LAW_CONTEXT_H
#include "shared/contact_types.h"

SEL_BEGIN

// What the wire did over the step at a quadrature point, relative to the wall.
typedef struct PointMotion {
    vec3 tangent;           // of the edge, unit
    real length;            // of the edge [m]
    vec3 move;              // of the axis point [m]
    vec3 turn;              // of the tangent [-]
    real spin;              // of the edge about its tangent [rad]
    int fresh;              // no start position: no friction yet
    uint epoch;             // of this step for this wire
    real radius_reduction;  // QuadraturePlace's [m]
} PointMotion;

typedef struct LawContext {
    QuadratureModel m;
    PointMotion mv;
    ContactParams par;
} LawContext;

// State at the start of the step.
typedef struct CarriedState {
    ContactState old;
    int was_active;  // it was in contact
} CarriedState;

// The normal force, and its derivative with depth.
typedef struct NormalLoad {
    real force, slope;  // [N], [N/m]
} NormalLoad;

// adds s * a a^T to the 4 x 4 symmetric block, a = (v, w)
SEL_FN void add_outer(SEL_OUT real* sym, real s, vec3 v, real w)
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

SEL_END
#endif
