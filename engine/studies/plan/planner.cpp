// The planner's order of work: reference, trials, search, a last timing of the best, and the plan.
#include "plan/planner.h"

#include "core/clock.h"
#include "models/wall_edges.h"
#include "plan/plan_search.h"

#include "core/error.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr int most_samples = 60;
constexpr double longest_step = 1.0 / 30;                                // [s]
constexpr double reference_share = 0.6;                                  // of the budget
constexpr double wanted_certainty = 1.0 / 6, least_certainty = 1.0 / 2;  // reference's uncertainty over the tolerance
constexpr double hurried_certainty = 1.0 / 3;  // where a model that is good enough is taken at once
constexpr int final_repeats = 3;
constexpr double contender = 1.15;  // costs up to this over the winner's are timed again
constexpr std::size_t most_contenders = 3;
constexpr double plainly_cheaper = 0.95;

class Planner {
public:
    Planner(const StudyScene& scene, const PlanOptions& options)
        : scene_(scene),
          options_(options),
          goals_(options.goals),
          cost_(options.device),
          store_(make_own_folder(options.trials).path())
    {
        is_static_ = scene.scene.integrator.scheme == Scheme::Static;
        wall_ = wall_edges(scene.setup);
        check_goals();
        const double duration = scene.scene.duration;
        const double samples =
            is_static_ ? 1 : std::clamp(std::floor(duration / longest_step + 1e-9), 1.0, static_cast<double>(most_samples));
        plan_.until = duration;
        plan_.interval = is_static_ ? 1 : duration / samples;
        plan_.stop = options.stop;
        plan_.peaks = goals_.peaks.asked();
        goals_.peaks.diameter = 2 * scene.scene.wire.shaft.radius;
    }

    Plan make()
    {
        plan_reference();
        if (result_.status == PlanStatus::Planned) plan_model();
        result_.spent = elapsed();
        return std::move(result_);
    }

private:
    [[nodiscard]] double elapsed() const { return seconds_since(start_); }
    [[nodiscard]] bool may_go_on() const { return elapsed() < options_.budget; }
    void tell(const std::string& what) const
    {
        if (options_.progress) options_.progress(what);
    }

    void check_goals() const
    {
        const auto fail = [&](const std::string& what) { throw Error(ErrorKind::BadScene, what); };
        if (is_static_ && goals_.rate > 0)
            fail(fmt::format("{}: scheme = \"static\" has no steps, so no --rate; take one of the two out",
                             scene_.scene.source.string()));
        if (!is_static_ && scene_.scene.duration <= 0)
            fail(fmt::format("{}: scene.duration_s: nothing to plan for", scene_.scene.source.string()));
    }

    void stop_with(PlanStatus status, std::string message)
    {
        result_.status = status;
        result_.message = std::move(message);
    }

    [[nodiscard]] std::string as_length(double metres) const { return fmt::format("{:.3g} mm", 1e3 * metres); }

    // ---- reference
    // --------------------------------------------------------------------------------------------------------------

    void plan_reference()
    {
        result_.status = PlanStatus::Planned;
        ReferenceGoals wanted;
        const double certainty = options_.enough > 0 ? hurried_certainty : wanted_certainty;
        wanted.shape = certainty * goals_.tolerance;
        wanted.force =
            goals_.force_tolerance > 0 ? certainty * goals_.force_tolerance : std::numeric_limits<double>::infinity();
        wanted.force_is_relative = goals_.force_is_relative;
        wanted.peaks = goals_.peaks;
        wanted.peaks.tolerance *= certainty;
        wanted.affordable = [this](double seconds) { return elapsed() + seconds <= reference_share * options_.budget; };
        wanted.seconds_left = [this] { return std::max(1.0, options_.budget - elapsed()); };
        result_.reference = refine_scene(scene_, plan_, wanted, store_, "reference", options_.progress);
        const Reference& reference = result_.reference;
        result_.touches = reference.contacts > 0;
        if (reference.stopped) return stop_with(PlanStatus::Interrupted, "interrupted");
        if (reference.levels.empty() && reference.failures.empty())
            return stop_with(
                PlanStatus::BelowReference,
                fmt::format("not even the coarsest run of this scene ended within --budget {:g}; give more", options_.budget));
        if (reference.levels.empty())
            return stop_with(PlanStatus::NothingHolds,
                             fmt::format("no model completes this scene: {}; make the scene less severe (contact.stiffness, "
                                         "feed speed, wire), {}or look at it with `seldinger run`",
                                         failures(reference), reference.out_of_budget ? "give a larger --budget, " : ""));
        const double shape = at(reference.uncertainty, Observable::Shape),
                     force = at(reference.uncertainty, Observable::HandForce);
        if (!reference.converges && !reference.out_of_budget)
            return stop_with(
                PlanStatus::NoReference,
                fmt::format(
                    "refinement does not converge: it still moves the wire by {} at {} nodes and {:.3g} ms; the last two levels "
                    "do not come closer than those before, which a bifurcation, chatter or a difference near what steps and "
                    "nodes resolve does; shorten scene.duration_s to before a bifurcation, or ask for a larger tolerance",
                    as_length(reference.moved.empty() ? 0 : at(reference.moved.back(), Observable::Shape)),
                    reference.model.nodes.value_or(0), 1e3 * reference.model.dt.value_or(0)));
        const double force_goal = goals_.force_tolerance * (goals_.force_is_relative ? reference.force_scale : 1.0);
        const bool force_known = goals_.force_tolerance == 0 || force <= least_certainty * force_goal;
        const bool peaks_known = goals_.peaks.holds({}, reference.peak_uncertainty, reference.values.peaks, least_certainty);
        if (shape <= least_certainty * goals_.tolerance && force_known && peaks_known && reference.converges) return;
        if (reference.levels.size() < 2) {
            stop_with(
                PlanStatus::BelowReference,
                fmt::format("only one run of the reference ended within its share of --budget {:g}: its error is "
                            "unknown; give more",
                            options_.budget));
            return;
        }
        std::string message =
            fmt::format("the reference is known to {} after {} refinements", as_length(shape), reference.levels.size() - 1);
        if (goals_.force_tolerance > 0)
            message += fmt::format(", its hand force to {:.2g} mN ({:.2g} %)", 1e3 * force, 100 * force / reference.force_scale);
        if (goals_.peaks.asked()) message += ", " + peaks_known_to(reference);
        // the plan is compared with the reference: half of the tolerance is the reference's own
        const bool shape_known = shape <= least_certainty * goals_.tolerance;
        std::string missing = shape_known ? "" : "shape to " + as_length(least_certainty * goals_.tolerance);
        const auto miss = [&](const std::string& what) { missing += (missing.empty() ? "" : ", ") + what; };
        if (!force_known) miss(fmt::format("hand force to {:.2g} mN", 1e3 * least_certainty * force_goal));
        if (!peaks_known) miss("peaks to half of their tolerance");
        if (!reference.converges) miss("refinements that come closer to one another");
        std::string looser = shape_known ? "" : as_length(2 * shape) + " or more";
        if (!force_known || !peaks_known)
            looser += looser.empty() ? "a larger error of the forces" : " and a larger error of the forces";
        message += fmt::format("; needed, half of what was asked: {}; ", missing);
        if (reference.out_of_budget)
            message += fmt::format("give more than --budget {:g}{}", options_.budget, looser.empty() ? "" : ", or ");
        if (!looser.empty()) message += "ask for " + looser;
        stop_with(PlanStatus::BelowReference, std::move(message));
        result_.accurate = described(reference.model, reference.values);
    }

    [[nodiscard]] static std::string peaks_known_to(const Reference& reference)
    {
        std::string text = "its peaks to";
        for (std::size_t k = 0; k < peak_words.size(); ++k) {
            const double right = reference.values.peaks[k];
            text += fmt::format("{} {:.2g} % ({})", k > 0 ? "," : "",
                                right > 0 ? 100 * reference.peak_uncertainty[k] / right : 0.0, peak_words[k].says);
        }
        return text;
    }

    /// The first and the last that broke off.
    [[nodiscard]] static std::string failures(const Reference& reference)
    {
        if (reference.failures.empty()) return "nothing was tried";
        if (reference.failures.size() == 1) return reference.failures.front();
        return fmt::format("{}; … {} refinements … {}", reference.failures.front(), reference.failures.size() - 1,
                           reference.failures.back());
    }

    /// Promises for the reference itself.
    PlannedModel described(const Model& model, const Trajectory&)
    {
        PlannedModel planned;
        planned.model = model;
        planned.scene = apply(model, scene_.scene);
        planned.nodes = model.nodes.value_or(0);
        planned.error = at(result_.reference.uncertainty, Observable::Shape);
        planned.force_error = at(result_.reference.uncertainty, Observable::HandForce);
        planned.peak_error = result_.reference.peak_uncertainty;
        return planned;
    }

    // ---- model
    // ------------------------------------------------------------------------------------------------------------------

    void plan_model()
    {
        if (!result_.touches && scene_.scene.vessel.shape != VesselShape::None)
            result_.notes.push_back(
                "the wire never touches the wall: this scene cannot show which contact model is needed, so contact stays as it "
                "is");
        note_what_is_not_tried();
        const double longest = is_static_ ? 0 : goals_.rate > 0 ? std::min(longest_step, 1 / goals_.rate) : longest_step;
        TrialRuns trials(scene_, plan_, result_.reference, goals_, cost_, store_, [this] { return options_.budget - elapsed(); });
        if (goals_.rate > 0 && !rate_is_thinkable(trials)) return out_of_reach(trials);
        const SearchGrid grid = grid_up_to(longest);
        if (options_.enough > 0 && take_at_once(trials, grid, longest)) return;
        if (trials.stopped()) return stop_with(PlanStatus::Interrupted, "interrupted");
        const auto go_on = [&, looked = std::size_t{0}]() mutable {
            tell(fmt::format("trial run {}", ++looked));
            return may_go_on();
        };
        const SearchResult found = search_models(scene_.scene, starting_model(), grid, result_.touches, trials, go_on);
        result_.trials = static_cast<int>(trials.all().size());
        if (trials.stopped()) return stop_with(PlanStatus::Interrupted, "interrupted");
        result_.search_complete = found.complete;
        if (!found.complete)
            result_.notes.push_back(
                fmt::format("the budget of {:g} s ended the search: there may be cheaper models", options_.budget));
        if (!found.best) return nothing_meets(trials, grid);
        const std::optional<PlannedModel> best = timed_best(*found.best, trials);
        if (!best) return stop_with(PlanStatus::Interrupted, "interrupted");
        if (goals_.rate > 0 && best->slowest > 1) return too_slow(*best, trials, grid);
        result_.chosen = best;
        look_at_wall(trials);
        look_at_omissions(trials);
        result_.trials = static_cast<int>(trials.all().size());
        if (trials.stopped()) stop_with(PlanStatus::Interrupted, "interrupted");
    }

    /// The search as far as the first model that is quick enough. @return whether there is one
    bool take_at_once(TrialRuns& trials, const SearchGrid& grid, double longest)
    {
        const auto is_enough = [&](const TrialRun& trial) {  // a trial with longer steps was there to see what a step costs
            return trial.meets && trial.model.dt.value_or(0) <= longest * (1 + 1e-9) && trial.slowest <= options_.enough;
        };
        const auto first = [&] {
            return std::find_if(trials.all().begin(), trials.all().end(),
                                [&](const auto& entry) { return is_enough(entry.second); });
        };
        const auto go_on = [&, looked = std::size_t{0}]() mutable {
            if (first() != trials.all().end() || !may_go_on()) return false;
            tell(fmt::format("trial run {}", ++looked));
            return true;
        };
        (void)search_models(scene_.scene, starting_model(), grid, result_.touches, trials, go_on);
        const auto found = first();
        result_.trials = static_cast<int>(trials.all().size());
        if (trials.stopped() || found == trials.all().end()) return false;
        result_.chosen = planned(found->second, found->second.slowest);
        result_.notes.push_back(fmt::format(
            "the first model that takes no more than {:.2g} of real time: there may be cheaper ones", options_.enough));
        return true;
    }

    [[nodiscard]] SearchGrid grid_up_to(double longest) const
    {
        SearchGrid grid = search_grid(result_.reference, plan_.interval, longest);
        grid.walls = wall_.trials();
        grid.finest_wall = result_.reference.model.wall_edge.value_or(0);
        return grid;
    }

    /// What could be run here and may not be chosen.
    void note_what_is_not_tried()
    {
        if (result_.reference.wall_far)
            result_.notes.push_back(fmt::format(
                "the wall moves by {}, more than 20 % of the lumen's radius, where contact with it is inexact, in every model",
                as_length(result_.reference.wall_move)));
        for (const PlanChoice& choice : choices_in(scene_.scene)) {
            if (choice.needs_contact && !result_.touches) continue;
            Model model = starting_model();
            choice.make(model);
            const std::string reason = not_vouched_for(model, scene_.scene, result_.touches);
            if (!reason.empty()) result_.notes.push_back(fmt::format("{} is not chosen: {}", choice.simpler, reason));
        }
    }

    /// The coarsest level of the reference that is not plainly hopeless: trials go on from there.
    Model starting_model() const
    {
        const Reference& reference = result_.reference;
        double left = 0;
        std::size_t level = reference.levels.size() - 1;
        while (level > 0) {
            left += at(reference.moved[level - 1], Observable::Shape);
            if (left > goals_.tolerance) break;
            --level;
        }
        Model model = reference.levels[level];
        return as_trial(model);
    }

    /// A trial keeps the reference's settings from the scene, except for the order in time without contact.
    Model as_trial(Model model) const
    {
        model.tolerance.reset();
        if (model.wall_edge.value_or(0) >= wall_.own) model.wall_edge.reset();  // no coarser than `run` has it
        if (model.trapezoid == scene_.scene.integrator.newmark) model.trapezoid.reset();
        return model;
    }

    /// A step cannot be cheaper than the cheapest that was seen: some rates need not be tried.
    bool rate_is_thinkable(TrialRuns& trials)
    {
        const Model coarse = as_trial(result_.reference.levels.front());
        const TrialRun* trial = trials.look_at(coarse);
        if (!trial) {
            stop_with(PlanStatus::Interrupted, "interrupted");
            return false;
        }
        const double step_seconds = trial->seconds * coarse.dt.value_or(1);
        // fewer nodes, one Newton step, at the very best; a rigid wall takes a twentieth of an elastic one
        const double cheaper_yet = wall_.elastic() ? 100 : 10;
        if (step_seconds * goals_.rate < cheaper_yet) return true;
        stop_with(PlanStatus::NotBoth, fmt::format("no model reaches {:g} steps a second here: a step of {} takes {:.3g} us, so "
                                                   "that {:.2g} a second is about the most",
                                                   goals_.rate, label(coarse), 1e6 * step_seconds, cheaper_yet / step_seconds));
        return false;
    }

    /// The nearest to a rate that no model reaches: what the tolerance costs, and the quickest steps that were seen.
    void out_of_reach(TrialRuns& trials)
    {
        if (trials.stopped()) return;
        const SearchGrid grid = grid_up_to(longest_step);
        const auto go_on = [&] { return may_go_on(); };
        const SearchResult found = search_models(scene_.scene, starting_model(), grid, result_.touches, trials, go_on);
        result_.search_complete = found.complete;
        const std::optional<PlannedModel> best = found.best && !trials.stopped() ? timed_best(*found.best, trials) : std::nullopt;
        result_.trials = static_cast<int>(trials.all().size());
        if (trials.stopped()) return stop_with(PlanStatus::Interrupted, "interrupted");
        if (best) result_.accurate = best;
        const TrialRun* quickest = nullptr;
        const auto step_seconds = [](const TrialRun& trial) { return trial.seconds * trial.model.dt.value_or(1); };
        for (const auto& [key, trial] : trials.all())
            if (trial.sound && (!quickest || step_seconds(trial) < step_seconds(*quickest))) quickest = &trial;
        if (!quickest) return;
        const Model model = quickest->model;
        const double slowest = trials.time_again(model, final_repeats);
        if (trials.stopped()) return stop_with(PlanStatus::Interrupted, "interrupted");
        result_.fast = planned(trials.all().at(label(model)), slowest);
        result_.message +=
            fmt::format("; the fastest model found reaches {:.3g}", 1 / (result_.fast->slowest * model.dt.value_or(1)));
    }

    /// The winner and the few that come nearest are timed again, so that no single measurement decides. Another one wins only
    /// where it is plainly cheaper.
    std::optional<PlannedModel> timed_best(const Model& winner, TrialRuns& trials)
    {
        const std::string own = label(winner);
        std::vector<std::pair<double, Model>> contenders;
        for (const auto& [key, trial] : trials.all())
            if (trial.meets && key != own && trial.seconds <= contender * trials.all().at(own).seconds)
                contenders.emplace_back(trial.seconds, trial.model);
        std::stable_sort(contenders.begin(), contenders.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        if (contenders.size() > most_contenders) contenders.resize(most_contenders);
        contenders.insert(contenders.begin(), {0, winner});
        std::optional<PlannedModel> best;
        for (const auto& [seconds, model] : contenders) {
            if (best && !may_go_on()) break;
            tell("timing " + label(model));
            const double slowest = trials.time_again(model, final_repeats);
            if (trials.stopped()) return std::nullopt;
            const TrialRun& trial = trials.all().at(label(model));
            if (!best || trial.seconds < plainly_cheaper * best->seconds) best = planned(trial, slowest);
        }
        return best;
    }

    PlannedModel planned(const TrialRun& trial, double slowest) const
    {
        PlannedModel model;
        model.model = trial.model;
        model.scene = apply(trial.model, scene_.scene);
        model.error = trial.error;
        model.worst = trial.worst;
        model.force_error = trial.force_error;
        model.peak_error = trial.peak_error;
        model.seconds = trial.seconds;
        model.slowest = is_static_ ? trial.seconds : slowest;
        model.nodes = trial.nodes;
        model.outcome = trial.outcome;
        model.jitter = trial.jitter;
        return model;
    }

    void too_slow(const PlannedModel& best, TrialRuns& trials, const SearchGrid& grid)
    {
        result_.accurate = best;
        add_fast(best.model, trials, grid);
        std::string message =
            fmt::format("nothing meets both: the cheapest that meets {} reaches {:.3g} of real time in its slowest stretch",
                        as_length(goals_.tolerance), 1 / best.slowest);
        if (result_.fast)
            message += fmt::format("; the most accurate model at this rate is within {}", as_length(result_.fast->error));
        stop_with(PlanStatus::NotBoth, std::move(message));
    }

    void nothing_meets(TrialRuns& trials, const SearchGrid& grid)
    {
        const Model& finest = result_.reference.model;
        // with a rate, steps are limited from above only: the remaining accuracy is found at the reference
        result_.accurate = described(finest, result_.reference.values);
        if (goals_.rate > 0) add_fast(starting_model(), trials, grid);
        stop_with(goals_.rate > 0 ? PlanStatus::NotBoth : PlanStatus::BelowReference,
                  fmt::format("no trial run was within {} by more than the reference's own uncertainty, {}; ask for {} or more{}",
                              as_length(goals_.tolerance), as_length(at(result_.reference.uncertainty, Observable::Shape)),
                              as_length(2 * at(result_.reference.uncertainty, Observable::Shape) + goals_.tolerance),
                              result_.search_complete ? "" : ", or give a larger --budget"));
    }

    void add_fast(const Model& from, TrialRuns& trials, const SearchGrid& grid)
    {
        const auto go_on = [&] { return true; };
        const std::optional<Model> fast = search_rate(from, grid, 1, trials, go_on);
        if (!fast) return;
        const double slowest = trials.time_again(*fast, final_repeats);
        if (!trials.stopped()) result_.fast = planned(trials.all().at(label(*fast)), slowest);
    }

    // ---- simplifications -----------------------------------------------------------------------------------------------------

    /// The wall that was not chosen, elastic or rigid, at the nodes and steps of the chosen model: run to its end, budget or not,
    /// since the reason for the choice comes of it.
    void look_at_wall(TrialRuns& trials)
    {
        if (!wall_.elastic() || !result_.touches) return;
        const PlannedModel& chosen = *result_.chosen;
        WallChoice wall{
            .elastic = chosen.scene.vessel.elastic, .move = result_.reference.wall_move, .far = result_.reference.wall_far};
        wall.edge = wall.elastic ? chosen.model.wall_edge.value_or(wall_.own) : wall_.own;
        Model other = chosen.model;
        other.elastic_wall = !wall.elastic;
        other.wall_edge.reset();
        if (why_not(other, scene_.scene).empty()) {
            tell("the other wall");
            const TrialRun* trial = trials.measure(other);
            if (trial && trial->complete) {
                wall.other_known = true;
                wall.cost_ratio = trial->seconds / chosen.seconds;
                wall.other_tip = trial->tip_error, wall.other_error = trial->error, wall.other_force = trial->force_error;
            }
            if (trial && wall.elastic) result_.left_out.push_back(omission("a rigid wall instead", *trial));
        }
        result_.wall = wall;
    }

    [[nodiscard]] Omission omission(const std::string& what, const TrialRun& trial) const
    {
        return {what, trial.seconds / result_.chosen->seconds, trial.error, trial.force_error, trial.complete, trial.too_dear};
    }

    void look_at_omissions(TrialRuns& trials)
    {
        const PlannedModel chosen = *result_.chosen;
        const auto add = [&](const std::string& what, const Model& model) {
            if (label(model) == label(chosen.model) || !may_go_on() || !why_not(model, scene_.scene).empty()) return;
            tell("left out: " + what);
            const TrialRun* trial = trials.look_at(model);
            if (trial) result_.left_out.push_back(omission(what, *trial));
        };
        for (const PlanChoice& choice : choices_in(scene_.scene, wall_.trials())) {
            if (choice.needs_contact && !result_.touches) continue;
            Model made = chosen.model;
            choice.make(made);
            if (label(made) != label(chosen.model)) continue;  // it was not made
            Model fuller = chosen.model;
            choice.undo(fuller);
            add(choice.fuller, fuller);
        }
        Model finer = chosen.model;
        if (finer.nodes.value_or(0) > 0) {
            finer.nodes = 2 * (*finer.nodes - 1) + 1;
            add(fmt::format("twice the nodes ({})", *finer.nodes), finer);
        }
        if (finer = chosen.model; finer.dt) {
            finer.dt = *finer.dt / 2;
            add(fmt::format("half the step ({:.3g} ms)", 1e3 * *finer.dt), finer);
        }
    }

    const StudyScene& scene_;
    const PlanOptions& options_;
    PlanGoals goals_;
    CostRule cost_;
    RunStore store_;
    RunPlan plan_;
    Plan result_;
    WallEdges wall_;
    bool is_static_ = false;
    Clock::time_point start_ = Clock::now();
};

}  // namespace

Plan make_plan(const StudyScene& scene, const PlanOptions& options) { return Planner(scene, options).make(); }

}  // namespace seldinger
