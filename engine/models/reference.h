#pragma once
// Reference of a run: the analytic solution if there is one, else the scene itself refined until it does not change.

#include "models/errors.h"
#include "models/run_model.h"

#include <filesystem>
#include <optional>
#include <string>

namespace seldinger {

/// How a scene is refined: level k has (nodes - 1) 2^k edges and steps of dt / 2^k, converged to `tolerance`.
struct Refinement {
    Model coarsest;              // nodes and dt given
    double least_wall_edge = 0;  // of an elastic wall: coarsest.wall_edge / 1.5^k, which halves its error, as far as this [m]
    int least_levels = 3, most_levels = 6;
    double wall_limit = 120;  // of all levels together [s]; no level is begun that would pass it, going by the last
};

/// Model of level k.
[[nodiscard]] Model refined(const Refinement& how, int level);

enum class Convergence {
    Analytic,  // exact; uncertainty 0
    Falling,   // each refinement moves the result less than the one before: uncertainty is what the last one moved (rms). Judged
               // by the rms or the median over samples: a slip or a snap that comes a moment earlier moves one sample, and widens
               // the band by it. A wire that takes another path moves all that follow
    NotFalling,  // it does not: a bifurcation, chatter or a scene that has no single answer. Not to be charted
    Unknown,     // too few levels could be run
};
[[nodiscard]] std::string_view word_of(Convergence convergence);

struct Reference {
    Trajectory values;
    std::array<bool, observable_count> known{};  // observables it speaks of (an analytic one may know the tip alone)
    std::array<Convergence, observable_count> convergence{};
    PerObservable uncertainty{};                     // rms over the window, what the last refinement moved [SI]
    std::vector<PerObservable> moved, moved_median;  // [levels - 1] between level k and k + 1, over the samples
    int levels = 0;
    std::string note;  // one line: how it was made, or why it is not there

    [[nodiscard]] bool usable(Observable which) const
    {
        const auto k = static_cast<std::size_t>(which);
        return known[k] && (convergence[k] == Convergence::Falling || convergence[k] == Convergence::Analytic);
    }
};

/// Refines a scene step by step. Finished levels are kept in `folder` (when given) and taken from there another time.
class Refiner {
public:
    /// @param folder  empty: nothing is kept
    /// @param baselines  for a model to refine that is one of them
    Refiner(const StudyScene& scene, Refinement how, RunPlan plan, Window window, std::filesystem::path folder = {},
            std::vector<Baseline> baselines = {});

    /// Runs levels until every observable's uncertainty is at most `wanted` of it (NaN or 0: as good as possible). It ends earlier
    /// if the last level is reached, the budget is spent, or the results plainly do not converge. May be called again with less.
    /// @return the reference so far
    const Reference& refine_to(const PerObservable& wanted);
    [[nodiscard]] const Reference& reference() const { return reference_; }
    [[nodiscard]] bool stopped() const { return stopped_; }  // by plan.stop

private:
    [[nodiscard]] bool add_level();
    void judge();
    [[nodiscard]] bool nothing_to_gain(const PerObservable& wanted) const;

    const StudyScene& scene_;
    Refinement how_;
    RunPlan plan_;
    Window window_;
    std::filesystem::path folder_;
    std::vector<Baseline> baselines_;
    std::vector<Trajectory> levels_;
    Reference reference_;
    double spent_ = 0, last_wall_ = 0;  // [s]
    bool stopped_ = false, exhausted_ = false;
    std::string failure_;  // why a level could not be run
};

/// Continuation of a sequence of movements. NotFalling: the last refinement moved the result by more than 0.8 of the one before,
/// or, with three at hand, than 0.5 of the one before that. A sequence below `noise` has arrived.
[[nodiscard]] Convergence judge_movements(const std::vector<double>& moved, double noise);

}  // namespace seldinger
