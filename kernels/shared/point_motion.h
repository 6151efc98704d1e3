// Motion of a quadrature point of the wire over a step.
#ifndef SEL_SHARED_POINT_MOTION_H
#define SEL_SHARED_POINT_MOTION_H
#include "shared/law_context.h"
#include "shared/views.h"

SEL_BEGIN

SEL_FN PointMotion motion_of(QuadraturePlace place, AxisPoint at, NodeView nodes, NodeView nodes_t0)
{
    PointMotion mv;
    mv.length = sqrt(dot3(at.edge, at.edge));
    mv.tangent = (1 / mv.length) * at.edge;
    mv.epoch = place.epoch;
    mv.radius_reduction = place.radius_reduction;
    mv.fresh = place.edge_t0 == SEL_NO_EDGE;
    mv.move = mv.turn = make_vec3(0, 0, 0);
    mv.spin = 0;
    if (!mv.fresh) {
        const AxisPoint was = axis_point(place.edge_t0, place.bary_t0, nodes_t0);
        mv.move = (at.origin - was.origin) + (at.offset - was.offset);
        // the turn of the edge on which the point lies now. Material that slides along a polygon passes its corners without a
        // turn, since the pushing hand feels none (EdgeSums::along). theta of two edges has two references
        const vec3 edge_t0 = axis_point(place.edge, place.bary, nodes_t0).edge;
        mv.turn = mv.tangent - (1 / sqrt(dot3(edge_t0, edge_t0))) * edge_t0;
        mv.spin = nodes.theta[place.edge] - nodes_t0.theta[place.edge];
    }
    return mv;
}

SEL_END
#endif
