// Multipliers at the start of a solve and between solves.
//   launch  engine/physics/contact/multipliers.cpp       test  tests/contact/test_host_reference.cpp
#include "shared/kernel.h"
#include "shared/multipliers.h"

// Multipliers at the start of a solve.
//   item    one quadrature point; range rounded up to the work-group size
//   reads   models, places [points]; states_t0 [points][2]      writes  multipliers [points][2]
SEL_KERNEL void contact_start(const ContactParams par, __global const QuadratureModel* restrict models,
                              __global const QuadraturePlace* restrict places, __global const ContactState* restrict states_t0,
                              __global MultiplierState* restrict multipliers)
{
    const uint s = get_global_id(0);
    if (s < par.item_count)
        for (uint k = 2 * s; k < 2 * s + 2; ++k) multipliers[k] = multiplier_start(states_t0[k], places[s].epoch, models[s], par);
}

// Multipliers after a solve; those of a quadrature point with no wall near are zero.
//   item    one quadrature point
//   reads   models, places, counts [points]; states_t0, states, multipliers [points][2]
//   writes  next [points][2]; ratios [points]: largest miss over the one allowed
SEL_KERNEL void contact_multipliers(const ContactParams par, __global const QuadratureModel* restrict models,
                                    __global const QuadraturePlace* restrict places, __global const uint* restrict counts,
                                    __global const ContactState* restrict states_t0, __global const ContactState* restrict states,
                                    __global const MultiplierState* restrict multipliers, __global MultiplierState* restrict next,
                                    __global real* restrict ratios)
{
    const uint s = get_global_id(0);
    if (s < par.item_count) {
        ContactState none = states[2 * s];
        none.flags = 0;
        real ratio = 0;
        for (uint k = 2 * s; k < 2 * s + 2; ++k)
            next[k] = multiplier_update(multipliers[k], counts[s] > 0 ? states[k] : none, states_t0[k], places[s].epoch,
                                        models[s], par, &ratio);
        ratios[s] = ratio;
    }
}
