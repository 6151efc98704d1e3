#pragma once
// The one loop over the steps of scenes: where a run begins, what is stepped, how each system fares and when it is over. The
// command, a batch, Python and the golden tests use it, and record through RunHooks.

#include "setup/key_frames.h"
#include "scene/scene.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace seldinger {

/// How a run ended, or where it stands.
enum class RunStatus : std::int32_t { Running, Done, TimeLimit, Interrupted, Stopped };
[[nodiscard]] const char* status_word(RunStatus status);  // "done", "time-limit", ...

/// Whether a run begins with a static equilibrium.
[[nodiscard]] inline bool settles_first(const Scene& scene)
{
    return scene.start_settled || scene.integrator.scheme == Scheme::Static;
}

/// Questions and reports of a run, for those who record it.
class RunHooks {
public:
    virtual ~RunHooks() = default;
    /// Input of the next step, instead of the scenes' key frames; null: these.
    virtual const Control* control() { return nullptr; }
    /// Before every step: Running, or why the run ends here.
    virtual RunStatus asked() { return RunStatus::Running; }
    /// An intermediate equilibrium of a static run, at a time of its keys [s].
    virtual void passed(double /*time*/) {}
    /// The equilibrium that a system begins with.
    virtual void settled(int /*system*/, const WireReport& /*report*/) {}
    /// Whether a world without one starts from the wires as they were placed; else its systems have stopped.
    [[nodiscard]] virtual bool starts_as_placed() const { return false; }
    /// It does.
    virtual void placed() {}
    /// A step of dt [s] that a system has accepted. @return whether its tip has been at the target of [task]
    virtual bool stepped(int /*system*/, const WireReport& /*report*/, double /*dt*/) { return false; }
    /// A system is over: Done, or Stopped where it found no state.
    virtual void ended(int /*system*/, RunStatus /*status*/) {}
};

class SceneRun {
public:
    /// @param scenes  one for each system of the world    @param hooks  may be null
    SceneRun(World& world, std::span<const Scene> scenes, RunHooks* hooks = nullptr);

    /// Where a saved run stood: it has begun. @param rest_steps  the last steps in a row after which the system was at rest
    void resume(int system, long steps, long rest_steps, bool over);
    /// The equilibrium that scenes begin with, where they do. A static scene is over then.
    void begin();
    /// One step of all systems that run.
    void step();
    /// Begins if nothing has begun, and steps until no system runs, a hook asks to end, or so many steps have been taken in all.
    /// @return Running: as many as were asked for; Stopped: where any system has
    RunStatus run(long steps = std::numeric_limits<long>::max());

    [[nodiscard]] bool begun() const { return begun_; }
    [[nodiscard]] int running() const { return running_; }
    [[nodiscard]] bool runs(int system) const { return systems_[static_cast<std::size_t>(system)].status == RunStatus::Running; }
    /// Done, Stopped or Running, of all systems.
    [[nodiscard]] RunStatus status() const;
    [[nodiscard]] long rest_steps(int system) const { return systems_[static_cast<std::size_t>(system)].rest_steps; }
    /// Report of the last step, or of settling.
    [[nodiscard]] const StepReport& report() const { return report_; }

private:
    struct System {
        Until until = Until::Time;
        long last_step = 0;
        double moving_until = 0;  // rest before that is a pause [s]
        long steps = 0, rest_steps = 0;
        RunStatus status = RunStatus::Running;
    };
    [[nodiscard]] bool is_over(int system, bool reached) const;
    void end(int system, RunStatus status);

    World& world_;
    RunHooks none_;
    RunHooks& hooks_;
    KeyFrames keys_;
    std::vector<System> systems_;
    Scene first_;  // whose step lengths and scheme are those of all
    long taken_ = 0;  // steps of the world, of earlier parts of the run too
    int running_ = 0;
    bool begun_ = false;
    StepReport report_;
};

}  // namespace seldinger
