#pragma once
// Parts of the stability maps: the usual wire, bend and feeds, and lists of values. Private to the maps.

#include "lab/stability.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace seldinger::stability_parts {

using Texts = std::vector<std::string>;
namespace fs = std::filesystem;

inline constexpr double duration = 2.0 / 3;  // a whole number of steps of 1/30 s, 1/60 s and (almost) of the decimal ones [s]
inline constexpr double radius = 4.445e-4;   // of the wire [m]

inline constexpr const char* wire = R"(
[wire]
length_m = 0.08
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 1.0e-4
twist_nm2 = 7.7e-5
stretch_n = 1.0e4
nodes = 33
)";

// half a centimetre straight, then a quarter of a circle of 3 cm; the lumen is 5.6 wires wide
inline constexpr const char* bend = R"(
[vessel]
youngs_pa = 1e6
shape = "arc"
radius_m = 0.0025
bend_radius_m = 0.03
angle_deg = 90.0
lead_in_m = 0.005
lead_out_m = 0.02
normal = [0.0, 0.0, 1.0]
triangles = 3000

[feed]
inlet = "auto"
keys = [ {t_s = 0.0, advance_m = 0.0} ]
)";

[[nodiscard]] std::string head(const char* name);

/// Feeds `length` at an even speed over the whole run. @param start  already inside, straight [m]
[[nodiscard]] Texts feed(double length, double time, double pace, double start = 0);

// inside at the start, straight: half a millimetre before the outer wall of the bend [m]
inline constexpr double bend_start = 0.0155;

/// The usual run, 4 cm round the bend, and what else is set.
[[nodiscard]] Texts fed(double pace, Texts more = {});

[[nodiscard]] std::vector<double> decades(double from, double to, int per_decade = 1);

/// A map of the usual wire; `set` is still to come.
[[nodiscard]] StabilityMap map_of(const char* name, const char* rows, const char* title, const char* axis,
                                  std::vector<double> values);

/// The same, fed round the bend.
[[nodiscard]] StabilityMap fed_map(const char* name, const char* rows, const char* title, const char* axis,
                                   std::vector<double> values);

/// And with what else a value sets there.
[[nodiscard]] StabilityMap fed_by(const char* name, const char* rows, const char* title, const char* axis,
                                  std::vector<double> values, std::function<Texts(double value)> set);

/// Maps of several instruments (stability_instruments.cpp): a wire in a catheter as two rods and as one, two wires beside each
/// other.
[[nodiscard]] std::vector<StabilityMap> instrument_maps();

}  // namespace seldinger::stability_parts
