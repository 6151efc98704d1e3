// The law of contact between two instruments, per metre of a, from their surfaces. It is the wall's damped law (D6b, D7) with two
// rods, or a rod and a lumen, as its sides, and sticking and sliding friction (D9) of the surfaces.
//
// Which laws: hunt-crossley and lankarani-nikravesh, whatever the wall's contact follows: a world whose wall is hard by
// multipliers or a barrier has its instruments touch by the damped law all the same. No rolling resistance (D10) between
// instruments, and no separate law for a tip that is pushed into a wire head on (D6c).
//
// A line law f = k depth^n makes of two crossing wires a contact of force ~ depth^(n + 1/2): depth^2 for beds (n = 3/2), Hertz's
// depth^(3/2) for n = 1.
#ifndef SEL_SHARED_INSTRUMENT_LAW_H
#define SEL_SHARED_INSTRUMENT_LAW_H
#include "shared/contact_law.h"
#include "shared/instrument_types.h"

SEL_BEGIN

#define SEL_INSTRUMENT_EXACT ((real)0.8)  // of depth_limit: as for the wall, see engine/physics/contact/wall_law.cpp
#define SEL_WEIGHT_GRAVITY ((real)9.81)

// Depth that the law may reach [m]: half of the smaller radius, or of the wall round a lumen, if that is less. Axes are then
// always farther apart than two nodes may move at once, and stay on their sides.
SEL_FN real instrument_depth_limit(InstrumentSurface a, InstrumentSurface b, uint touch)
{
    const real other = touch == SEL_TOUCH_INSIDE ? b.radius - b.lumen : b.radius;
    return (real)0.5 * min_r(a.radius, other);
}

SEL_FN QuadratureModel instrument_model(InstrumentSurface a, InstrumentSurface b, InstrumentPair pair)
{
    const int inside = pair.touch == SEL_TOUCH_INSIDE;
    QuadratureModel m;
    m.weight = m.length = 1;
    m.radius = a.radius;
    m.reach = m.roll_arm = m.roll_depth = m.roll_force = 0;
    m.penalty_stiffness = m.law_length = m.line_mass = m.restitution = m.multiplier_most = 0;
    m.depth_limit = instrument_depth_limit(a, b, pair.touch);
    m.depth_exact = 0;
    m.exponent = (real)1.5;
    if (pair.stiffness > 0) {
        m.stiffness = pair.stiffness;
        m.exponent = pair.exponent;
        m.depth_exact = SEL_INSTRUMENT_EXACT * m.depth_limit;
    } else {
        const LawSide one = rod_side(a.radius, a.modulus);
        const LawSide two = inside ? wall_side(b.lumen, a.radius, b.lumen_modulus) : rod_side(b.radius, b.modulus);
        m.stiffness = (real)4 / 3 * effective_modulus(one, two) * sqrt(2 * effective_radius(one, two));
    }
    m.damping = pair.damping;
    const int given = pair.mu_sliding >= 0;
    m.mu_static = given ? pair.mu_static : sqrt(a.mu_static * b.mu_static);
    m.mu_sliding = given ? pair.mu_sliding : sqrt(a.mu_sliding * b.mu_sliding);
    const real load = min_r(a.load, b.load), depth = depth_carrying(load, m);
    m.friction_stiffness = (real)2 / 3 * m.exponent * load / depth;
    m.speed_floor = max_r(m.damping / 2 * sqrt(SEL_WEIGHT_GRAVITY * depth / m.exponent), (real)1e-12);
    return m;
}

// The state that a slot had at the start of the step, and its law; law.mv.fresh: it had none.
typedef struct SlotLaw {
    ContactState old;
    LawContext law;
} SlotLaw;

SEL_FN CarriedState carried_of(const SlotLaw* slot)
{
    const CarriedState carried = {slot->old, !slot->law.mv.fresh && (slot->old.flags & SEL_CONTACT_ACTIVE)};
    return carried;
}

SEL_END
#endif
