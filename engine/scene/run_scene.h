#pragma once
// The scene that lies in a run's folder.

#include "core/folder.h"
#include "scene/scene.h"

namespace seldinger {

/// The scene.toml that a run has written into its folder, which includes nothing: a run of somebody else's does not have files from
/// elsewhere read by an include, nor by a link. @throws Error BadFile, BadScene
[[nodiscard]] Scene read_run_scene(const Folder& run, std::span<const std::string> overrides = {});

}  // namespace seldinger
