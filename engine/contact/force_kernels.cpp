// Which kernels make forces on a device, and the memory of their stages.

#include "contact/force_kernels.h"

#include "shared/contact_stages.h"

namespace seldinger {

ForceKernels::ForceKernels(device::Context& context, const std::string& program, std::size_t points, bool rolling) : context_(&context)
{
    const device::Items items = device::Items::Branching;
    if (context.workgroup(items) == 1) {
        whole_ = device::Kernel(context, program, "contact_evaluate", items);
        return;
    }
    const auto add = [&](const char* name, cl_uint side) { stages_.push_back({device::Kernel(context, program, name, items), side}); };
    add("contact_clear", 0);
    add("contact_nearest", 0);
    add("contact_behind", 0);
    add("contact_join", 0);
    add("contact_oppose", 0);
    add("contact_join", 1);
    for (const cl_uint side : {0u, 1u}) {
        add("contact_press", side);
        add("contact_rub", side);
        add("contact_tangent", side);
        if (rolling) add("contact_roll", side);
    }
    records_ = device::Buffer(context, points * SEL_STAGE_REALS * (context.float32() ? sizeof(float) : sizeof(double)));
    todo_ = device::Buffer(context, (points + 1) * sizeof(cl_uint));
}

}  // namespace seldinger
