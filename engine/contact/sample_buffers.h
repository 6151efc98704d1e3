#pragma once
// What the kernels beside contact_evaluate read of the samples. Put together for each call: lists grow, and touches are swapped
// when a step is accepted.

#include "contact/contact_system.h"

namespace seldinger {

struct SampleBuffers {
    const device::Buffer &models, &places, &list, &candidates, &counts, &touches_t0, &touches;
    const DeviceWall& wall;
    const DeviceNodes& nodes;
};

}  // namespace seldinger
