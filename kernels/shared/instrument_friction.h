// Friction of one cell of rod a on rod b.
//
// Friction is that of the whole force of the cell at its centroid: slip of a's surface past b's there, with both spins and the
// turning of both tangents (friction_law.h). Both surfaces are taken at one point, on a's, so that force, couple and torques on
// the two rods are those of one force and its opposite.
#ifndef SEL_SHARED_INSTRUMENT_FRICTION_H
#define SEL_SHARED_INSTRUMENT_FRICTION_H
#include "shared/instrument_law.h"
#include "shared/instrument_pieces.h"

SEL_BEGIN

// One rod's surface at the contact: what its nodes do to it.
typedef struct SurfaceMotion {
    SplinePlace place;
    vec3 lever;    // from the axis to the contact [m]
    vec3 tangent;  // unit
    real length;   // |c'| [m]
    vec3 move;     // of the contact over the step [m]
} SurfaceMotion;

// @param edge  near the material point
SEL_FN SurfaceMotion surface_motion(SplineView now, SplineView then, real at, real material, uint edge, vec3 lever)
{
    SurfaceMotion m;
    m.place = spline_place(at, now.count);
    m.lever = lever;
    const vec3 along = spline_sum(now, m.place.node, m.place.d);
    m.length = sqrt(dot3(along, along));
    m.tangent = (1 / m.length) * along;
    const SplinePlace old = spline_place(spline_at_near(then, material, edge), then.count);
    const vec3 along_t0 = spline_sum(then, old.node, old.d);
    const vec3 turn = m.tangent - (1 / sqrt(dot3(along_t0, along_t0))) * along_t0;
    const real spin = spline_spin(now, m.place) - spline_spin(then, old);
    m.move = spline_sum(now, m.place.node, m.place.w) - spline_sum(then, old.node, old.w) + spin * cross3(m.tangent, lever) +
             dot3(m.tangent, lever) * turn - dot3(lever, turn) * m.tangent;
    return m;
}

SEL_FN InstrumentRow instrument_row(vec3 v, SurfaceMotion a, SurfaceMotion b)
{
    InstrumentRow row;
    store_vec(row.v, v);
    store_vec(row.turn_a, (1 / a.length) * (dot3(a.tangent, a.lever) * v - dot3(v, a.tangent) * a.lever));
    store_vec(row.turn_b, (1 / b.length) * (dot3(b.tangent, b.lever) * v - dot3(v, b.tangent) * b.lever));
    row.spin_a = dot3(v, cross3(a.tangent, a.lever));
    row.spin_b = dot3(v, cross3(b.tangent, b.lever));
    return row;
}

SEL_FN void place_friction(CellPoint point, SurfaceMotion a, SurfaceMotion b, SEL_OUT InstrumentForce* out)
{
    for (int k = 0; k < 3; ++k) {
        out->wa[k] = a.place.w[k];
        out->da[k] = a.place.d[k];
        out->wb[k] = b.place.w[k];
        out->db[k] = b.place.d[k];
    }
    store_vec(out->n, point.g.n);
    store_vec(out->turn, point.g.turn);
    out->node_a = a.place.node;
    out->node_b = b.place.node;
}

// Friction under the cell's normal force at the point `point` of a.
SEL_FN void rub_at(const InstrumentScene* scene, CellPoint point, const SlotLaw* slot, SEL_OUT InstrumentState* now,
                   SEL_OUT InstrumentForce* out)
{
    const CarriedState carried = carried_of(slot);
    LawContext c = slot->law;
    c.m.weight = out->length;
    const vec3 n = point.g.n, x = spline_sum(scene->a, point.a.node, point.a.w);
    const vec3 lever = -c.m.radius * n;
    const real along_b = spline_material(scene->b, point.g.at);
    const SurfaceMotion a =
        surface_motion(scene->a, scene->a_t0, spline_at_near(scene->a, point.s, scene->edge), point.s, scene->edge, lever);
    const SurfaceMotion b =
        surface_motion(scene->b, scene->b_t0, point.g.at, along_b, (uint)point.g.at, x + lever - point.g.centre);
    place_friction(point, a, b, out);
    vec3 move = a.move - b.move;
    move = move - dot3(move, n) * n;
    const vec3 slip = total_slip(move, n, carried, &c);
    const real size = sqrt(dot3(slip, slip)), load = out->normal_sum;
    const SlipLaw law = slip_law(size, load, carried, &c);
    const vec3 d = size > 0 ? (1 / size) * slip : across_of(n), f = -law.force * d;
    out->force = instrument_row(f, a, b);
    out->along = instrument_row(d, a, b);
    out->across = instrument_row(cross3(n, d), a, b);
    out->stiff_along = size > 0 ? law.along : law.across;
    out->stiff_across = law.across;
    out->flags |= SEL_FORCE_COUPLE;
    if (!law.stuck && size > 0) {
        out->skew = out->slope_sum > 0 ? law.force / load * out->slope_sum : 0;
        out->flags |= SEL_FORCE_SLIDING;
        out->sliding_sum = law.force;
    }
    out->friction_sum = law.force;
    out->friction_work = dot3(f, move);
    out->stored += law.force * law.force / (2 * c.m.friction_stiffness * c.m.weight);
    write_friction(slip, size, f, law, &c, &now->contact);
}

SEL_END
#endif
