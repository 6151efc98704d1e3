#pragma once
// The folder of files that come with the program: scenes, instruments, plot scripts.

#include <filesystem>

namespace seldinger {

/// $SELDINGER_ASSETS, else beside the program (its build folder, or where it was installed), in the source tree of the library,
/// or where that was installed.
/// @throws Error BadFile, none is there
[[nodiscard]] std::filesystem::path assets_folder();

}  // namespace seldinger
