#pragma once
// The catalogue: wires, catheters and sheaths that come with the program, one file each in assets/instruments
// (docs/instruments.md). A scene brings one in with [wire] preset = "name".

#include "rod/wire_spec.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

struct Instrument {
    std::string name;   // what `preset` calls it: the file's stem
    std::string title;  // one line: maker, product, size
    std::string kind;   // "wire", "catheter" or "sheath"
    WireSpec wire;      // as the file has it; its length, nodes and placement are the scene's
};

/// The file of an instrument, whether or not it is there. @throws Error BadFile, the program's assets are not found
[[nodiscard]] std::filesystem::path instrument_file(const std::string& name);

/// What `preset` may say, sorted. @throws Error BadFile as above
[[nodiscard]] std::vector<std::string> instrument_names();

/// All of the catalogue, sorted by name. @throws Error BadFile as above; BadScene, with its place, for an error in a file
[[nodiscard]] std::vector<Instrument> instruments();

}  // namespace seldinger
