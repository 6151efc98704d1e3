#pragma once
// What a scene says of how it is looked at by X-ray, as the options of a fluoroscope: for the command and the Python package.

#include "scene/scene.h"
#include "view/xray/fluoro_run.h"

namespace seldinger::apps {

/// [carm], [contrast] and what the instruments are made of. @param instruments  whether the scene's are those that are looked at
[[nodiscard]] FluoroOptions fluoro_options(const Scene& scene, bool instruments = true);

}  // namespace seldinger::apps
