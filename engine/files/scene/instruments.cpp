// Lists and reads the files of assets/instruments.
#include "scene/instruments.h"

#include "core/assets.h"
#include "scene/scene.h"
#include "scene/scene_layers.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {

namespace fs = std::filesystem;

fs::path instrument_file(const std::string& name) { return assets_folder() / "instruments" / (name + ".toml"); }

std::vector<std::string> instrument_names()
{
    std::vector<std::string> names;
    std::error_code unreadable;
    for (const auto& entry : fs::directory_iterator(assets_folder() / "instruments", unreadable))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<Instrument> instruments()
{
    std::vector<Instrument> all;
    for (const std::string& name : instrument_names()) {
        const toml::table file = read_instrument(instrument_file(name));
        Instrument instrument;
        instrument.name = name;
        instrument.title = file["title"].value_or(std::string());
        instrument.kind = file["kind"].value_or(std::string());
        // longer than any instrument's sections: none is cut short
        const std::string scene = fmt::format("integrator.scheme = \"static\"\n[wire]\npreset = \"{}\"\nlength_m = 10.0\n", name);
        instrument.wire = read_scene_text(scene, fs::path(name + ".toml")).wire;
        all.push_back(std::move(instrument));
    }
    return all;
}

}  // namespace seldinger
