#pragma once
// Looks for the cheapest model that meets a plan's goals, by trials. Every step of the search compares measured costs and errors;
// nothing is extrapolated.
//
// A model is a family (integrator, detection, laws, simplifications) and a place on a grid of nodes and steps. In one family the
// error grows with the step and with the edges, so the places that meet the goals are bounded by a curve over nodes and steps:
// the search goes down to a point of it, then along it as far as that pays. Families are tried from the winner's place on, the
// likeliest to pay first. An elastic wall is tried first of all, rigid and on coarser control meshes, where the search begins. It
// makes every step several times as expensive, so this choice sets the cost of all later trials.

#include "plan/plan_trials.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

/// Places that the search may go to, fine to coarse.
struct SearchGrid {
    std::vector<int> nodes;
    std::vector<double> steps;  // [s]; empty: static
    std::vector<double>
        walls;               // control edges of an elastic wall, coarse to fine, the scene's own last [m]; empty: it is rigid
    double finest_wall = 0;  // the reference's: where nothing meets the goals at a start on a coarser one [m]
};

/// Neighbours are a factor of 1.3 apart at most, where there are whole numbers of edges and of steps in an interval between.
/// @param interval  between samples: every step divides it  @param longest_step  [s]; 0: static
[[nodiscard]] SearchGrid search_grid(const Reference& reference, double interval, double longest_step);

/// One choice that a model can make, and its other way.
struct PlanChoice {
    std::string simpler;  // what it means to make it, e.g. "rolling friction left out"
    std::string fuller;   // what it means not to, e.g. "rolling friction"
    std::function<void(Model&)> make, undo;
    bool needs_contact = true;
    bool leaves_out = false;  // leaves a part of the physics out: made where that changes nothing, even if it saves nothing
    bool of_wall = false;     // what the wall is: tried before the search goes down to coarser places
};

/// Choices that this build can make in the scene, the likeliest to pay first.
/// @param walls  as SearchGrid::walls
[[nodiscard]] std::vector<PlanChoice> choices_in(const Scene& scene, const std::vector<double>& walls = {});

/// Why no plan may choose a model, although it can be run; empty: it may. A trial shows that a model went through the scene once.
/// Two facts vouch for the run afterwards: every step's equations are solved, and its energy balances (solve/energy_balance.h).
/// The residual of one linearised step is not bounded. In contact the trapezoid rule generates energy at any step, a little in
/// every touch, until the balance ends the run.
[[nodiscard]] std::string not_vouched_for(const Model& model, const Scene& scene, bool touches);

struct SearchResult {
    std::optional<Model> best;  // the cheapest that meets the goals
    bool complete = true;       // false: ended by `may_go_on` or a stop
};

/// @param from  families begin here: a model that meets the goals, at a place of the grid or between two
/// @param may_go_on  asked before every trial
[[nodiscard]] SearchResult search_models(const Scene& scene, const Model& from, const SearchGrid& grid, bool touches,
                                         TrialRunSource& trials, const std::function<bool()>& may_go_on);

/// The most accurate model whose trial takes at most `seconds` per simulated second with steps of at most `longest_step`;
/// coarsens from `start` until the rate is met. Empty: none was found.
[[nodiscard]] std::optional<Model> search_rate(const Model& start, const SearchGrid& grid, double seconds, TrialRunSource& trials,
                                               const std::function<bool()>& may_go_on);

}  // namespace seldinger
