#pragma once
// Reference of a plan's trials: the scene itself, refined in nodes and steps until two refinements bound the remaining error.

#include "models/errors.h"
#include "models/run_store.h"

#include <functional>
#include <string>
#include <vector>

namespace seldinger {

/// Level k has (n0 - 1) 1.5^k edges and steps of dt0 / 2^k. Edges converge with order 2 and steps with order 1 (backward Euler;
/// without a vessel the trapezoid rule, with order 2). So both errors fall by about two, and cost grows by three.
inline constexpr double edge_refinement = 1.5, step_refinement = 2;
// An elastic wall has its control mesh refined like the wire's edges, from twice the scene's own edge on, as far as memory is
// (wall_edges.h). What the finest mesh is wrong by is then bounded by one more run, with the edge that comes before it: second
// order, so that as much is left as that moves.

struct PlanReference {
    Trajectory values;
    Model model;                       // of the finest level
    std::vector<Model> levels;         // coarse to fine
    std::vector<PerObservable> moved;  // [levels - 1] rms between level k and k + 1
    PerObservable uncertainty{};       // bound of the finest level's own error [SI]
    std::vector<Peaks> peaks_moved;    // [levels - 1], where they were asked for
    Peaks peak_uncertainty{};          // likewise
    double force_scale = 0;            // rms of the hand force, 1 mN at least [N]
    int contacts = 0;                  // at most
    double wall_move = 0;              // of the finest level: farthest that the wall goes [m]; 0 of a rigid one
    bool wall_far = false;             // and that is more than 20 % of the lumen's radius
    bool jitters = false;              // the finest level's hand force does
    bool converges = false;            // the movements fall
    bool out_of_budget = false, stopped = false;
    std::vector<std::string> failures;  // levels that broke off, and how
};

/// Requirements on the reference: refinement continues until its uncertainties are below.
struct ReferenceGoals {
    double shape = 0, force = 0;                                // [m], [N]; force infinity: not asked
    bool force_is_relative = false;                             // then of the rms hand force
    PeakGoal peaks;
    std::function<bool(double next_level_seconds)> affordable;  // asked before a level that is expected to take so long
    std::function<double()> seconds_left;                       // a level that takes longer is broken off [s]; may be empty
};

/// @param store, name  where levels are kept
/// @param plan  samples and stop; every level is run over the whole of it
[[nodiscard]] PlanReference refine_scene(const StudyScene& scene, const RunPlan& plan, const ReferenceGoals& goals,
                                         RunStore& store, const std::string& name,
                                         const std::function<void(const std::string&)>& progress);

/// A bound of the remaining error after the last of these movements, by Richardson: the rest of a geometric series whose ratio is
/// that of the last two. The ratio is taken as at least `least_ratio` (half: first order), and as `most_ratio` if there is only one
/// movement or they do not fall.
[[nodiscard]] double error_left(const std::vector<double>& moved);
/// The movements fall: the last is below `most_ratio` of the one before or, with three, below its square of the one before that.
[[nodiscard]] bool falls(const std::vector<double>& moved, double noise);

}  // namespace seldinger
