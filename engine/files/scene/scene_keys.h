#pragma once
// Every key of a scene file, by table: the one place where a key is declared. A new key is a member of a spec and a row here; rules
// that join several keys are in the readers (scene_read_*.cpp). Rows of the tables of docs/scene-file.md come from here
// (tests/scene/test_scene_docs.cpp).

#include "scene/scene.h"
#include "scene/scene_key.h"

#include <string>
#include <vector>

namespace seldinger::keys {

inline constexpr int most_steps = 1'000'000'000, most_nodes = 200'000;

// Keys bound to the members of the argument, in the order in which they are written. Which keys are written and allowed can
// depend on other members (Use), so lists are made anew after a change.
[[nodiscard]] std::vector<Key> scene(Scene& s);
[[nodiscard]] std::vector<Key> wire(SceneInstrument& i);  // with a label: of [[instrument]]
/// Radius, material and friction of a wire or of a section. @param of_section  absent ones are the shaft's
[[nodiscard]] std::vector<Key> properties(WireSection& s, bool of_section);
[[nodiscard]] std::vector<Key> of_instrument(WireSpec& w);  // what one of the catalogue may have: properties, not place or discretisation
[[nodiscard]] std::vector<Key> section(WireSectionRange& range);
[[nodiscard]] std::vector<Key> place(WirePlacement& p);
[[nodiscard]] std::vector<Key> feed(SceneFeed& f, bool inside);  // inside: of an instrument within another one
[[nodiscard]] std::vector<Key> feed_key(FeedKey& k, bool driven);
[[nodiscard]] std::vector<Key> coaxial(CoaxialSpec& c, const Scene& s);
[[nodiscard]] std::vector<Key> integrator(IntegratorSpec& i);
[[nodiscard]] std::vector<Key> vessel(VesselSpec& v);
[[nodiscard]] std::vector<Key> contact(Scene& s);
[[nodiscard]] std::vector<Key> hold(HoldSpec& h, std::string& instrument);
[[nodiscard]] std::vector<Key> load(LoadSpec& l, std::string& instrument);
[[nodiscard]] std::vector<Key> link(LinkSpec& l, std::string& instrument);
/// With the plugin's own keys, by the names that its ForceKeys have.
[[nodiscard]] std::vector<Key> force(SceneForce& f, std::string& instrument);
[[nodiscard]] std::vector<Key> wall_load(WallLoad& l);
[[nodiscard]] std::vector<Key> task(TaskSpec& t);
[[nodiscard]] std::vector<Key> target(TaskSpec& t);
[[nodiscard]] std::vector<Key> carm(SceneCArm& c);
[[nodiscard]] std::vector<Key> carm_key(CArmKey& k);
[[nodiscard]] std::vector<Key> contrast(SceneContrast& c);
[[nodiscard]] std::vector<Key> contrast_key(ContrastKey& k);
[[nodiscard]] std::vector<Key> output(Scene& s);

/// A table of a scene.
struct Table {
    std::string name, header;  // "wire.section", "[[wire.section]]"
    std::vector<Key> keys;
};
/// All tables that the scene has, in the order in which they are written. Those within a table are Tables of their key.
[[nodiscard]] std::vector<Table> tables(Scene& s);

/// Stiffness of a wire is a material or these three.
inline constexpr std::string_view stiffness[] = {"bend_nm2", "twist_nm2", "stretch_n"};
/// Names of the keys of [wire] that an instrument of the catalogue may have.
[[nodiscard]] const std::vector<std::string_view>& of_instruments();

}  // namespace seldinger::keys
