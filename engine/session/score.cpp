// Targets as balls along the centreline, and the sums of the score sheet.
#include "session/score.h"

#include "core/error.h"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <utility>

namespace seldinger {

namespace {

constexpr double contrast_rate = 4;      // of the injector [ml/s]
constexpr double change_of_mind = 0.002;  // a hub that goes back by less trembles [m]

std::vector<int> path_from_root(const Centreline& line, int leaf)
{
    std::vector<int> path;
    for (int at = leaf; at >= 0; at = line.parent[static_cast<std::size_t>(at)]) path.push_back(at);
    std::reverse(path.begin(), path.end());
    return path;
}

std::vector<int> child_counts(const Centreline& line)
{
    std::vector<int> children(line.points.size());
    for (const int parent : line.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    return children;
}

/// Index in `path` behind its last fork; 0 without any.
std::size_t after_last_fork(const std::vector<int>& path, const std::vector<int>& children)
{
    for (std::size_t k = path.size() - 1; k-- > 0;)
        if (children[static_cast<std::size_t>(path[k])] > 1) return k + 1;
    return 0;
}

double length_to(const Centreline& line, const std::vector<int>& path, std::size_t end)
{
    double length = 0;
    for (std::size_t k = 1; k <= end && k < path.size(); ++k)
        length += (line.points[static_cast<std::size_t>(path[k])] - line.points[static_cast<std::size_t>(path[k - 1])]).norm();
    return length;
}

}  // namespace

std::vector<int> branch_leaves(const Centreline& line)
{
    const std::vector<int> children = child_counts(line), trunk = line.empty() ? std::vector<int>{} : line.main_path();
    std::vector<std::pair<double, int>> found;
    for (int leaf = 0; leaf < static_cast<int>(line.points.size()); ++leaf) {
        if (children[static_cast<std::size_t>(leaf)] > 0) continue;
        const std::vector<int> path = path_from_root(line, leaf);
        const bool is_trunk = leaf == trunk.back();
        found.emplace_back(is_trunk ? std::numeric_limits<double>::infinity()
                                    : length_to(line, path, after_last_fork(path, children)), leaf);
    }
    std::sort(found.begin(), found.end());
    std::vector<int> leaves;
    for (const auto& [distance, leaf] : found) leaves.push_back(leaf);
    return leaves;
}

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
