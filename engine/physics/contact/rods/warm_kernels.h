#pragma once
// Kernels of contact between instruments, compiled before a run needs them.

namespace seldinger {

/// On both queues of the device, as `seldinger devices` numbers it; -1: the default.
void warm_instrument_kernels(int device_index);

}  // namespace seldinger
