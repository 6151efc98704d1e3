#pragma once
// The folder of files that come with the program: scenes, instruments, plot scripts.

#include <filesystem>
#include <string>

namespace seldinger {

/// $SELDINGER_ASSETS, else around the shared library or the program, where it was built or installed.
/// @throws Error BadFile, none is there
[[nodiscard]] std::filesystem::path assets_folder();

/// The file of a scene that comes with the program, if `word` is its name (aortic-arch, training/renal) and no file is called so
/// here; else `word`.
[[nodiscard]] std::string scene_file(const std::string& word);

}  // namespace seldinger
