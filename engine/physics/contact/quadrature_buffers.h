#pragma once
// Data of quadrature points for a launch over a list of them. Put together for each call: lists grow, and states
// are swapped when a step is accepted.

#include "contact/device_views.h"
#include "device/device.h"

namespace seldinger {

struct QuadratureBuffers {
    const device::Buffer &models, &places, &list, &near_cells, &counts, &states_t0, &states;
    const DeviceWall& wall;
    const DeviceNodes& nodes;
};

}  // namespace seldinger
