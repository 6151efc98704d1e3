// Targets as balls along the centreline, and the sums of the score sheet.
#include "session/score.h"

#include "core/error.h"
#include "vessel/branches.h"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <utility>

namespace seldinger {

namespace {

constexpr double contrast_rate = 4;      // of the injector [ml/s]
constexpr double change_of_mind = 0.002;  // a hub that goes back by less trembles [m]

}  // namespace

TaskTarget::TaskTarget(const TaskSpec& task, const Centreline& centreline, const std::string& source) : kind_(task.target)
{
    if (kind_ == TaskSpec::Target::Point) {
        points_ = {task.point};
        radius_ = {task.radius};
        mark_ = task.point;
        mark_radius_ = task.radius;
    }
    if (kind_ == TaskSpec::Target::Branch) follow_branch(task, centreline, source);
}

void TaskTarget::follow_branch(const TaskSpec& task, const Centreline& line, const std::string& source)
{
    const std::vector<int> leaves = branch_leaves(line);
    if (task.branch > static_cast<int>(leaves.size()))
        throw Error(ExitCode::BadScene, fmt::format("{}: task.target.branch: {}: the vessel's centreline has {} branches", source,
                                                    task.branch, leaves.size()));
    const std::vector<int> path = path_from_root(line, leaves[static_cast<std::size_t>(task.branch - 1)]);
    const std::size_t fork = after_last_fork(path, child_counts(line));
    const double from = length_to(line, path, fork) + task.beyond;
    for (std::size_t k = fork; k < path.size(); ++k) {
        if (length_to(line, path, k) < from) continue;
        const auto at = static_cast<std::size_t>(path[k]);
        // the lumen's own ball and half as much: sections are not round
        points_.push_back(line.points[at]);
        radius_.push_back(1.5 * line.radius[at]);
    }
    if (points_.empty())
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: task.target.beyond_m: {} m is more than branch {} is long, {:.4g} m", source, task.beyond,
                                task.branch, length_to(line, path, path.size()) - length_to(line, path, fork)));
    mark_ = points_.front();
    mark_radius_ = radius_.front() / 1.5;
}

double TaskTarget::distance(const Vec3& tip) const
{
    if (kind_ == TaskSpec::Target::None) return -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points_.size(); ++k) least = std::min(least, (tip - points_[k]).norm() - radius_[k]);
    return std::max(0.0, least);
}

void Scorer::stepped(double dt, const Vec3& tip, double moved, double wall_force, double patch_force, bool fluoroscopy,
                     bool contrast)
{
    ScoreNumbers& s = score_;
    s.distance = target_.distance(tip);
    if (s.reached) return;  // the sheet is closed
    elapsed_ += dt;
    s.time = elapsed_;
    if (has_tip_) s.path_length += (tip - last_tip_).norm();
    last_tip_ = tip;
    has_tip_ = true;
    (moved > 0 ? s.advanced : s.pulled_back) += std::abs(moved);
    count_direction(moved);
    force_time_ += wall_force * dt;
    s.wall_force = wall_force;
    s.wall_force_mean = force_time_ / elapsed_;
    s.wall_force_max = std::max(s.wall_force_max, wall_force);
    s.patch_force = patch_force;
    s.patch_force_max = std::max(s.patch_force_max, patch_force);
    const auto above = [](double force, double limit) { return limit > 0 && force > limit; };
    if (above(wall_force, task_.wall_force) || above(patch_force, task_.patch_force)) s.time_above += dt;
    if (fluoroscopy) s.fluoroscopy += dt;
    if (contrast) s.contrast += contrast_rate * dt;
    s.failed = s.failed || s.time_above > 0 || (task_.time > 0 && s.time > task_.time) ||
               (task_.fluoroscopy > 0 && s.fluoroscopy > task_.fluoroscopy);
    s.reached = s.distance == 0;
}

void Scorer::count_direction(double moved)
{
    const int sign = moved > 0 ? 1 : moved < 0 ? -1 : 0;
    if (sign == 0) return;
    way_ = way_ * sign >= 0 ? way_ + moved : moved;
    if (std::abs(way_) < change_of_mind || sign == direction_) return;
    direction_ = sign;
    ++(sign > 0 ? score_.pushes : score_.pull_backs);
}

void Scorer::reset()
{
    score_ = {};
    has_tip_ = false;
    force_time_ = elapsed_ = way_ = 0;
    direction_ = 0;
}

const char* verdict_of(const TaskSpec& task, const ScoreNumbers& score)
{
    if (task.target == TaskSpec::Target::None) return score.failed ? "failed" : "free";
    if (score.failed) return "failed";
    return score.reached ? "passed" : "open";
}

}  // namespace seldinger
