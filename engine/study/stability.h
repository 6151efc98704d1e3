#pragma once
// The stability map: where in (step, one other parameter) each method holds and how it fails where it does not. A map is one of
// the failure rows F1 ... F17 as a small scene with one thing varied; a cell is that scene at one step and one value, run with one
// method and judged by study/classify.h.

#include "study/classify.h"
#include "study/simulation.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace seldinger {

/// One map. Everything that a cell changes is text of `seldinger run SCENE --set`, so that any cell can be run again by hand.
struct StabilityMap {
    std::string name;    // in tables and on the command line
    std::string rows;    // "F2 F3": failure rows that it shows
    std::string title;   // one line
    std::string axis;    // what is varied, with its unit
    bool logarithmic = true;
    bool touches = true;        // false: a free rod, where methods differ by their integrator alone
    bool static_load = true;    // a static load presses, so that overlap is judged by the law's static indentation; false: impacts do
    std::string scene;          // TOML
    std::vector<double> values;        // SI, rising
    std::vector<double> quick_values;  // a subset
    /// --set texts for one value. @param dt  the cell's step [s], for what has to be prescribed step by step
    /// @param pace  by how much all prescribed motion is slowed down, 1 or more
    /// @param folder  where meshes were written (write_stability_meshes); only named here
    std::function<std::vector<std::string>(double value, double dt, double pace, const std::filesystem::path& folder)> set;
    /// Writes the meshes that `set` names, empty for maps with generated vessels. Files that are there already stay.
    std::function<void(const std::filesystem::path& folder)> write_meshes;
};

/// All maps, in the order of their rows.
[[nodiscard]] const std::vector<StabilityMap>& stability_maps();

/// Steps that every map is swept over [s].
[[nodiscard]] std::vector<double> stability_steps(bool quick);

/// Methods: the published one, each of its choices exchanged for ours and ours for its, the default last.
[[nodiscard]] const std::vector<Model>& stability_methods();
[[nodiscard]] const Model& default_method();

struct CellResult {
    Verdict verdict;
    double overlap_limit = 0;  // that overlap was judged by [m]
    double simulated = 0;      // [s]; less than asked when the run broke off
    bool over_limit = false;   // took longer than the limit and was ended
};

/// The scene of a cell. @throws Error BadScene: a map that its own scene reader refuses
[[nodiscard]] Scene stability_scene(const StabilityMap& map, double value, double dt, double pace, const std::filesystem::path& folder);

/// The deepest that the wire sinks in where the same is done slowly and with the default method: the law's static indentation
/// under the scene's largest load. infinity where the map has no static load. [m]
[[nodiscard]] double static_indentation(const StabilityMap& map, double value, const std::filesystem::path& folder);

/// @param indentation  of static_indentation()  @param wall_limit  of the steps [s]
[[nodiscard]] CellResult run_stability_cell(const StabilityMap& map, const Model& method, double dt, double value, double indentation,
                                            const std::filesystem::path& folder, double wall_limit);

/// Why a method has no place in a map ("the scene has no vessel to touch", "not available yet"); empty when it has. `folder`
/// holds the map's meshes.
[[nodiscard]] std::string why_not_in(const StabilityMap& map, const Model& method, const std::filesystem::path& folder);

}  // namespace seldinger
