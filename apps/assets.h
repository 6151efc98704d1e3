#pragma once
// The plot scripts that come with the program.

#include "core/assets.h"

#include <string>
#include <vector>

namespace seldinger::apps {

/// Runs a plot script of the assets with Debian's python3, whose matplotlib it needs. Results are there without pictures too:
/// whatever is missing is one line on stderr with the command that draws them later.
/// @return whether it was drawn
bool draw_with(const std::string& script, const std::vector<std::string>& paths);

}  // namespace seldinger::apps
