#pragma once
// Layers of a scene before it is read as one table: the file itself over its included files, [wire] over the instrument named as
// its preset, --set over all. Private to scene/.

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <toml++/toml.h>

namespace seldinger {

struct LayeredScene {
    toml::table root;  // without `include` and `wire.preset`; nodes know the file they came from
    std::vector<std::pair<std::string, std::string>> notes;  // what was brought in, for Scene::notes
    std::vector<std::string> warnings;                       // for Scene::warnings
    std::size_t included = 0, included_bytes = 0;            // files that were included so far, those in others too
};

/// A file of the catalogue, its keys checked by name. @throws Error BadFile, BadScene
[[nodiscard]] toml::table read_instrument(const std::filesystem::path& file);

/// @param file  of `text`, for messages and as the place that relative includes start from
/// @throws Error BadScene, one line with the place
[[nodiscard]] LayeredScene layer_scene(const std::string& text, const std::filesystem::path& file,
                                       std::span<const std::string> overrides);

}  // namespace seldinger
