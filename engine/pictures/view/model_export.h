#pragma once
// A run as a model that moves, for other programs to draw.

#include "io/animated_model.h"
#include "view/frame_range.h"
#include "view/viewpoint.h"

namespace seldinger {

/// Frames of a run: each instrument through the same number of stations at even shares of its length in every frame. The vessel
/// is where vessel.vtp has it. @throws Error BadFile
[[nodiscard]] AnimatedModel animated_model(const RunFolder& run, const FrameRange& range, const PatientAxes& patient);

}  // namespace seldinger
