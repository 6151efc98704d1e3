#pragma once
// A World as Python holds it: with its scenes, its key frames, a copy of the last readings, and a lock, so that threads may share
// it.

#include "run/scene_run.h"
#include "run/score.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace seldinger::python {

/// Input of one hub in a call of step().
struct HubTarget {
    bool moves = false;            // else it stays
    double advance = 0, turn = 0;  // at the end of the call [m], [rad]
};

/// A load in a call of step().
struct PointLoad {
    int instrument;
    double at;  // from the tip [m]
    Vec3 force, moment;
};
/// A force on the hub likewise (Control::push).
struct HubPush {
    int instrument;
    double force, turn, spring;
};
struct ControlForces {
    std::vector<PointLoad> loads;
    std::vector<HubPush> pushes;
};

/// What became of the steps of one call.
struct StepSummary {
    long steps = 0;  // taken; fewer than asked for where one failed
    StepReport report;
};

/// A saved state: every changing byte, and what could be read then (the engine reads off an accepted step, and there is none
/// after a restore).
struct SavedState {
    int system = -1;  // of which; -1: of all
    std::vector<std::uint8_t> bytes;
    std::shared_ptr<const Output> output;
    std::vector<ScoreNumbers> scores;  // of [task], of each system that it is of
};

/// In a child that was forked after OpenCL had been started.
[[nodiscard]] bool forked();
/// @throws Error NoDevice in a child that was forked after OpenCL had been started: its threads are not there
void check_process();

class Handle : RunHooks {
public:
    /// @param text  of the scene   @param file  names it in messages; relative paths start at its folder
    /// @param overrides  per system, texts of --set: as many systems as lists
    Handle(const std::string& text, const std::string& file, const std::vector<std::vector<std::string>>& overrides, int device);

    ~Handle();
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;

    void close();
    /// @throws Error BadScene when closed; NoDevice after a fork
    [[nodiscard]] World& world() const;
    [[nodiscard]] const Scene& scene(int system = 0) const { return scenes_[static_cast<std::size_t>(system)]; }

    /// `n` steps of dt. @param targets  per instrument; none: the hubs follow the scene's key frames
    /// @param go_on  past a step that failed; else a world of one system stops there
    StepSummary step(const std::vector<HubTarget>* targets, long n, double dt, bool go_on = false,
                     const ControlForces& forces = {});
    /// Per instrument: whether a step of the last call failed.
    [[nodiscard]] const std::vector<std::uint8_t>& failed() const { return failed_; }
    StepReport settle();

    /// A run of the scene from the present state on. @param settles  it begins with the equilibrium that the scene asks for
    void begin_run(bool settles);
    /// How a part of it went. @param to  steps of the world at its end, `most` of them in one part: signals are seen in between
    struct RunPart {
        bool over = false, as_placed = false;  // as_placed: no equilibrium was found, the wire starts as it was placed
        std::optional<StepReport> failed;
        bool settling = false;  // that failed
    };
    RunPart run(long to, long most);
    /// Output of the present state; the same object until something changes.
    std::shared_ptr<const Output> output();
    SavedState save(int system);
    [[nodiscard]] std::string state_hash(int system) const;
    /// @param into  a state of one system: which of them becomes it, -1: the one that it was saved of
    void restore(const SavedState& state, int into = -1);

    /// How a system's [task] goes. @throws Error BadScene: there is no task, or no such system
    [[nodiscard]] const ScoreNumbers& score(int system) const;
    /// The branch of the vessel that a system's leading tip is in.
    [[nodiscard]] Branches::Place branch(int system) const;
    [[nodiscard]] const Branches& branches(int system) const;

    std::mutex& lock() const { return lock_; }
    /// @throws Error BadScene: there is no such system
    void check_system(int system) const;
    /// A renderer and a fluoroscope, kept with the world.
    std::shared_ptr<void> companion, fluoroscope;

private:
    bool starts_as_placed() const override { return true; }
    void placed() override { part_.as_placed = true; }
    bool stepped(int system, const WireReport& report, double dt) override;
    void ended(int system, RunStatus status) override;
    RunStatus asked() override { return part_.failed ? RunStatus::Stopped : RunStatus::Running; }
    void begin_tasks();
    void follow_task(int system, double dt);
    void forget_output();
    void follow_tasks(double dt);
    StepReport one_step(const std::vector<HubTarget>* targets, const std::vector<HubTarget>& start, double share, double dt,
                        const ControlForces& forces);

    std::vector<Scene> scenes_;
    KeyFrames keys_{std::vector<std::vector<FeedKey>>{}};
    std::unique_ptr<World> world_;
    std::optional<SceneRun> run_;  // after begin_run()
    RunPart part_;
    std::vector<std::uint8_t> failed_;
    WorldBranches branches_;
    std::optional<ScoreWatch> watch_;   // where the scene has a [task]
    std::vector<ScoreNumbers> scores_;  // of each system
    Control control_;
    std::shared_ptr<Output> output_;  // of the present state, once somebody has asked
    std::shared_ptr<Output> spare_;   // to be filled again when nobody looks at it any more
    mutable std::mutex lock_;
};

/// To and from the bytes of a pickle. @throws Error BadFile
[[nodiscard]] std::vector<std::uint8_t> pack(const std::vector<ScoreNumbers>& scores);
[[nodiscard]] std::vector<ScoreNumbers> unpack_scores(const std::vector<std::uint8_t>& bytes);
[[nodiscard]] std::vector<std::uint8_t> pack(const Output& output);
[[nodiscard]] std::shared_ptr<const Output> unpack(const std::vector<std::uint8_t>& bytes);

}  // namespace seldinger::python
