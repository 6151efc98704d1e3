#pragma once
// Forces from libraries that others have compiled against the installed headers (SELDINGER_FORCE, solve/force.h).

#include "scene/scene.h"

#include <memory>

namespace seldinger {

/// Opens the library, which stays open, and makes its force. What the force throws later names the file. It is looked for in the
/// folders of SELDINGER_PLUGINS, a:b, and nowhere else: a scene of somebody else runs no code that the user has not put there.
/// @throws Error BadFile: no such library, not a plugin, one for another version, keys that it refuses or does not know
[[nodiscard]] std::shared_ptr<const Force> load_force(const SceneForce& from);

}  // namespace seldinger
