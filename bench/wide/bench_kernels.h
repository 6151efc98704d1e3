#pragma once
// The kernels of bench/, which the engine does not use: peaks of a device, and queries of the wide tree.

namespace seldinger {

/// Makes roofline/peaks.cl and wide/queries.cl known to the device layer.
void add_bench_kernels();

}  // namespace seldinger
