#pragma once
// [task]: where the tip is to go, within which limits, and how it went. One implementation for runs, batches, Python and live
// sessions.

#include "engine.h"
#include "run/score_numbers.h"
#include "vessel/branches.h"

#include <string>
#include <vector>

namespace seldinger {

struct Scene;
struct TaskSpec;

/// The branches of the vessel as the leading wire of each system meets them, from the inlet that it is fed through
/// (or from the centreline's root: VesselSpec::branches_from_root). Those of one inlet are one.
class WorldBranches {
public:
    WorldBranches() = default;
    explicit WorldBranches(const World& world) : WorldBranches(world.setup()) {}
    explicit WorldBranches(const WorldSetup& setup);
    [[nodiscard]] const std::vector<Branches>& all() const { return all_; }
    [[nodiscard]] std::size_t index(int system) const { return of_[static_cast<std::size_t>(system)]; }
    [[nodiscard]] const Branches& of(int system) const { return all_[index(system)]; }
    /// Where the tip of a system's leading wire is.
    [[nodiscard]] Branches::Place tip(const World& world, int system) const;

private:
    std::vector<Branches> all_;
    std::vector<std::size_t> of_;  // [systems]
};

/// Where the tip is to go: into a ball, or so far into a branch.
class TaskTarget {
public:
    /// @param source  names the scene in messages  @throws Error BadScene: no such branch, or it is too short
    TaskTarget(const TaskSpec& task, Branches branches, const std::string& source);

    /// How far the tip still has to go, 0 when it is there [m]; -1 without a target.
    [[nodiscard]] double distance(const Vec3& tip) const;
    /// Where to mark it in a picture.
    [[nodiscard]] Vec3 mark() const { return mark_; }
    /// Radius of the ball, or of the lumen where the branch's target begins [m].
    [[nodiscard]] double mark_radius() const { return radius_; }

private:
    void enter_branch(const TaskSpec& task, const std::string& source);
    [[nodiscard]] bool is_beyond_mark(const Branches::Place& place) const;
    Vec3 mark_ = Vec3::Zero();
    double radius_ = 0;  // 0: there is no target
    int stretch_ = -1;   // -1: a ball
    double beyond_ = 0;  // its mouth, along its axis [m]
    Vec3 along_ = Vec3::Zero();  // the axis at the mark
    Branches branches_;
};

/// Contribution of one step to the score.
struct ScoreStep {
    double dt = 0;           // [s]
    double time = 0;         // at its end [s]
    Vec3 tip = Vec3::Zero(); // [m]
    double inserted = 0;     // [m]
    double turned = 0;       // [rad]
    double wall_force = 0, patch_force = 0, hand_force = 0;  // on all of the wall, on its worst patch; of the hand [N]
    bool fluoroscopy = false, contrast = false;
};

/// Adds a step to the score. Reaching the target closes it.
void add_step(const TaskSpec& task, const TaskTarget& target, const ScoreStep& step, ScoreNumbers& score);

/// Keeps the scores of a world's systems. It holds their common part (target and limits); each score is the caller's, so that a
/// checkpoint carries it.
class ScoreWatch {
public:
    /// In which steps the force on the worst patch is read, which takes a pass over the contacts.
    enum class Patch { Always, WhereItCounts };  // WhereItCounts: it can be a new maximum, or above its limit

    /// @param scene  of the world's systems, whose [task] is one  @throws Error BadScene: a task that the vessel has not
    ScoreWatch(const Scene& scene, const World& world, Patch patch);

    /// The system is where its task begins, at first or after a reset.
    void begin(const World& world, int system, ScoreNumbers& score) const;
    /// A step of dt [s] has been taken. Allocates nothing once it has been called.
    void stepped(const World& world, int system, double dt, bool fluoroscopy, bool contrast, ScoreNumbers& score);
    [[nodiscard]] const TaskTarget& target(int system = 0) const { return targets_[branches_.index(system)]; }
    [[nodiscard]] const WorldBranches& branches() const { return branches_; }

private:
    [[nodiscard]] double patch_force(const World& world, int first, int end, double wall_force, const ScoreNumbers& score);
    const TaskSpec& task_;
    WorldBranches branches_;
    std::vector<TaskTarget> targets_;  // of branches_.all()
    Patch patch_;
    std::vector<WireOutput> loads_;
};

/// The wire of a system whose tip counts: the first that is fed, else the first.
[[nodiscard]] int leading_wire(const World& world, int system);

/// "passed", "failed", "open" or "free" (no target).
[[nodiscard]] const char* verdict_of(const TaskSpec& task, const ScoreNumbers& score);
/// What the target is called: `name` of [task.target], else "branch 2", "the point".
[[nodiscard]] std::string target_name(const TaskSpec& task);

}  // namespace seldinger
