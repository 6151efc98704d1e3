#pragma once
// The readers of a scene's tables, one each; private to scene/. A reader fills its part of the Scene and checks it against the
// parts read before (order: integrator, scene, contact, vessel, instruments with their feeds, holds, loads, links, output).

#include "scene/scene_keys.h"
#include "scene/toml_table.h"

#include <functional>

namespace seldinger {

void read_vessel_table(const toml::table& table, Scene& scene);  // [vessel]
void read_task_table(const toml::table& table, Scene& scene);    // [task]

/// Properties, sections and placement of an instrument. @param path  of the table, "wire" or "instrument.1"
/// @param fed  whether it has a feed   @param scene  takes the notes
void read_wire_table(const toml::table& table, const std::string& path, bool fed, SceneInstrument& into, Scene& scene);

/// Place of a feed's instrument among others.
struct FeedPlace {
    bool inside = false;  // another one, and so enters where that does
    bool merged = false;  // it shares its centreline with others
};
/// Reads the place where an instrument enters, and its key frames.
void read_feed_table(const toml::table& table, const std::string& path, FeedPlace place, SceneInstrument& into,
                     Scene& scene);

/// A contact cannot need less force to start sliding than to continue. A mu_static of the table below mu_sliding is refused; one
/// that nobody gave is raised, for the summary and with a warning. @param path  of the table
void order_friction(const TableReader& t, const std::string& path, double& mu_static, double mu_sliding, Scene& scene);

void read_carm_table(const toml::table& table, Scene& scene);      // [carm]
void read_contrast_table(const toml::table& table, Scene& scene);  // [contrast]

/// [[instrument]] with their feeds, and [coaxial].
void read_instruments(const toml::table& root, Scene& scene);
/// What instruments that share a centreline, or touch each other, cannot be joined with. All of that has been read.
void check_several(const toml::table& root, const Scene& scene);

/// [[hold]], [[load]], [[link]], [[force]], each to the instrument that it names.
void read_holds_and_loads(const toml::table& root, Scene& scene);

/// Calls `read` for each of the tables [[name]], with its path "name.0".
void for_each_table(const toml::table& parent, const std::string& name, const std::string& path,
                    const std::function<void(const toml::table&, const std::string&)>& read);

/// The table of that name, or null when the scene has none.
[[nodiscard]] const toml::table* find_table(const toml::table& root, std::string_view name);

}  // namespace seldinger
