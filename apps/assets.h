#pragma once
// The files that come with the program: scenes and plot scripts.

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

/// $SELDINGER_ASSETS, else beside the build folder, where it was installed, or in the source tree. @throws Error BadFile, none is
/// there
[[nodiscard]] std::filesystem::path assets_folder();

/// Runs a plot script of the assets with Debian's python3, whose matplotlib it needs. Results are there without pictures too:
/// whatever is missing is one line on stderr with the command that draws them later.
/// @return whether it was drawn
bool draw_with(const std::string& script, const std::vector<std::string>& arguments);

}  // namespace seldinger::apps
