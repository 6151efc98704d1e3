// Which kernels make forces on a device, and the memory of their stages.
#include "contact/force_kernels.h"

#include "contact/programs.h"
#include "shared/contact_stages.h"
#include "shared/instrument_slot.h"
#include "shared/instrument_types.h"

namespace seldinger {
namespace {

constexpr device::Items items_ = device::Items::Branching;

}  // namespace

StagedKernel::StagedKernel(device::Context& context, const std::string& program, const char* whole)
    : context_(&context), program_(program)
{
    if (is_whole()) whole_ = device::Kernel(context, program, whole, items_);
}

bool StagedKernel::is_whole() const { return context_->workgroup(items_) == 1; }

void StagedKernel::add(const char* name, cl_uint side)
{
    stages_.push_back({device::Kernel(*context_, program_, name, items_), side});
}

void StagedKernel::add_geometry()
{
    for (const char* name : {"contact_nearest", "contact_behind", "contact_join", "contact_share", "contact_oppose"}) add(name);
    add("contact_join", 1);
    add("contact_share", 1);
}

void StagedKernel::provide_records(std::size_t points)
{
    records_ = device::Buffer(*context_, points * SEL_STAGE_REALS * (context_->float32() ? sizeof(float) : sizeof(double)));
    todo_ = device::Buffer(*context_, (points + 1) * sizeof(cl_uint));
}

ForceKernels::ForceKernels(device::Context& context, const std::string& program, std::size_t points, bool rolling)
    : StagedKernel(context, program, "contact_evaluate")
{
    if (is_whole()) return;
    add("contact_clear");
    add_geometry();
    for (const cl_uint side : {0u, 1u}) {
        add("contact_press", side);
        add("contact_rub", side);
        add("contact_tangent", side);
        if (rolling) add("contact_roll", side);
    }
    provide_records(points);
}

GapKernels::GapKernels(device::Context& context, std::size_t points)
    : StagedKernel(context, programs::barrier, "contact_clearance")
{
    if (is_whole()) return;
    program_ = programs::quadrature;
    add("contact_all");
    add_geometry();
    add("contact_gap");
    provide_records(points);
}

InstrumentKernels::InstrumentKernels(device::Context& context, const std::string& program, Of of)
    : StagedKernel(context, program, of == Of::Others ? "instruments_evaluate" : "instruments_evaluate_self"), of_(of)
{
    if (is_whole()) return;
    const auto add_all = [&](std::initializer_list<const char*> names) {
        for (const char* name : names) add(name);
    };
    if (of == Of::Others)
        add_all({"instruments_ends", "instruments_look", "instruments_push", "instruments_whole", "instruments_rub"});
    else
        add_all({"instruments_self_mark", "instruments_self_touch", "instruments_self_close", "instruments_self_push",
                 "instruments_self_rub"});
}

void InstrumentKernels::provide(std::size_t slots)
{
    const std::size_t record = of_ == Of::Others ? sizeof(CellWork) : sizeof(SelfWork);
    if (is_whole() || records_.bytes() >= slots * record) return;
    records_ = device::Buffer(*context_, 2 * slots * record);
    todo_ = device::Buffer(*context_, (2 * slots + 1) * sizeof(cl_uint));
}

// Launches them over no cells.

void warm_instrument_kernels(int device_index)
{
    device::Context context(device_index);
    const device::Buffer none(context, 1 << 12);
    for (const auto of : {InstrumentKernels::Of::Others, InstrumentKernels::Of::Itself}) {
        InstrumentKernels kernels(context, programs::instruments, of);
        kernels.provide(1);
        for (const device::Queue at : {device::Queue::Inline, device::Queue::Pool}) {
            context.enter(at);
            kernels.launch(at, 1, InstrumentParams{}, none, none, none, none, none, none, none, none, none, none, none, none);
            context.finish(at);
        }
    }
}

}  // namespace seldinger
