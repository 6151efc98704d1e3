// Segmented sum of forces and tangents: one edge per item, its quadrature points (or pairs) in order, so that the same bits come
// from any number of threads.
//   launch  engine/physics/contact/evaluation.cpp, engine/physics/contact/layer.cpp       test  tests/contact/test_host_reference.cpp
#include "shared/edge_sums.h"
#include "shared/kernel.h"

//   item    one active edge; its forces are first[item] .. first[item + 1] - 1; range rounded up to the work-group size
//   reads   first [item_count + 1]; forces, barys      writes  edges [item_count]
SEL_WALK_KERNEL void contact_reduce(const uint item_count, __global const uint* restrict first,
                                    __global const ContactForce* restrict forces, __global const real* restrict barys,
                                    __global EdgeForce* restrict edges)
{
    const uint item = get_global_id(0);
    if (item < item_count) reduce_edge(forces, barys, first[item], first[item + 1], edges + item);
}
