#pragma once
// The score sheet of a task: what a trainee did, counted step by step from what the world says.

#include "scene/scene.h"
#include "session/snapshot.h"

#include <string>

namespace seldinger {

/// Where the tip is to go, as points with how far it may be off.
class TaskTarget {
public:
    /// @throws Error BadScene: no such branch
    TaskTarget(const TaskSpec& task, const Centreline& centreline, const std::string& source);

    /// How far the tip still has to go, 0 when it is there [m]; -1 without a target.
    [[nodiscard]] double distance(const Vec3& tip) const;
    /// Where to mark it in a picture.
    [[nodiscard]] Vec3 mark() const { return mark_; }
    [[nodiscard]] double mark_radius() const { return mark_radius_; }

private:
    void follow_branch(const TaskSpec& task, const Centreline& centreline, const std::string& source);
    TaskSpec::Target kind_;
    std::vector<Vec3> points_;    // inside the target
    std::vector<double> radius_;  // of the ball about each that is
    Vec3 mark_ = Vec3::Zero();
    double mark_radius_ = 0;
};

class Scorer {
public:
    Scorer(const TaskSpec& task, TaskTarget target) : task_(task), target_(std::move(target)) {}

    /// A step of dt [s] has been taken. @param moved  by the hub in it [m]
    /// @param wall_force  on all of the wall  @param patch_force  on the worst patch of it [N]
    void stepped(double dt, const Vec3& tip, double moved, double wall_force, double patch_force, bool fluoroscopy, bool contrast);
    void reset();
    [[nodiscard]] const ScoreNumbers& now() const { return score_; }
    [[nodiscard]] const TaskTarget& target() const { return target_; }
    [[nodiscard]] const TaskSpec& task() const { return task_; }

private:
    void count_direction(double moved);
    TaskSpec task_;
    TaskTarget target_;
    ScoreNumbers score_;
    Vec3 last_tip_ = Vec3::Zero();
    bool has_tip_ = false;
    double force_time_ = 0;              // integral of the wall force [N s]
    double elapsed_ = 0;                 // [s]
    double way_ = 0;                     // the hub has gone since it last changed its mind [m]
    int direction_ = 0;
};

/// The score sheet as JSON.
[[nodiscard]] std::string score_json(const Scene& scene, const ScoreNumbers& score);
/// And as a page, without anything from outside.
[[nodiscard]] std::string score_page(const Scene& scene, const ScoreNumbers& score);

/// "passed", "failed", "open" or "free" (no target).
[[nodiscard]] const char* verdict_of(const TaskSpec& task, const ScoreNumbers& score);

}  // namespace seldinger
