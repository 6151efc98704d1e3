#pragma once
// The stability map: where in (step, one other parameter) each method holds and how it fails where it does not. A map is one of
// the failure rows F1 ... F21 as a small scene with one thing varied; a cell is that scene at one step and one value, run with
// one method and judged by models/classify.h.

#include "models/classify.h"
#include "models/simulation.h"

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace seldinger {

/// One map. Everything that a cell changes is text of `seldinger run SCENE --set`, so that any cell can be run again by hand.
struct StabilityMap {
    std::string name;   // in tables and on the command line
    std::string rows;   // "F2 F3": failure rows that it shows
    std::string title;  // one line
    std::string axis;   // what is varied, with its unit
    bool logarithmic = true;
    bool touches = true;  // false: a free rod, where methods differ by their integrator alone
    // a static load presses, so that overlap is judged by the law's static indentation; false: impacts do
    bool static_load = true;
    // false: what is prescribed makes the hand's force jump from step to step, which is then no jitter
    bool hand_is_steady = true;
    std::string scene;  // TOML
    std::filesystem::path source;      // the file that `scene` was read from, where it is the user's; else empty
    std::vector<double> values;        // SI, rising
    std::vector<double> quick_values;  // a subset
    /// --set texts for one value. @param dt  the cell's step [s], for input that is prescribed step by step
    /// @param pace  by how much all prescribed motion is slowed down, 1 or more
    /// @param folder  where meshes were written (write_stability_meshes); only named here
    std::function<std::vector<std::string>(double value, double dt, double pace, const std::filesystem::path& folder)> set;
    /// Writes the meshes that `set` names, empty for maps with generated vessels. Files that are there already stay.
    std::function<void(const std::filesystem::path& folder)> write_meshes;
};

/// All maps, in the order of their rows.
[[nodiscard]] const std::vector<StabilityMap>& stability_maps();

/// A map of a scene of the user's: `key` takes `values`. Overlap is judged by the wire's radius alone, since nothing is known of
/// its loads. @throws Error BadFile, BadScene: no such scene, or it cannot be read with one of the values
[[nodiscard]] StabilityMap map_of_scene(const std::filesystem::path& file, const std::string& key,
                                        const std::vector<double>& values);

/// Steps that every map is swept over [s].
[[nodiscard]] std::vector<double> stability_steps(bool quick);

/// Methods: the published one, each of its choices exchanged for ours and ours for its, the default last.
[[nodiscard]] const std::vector<Model>& stability_methods();
/// The few that are shown side by side unless others are asked for.
[[nodiscard]] bool is_shown(const Model& method, bool quick);
[[nodiscard]] const Model& default_method();

struct CellResult {
    Verdict verdict;
    double overlap_limit = 0;  // that overlap was judged by [m]
    double jitter_limit = 0;   // that jitter was judged by [-]
    double simulated = 0;      // [s]; less than asked when the run broke off
    bool over_limit = false;   // took longer than the limit and was ended
    bool stopped = false;      // by `stop`: says nothing
    long wall_far_steps = 0;   // StepWallFar, of an elastic wall
    /// The observed failure; "unfinished" if nothing had failed when the limit ended the run: only a run that ends can hold.
    [[nodiscard]] const char* outcome() const { return over_limit && verdict.held() ? "unfinished" : name(verdict.outcome); }
};

/// The scene of a cell. @throws Error BadScene: a map that its own scene reader refuses
[[nodiscard]] Scene stability_scene(const StabilityMap& map, double value, double dt, double pace,
                                    const std::filesystem::path& folder);

/// What the cells of one map and value are judged by: the default method's own runs of that scene, well resolved.
struct CellReference {
    /// The largest depth of the wire in the same slow motion: the law's static indentation under the scene's largest load.
    /// infinity if the map has no static load, or if that run has no end. [m]
    double indentation = std::numeric_limits<double>::infinity();
    /// The hand's force after every millisecond [N]; empty where it is not judged.
    std::vector<double> hand_force;

    /// Jitter of the force sampled every `dt`: a tip that crosses a ridge of the wall every few steps is not the method's fault.
    /// 0 for steps that resolve it. [-]
    [[nodiscard]] double honest_jitter(double dt) const;
};

/// A method at one step and value of a map.
struct StabilityCell {
    const StabilityMap& map;
    const Model& method;
    double dt = 0;  // [s]
    double value = 0;
    std::filesystem::path folder;  // of the map's meshes
};

/// @param stop  asked after every step; true ends it with what there is. May be empty
[[nodiscard]] CellReference cell_reference(const StabilityMap& map, double value, const std::filesystem::path& folder,
                                           const std::function<bool()>& stop = {});

/// @param wall_limit  of the steps [s]  @param stop  as above
[[nodiscard]] CellResult run_stability_cell(const StabilityCell& cell, const CellReference& reference, double wall_limit,
                                            const std::function<bool()>& stop = {});

/// Why a method has no place in a map ("the scene has no vessel to touch"); empty when it has. `folder`
/// holds the map's meshes.
[[nodiscard]] std::string why_not_in(const StabilityMap& map, const Model& method, const std::filesystem::path& folder);

}  // namespace seldinger
