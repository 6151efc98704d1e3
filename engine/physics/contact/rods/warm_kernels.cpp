// Launches them over no cells.

#include "contact/rods/warm_kernels.h"

#include "contact/force_kernels.h"
#include "contact/programs.h"
#include "shared/instrument_types.h"

namespace seldinger {

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
