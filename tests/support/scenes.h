#pragma once
// Texts that scenes of several tests have: wires, and the files of tests/scenes, which Python reads too and which lack [scene].

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

namespace seldinger::test {

/// @param head  what stands before the file: [scene] and its keys
inline std::string shared_scene(const std::string& head, const std::string& name)
{
    std::ifstream file(SEL_SOURCE_DIR "/tests/scenes/" + name + ".toml");
    if (!file) throw std::runtime_error("tests/scenes/" + name + ".toml: not there");
    std::string text(std::istreambuf_iterator<char>(file), {});
    return head + text.substr(text.find("\n[") + 1);
}

/// [wire] of 0.4 mm radius, as heavy as steel. [m], [N m^2]
inline std::string wire_text(double length, double bend, double twist, int nodes = 0)
{
    return fmt::format("[wire]\nlength_m = {}\nradius_m = 0.0004\ndensity = 7900\nbend_nm2 = {}\ntwist_nm2 = {}\n", length, bend,
                       twist) +
           "stretch_n = 1e4\n" + (nodes > 0 ? fmt::format("nodes = {}\n", nodes) : "");
}

}  // namespace seldinger::test
