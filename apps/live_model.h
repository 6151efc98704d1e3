#pragma once
// The model of a live session where it is chosen by `plan`.

#include "scene/scene.h"

#include <string>

namespace seldinger::apps {

/// The cheapest model of a scene that stays within a length and keeps the rate, as `seldinger plan` finds it.
/// @throws Error NotFeasible: there is none; BadScene: the text is no length
[[nodiscard]] Scene model_for(const Scene& scene, const std::string& tolerance, double rate, int device, bool quiet);

}  // namespace seldinger::apps
