// The two sides of a contact, as the laws see them: shape, stiffness and motion. A rod against a wall is one case; whichever side
// is called a, the numbers are the same and the forces opposite.
#ifndef SEL_SHARED_CONTACT_SIDES_H
#define SEL_SHARED_CONTACT_SIDES_H
#include "shared/portable.h"

SEL_BEGIN

typedef struct LawSide {
    real
        curvature;  // across the wire's direction, towards the other side [1/m]; > 0: a rod; < 0: a lumen from inside; 0: a plane
    real modulus;   // k_f, pressure per depth of the soft surface [N/m^3]; 0: rigid
} LawSide;

SEL_FN LawSide rod_side(real radius, real modulus)
{
    const LawSide side = {1 / radius, modulus};
    return side;
}

// @param lumen_radius  of the vessel round a wire; one that does not hold the wire counts as a plane, and so does infinity
SEL_FN LawSide wall_side(real lumen_radius, real wire_radius, real modulus)
{
    const LawSide side = {lumen_radius > wire_radius ? -(1 / lumen_radius) : (real)0, modulus};
    return side;
}

// r* of (D6b): 1/r* = 1/r_a + 1/r_b.
SEL_FN real effective_radius(LawSide a, LawSide b) { return 1 / (a.curvature + b.curvature); }

// Both surfaces carry the same pressure, and their depths add: k = 1 / (1/k_a + 1/k_b).
SEL_FN real effective_modulus(LawSide a, LawSide b)
{
    if (a.modulus <= 0) return b.modulus;
    if (b.modulus <= 0) return a.modulus;
    return a.modulus * b.modulus / (a.modulus + b.modulus);
}

SEL_END
#endif
