// A scene for a program that links the library, and the folder of what it steps.
#include "record/recording.h"

#include "core/assets.h"
#include "core/clock.h"
#include "core/error.h"
#include "record/recorder.h"
#include "run/scene_run.h"
#include "run/score.h"
#include "run/wall_path.h"
#include "setup/scene_setup.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace seldinger {

/// What a scene was read as.
struct SceneSource {
    Scene scene;
    RepairReport vessel;
};

LoadedScene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides)
{
    const auto source = std::make_shared<SceneSource>();
    source->scene = read_scene(scene_file(file.string()), overrides);
    const Scene& scene = source->scene;
    LoadedScene loaded{make_setup(scene, -1, &source->vessel), {}, scene.dt, scene.duration, scene.task, source};
    find_wall_path(std::span(&scene, 1), loaded.setup);
    for (int k = 0; k < scene.instrument_count(); ++k) loaded.keys.push_back(scene.instrument(k).feed.keys);
    return loaded;
}

struct Recording::Data {
    Data(std::shared_ptr<const SceneSource> of, const World& world, const std::filesystem::path& dir)
        : source(std::move(of)), recorder(source->scene, source->vessel, world, dir)
    {
        if (source->scene.task.on) watch.emplace(source->scene, world, ScoreWatch::Patch::WhereItCounts);
        begin_task(world);
    }

    /// The wires are where they begin.
    void begin_task(const World& world)
    {
        time = world.time();
        if (!watch) return;
        watch->begin(world, 0, score);
        recorder.scored(score);
    }

    std::shared_ptr<const SceneSource> source;  // outlives the recorder
    Recorder recorder;
    std::optional<ScoreWatch> watch;
    ScoreNumbers score;
    Output output;
    double time = 0;
    Clock::time_point start = Clock::now();
};

Recording::Recording(const LoadedScene& scene, const World& world, const std::filesystem::path& dir, bool overwrite)
{
    if (!scene.source)
        throw Error(ErrorKind::BadScene, "Recording: got a scene that was not read; expected what load_scene() returned");
    make_folder(dir);
    check_run_folder(dir, overwrite ? FolderUse::Overwrite : FolderUse::Refuse, scene.source->scene);
    data_ = std::make_unique<Data>(scene.source, world, dir);
}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

void Recording::settled(const World& world, const StepReport& report)
{
    Data& d = *data_;
    world.read(d.output);
    d.recorder.gauge(world, d.output);
    d.recorder.settled(d.output, report);
    d.begin_task(world);
}

void Recording::stepped(const World& world, const StepReport& report, double seconds)
{
    Data& d = *data_;
    const double dt = world.time() - d.time;
    const Scene& scene = d.source->scene;
    const double due = scene.step_length(static_cast<long>(d.recorder.tally().steps));
    if (report.failed())
        throw Error(ErrorKind::BadScene,
                    fmt::format("Recording: got the report of a step that failed (flags {}); expected one that was accepted",
                                report.flags));
    if (std::abs(dt - due) > 1e-6 * due)
        throw Error(
            ErrorKind::BadScene,
            fmt::format("Recording: got a step of {} s; expected {} s, dt of the scene. Fix: record every step", dt, due));
    d.time = world.time();
    world.read(d.output, d.recorder.wants(world));
    d.recorder.gauge(world, d.output);
    d.recorder.stepped(d.output, report, seconds);
    if (!d.watch) return;
    d.watch->stepped(world, 0, dt, false, false, d.score);
    d.recorder.scored(d.score);
}

TaskProgress Recording::task() const
{
    const ScoreNumbers& s = data_->score;
    return {s.reached != 0, s.reached_at_s, s.reached_at_m, s.distance, s.wall_force_max, s.patch_force_max, s.hand_force_max,
            verdict_of(data_->source->scene.task, s)};
}

std::string Recording::finish(const World& world)
{
    return data_->recorder.finish(world, RunStatus::Done, seconds_since(data_->start));
}

}  // namespace seldinger
