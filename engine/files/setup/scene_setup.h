#pragma once
// From scenes to the parts of a World.

#include "scene/scene.h"
#include "setup/vessel_load.h"

namespace seldinger {

/// Loads the vessel, places the feed and checks that wire and vessel fit each other.
/// @param device_index  as in `seldinger devices`; -1: the default
/// @param report  out, may be null: findings and repairs of the import
/// @throws Error BadFile, BadScene
[[nodiscard]] WorldSetup make_setup(const Scene& scene, int device_index = -1, RepairReport* report = nullptr);

/// One world for several scenes, each its own system, that agree in everything but their instruments, [feed], [[hold]], [[load]],
/// [[link]], [[force]] and the coefficients of [contact]. @param vessel  of these scenes, loaded
[[nodiscard]] WorldSetup make_setup(std::span<const Scene> scenes, LoadedVessel vessel, int device_index);

}  // namespace seldinger
