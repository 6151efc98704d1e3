#pragma once
// The plot scripts and scenes that come with the program.

#include "core/assets.h"

#include <string>
#include <vector>

namespace seldinger::apps {

/// Runs a plot script of the assets with Debian's python3, whose matplotlib it needs. Results are there without pictures too:
/// whatever is missing is one line on stderr with the command that draws them later.
/// @return whether it was drawn
bool draw_with(const std::string& script, const std::vector<std::string>& paths);

/// The file of a scene that comes with the program, if `word` is its name (aortic-arch) and no file is called so here; else `word`.
[[nodiscard]] std::string scene_file(const std::string& word);

}  // namespace seldinger::apps
