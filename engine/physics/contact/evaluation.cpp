// Launches of the force kernels and of contact_reduce.
#include "contact/evaluation.h"

#include "contact/device_records.h"
#include "contact/programs.h"

#include <algorithm>

namespace seldinger {
namespace {

bool any_rolls(std::span<const QuadratureModel> models)
{
    return std::any_of(models.begin(), models.end(), [](const QuadratureModel& m) { return m.roll_arm > 0; });
}

}  // namespace

Evaluation::Evaluation(device::Context& context, std::span<const QuadratureModel> models)
    : context_(context),
      evaluate_(context, programs::quadrature, models.size(), any_rolls(models)),
      reduce_(context, programs::quadrature, "contact_reduce", device::Items::Branching),
      forces_(context, models.size() * device_size<ContactForce>(context)),
      barys_(context, models.size() * device_size<double>(context)),
      no_multipliers_(context, sizeof(MultiplierState)),
      // stages have none
      memories_(context,
                (context.workgroup(device::Items::Branching) == 1 ? models.size() : 1) * device_size<WallMemory>(context))
{
}

void Evaluation::launch_forces(device::Queue queue, const ContactParams& par, const QuadratureBuffers& b,
                               const DeviceNodes& before, const device::Buffer& clearances, const device::Buffer* multipliers)
{
    const auto launch = [&](const auto& params) {
        evaluate_.launch(queue, std::max(par.item_count, 1u), params, b.list, b.models, b.places, b.near_cells, b.counts, b.wall,
                         b.nodes, before, b.states_t0, b.states, forces_, barys_, multipliers ? *multipliers : no_multipliers_,
                         clearances, memories_);
    };
    if (context_.float32()) launch(narrow(par));
    else launch(par);
}

void Evaluation::launch_sums(device::Queue queue, std::size_t edges, const device::Buffer& first, const device::Buffer& sums)
{
    reduce_.launch(queue, std::max<std::size_t>(edges, 1), static_cast<cl_uint>(edges), first, forces_, barys_, sums);
}

}  // namespace seldinger
