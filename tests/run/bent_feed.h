#pragma once
// A wire fed round a bend: where nodes and facets show in tip and forces.

#include "scene/scene.h"
#include "support/scenes.h"

#include <fmt/format.h>

#include <string>

namespace seldinger::test {

/// A wire fed 10 cm round an arc of 100 degrees, without friction. @param vessel_keys  further lines of [vessel]
inline Scene fed_round_a_bend(int nodes, const std::string& vessel_keys = "")
{
    return read_scene_text(scene_text(1, 0.004, "gravity = [0.0, 0.0, 0.0]\n") +
                               wire_text(0.3, 5e-4, 3.8e-4, nodes, 0.0004445, 6500) +
                               "[vessel]\nshape = \"arc\"\nradius_m = 0.004\nbend_radius_m = 0.05\nangle_deg = 100.0\n"
                               "lead_in_m = 0.03\nlead_out_m = 0.05\n" +
                               vessel_keys +
                               "\n[contact]\nmu_static = 0.0\nmu_sliding = 0.0\n[feed]\ninlet = \"auto\"\n"
                               "keys = [ {t_s = 0.0, advance_m = 0.0}, {t_s = 1.0, advance_m = 0.1} ]\n",
                           "arc.toml");
}

}  // namespace seldinger::test
