#pragma once
// A scene's X-ray settings as the options of a fluoroscope.

#include "pictures/fluoro_run.h"
#include "scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

/// [carm], [contrast] and what the instruments are made of. @param instruments  whether the scene's are those in the picture
[[nodiscard]] FluoroOptions fluoro_options(const Scene& scene, bool instruments = true);

/// A run's scene; if its mesh has gone, the wall that the run wrote replaces it. Without a scene.toml: the default.
[[nodiscard]] Scene scene_of_pictures(const std::filesystem::path& dir, std::vector<std::string> overrides = {});

}  // namespace seldinger
