#pragma once
// A wire fed round a bend: where nodes and facets show in tip and forces.

#include "scene/scene.h"

#include <fmt/format.h>

#include <string>

namespace seldinger::test {

/// A wire fed 10 cm round an arc of 100 degrees, without friction. @param vessel_keys  further lines of [vessel]
inline Scene fed_round_a_bend(int nodes, const std::string& vessel_keys = "")
{
    return read_scene_text(fmt::format(R"([scene]
gravity = [0.0, 0.0, 0.0]
duration_s = 1.0
dt_s = 0.004
[wire]
length_m = 0.3
radius_m = 0.0004445
density = 6500.0
bend_nm2 = 5.0e-4
twist_nm2 = 3.8e-4
stretch_n = 1.0e4
nodes = {}
[vessel]
shape = "arc"
radius_m = 0.004
bend_radius_m = 0.05
angle_deg = 100.0
lead_in_m = 0.03
lead_out_m = 0.05
{}
[contact]
mu_static = 0.0
mu_sliding = 0.0
[feed]
inlet = "auto"
keys = [ {{t_s = 0.0, advance_m = 0.0}}, {{t_s = 1.0, advance_m = 0.1}} ]
)",
                                       nodes, vessel_keys),
                           "arc.toml");
}

}  // namespace seldinger::test
