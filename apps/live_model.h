#pragma once
// The model of a live session where it is chosen by `plan`.

#include "scene/scene.h"

#include <filesystem>
#include <string>

namespace seldinger::apps {

/// The cheapest model of a scene that stays within a length and keeps the rate, as `seldinger plan` finds it.
/// @param trials  folder of the trial runs: what it holds already is not run again
/// @throws Error NotFeasible: there is none; BadScene: the text is no length
[[nodiscard]] Scene model_for(const Scene& scene, const std::string& tolerance, double rate, const std::filesystem::path& trials, int device,
                              bool quiet);

}  // namespace seldinger::apps
