#pragma once
// The readers of a scene's tables, one each; private to scene/. A reader fills its part of the Scene and checks it against the
// parts read before (order: integrator, scene, contact, wire, vessel, feed, holds, loads, links, output).

#include "scene/scene.h"
#include "scene/toml_table.h"

namespace seldinger {

/// [wire] with its sections and placement; `root` tells whether it is fed.
void read_wire_table(const toml::table& table, const toml::table& root, Scene& scene);
void read_vessel_table(const toml::table& table, Scene& scene);  // [vessel]
void read_task_table(const toml::table& table, Scene& scene);    // [task]

/// The spelled form of `at`: "base", "tip" or metres from the tip, at most the wire's length.
void read_point(const TableReader& t, const WireSpec& wire, WirePoint& point);

/// Error when times of rows [t, ...] are negative or do not increase.
void check_times(const TableReader& t, std::string_view key, const std::vector<std::vector<double>>& rows);

}  // namespace seldinger
