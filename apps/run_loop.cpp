// The loop of `seldinger run`: settle, step, record, save; it ends at rest, at a signal, at a limit or at a failed step.
#include "run_loop.h"

#include "bands/step_twin.h"
#include "core/clock.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "progress.h"
#include "replay.h"
#include "run/ready.h"
#include "run/scene_run.h"
#include "run/wall_path.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <optional>

namespace seldinger::apps {
namespace {

constexpr double estimate_patience = 2;   // of one who ends the run, with steps for the estimate [s]
constexpr double checkpoint_seconds = 5;  // a power cut costs this much at most

/// What to change where energy came from nowhere.
std::string energy_advice(const IntegratorSpec& integrator)
{
    if (integrator.scheme == Scheme::Linearised)
        return "one Newton iteration per step does not converge here; set integrator.scheme = \"newton\"";
    if (integrator.scheme == Scheme::Explicit)
        return "an explicit step must be shorter than the fastest wave's period; make scene.dt_s smaller, or set "
               "integrator.scheme = \"newton\"";
    if (integrator.newmark)
        return "Newmark's steps gain energy in contact and in fast stretching; leave integrator.beta and integrator.gamma "
               "out "
               "(backward Euler)";
    if (integrator.conserve) return "set integrator.conserve = false (backward Euler), or make scene.dt_s smaller";
    return "make scene.dt_s smaller or contact.stiffness lower";
}

/// Which setting helps, by what went wrong.
std::string advice(const StepReport& report, bool settling, const IntegratorSpec& integrator, double energy_made)
{
    if (report.flags & StepEnergy)
        return fmt::format("unstable: the simulation gained {:.3g} J of energy, even with 8 x smaller steps: {}", energy_made,
                           energy_advice(integrator));
    if (report.flags & StepNonFinite)
        return "a value is not finite; check the wire's stiffness and density, make scene.dt_s smaller";
    if (report.flags & StepWallBuckles)
        return "the elastic wall has no stable state: its pressure buckles it, or nothing holds it in place; bring "
               "vessel.pressure_pa "
               "nearer to 0, make vessel.support_pa_m larger, or hold its rims (vessel.rims)";
    if (settling)
        return "no equilibrium was found; raise integrator.tolerance, or run it in time with integrator.damping_mass_1_s";
    return "the step did not converge, even divided; make scene.dt_s smaller or contact.stiffness lower";
}

/// Where a wall was beyond its theory no setting of the step is to blame.
constexpr const char* wall_advice =
    "the wall moved by more than 20 % of the lumen's radius, where contact with it is inexact: give it its true "
    "vessel.youngs_pa and vessel.thickness_m, a wire that bends more easily, or wall = \"rigid\"";

class Run : RunHooks {
public:
    Run(const Scene& scene, const RunOptions& options, WorldSetup setup, RepairReport vessel,
        const std::optional<Checkpoint>& saved, Replay* replay)
        : scene_(scene),
          replay_(replay),
          options_(options),
          vessel_(std::move(vessel)),
          world_(std::move(setup)),
          recorder_(saved ? Recorder(scene, vessel_, world_, options.dir, *saved)
                          : Recorder(scene, vessel_, world_, options.dir)),
          loop_(world_, std::span(&scene, 1), this),
          progress_(scene, options.quiet),
          earlier_wall_(recorder_.tally().wall),
          fresh_(!saved || saved->tally.steps == 0)
    {
        const RunTally& tally = recorder_.tally();
        if (!fresh_) loop_.resume(0, static_cast<long>(tally.steps), static_cast<long>(tally.rest_steps), false);
    }

    RunOutcome go(Clock::time_point called)
    {
        called_ = called;
        loop_start_ = last_checkpoint_ = Clock::now();
        if (fresh_) settle_first();
        if (scene_.integrator.scheme != Scheme::Static && loop_.running() > 0) begin_steps();
        else if (loop_.status() == RunStatus::Done && options_.estimate) estimate_equilibrium();
        const RunStatus status = loop_.run();
        if (replay_ && replay_->begun() && status == RunStatus::Done) replay_->end(world_);
        return stop(status);
    }

private:
    // ---- hooks

    const Control* control() override
    {
        step_start_ = Clock::now();
        return replay_ ? &replay_->next(world_) : nullptr;
    }

    RunStatus asked() override
    {
        if (!first_) {
            if (seconds_since(last_checkpoint_) >= checkpoint_seconds) {
                recorder_.checkpoint(world_, RunStatus::Running, wall());
                last_checkpoint_ = Clock::now();
            }
            progress_.show(recorder_, wall());
        }
        if (stop_asked_for() != 0) return stop_asked_for() == SIGINT ? RunStatus::Interrupted : RunStatus::TimeLimit;
        return !first_ && is_late() ? RunStatus::TimeLimit : RunStatus::Running;
    }

    void passed(double time) override
    {
        read_settled(time);
        recorder_.passed(output_);
    }

    void settled(int, const WireReport&) override
    {
        read_settled(prescribed_until(scene_));
        recorder_.settled(output_, loop_.report());
    }

    bool starts_as_placed() const override { return true; }

    void placed() override
    {
        recorder_.warn(fmt::format(
            "scene.start: got \"settled\", but {}. The run starts from the wire as it was placed. Fix: let the wire move "
            "for a while before what is measured, or place it nearer to rest",
            "no equilibrium was found"));
        world_.read(output_);
        recorder_.placed(output_);
    }

    bool stepped(int, const WireReport&, double dt) override
    {
        const StepReport& report = loop_.report();
        first_ = false;
        wall_was_far_ = report.flags & StepWallFar;
        const double seconds = seconds_since(step_start_);
        if (replay_) replay_->stepped(world_);
        world_.read(output_, recorder_.wants(world_));
        recorder_.gauge(world_, output_);
        recorder_.stepped(output_, report, seconds, loop_.rest_steps(0));
        follow_task(dt);
        const RunTally& tally = recorder_.tally();
        if (twin_) twin_->stepped(world_, recorder_.readings(), static_cast<long>(tally.steps),
                                  {tally.on_wall.patch_force, tally.wall_move.value, tally.wall_stress.value});
        return tally.score.reached;
    }

    void ended(int, RunStatus status) override
    {
        if (status != RunStatus::Stopped) return;
        const StepReport& report = loop_.report();
        if (settling_) {
            failure_ = fmt::format("settling: {}", advice(report, true, scene_.integrator, 0));
            return;
        }
        const std::string what = advice(report, false, scene_.integrator, world_.readings(0).energy_made);
        failure_ = fmt::format("step {} ({:.6g} s): {}{}{}", recorder_.tally().steps + 1, world_.time(), what,
                               wall_was_far_ ? "; " : "", wall_was_far_ ? wall_advice : "");
    }

    // ----

    /// A recorded hand cannot be halved.
    bool estimates() const { return options_.estimate && !replay_; }
    StepTwin::Finer finer_twins(RunStatus status) const
    {
        if (status != RunStatus::Done) return StepTwin::Finer::Never;  // who interrupts is not kept waiting
        if (options_.asked_estimate) return StepTwin::Finer::Always;
        return scene_.vessel.elastic ? StepTwin::Finer::Never
                                     : StepTwin::Finer::WhereCheap;  // each length of step has columns of its own
    }
    double wall() const { return earlier_wall_ + seconds_since(loop_start_); }
    bool is_late() const { return options_.time_limit > 0 && seconds_since(called_) >= options_.time_limit; }

    void settle_first()
    {
        const NoPolling settling;
        settling_ = true;
        loop_.begin();
        settling_ = false;
    }

    void read_settled(double time)
    {
        world_.read(output_);
        recorder_.gauge(world_, output_);
        if (scene_.integrator.scheme == Scheme::Static) output_.time = time;  // of the keys: that of the world stands still
    }

    void estimate_equilibrium()
    {
        const RunTally& tally = recorder_.tally();
        recorder_.estimated(equilibrium_estimate(scene_, world_, recorder_.readings(), tally.hand_force_max, tally.friction_max,
                                                 tally.on_wall.patch_force));
    }

    void begin_steps()
    {
        if (replay_) replay_->begin(scene_, world_);
        else if (scene_.task.on) begin_task();
        if (const double spend = options_.asked_estimate ? StepTwin::unlimited : bands::most_spent; estimates())
            twin_.emplace(scene_, world_, static_cast<long>(recorder_.tally().steps), spend);
        const std::function<bool()> asked = [this] {
            if (ending_) return seconds_since(*ending_) > estimate_patience;
            progress_.show(recorder_, wall());
            return stop_asked_for() != 0 || (!first_ && is_late());
        };
        world_.stop_when(asked);
        if (twin_) twin_->stop_when(asked);
    }

    void begin_task()
    {
        score_.emplace(scene_, world_, ScoreWatch::Patch::WhereItCounts);
        if (!fresh_) return;
        ScoreNumbers score;
        score_->begin(world_, 0, score);
        recorder_.scored(score);
    }

    void follow_task(double dt)
    {
        ScoreNumbers score = recorder_.tally().score;
        if (replay_) score = replay_->score();
        else if (score_) score_->stepped(world_, 0, dt, false, false, score);
        recorder_.scored(score);
    }

    RunOutcome stop(RunStatus status)
    {
        RunOutcome outcome;
        if (status == RunStatus::Interrupted || status == RunStatus::TimeLimit) ending_ = Clock::now();
        if (twin_) recorder_.estimated(twin_->finish(finer_twins(status)));
        outcome.summary = recorder_.finish(world_, status, wall());
        if (replay_ && replay_->begun()) replay_->write_score(scene_, options_.dir);
        const std::string dir = options_.dir.string();
        const std::string saved = fmt::format("at step {} of {}, state saved in {}; run again with --resume -o {}",
                                              recorder_.tally().steps, scene_.steps(), dir, dir);
        switch (status) {
            case RunStatus::Stopped:
                outcome = {ErrorKind::Stopped, outcome.summary, fmt::format("{}; last good state in {}", failure_, dir)};
                break;
            case RunStatus::TimeLimit:
                outcome = {ErrorKind::TimeLimit, outcome.summary, "stopped by a limit or SIGTERM " + saved};
                break;
            case RunStatus::Interrupted:
                outcome = {ErrorKind::Interrupted, outcome.summary, "interrupted " + saved};
                break;
            default:
                break;
        }
        return outcome;
    }

    const Scene& scene_;
    Replay* replay_;  // may be null
    const RunOptions& options_;
    RepairReport vessel_;
    World world_;
    Recorder recorder_;
    SceneRun loop_;
    Progress progress_;
    std::optional<StepTwin> twin_;
    std::optional<ScoreWatch> score_;  // of [task], where no session is replayed
    Output output_;  // of the last step, as far as the recorder wants it
    double earlier_wall_;
    bool fresh_;
    bool first_ = true;      // no step has been taken by this call
    bool settling_ = false;
    Clock::time_point called_, loop_start_, last_checkpoint_, step_start_;
    std::optional<Clock::time_point> ending_;  // a signal or a limit has ended the run
    std::string failure_;
    bool wall_was_far_ = false;  // in the last step
};

}  // namespace

RunOutcome run_scene(const Scene& given, const RunOptions& options)
{
    const auto called = Clock::now();
    std::optional<Replay> replay;
    if (!options.replay.empty()) replay.emplace(options.replay);
    const Scene scene = replay ? replay->scene(given) : given;
    const StopSignal listening;
    std::optional<NoPolling> loading(std::in_place);
    const FileLock lock = FileLock::of_folder(options.dir);
    check_run_folder(options.dir, options.use, scene);
    std::optional<Checkpoint> saved;
    const auto file = options.dir / "checkpoint.bin";
    if (options.use == FolderUse::Resume && std::filesystem::exists(file)) saved = read_checkpoint(file);
    if (saved) check_checkpoint(file, *saved, scene, write_scene(scene, options.dir));
    if (saved && saved->status == RunStatus::Done) return {ErrorKind::None, read_file(options.dir / "summary.json"), {}};
    RepairReport vessel;
    WorldSetup setup = ready_setup(scene, options.device, &vessel);
    if (replay) replay->check(scene, setup);
    else find_wall_path(std::span(&scene, 1), setup, [] { return stop_asked_for() != 0; });
    Run run(scene, options, std::move(setup), std::move(vessel), saved, replay ? &*replay : nullptr);
    loading.reset();
    return run.go(called);
}

}  // namespace seldinger::apps
