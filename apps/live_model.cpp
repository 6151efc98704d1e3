// Plans a scene for a live session in a separate process: the memory of the trials' worlds and kernels is freed with it.
#include "live_model.h"

#include "child_process.h"
#include "command_line.h"
#include "commands.h"
#include "core/child_process.h"
#include "core/exit_code.h"
#include "core/note.h"
#include "io/json_text.h"
#include "quantity.h"
#include "stop_signal.h"
#include "plan/planner.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <iterator>
#include <memory>

namespace seldinger::apps {
namespace {

constexpr const char* command_name = "choose-live-model";
constexpr double enough = 0.7;  // of real time: a session whose model needs no more is begun, cheaper ones or not

struct LiveModelArguments {
    std::filesystem::path source;
    pid_t parent = 0;
    LiveModelWish wish;
};

Plan planned(const Scene& scene, const LiveModelWish& wish)
{
    PlanOptions what;
    what.goals.tolerance = parse_length("--tolerance", wish.tolerance);
    what.goals.rate = wish.rate;
    what.enough = enough;
    what.budget = wish.budget;
    what.trials = wish.trials;
    what.device = wish.device;
    what.stop = [] { return stop_asked_for() != 0; };
    const bool shows = !wish.quiet && isatty(STDERR_FILENO) != 0;
    if (shows) what.progress = [](const std::string& doing) { note(fmt::format("\r\033[K{}", doing)); };
    Plan plan = make_plan(load_study_scene(scene, wish.device), what);
    if (shows) note("\r\033[K");
    return plan;
}

/// The whole of the process: scene in, model out, as JSON.
ErrorKind choose(const LiveModelArguments& options)
{
    end_with_parent(options.parent, SIGKILL);
    const StopSignal listening;
    const std::string text(std::istreambuf_iterator<char>(std::cin), {});
    nlohmann::json said;
    try {
        const Plan plan = planned(read_scene_text(text, options.source), options.wish);
        if (plan.status == PlanStatus::Interrupted)
            throw Error(ErrorKind::Interrupted, "interrupted while the model was being chosen");
        if (!plan.chosen) throw Error(ErrorKind::NotFeasible, plan.message);
        said = {{"scene", write_scene(plan.chosen->scene, options.source.parent_path())}, {"label", label(plan.chosen->model)},
                {"error", plan.chosen->error}, {"slowest", plan.chosen->slowest}};
    } catch (const Error& error) {
        said = {{"code", exit_code(error.kind())}, {"message", error.what()}};
    }
    print(json_text(said) + "\n");
    return ErrorKind::None;
}

}  // namespace

Scene model_for(const Scene& scene, const LiveModelWish& wish)
{
    (void)parse_length("--tolerance", wish.tolerance);
    const std::filesystem::path source = std::filesystem::absolute(scene.source);
    std::vector<std::string> arguments = {command_name, "--source", source.string(), "--trials", wish.trials.string(),
                                          "--tolerance", wish.tolerance, "--rate", fmt::format("{}", wish.rate),
                                          "--budget", fmt::format("{}", wish.budget), "--device", std::to_string(wish.device),
                                          "--parent", std::to_string(::getpid())};
    if (wish.quiet) arguments.emplace_back("--quiet");
    const ChildEnd end = run_self(arguments, write_scene(scene, source.parent_path()));
    const nlohmann::json said = nlohmann::json::parse(end.out, nullptr, false);
    if (stop_asked_for() != 0)
        throw Error(stop_asked_for() == SIGTERM ? ErrorKind::TimeLimit : ErrorKind::Interrupted,
                    "interrupted while the model was being chosen");
    if (!said.is_object())
        throw Error(ErrorKind::Stopped,
                    fmt::format("choosing the model ended with code {}; try `seldinger plan` on the scene", end.code));
    if (said.contains("code")) throw Error(kind_of_exit_code(said["code"].get<int>()), said["message"].get<std::string>());
    if (!wish.quiet)
        note(fmt::format("model: {}; within {:.2g} mm, {:.2g} s of computation per second in its slowest part\n",
                         said["label"].get<std::string>(), 1e3 * said["error"].get<double>(), said["slowest"].get<double>()));
    Scene chosen = read_scene_text(said["scene"].get<std::string>(), source);
    chosen.source = scene.source;
    chosen.task = scene.task;
    if (chosen.dt > 1 / wish.rate) chosen.dt = 1 / wish.rate;
    return chosen;
}

void add_choose_live_model(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<LiveModelArguments>();
    CommandLine* command = app.add_subcommand(command_name, "what `live --tolerance` runs; scene on stdin")->hidden();
    command->add_option("--source", options->source)->required();
    command->add_option("--trials", options->wish.trials)->required();
    command->add_option("--tolerance", options->wish.tolerance)->required();
    command->add_option("--rate", options->wish.rate)->required();
    command->add_option("--budget", options->wish.budget)->required();
    command->add_option("--device", options->wish.device);
    command->add_option("--parent", options->parent)->required();
    command->add_flag("--quiet", options->wish.quiet);
    command->callback([options, &chosen] { chosen = [options] { return choose(*options); }; });
}

}  // namespace seldinger::apps
