// Sum of the forces and tangents of an edge's quadrature points (or pairs), as generalised force on its nodes and its angle.
#ifndef SEL_SHARED_EDGE_SUMS_H
#define SEL_SHARED_EDGE_SUMS_H
#include "shared/contact_types.h"

SEL_BEGIN

// Before the rounds of a loop over the entries of matrices in memory: one round after another there, since all at once would be
// as many registers.
#if SEL_SUMS_IN_MEMORY
    #define SEL_IN_TURN SEL_ROLLED
#else
    #define SEL_IN_TURN
#endif

// Adds what a quadrature point's couple does: q = (x_a, x_b, theta), x = a x_a + b x_b, w = x_b - x_a.
SEL_FN void add_couple(SEL_GLOBAL const ContactForce* f, real a, real b, SEL_GLOBAL EdgeForce* out)
{
    const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};  // of (i, j) among xx xy xz yy yz zz
    SEL_IN_TURN for (int i = 0; i < 3; ++i)
    {
        out->force_a[i] -= f->couple[i];
        out->force_b[i] += f->couple[i];
        out->st_a[i] -= f->sym_tw[i];
        out->st_b[i] += f->sym_tw[i];
        for (int j = 0; j < 3; ++j) {
            const real xw = f->sym_xw[3 * i + j], wx = f->sym_xw[3 * j + i], ww = f->sym_ww[place[3 * i + j]];
            out->s_ab[3 * i + j] += a * xw - b * wx - ww;
            if (j < i) continue;
            out->s_aa[place[3 * i + j]] += ww - a * (xw + wx);
            out->s_bb[place[3 * i + j]] += ww + b * (xw + wx);
        }
    }
    if (!(f->flags & SEL_FORCE_SLIDING)) return;
    SEL_IN_TURN for (int i = 0; i < 9; ++i)
    {
        out->u_aa[i] -= a * f->skew_wx[i];
        out->u_ab[i] -= b * f->skew_wx[i];
        out->u_ba[i] += a * f->skew_wx[i];
        out->u_bb[i] += b * f->skew_wx[i];
    }
}

SEL_FN EdgeForce no_edge_force(void)
{
    EdgeForce none;
    for (int k = 0; k < 3; ++k) none.force_a[k] = none.force_b[k] = none.st_a[k] = none.st_b[k] = none.ut_a[k] = none.ut_b[k] = 0;
    for (int k = 0; k < 6; ++k) none.s_aa[k] = none.s_bb[k] = 0;
    for (int k = 0; k < 9; ++k) none.s_ab[k] = none.u_aa[k] = none.u_ab[k] = none.u_ba[k] = none.u_bb[k] = 0;
    none.torque = none.s_tt = 0;
    none.depth = (real)-1e30;
    none.normal_sum = none.friction_sum = none.sliding_sum = none.rolling_sum = none.length = 0;
    none.normal_work = none.friction_work = none.rolling_work = 0;
    none.flags = none.contacts = 0;
    return none;
}

// Force on the axis point x = a x_a + b x_b, and the symmetric part of its tangent.
SEL_FN void add_axis_force(SEL_GLOBAL const ContactForce* f, real a, real b, SEL_GLOBAL EdgeForce* out)
{
    const int block[6] = {0, 1, 2, 4, 5, 7};  // xx xy xz yy yz zz among the ten of `sym`
    const int spin[3] = {3, 6, 8};            // xt yt zt
    const int full[9] = {0, 1, 2, 1, 4, 5, 2, 5, 7};
    for (int i = 0; i < 3; ++i) {
        out->force_a[i] += a * f->force[i];
        out->force_b[i] += b * f->force[i];
        out->st_a[i] += a * f->sym[spin[i]];
        out->st_b[i] += b * f->sym[spin[i]];
    }
    for (int i = 0; i < 6; ++i) {
        out->s_aa[i] += a * a * f->sym[block[i]];
        out->s_bb[i] += b * b * f->sym[block[i]];
    }
    SEL_IN_TURN for (int i = 0; i < 9; ++i) out->s_ab[i] += a * b * f->sym[full[i]];
}

// What sliding makes unsymmetric.
SEL_FN void add_sliding(SEL_GLOBAL const ContactForce* f, real a, real b, SEL_GLOBAL EdgeForce* out)
{
    SEL_IN_TURN for (int i = 0; i < 9; ++i)
    {
        out->u_aa[i] += a * a * f->skew[i];
        out->u_ab[i] += a * b * f->skew[i];
        out->u_ba[i] += a * b * f->skew[i];
        out->u_bb[i] += b * b * f->skew[i];
    }
    for (int i = 0; i < 3; ++i) {
        out->ut_a[i] += a * f->skew[9 + i];
        out->ut_b[i] += b * f->skew[9 + i];
    }
}

// Sums forces[first..last) (consecutive on one edge) in order. barys: where on the edge they act.
SEL_PART void reduce_edge(SEL_GLOBAL const ContactForce* forces, SEL_GLOBAL const real* barys, uint first, uint last,
                          SEL_GLOBAL EdgeForce* out)
{
    *out = no_edge_force();
    for (uint k = first; k < last; ++k) {
        SEL_GLOBAL const ContactForce* f = forces + k;
        out->depth = max_r(out->depth, f->depth);
        out->flags |= f->flags;
        if (f->contacts == 0) continue;
        const real b = barys[k], a = 1 - b;
        add_axis_force(f, a, b, out);
        if (f->flags & SEL_FORCE_COUPLE) add_couple(f, a, b, out);
        if (f->flags & SEL_FORCE_SLIDING) add_sliding(f, a, b, out);
        out->torque += f->force[3];
        out->s_tt += f->sym[9];
        out->normal_sum += f->normal_sum;
        out->friction_sum += f->friction_sum;
        out->sliding_sum += f->sliding_sum;
        out->rolling_sum += f->rolling_sum;
        out->normal_work += f->normal_work;
        out->friction_work += f->friction_work;
        out->rolling_work += f->rolling_work;
        out->length += f->length;
        out->contacts += f->contacts;
    }
}

SEL_END
#endif
