#pragma once
// A scene's X-ray settings as the options of a fluoroscope: for the command and the Python package.

#include "pictures/fluoro_run.h"
#include "scene/scene.h"

namespace seldinger::apps {

/// [carm], [contrast] and what the instruments are made of. @param instruments  whether the scene's are those in the picture
[[nodiscard]] FluoroOptions fluoro_options(const Scene& scene, bool instruments = true);

}  // namespace seldinger::apps
