#pragma once
// From a scene to the setup of a world that nothing refuses before its first step: the one check of `check`, `run` and all that
// step.

#include "setup/scene_setup.h"

namespace seldinger {

/// make_setup, and all that World's constructor or [task] would refuse later. Needs no device.
/// @param device_index, report  as of make_setup
/// @throws Error BadFile, BadScene: the line names scene, place, expected value and fix
[[nodiscard]] WorldSetup ready_setup(const Scene& scene, int device_index = -1, RepairReport* report = nullptr);

/// The same of several scenes for one world.
[[nodiscard]] WorldSetup ready_setup(std::span<const Scene> scenes, LoadedVessel vessel, int device_index);

}  // namespace seldinger
