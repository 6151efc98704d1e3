#pragma once
// Reference of a run: the analytic solution if there is one, else the scene itself, refined in nodes and steps until two
// refinements bound the remaining error. Planner and charts refine differently (Levels) and judge differently; what they share is
// Refiner.

#include "models/errors.h"
#include "models/run_store.h"

#include <functional>
#include <string>
#include <vector>

namespace seldinger {

enum class Convergence {
    Analytic,    // exact; uncertainty 0
    Falling,     // each refinement moves the result less than the one before
    NotFalling,  // it does not: a bifurcation, chatter or a scene that has no single answer. Not to be charted
    Unknown,     // too few levels could be run
};
[[nodiscard]] std::string_view word_of(Convergence convergence);

struct Reference {
    Trajectory values;
    Model model;                                     // of the finest level
    std::vector<Model> levels;                       // coarse to fine
    std::vector<PerObservable> moved, moved_median;  // [levels - 1] between level k and k + 1, rms and median of the samples
    std::vector<Peaks> peaks_moved;                  // likewise, where they were asked for
    std::array<bool, observable_count> known{};      // observables it speaks of (an analytic one may know the tip alone)
    std::array<Convergence, observable_count> convergence{};
    PerObservable uncertainty{};  // of the finest level [SI]
    Peaks peak_uncertainty{};     // likewise
    double force_scale = 0;       // rms of the hand force, 1 mN at least [N]
    int contacts = 0;             // at most
    double wall_move = 0;         // of the finest level: farthest that the wall goes [m]; 0 of a rigid one
    bool wall_far = false;        // and that is more than 20 % of the lumen's radius
    bool jitters = false;         // the finest level's hand force does
    bool converges = false;       // what was asked for does
    bool out_of_budget = false, stopped = false;
    std::vector<std::string> failures;  // levels that broke off, and how
    std::string note;                   // one line: how it was made, or why it is not there

    [[nodiscard]] bool usable(Observable which) const
    {
        const auto k = static_cast<std::size_t>(which);
        return known[k] && (convergence[k] == Convergence::Falling || convergence[k] == Convergence::Analytic);
    }
};

/// Models of rising cost, and how far to go on with them.
struct Levels {
    std::function<Model(int level)> model;
    int most = 6;
    double cost_growth = 4;                             // from a level to the next
    bool ends_when_broken = false;                      // else a finer level may run where a coarse one breaks off
    std::function<bool(std::size_t broken)>
        over_again;  // after so many broken levels: from level 0, with other models. May be empty
    /// Asked before a level other than the first that is expected to take `next`, after `spent` [s].
    std::function<bool(int level, double spent, double next)> affordable;
    std::function<double()> seconds_left;  // a level that takes longer is broken off [s]; may be empty
    std::function<void(const std::string&)> progress;  // may be empty
};

/// Runs one level after another and keeps how far each moves the result.
class Refiner {
public:
    /// @param store, name  where finished levels are kept
    /// @param plan  samples and stop; every level is run over the whole of it
    /// @param baselines  for a model to refine that is one of them
    Refiner(const StudyScene& scene, Levels levels, RunPlan plan, RunStore& store, std::string name, Window window = {},
            std::vector<Baseline> baselines = {});

    /// Ends when `enough`, which judges the reference so far after each level, or when nothing more can be run. May be called
    /// again.
    Reference& refine_until(const std::function<bool(Reference&)>& enough);
    [[nodiscard]] Reference& reference() { return reference_; }
    /// Runs one model. Nothing when it was stopped, or took longer than there is time.
    [[nodiscard]] std::optional<RunRecord> run(const Model& model, Trajectory& values);

private:
    [[nodiscard]] bool add_level();
    void take_in(const Model& model, const RunRecord& run, Trajectory values);
    [[nodiscard]] bool go_on_after(const Model& broken, const RunRecord& run);

    const StudyScene& scene_;
    Levels levels_;
    RunPlan plan_;
    RunStore& store_;
    std::string name_;
    Window window_;
    std::vector<Baseline> baselines_;
    Reference reference_;
    int level_ = 0;                        // the next one
    double spent_ = 0, last_seconds_ = 0;  // [s]
    bool exhausted_ = false;
};

// ---- of a plan

/// Level k has (n0 - 1) 1.5^k edges and steps of dt0 / 2^k. Edges converge with order 2 and steps with order 1 (backward Euler;
/// without a vessel the trapezoid rule, with order 2). So both errors fall by about two, and cost grows by three.
inline constexpr double edge_refinement = 1.5, step_refinement = 2;
// An elastic wall has its control mesh refined like the wire's edges, from twice the scene's own edge on, as far as memory is
// (wall_edges.h). What the finest mesh is wrong by is then bounded by one more run, with the edge that comes before it: second
// order, so that as much is left as that moves.

/// Requirements on the reference: refinement continues until its uncertainties are below.
struct ReferenceGoals {
    double shape = 0, force = 0;                                // [m], [N]; force infinity: not asked
    bool force_is_relative = false;                             // then of the rms hand force
    PeakGoal peaks;
    std::function<bool(double next_level_seconds)> affordable;  // asked before a level that is expected to take so long
    std::function<double()> seconds_left;                       // a level that takes longer is broken off [s]; may be empty
};

/// @param store, name, plan  see Refiner
[[nodiscard]] Reference refine_scene(const StudyScene& scene, const RunPlan& plan, const ReferenceGoals& goals, RunStore& store,
                                     const std::string& name, const std::function<void(const std::string&)>& progress);

// ---- of a chart

/// Level k has (nodes - 1) 2^k edges and steps of dt / 2^k.
struct Refinement {
    Model coarsest;              // nodes and dt given
    double least_wall_edge = 0;  // of an elastic wall: coarsest.wall_edge / 1.5^k, which halves its error, as far as this [m]
    int least_levels = 3, most_levels = 6;
    double wall_limit = 120;  // of all levels together [s]; no level is begun that would pass it, going by the last

    [[nodiscard]] Model model(int level) const;
    [[nodiscard]] Levels levels() const;
};

/// Refines until every observable's uncertainty, what the last refinement moved (rms), is at most `wanted` of it (NaN or 0: as
/// good as possible), or the results plainly do not converge. Convergence is judged by the rms or the median over samples: a slip
/// or a snap that comes a moment earlier moves one sample, and widens the band by it. A wire that takes another path moves all
/// that follow.
const Reference& refine_to(Refiner& refiner, const Refinement& how, const PerObservable& wanted);

// ---- of both

/// A bound of the remaining error after the last of these movements, by Richardson: the rest of a geometric series whose ratio is
/// that of the last two. The ratio is taken as at least `least_ratio` (half: first order), and as `most_ratio` if there is only
/// one movement or they do not fall.
[[nodiscard]] double error_left(const std::vector<double>& moved);
/// NotFalling: the last is more than `most_ratio` of the one before and, where there are three, more than its square of the one
/// before that. What is below `noise` has arrived.
[[nodiscard]] Convergence judge_movements(const std::vector<double>& moved, double noise);

}  // namespace seldinger
