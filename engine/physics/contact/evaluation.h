#pragma once
// The launches that make contact forces of quadrature points and sum them by edge.

#include "contact/force_kernels.h"
#include "contact/quadrature_buffers.h"
#include "shared/contact_types.h"

#include <span>

namespace seldinger {

class Evaluation {
public:
    /// @param models  of all points, which stay as they are
    Evaluation(device::Context& context, std::span<const QuadratureModel> models);

    /// Forces of the first par.item_count listed points; 0: the kernel is launched with nothing to do. before: nodes where the
    /// moves of the step begin; multipliers: [points][2] or nullptr
    void launch_forces(device::Queue queue, const ContactParams& par, const QuadratureBuffers& buffers, const DeviceNodes& before,
                       const device::Buffer& clearances, const device::Buffer* multipliers);
    /// Their sums over `edges` edges, which may be none, of each of which `first` has the first.
    void launch_sums(device::Queue queue, std::size_t edges, const device::Buffer& first, const device::Buffer& sums);

private:
    device::Context& context_;
    ForceKernels evaluate_;
    device::Kernel reduce_;
    device::Buffer forces_, barys_;
    device::Buffer no_multipliers_;  // for the laws that have none
    device::Buffer memories_;        // [points] kernels/shared/wall_memory.h
};

}  // namespace seldinger
