#pragma once
// Finds the cheapest model that meets a tolerance for a scene, by trials on the scene itself.
//
//   1. A reference: the scene refined in nodes and steps at once until two refinements bound the remaining error
//      (models/refinement.h).
//   2. A search over models. Each runs over the whole path, is compared with the reference and stops early once it is plainly too
//      wrong (plan_trials.h, plan_search.h). Promised errors are measured, not extrapolated.
//   3. The best are timed again, and each choice of the winner is exchanged for its neighbour, to report simplifications and their
//      price.
//
// Error of a run: root mean square, over sampled times, of the Fréchet distance of the wire's whole axis from the reference's
// (never less than the tip's distance). For the hand force: of 20 ms means, relative to the rms of the reference's.

#include "models/refinement.h"
#include "plan/plan_trials.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

struct PlanOptions {
    PlanGoals goals;
    std::filesystem::path trials;  // folder where trials are kept; a plan that was interrupted goes on from there
    double budget = 120;           // wall time of this call [s]
    int device = -1;
    // With a rate: takes the first model that meets the goals and needs at most this fraction of real time in its slowest part.
    // The reference is then known to 1/3 of the tolerance only. 0: looks for the cheapest model, and reports its simplifications
    double enough = 0;
    std::function<bool()> stop;                        // asked between samples of a trial; may be empty
    std::function<void(const std::string&)> progress;  // what is being done; may be empty
};

/// A model with its trial results.
struct PlannedModel {
    Model model;
    Scene scene;             // to be run
    double error = 0;        // rms [m]
    double worst = 0;        // of all samples [m]
    double force_error = 0;  // rms [N]
    Peaks peak_error{};      // where peaks were asked for
    double seconds = 0;      // of computation per simulated second; of a static scene per solution
    double slowest = 0;      // the same over the slowest of the sampled intervals
    int nodes = 0;           // at most
    Outcome outcome = Outcome::Hold;
    double jitter = 0;  // of the hand force, see FailureReadings
};

/// One choice of the chosen model exchanged for another.
struct Omission {
    std::string what;                   // "converged Newton steps"
    double cost_ratio = 1;              // its cost over the chosen model's
    double error = 0, force_error = 0;  // [m], [N]
    bool holds = true;                  // false: such a model does not run here
    bool too_dear = false;              // it was not run to its end because it took many times as long
};

/// What the chosen model makes of an elastic wall, and what the other choice does at its nodes and steps.
struct WallChoice {
    bool elastic = true;
    double edge = 0;                                         // of the control mesh, of the elastic one of the two [m]
    double move = 0;                                         // farthest that the wall goes in the reference [m]
    bool far = false;                                        // by more than 20 % of the lumen's radius
    bool other_known = false;                                // the other choice came to its end
    double cost_ratio = 1;                                   // of the other over the chosen
    double other_tip = 0, other_error = 0, other_force = 0;  // rms [m], [m], [N]
};

enum class PlanStatus {
    Planned,         // `chosen` meets what was asked
    NotBoth,         // nothing meets tolerance and rate; nearest on each side in `accurate` and `fast`, where there are any
    BelowReference,  // the tolerance is below what the reference is known to; `accurate` holds what can be promised
    NoReference,     // refinements do not converge: the scene has no single answer
    NothingHolds,    // every model breaks off
    Interrupted,
};

struct Plan {
    PlanStatus status = PlanStatus::Interrupted;
    std::string message;  // one line for what was not planned; empty when it was
    Reference reference;
    std::optional<PlannedModel> chosen;    // Planned
    std::optional<PlannedModel> accurate;  // the cheapest that meets the tolerance (or the most accurate), whatever its rate
    std::optional<PlannedModel> fast;      // the most accurate that meets the rate
    std::vector<Omission> left_out;
    std::optional<WallChoice> wall;  // of a scene whose wall is elastic and is touched
    std::vector<std::string> notes;  // one sentence each
    bool touches = false;            // the wire met the wall
    bool search_complete = true;     // false: the budget ended it
    int trials = 0;                  // looked at, those of earlier calls included
    double spent = 0;                // wall time of this call [s]
};

/// @throws Error BadScene: goals that contradict the scene; BadFile
[[nodiscard]] Plan make_plan(const StudyScene& scene, const PlanOptions& options);

}  // namespace seldinger
