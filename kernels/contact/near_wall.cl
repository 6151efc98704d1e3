// The wall near quadrature points: near nodes of the tree (walk.h), distance of the wall.
//   launch  engine/physics/contact/near_wall.cpp       test  tests/contact/test_host_reference.cpp
#include "shared/clearance.h"
#include "shared/kernel.h"
#include "shared/wall_distance.h"

// Nodes of the tree near listed quadrature points.
//   item    one entry of `list`; range rounded up to the work-group size
//   reads   list [item_count] index of a quadrature point; models, places [points]; nodes [nodes][3] [m]; wall
//   writes  near_cells [points][slots], counts [points], found [item_count]: how many hold the wall within radius + reach + slack,
//           also beyond `slots`; 0: nothing is; clearances [points]
SEL_WALK_KERNEL void contact_find(const ContactParams par, const real slack, __global const uint* restrict list,
                                  __global const QuadratureModel* restrict models,
                                  __global const QuadraturePlace* restrict places, SEL_NODE_ARGUMENTS(node), SEL_WALL_ARGUMENTS,
                                  __global uint* restrict near_cells, __global uint* restrict counts,
                                  __global uint* restrict found, __global Clearance* restrict clearances)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        const WallView wall = SEL_WALL;
        const AxisPoint at = axis_point(places[s].edge, places[s].bary, SEL_NODES(node));
        const real radius = models[s].radius, range = radius + models[s].reach + slack;
        const uint count =
            find_near_cells(at, range, SEL_NEAR_CELL_SIZE * radius, wall, par.slots, near_cells + (ulong)s * par.slots);
        counts[s] = found[item] = count;
        clearances[s] = found_clearance(at.origin + at.offset, range, slack, radius, count);
    }
}

// How far listed quadrature points are from the wall.
//   item    one entry of `list`
//   reads   list [item_count]; places [points]; nodes; wall     writes  distances [item_count] [m], at most `most`
SEL_WALK_KERNEL void contact_distance(const uint item_count, const real most, __global const uint* restrict list,
                                      __global const QuadraturePlace* restrict places, SEL_NODE_ARGUMENTS(node),
                                      SEL_WALL_ARGUMENTS, __global real* restrict distances)
{
    const uint item = get_global_id(0);
    if (item < item_count) {
        const QuadraturePlace place = places[list[item]];
        const AxisPoint at = axis_point(place.edge, place.bary, SEL_NODES(node));
        distances[item] = wall_distance(at.origin + at.offset, most, SEL_WALL);
    }
}
