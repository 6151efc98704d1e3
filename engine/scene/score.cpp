// Targets as balls along the centreline, the sums of a score, and what of a world they are made of.
#include "scene/score.h"

#include "core/error.h"
#include "scene/scene.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {

namespace {

constexpr double contrast_rate = 4;      // of the injector [ml/s]
constexpr double change_of_mind = 0.002;  // a hub that goes back by less trembles [m]

bool is_above(double force, double limit) { return limit > 0 && force > limit; }

void count_direction(double moved, ScoreNumbers& score)
{
    const int sign = moved > 0 ? 1 : moved < 0 ? -1 : 0;
    if (sign == 0) return;
    score.run = score.run * sign >= 0 ? score.run + moved : moved;
    if (std::abs(score.run) < change_of_mind || sign == score.direction) return;
    score.direction = sign;
    ++(sign > 0 ? score.pushes : score.pull_backs);
}

void count_path(const Vec3& tip, double inserted, ScoreNumbers& score)
{
    if (score.has_tip) score.path_length += (tip - Vec3(score.tip[0], score.tip[1], score.tip[2])).norm();
    score.tip[0] = tip.x(), score.tip[1] = tip.y(), score.tip[2] = tip.z();
    score.has_tip = 1;
    const double moved = inserted - score.inserted;
    score.inserted = inserted;
    (moved > 0 ? score.advanced : score.pulled_back) += std::abs(moved);
    count_direction(moved, score);
}

}  // namespace

TaskTarget::TaskTarget(const TaskSpec& task, const Centreline& centreline, const std::string& source)
{
    if (task.target == TaskSpec::Target::Point) {
        points_ = {task.point};
        radius_ = {task.radius};
        mark_ = task.point;
        mark_radius_ = task.radius;
    }
    if (task.target == TaskSpec::Target::Branch) follow_branch(task, centreline, source);
}

void TaskTarget::follow_branch(const TaskSpec& task, const Centreline& line, const std::string& source)
{
    const Branches branches(line);
    if (task.branch > branches.count())
        throw Error(ExitCode::BadScene, fmt::format("{}: task.target.branch: {}: the vessel's centreline has {} branches", source,
                                                    task.branch, branches.count()));
    const std::vector<int>& own = branches.points(task.branch);
    const double fork = branches.from_root(own.front());
    for (const int i : own) {
        if (branches.from_root(i) < fork + task.beyond) continue;
        // the lumen's own ball and half as much: sections are not round
        points_.push_back(line.points[static_cast<std::size_t>(i)]);
        radius_.push_back(1.5 * line.radius[static_cast<std::size_t>(i)]);
    }
    if (points_.empty())
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: task.target.beyond_m: {} m is more than branch {} is long, {:.4g} m", source, task.beyond,
                                task.branch, branches.from_root(own.back()) - fork));
    mark_ = points_.front();
    mark_radius_ = radius_.front() / 1.5;
}

double TaskTarget::distance(const Vec3& tip) const
{
    if (points_.empty()) return -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points_.size(); ++k) least = std::min(least, (tip - points_[k]).norm() - radius_[k]);
    return std::max(0.0, least);
}

void add_step(const TaskSpec& task, const TaskTarget& target, const ScoreStep& step, ScoreNumbers& s)
{
    s.distance = target.distance(step.tip);
    if (s.reached) return;  // the sheet is closed
    s.time += step.dt;
    count_path(step.tip, step.inserted, s);
    s.force_time += step.wall_force * step.dt;
    s.wall_force = step.wall_force;
    s.wall_force_mean = s.force_time / s.time;
    s.wall_force_max = std::max(s.wall_force_max, step.wall_force);
    s.patch_force = step.patch_force;
    s.patch_force_max = std::max(s.patch_force_max, step.patch_force);
    s.hand_force_max = std::max(s.hand_force_max, std::abs(step.hand_force));
    if (is_above(step.wall_force, task.wall_force) || is_above(step.patch_force, task.patch_force)) s.time_above += step.dt;
    if (step.fluoroscopy) s.fluoroscopy += step.dt;
    if (step.contrast) s.contrast += contrast_rate * step.dt;
    const bool failed = s.time_above > 0 || (task.time > 0 && s.time > task.time) ||
                        (task.fluoroscopy > 0 && s.fluoroscopy > task.fluoroscopy);
    s.failed = s.failed || failed ? 1 : 0;
    if (s.distance != 0) return;
    s.reached = 1;
    s.reached_at_m = step.inserted;
    s.reached_at_s = step.time;
}

int leading_wire(const World& world, int system)
{
    const auto [first, end] = world.wires_of(system);
    for (int w = first; w < end; ++w)
        if (world.setup().wires[static_cast<std::size_t>(w)].feed.on) return w;
    return first;
}

ScoreWatch::ScoreWatch(const Scene& scene, const World& world, Patch patch)
    : task_(scene.task), target_(scene.task, world.setup().centreline, scene.source.string()), patch_(patch)
{
}

void ScoreWatch::begin(const World& world, int system, ScoreNumbers& score) const
{
    score = {};
    const int wire = leading_wire(world, system);
    score.inserted = world.readings(wire).inserted;
    score.distance = target_.distance(world.rod(wire).pos(0));
}

/// No patch bears more than the sum of all forces but for rounding (LoadTally::may_rise): most steps need no pass over the contacts.
double ScoreWatch::patch_force(const World& world, int first, int end, double wall_force, const ScoreNumbers& score)
{
    const double most = (1 + 1e-9) * wall_force;
    if (patch_ == Patch::WhereItCounts && most <= score.patch_force_max && !is_above(most, task_.patch_force)) return 0;
    double worst = 0;
    loads_.resize(static_cast<std::size_t>(end - first));
    for (int w = first; w < end; ++w) {
        WireOutput& of_wire = loads_[static_cast<std::size_t>(w - first)];
        world.read_loads(w, of_wire);
        worst = std::max(worst, of_wire.on_wall.patch_force);
    }
    return worst;
}

void ScoreWatch::stepped(const World& world, int system, double dt, bool fluoroscopy, bool contrast, ScoreNumbers& score)
{
    const auto [first, end] = world.wires_of(system);
    const int wire = leading_wire(world, system);
    ScoreStep step;
    for (int w = first; w < end; ++w) {
        const WireReadings r = world.readings(w);
        step.wall_force += r.normal - r.normal_between;
        if (w == wire) step.inserted = r.inserted, step.hand_force = r.hand_force;
    }
    step.wall_force = std::max(step.wall_force, 0.0);
    step.dt = dt;
    step.time = world.time(wire);
    step.tip = world.rod(wire).pos(0);
    step.patch_force = score.reached ? 0 : patch_force(world, first, end, step.wall_force, score);
    step.fluoroscopy = fluoroscopy;
    step.contrast = contrast;
    add_step(task_, target_, step, score);
}

const char* verdict_of(const TaskSpec& task, const ScoreNumbers& score)
{
    if (task.target == TaskSpec::Target::None) return score.failed ? "failed" : "free";
    if (score.failed) return "failed";
    return score.reached ? "passed" : "open";
}

std::string target_name(const TaskSpec& task)
{
    if (!task.target_name.empty()) return task.target_name;
    return task.target == TaskSpec::Target::Branch ? fmt::format("branch {}", task.branch) : "the point";
}

}  // namespace seldinger
