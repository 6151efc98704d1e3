// seldinger live SCENE.toml [--port 8080] [--udp 9090] [--bind 127.0.0.1] [--token T] [--rate 1000] [--record FILE] [--duration
// S] [--set ...]

#include "command_line.h"
#include "commands.h"
#include "core/note.h"
#include "live_model.h"
#include "session/live_session.h"
#include "session/session.h"
#include "session/web_policy.h"
#include "stop_signal.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>
#include <thread>

namespace seldinger::apps {
namespace {

struct LiveArguments {
    std::filesystem::path scene;
    std::vector<std::string> overrides;
    std::optional<std::string> wire;
    LiveModelWish model;
    LiveOptions live;
    bool quiet = false, json = false;
};

/// Path of the file beside the record that `ending` names.
std::filesystem::path beside(const std::filesystem::path& record, const char* ending) { return record.string() + ending; }

void note_rate(const Session& session, double rate, bool& noted)
{
    const auto steps = session.steps_so_far();
    if (noted || static_cast<double>(steps) < rate || 2 * session.late_so_far() < steps) return;
    noted = true;
    note(fmt::format("this scene cannot keep {} steps a second here: time stretches; give --tolerance 0.5mm, or a lower --rate\n",
                     rate));
}

void wait_for_end(LiveSession& live, double rate)
{
    bool noted = false;
    while (live.running()) {
        if (stop_asked_for() != 0) live.stop();
        note_rate(live.session(), rate, noted);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
}

std::string end_for_people(const Session& session, const std::filesystem::path& record)
{
    const ScoreNumbers& score = session.score();
    const auto steps = std::max<std::uint64_t>(1, session.steps_so_far());
    return fmt::format(
        "{} steps, {:.3g} % late, {} cut short; step p50 {:.2f} p99 {:.2f} p99.9 {:.2f} ms\n"
        "task: {}\nrecord {}, score {}\nstate_hash {}\n",
        session.steps_so_far(), 100.0 * static_cast<double>(session.late_so_far()) / static_cast<double>(steps),
        session.cut_short_so_far(), 1e3 * session.step_times.quantile(0.5), 1e3 * session.step_times.quantile(0.99),
        1e3 * session.step_times.quantile(0.999), verdict_of(session.scene().task, score), record.string(),
        beside(record, ".score.json").string(), session.world().state_hash());
}

ErrorKind live(LiveArguments& options)
{
    const StopSignal listening("start it again");  // there is nothing to resume
    if (options.wire) options.overrides.push_back("wire.preset=" + *options.wire);
    Scene scene = read_scene(options.scene, options.overrides);
    LiveOptions& what = options.live;
    scene.dt = 1 / what.rate;
    if (what.record.empty()) what.record = options.scene.stem().string() + "-live.record";
    if (!options.model.tolerance.empty()) {
        options.model.rate = what.rate;
        options.model.trials = beside(what.record, ".pilots");
        options.model.device = what.device;
        options.model.quiet = options.quiet;
        scene = model_for(scene, options.model);
    }
    if (what.page_token.empty() && !is_loopback(what.page_address) && !options.quiet && !options.json)
        what.page_token = make_token();
    std::optional<NoPolling> loading(std::in_place);
    LiveSession live(scene, what);
    loading.reset();
    live.start();
    if (!options.quiet && !options.json)
        print(fmt::format("page http://{}:{}/{}  hand UDP {}:{}  {} steps a second\n", in_url(what.page_address),
                          live.page_port(), what.page_token.empty() ? "" : "?token=" + what.page_token, what.hand_address,
                          live.hand_port(), what.rate));
    wait_for_end(live, what.rate);
    const std::string summary = live.finish();
    if (options.json) print(summary);
    else if (!options.quiet) print(end_for_people(live.session(), what.record));
    if (!live.failure().empty())
        throw Error(ErrorKind::Stopped, fmt::format("{}; record in {}", live.failure(), what.record.string()));
    const int signal = stop_asked_for();
    return signal == 0 ? ErrorKind::None : signal == SIGTERM ? ErrorKind::TimeLimit : ErrorKind::Interrupted;
}

void add_what(CommandLine& command, LiveArguments& options)
{
    command
        .add_option("SCENE", options.scene,
                    "scene file (TOML), or the name of a scene of the program; the device replaces its key frames")
        ->scene()
        ->required();
    command.add_option("--set", options.overrides, "change a key of the scene; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    command.add_option("--wire", options.wire, "another instrument of the catalogue: --set wire.preset=NAME")->type_name("NAME");
    command.add_option("--rate", options.live.rate, "steps a second (default: 1000)")
        ->check(in_range(1.0, 10000.0))
        ->type_name("N");
    command
        .add_option("--deadline", options.live.deadline,
                    "share of the period after which a step ends before its equations hold, e.g. 0.9 (default: never)")
        ->check(in_range(0.05, 1.0))
        ->type_name("SHARE");
    command
        .add_option("--tolerance", options.model.tolerance, "choose the model by `plan` for this error of the shape, e.g. 0.5mm")
        ->type_name("LENGTH");
    command
        .add_option("--budget", options.model.budget, "with --tolerance: seconds by the clock to choose the model (default: 300)")
        ->check(positive())
        ->type_name("S");
    command.add_flag("--lockstep", options.live.lockstep,
                     "one step for each request of the device, independent of the clock: the same on any machine");
    command.add_option("--record", options.live.record, "record of the session (default: <scene>-live.record)")
        ->type_name("FILE");
    command.add_option("--duration", options.live.duration, "end after this session time (default: never)")
        ->check(positive())
        ->type_name("S");
    command.add_option("--device", options.live.device, "OpenCL device, as `seldinger devices` lists them")
        ->check(not_negative())
        ->type_name("N");
    command.add_flag("--quiet", options.quiet, "print no address and no summary");
    command.add_flag("--json", options.json, "print the summary as one JSON object");
}

}  // namespace

void add_live(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<LiveArguments>();
    CommandLine* command = app.add_subcommand("live", "run a live session: force feedback by UDP, picture in the browser");
    add_what(*command, *options);
    const ArgumentCheck port = in_range(0, 65535);
    command->add_option("--port", options->live.page_port, "port of the page; 0: any free one (default: 8080)")
        ->check(port)
        ->type_name("N");
    command->add_option("--bind", options->live.page_address, "address of the page (default: 127.0.0.1)")->type_name("ADDRESS");
    command
        ->add_option(
            "--token", options->live.page_token,
            "secret that the page's address must carry, 16 characters or more (default: made where --bind is not loopback)")
        ->type_name("T");
    command->add_option("--udp", options->live.hand_port, "UDP port of the device; 0: any free one (default: 9090)")
        ->check(port)
        ->type_name("N");
    command
        ->add_option("--udp-bind", options->live.hand_address,
                     "address of the UDP port (default: 127.0.0.1); not protected by --token")
        ->type_name("ADDRESS");
    command
        ->add_option("--coupling-stiffness", options->live.coupling_stiffness,
                     "stiffness between hand and instrument (default: 500)")
        ->check(positive())
        ->type_name("N/m");
    command
        ->add_option("--coupling-damping", options->live.coupling_damping, "damping between hand and instrument (default: 1)")
        ->check(not_negative())
        ->type_name("N s/m");
    command->callback([options, &chosen] { chosen = [options] { return live(*options); }; });
}

}  // namespace seldinger::apps
