#pragma once
// From a scene and a sweep to a finished results table: steps the worlds one after the other, saves and stops.

#include "run_loop.h"
#include "study/batch.h"

namespace seldinger::apps {

/// @throws Error
[[nodiscard]] RunOutcome run_batch(const std::filesystem::path& scene, const std::filesystem::path& sweep,
                                   const RunOptions& options);

}  // namespace seldinger::apps
