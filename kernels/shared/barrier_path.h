// Start of a step with the barrier law: the gap of a quadrature point, and the release of one in overlap.
#ifndef SEL_SHARED_BARRIER_PATH_H
#define SEL_SHARED_BARRIER_PATH_H
#include "shared/contact_stages.h"

SEL_BEGIN

// Nearest gap of a quadrature point [m], as contact has it; its reach when nothing is nearer.
SEL_FN real nearer_gap(SEL_OUT const ContactPoint* first, SEL_OUT const ContactPoint* second, real reach)
{
    real depth = -reach;
    if (first->found) depth = max_r(depth, first->depth);
    if (second->found) depth = max_r(depth, second->depth);
    return -depth;
}

#if !SEL_SUMS_IN_MEMORY
SEL_PART real gap_of_point(PointView point, ContactParams par, NodeView nodes, SEL_GLOBAL const ContactState* states_t0)
{
    const AxisPoint at = axis_point(point.place.edge, point.place.bary, nodes);
    const ContactBall ball = contact_ball(at.offset, at.origin, point.model.radius, point.model.reach, par.smoothing);
    const ContactPointPair touching =
        contact_points_of(ball, point.near, last_touch(point.index, point.place.epoch, states_t0), no_recall());
    return nearer_gap(&touching.first, &touching.second, point.model.reach);
}
#endif

// A barrier has no force to push out what overlaps, and a wire may be placed, fed or remeshed into the wall. Such a quadrature
// point is made thinner until its gap is 0.1 % of the activation distance. Half of the gap made in each step is then taken off
// this `radius_reduction`, which never grows while the law holds: overlaps are pushed out and do not deepen.
SEL_FN real barrier_start(real gap, real radius_reduction_t0, QuadratureModel m)
{
    const real left = gap + radius_reduction_t0;
    return left > 0 ? max_r(radius_reduction_t0 - left / 2, 0) : (real)1e-3 * m.law_length - gap;
}

SEL_END
#endif
