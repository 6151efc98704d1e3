#pragma once
// Texts that scenes of several tests are made of, and the files of tests/scenes, which Python reads too and which lack [scene].

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

/// [scene] of that many seconds, in steps of `dt`. @param more  further keys
inline std::string scene_text(double duration, double dt = 1e-3, const std::string& more = "")
{
    return fmt::format("[scene]\nduration_s = {}\ndt_s = {}\n{}", duration, dt, more);
}

/// A scene at rest without weight.
inline const std::string static_scene = "[scene]\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\n";

/// [wire], as heavy as steel where nothing else is said. [m], [N m^2]
inline std::string wire_text(double length, double bend, double twist, int nodes = 0, double radius = 4e-4, double density = 7900,
                             double stretch = 1e4)
{
    return fmt::format("[wire]\nlength_m = {}\nradius_m = {}\ndensity = {}\nbend_nm2 = {}\ntwist_nm2 = {}\nstretch_n = {}\n",
                       length, radius, density, bend, twist, stretch) +
           (nodes > 0 ? fmt::format("nodes = {}\n", nodes) : "");
}

/// Of [wire]: straight along x.
inline const std::string placed_along_x =
    "place = { shape = \"straight\", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }\n";

inline const std::string held_base = "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\n";

/// [vessel]: a tube along x.
inline std::string tube_text(double radius, double length, int triangles)
{
    return fmt::format("[vessel]\nshape = \"tube\"\nradius_m = {}\nlength_m = {}\ntriangles = {}\n", radius, length, triangles);
}

}  // namespace seldinger::test
