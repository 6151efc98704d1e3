// seldinger plan SCENE.toml --tolerance 0.2mm [--force-tolerance 5%] [--peak-force-tolerance 10%] [--rate 60] [--enough 0.5]
// [--budget 120] [-o planned.toml] [--device N] [--json] [--quiet]

#include "command_line.h"
#include "commands.h"
#include "core/file_lock.h"
#include "core/note.h"
#include "plan_report.h"
#include "quantity.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <memory>

namespace seldinger::apps {
namespace {

struct PlanArguments {
    std::filesystem::path scene, plan = "planned.toml";
    std::string tolerance, force_tolerance, peak_tolerance;
    PlanOptions what;
    bool json = false, quiet = false;
};

ErrorKind kind_of(const Plan& plan)
{
    switch (plan.status) {
        case PlanStatus::Planned:
            return ErrorKind::None;
        case PlanStatus::NothingHolds:
            return ErrorKind::Stopped;
        case PlanStatus::Interrupted:
            return stop_asked_for() == SIGTERM ? ErrorKind::TimeLimit : ErrorKind::Interrupted;
        default:
            return ErrorKind::NotFeasible;
    }
}

ErrorKind plan_scene(PlanArguments& options)
{
    const StopSignal listening;
    PlanOptions& what = options.what;
    what.goals.tolerance = parse_length("--tolerance", options.tolerance);
    if (!options.force_tolerance.empty()) {
        const ForceTolerance force = parse_force_tolerance("--force-tolerance", options.force_tolerance);
        what.goals.force_tolerance = force.value;
        what.goals.force_is_relative = force.relative;
    }
    if (!options.peak_tolerance.empty()) {
        const ForceTolerance peak = parse_force_tolerance("--peak-force-tolerance", options.peak_tolerance);
        what.goals.peaks.tolerance = peak.value;
        what.goals.peaks.is_relative = peak.relative;
    }
    if (what.enough > 0 && what.goals.rate <= 0)
        throw Error(ErrorKind::BadScene, "--enough: got no --rate; expected one. Fix: give --rate N");
    const PlanFiles files = plan_files(options.plan);
    if (std::filesystem::exists(options.plan) && std::filesystem::equivalent(options.plan, options.scene))
        throw Error(ErrorKind::BadScene, fmt::format("-o {}: is the scene itself; choose another file", options.plan.string()));
    what.trials = options.plan.parent_path() / (options.plan.stem().string() + ".pilots");
    const FileLock lock = FileLock::of_file(options.plan);
    what.stop = [] { return stop_asked_for() != 0; };
    const bool shows = !options.quiet && isatty(STDERR_FILENO) != 0;
    if (shows) what.progress = [](const std::string& doing) { note(fmt::format("\r\033[K{}", doing)); };
    const StudyScene scene = [&] {
        const NoPolling loading;
        return load_study_scene(read_scene(options.scene), what.device);
    }();
    if (scene.scene.until != Until::Time && !options.quiet)
        note(fmt::format(
            "seldinger: note: scene.until ends a run early, but all {:.3g} s of scene.duration_s are planned for. Fix: make "
            "it end where the run does\n",
            scene.scene.duration));
    const Plan plan = make_plan(scene, what);
    if (shows) note("\r\033[K");
    if (plan.status == PlanStatus::Interrupted)
        throw Error(kind_of(plan), fmt::format("interrupted; all finished runs are kept in {}, and the same command continues",
                                               what.trials.string()));
    write_plan(plan, what.goals, files);
    if (options.json) print(plan_json(plan, what.goals, files));
    else if (!options.quiet) print(plan_report(plan, what.goals, files));
    if (plan.status != PlanStatus::Planned) throw Error(kind_of(plan), plan.message);
    return ErrorKind::None;
}

}  // namespace

void add_plan(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<PlanArguments>();
    CommandLine* command = app.add_subcommand("plan", "find the cheapest model that meets an accuracy");
    command->add_option("SCENE", options->scene, "scene file (TOML), or the name of a scene of the program")->scene()->required();
    command
        ->add_option("--tolerance", options->tolerance,
                     "allowed error of the wire's shape, root mean square over the run, e.g. 0.2mm")
        ->required()
        ->type_name("LENGTH");
    command->add_option("--force-tolerance", options->force_tolerance, "allowed error of the hand force, e.g. 5% or 10mN")
        ->type_name("SHARE|FORCE");
    command
        ->add_option("--peak-force-tolerance", options->peak_tolerance,
                     "allowed error of the largest hand force, friction and force per length (20 ms means), e.g. 10% or 5mN")
        ->type_name("SHARE|FORCE");
    command->add_option("--rate", options->what.goals.rate, "real time: steps of at most 1/N s, each computed within that time")
        ->check(positive())
        ->type_name("N");
    command
        ->add_option("--enough", options->what.enough,
                     "with --rate: take the first model that needs at most this fraction of real time, not the cheapest")
        ->check(in_range(0.01, 1.0))
        ->type_name("SHARE");
    command->add_option("--budget", options->what.budget, "seconds by the clock for this call (default: 120)")
        ->check(positive())
        ->type_name("S");
    command->add_option("-o", options->plan, "scene file to write (default: planned.toml); trials are kept beside it")
        ->type_name("FILE");
    command->add_option("--device", options->what.device, "OpenCL device, as `seldinger devices` lists them")
        ->check(not_negative())
        ->type_name("N");
    command->add_flag("--json", options->json, "print the plan as one JSON object");
    command->add_flag("--quiet", options->quiet, "no progress, no report");
    command->callback([options, &chosen] { chosen = [options] { return plan_scene(*options); }; });
}

}  // namespace seldinger::apps
