#pragma once
// The scene that lies in a run's folder.

#include "core/folder.h"
#include "scene/scene.h"

namespace seldinger {

/// The scene.toml that a run has written into its folder. It must not include files and must not be a link: a foreign run must
/// not make the program read files from elsewhere. @throws Error BadFile, BadScene
[[nodiscard]] Scene read_run_scene(const Folder& run, std::span<const std::string> overrides = {});

}  // namespace seldinger
