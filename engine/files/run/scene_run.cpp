// Settles, steps and ends the systems of a world as their scenes ask.
#include "run/scene_run.h"

#include "setup/joint_readings.h"

#include <algorithm>

namespace seldinger {
namespace {

bool is_at_rest(const World& world, int system)
{
    const auto [first, end] = world.wires_of(system);
    bool all = true;
    for (int w = first; w < end; ++w) all = all && world.at_rest(w);
    return all;
}

}  // namespace

const char* status_word(RunStatus status)
{
    switch (status) {
        case RunStatus::Running: return "running";
        case RunStatus::Done: return "done";
        case RunStatus::TimeLimit: return "time-limit";
        case RunStatus::Interrupted: return "interrupted";
        case RunStatus::Stopped: return "stopped";
    }
    return "unknown";
}

SceneRun::SceneRun(World& world, std::span<const Scene> scenes, RunHooks* hooks)
    : world_(world), hooks_(hooks ? *hooks : none_), keys_(scenes), first_(scenes.front()), running_(world.system_count())
{
    for (const Scene& scene : scenes)
        systems_.push_back({scene.until, scene.steps(), prescribed_until(scene), 0, 0, RunStatus::Running});
}

void SceneRun::resume(int system, long steps, long rest_steps, bool over)
{
    System& own = systems_[static_cast<std::size_t>(system)];
    own.steps = steps;
    own.rest_steps = rest_steps;
    begun_ = true;
    taken_ = std::max(taken_, steps);
    if (!over) return;
    own.status = RunStatus::Done;
    --running_;
}

bool SceneRun::is_over(int system, bool reached) const
{
    const System& own = systems_[static_cast<std::size_t>(system)];
    if (own.steps >= own.last_step || (own.until == Until::Reached && reached)) return true;
    return own.until == Until::Rest && own.rest_steps >= steps_at_rest &&
           world_.time(world_.wires_of(system).first) >= own.moving_until;
}

void SceneRun::end(int system, RunStatus status)
{
    systems_[static_cast<std::size_t>(system)].status = status;
    --running_;
    hooks_.ended(system, status);
}

void SceneRun::begin()
{
    begun_ = true;
    if (!settles_first(first_)) return;
    const bool is_static = first_.integrator.scheme == Scheme::Static;
    const bool may_move = !is_static && hooks_.starts_as_placed();
    const std::vector<std::uint8_t> placed = may_move ? world_.save_state() : std::vector<std::uint8_t>();
    report_ = settle(world_, [&](int, double time) { hooks_.passed(time); });
    if (may_move && report_.failed()) {
        world_.restore_state(placed);
        return hooks_.placed();
    }
    for (int k = 0; k < world_.system_count(); ++k) {
        const WireReport own = joint_report(world_, k);
        if (!own.failed()) hooks_.settled(k, own);
        if (own.failed() || is_static) end(k, own.failed() ? RunStatus::Stopped : RunStatus::Done);
    }
}

void SceneRun::step()
{
    const double dt = first_.step_length(taken_);
    const Control* control = hooks_.control();
    report_ = seldinger::step(world_, control ? *control : keys_.control(), dt);
    if (report_.flags & StepStopped) return;  // nothing has changed
    ++taken_;
    for (int k = 0; k < world_.system_count(); ++k) {
        if (!runs(k)) continue;
        const WireReport own = joint_report(world_, k);
        if (own.failed()) {
            end(k, RunStatus::Stopped);
            continue;
        }
        System& system = systems_[static_cast<std::size_t>(k)];
        system.steps++;
        if (system.until == Until::Rest) system.rest_steps = is_at_rest(world_, k) ? system.rest_steps + 1 : 0;
        const bool reached = hooks_.stepped(k, own, dt);
        if (is_over(k, reached)) end(k, RunStatus::Done);
    }
}

RunStatus SceneRun::run(long steps)
{
    if (!begun_) begin();
    for (int k = 0; k < world_.system_count(); ++k)
        if (runs(k) && is_over(k, false)) end(k, RunStatus::Done);
    while (running_ > 0 && taken_ < steps) {
        if (const RunStatus asked = hooks_.asked(); asked != RunStatus::Running) return asked;
        step();
    }
    return status();
}

RunStatus SceneRun::status() const
{
    if (running_ > 0) return RunStatus::Running;
    const bool stopped = std::ranges::any_of(systems_, [](const System& own) { return own.status == RunStatus::Stopped; });
    return stopped ? RunStatus::Stopped : RunStatus::Done;
}

}  // namespace seldinger
