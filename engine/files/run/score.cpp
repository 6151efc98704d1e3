// Targets as a ball or the part of a branch, the sums of a score, and what of a world they are made of.
#include "run/score.h"

#include "core/error.h"
#include "scene/scene.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

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

/// From the first move on: a wire that is placed against a wall bears on it before it goes anywhere.
void count_forces(const TaskSpec& task, const ScoreStep& step, ScoreNumbers& s)
{
    s.time += step.dt;
    s.force_time += step.wall_force * step.dt;
    s.wall_force_mean = s.force_time / s.time;
    s.wall_force_max = std::max(s.wall_force_max, step.wall_force);
    if (step.patch_force > s.patch_force_max) s.patch_force_max = step.patch_force, s.patch_force_max_time = step.time;
    s.hand_force_max = std::max(s.hand_force_max, std::abs(step.hand_force));
    if (is_above(step.wall_force, task.wall_force) || is_above(step.patch_force, task.patch_force)) s.time_above += step.dt;
}

/// ": "0", "1", "2.1", "2.2"", with the names that a file gives them.
std::string known_paths(const Branches& branches)
{
    constexpr std::size_t most = 24;
    std::string text;
    std::size_t listed = 0;
    for (const Stretch& s : branches.stretches()) {
        if (s.path.empty() || ++listed > most) continue;
        text += fmt::format("{} \"{}\"{}", text.empty() ? ":" : ",", s.path, s.name.empty() ? "" : fmt::format(" ({})", s.name));
    }
    return listed > most ? fmt::format("{} and {} more", text, listed - most) : text;
}

/// Of these wires the first that is fed, or the first.
int leading_wire(const WorldSetup& setup, int first, int end)
{
    for (int w = first; w < end; ++w)
        if (setup.wires[static_cast<std::size_t>(w)].feed.on) return w;
    return first;
}

}  // namespace

WorldBranches::WorldBranches(const WorldSetup& setup)
{
    std::vector<int> roots;
    const auto add = [&](int first, int count) {
        const FeedSpec& feed = setup.wires[static_cast<std::size_t>(leading_wire(setup, first, first + count))].feed;
        const int root = feed.on && !setup.vessel.branches_from_root ? end_at(setup.centreline, feed.point) : -1;
        const auto known = std::find(roots.begin(), roots.end(), root);
        of_.push_back(static_cast<std::size_t>(known - roots.begin()));
        if (known != roots.end()) return;
        roots.push_back(root);
        all_.emplace_back(setup.centreline, root);
    };
    int first = 0;
    for (const int count : setup.systems) add(first, count), first += count;
    for (int w = 0; w < static_cast<int>(setup.wires.size()) && setup.systems.empty(); ++w) add(w, 1);
}

Branches::Place WorldBranches::tip(const World& world, int system) const
{
    return of(system).locate(world.rod(leading_wire(world, system)).pos(0));
}

TaskTarget::TaskTarget(const TaskSpec& task, Branches branches, const std::string& source) : branches_(std::move(branches))
{
    if (task.target == TaskSpec::Target::Point) mark_ = task.point, radius_ = task.radius;
    if (task.target == TaskSpec::Target::Branch) enter_branch(task, source);
}

void TaskTarget::enter_branch(const TaskSpec& task, const std::string& source)
{
    const Centreline& line = branches_.line();
    if (task.branch > branches_.count())
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: task.target.branch: got {}; expected 1 to {}, the branches of the vessel's centreline",
                                source, task.branch, branches_.count()));
    stretch_ = task.branch > 0 ? branches_.numbered(task.branch) : branches_.find(task.branch_path);
    if (stretch_ < 0)
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: task.target.branch: got \"{}\"; expected a path of the vessel's centreline{}", source,
                                task.branch_path, known_paths(branches_)));
    const std::vector<int>& own = branches_.stretch(stretch_).points;
    const auto first = std::find_if(own.begin(), own.end(), [&](int i) { return branches_.depth(stretch_, i) >= task.beyond; });
    if (first == own.end())
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: task.target.beyond_m: got {} m; expected at most {:.4g} m, from the mouth of {} to its end",
                                source, task.beyond, branches_.depth(stretch_, own.back()), branches_.stretch(stretch_).words()));
    const auto at = [&](int i) { return line.points[static_cast<std::size_t>(i)]; };
    const int before = line.parent[static_cast<std::size_t>(*first)];
    mark_ = at(*first);
    along_ = before < 0 ? Vec3::Zero() : (at(*first) - at(before)).normalized();
    radius_ = line.radius[static_cast<std::size_t>(*first)];
    if (before >= 0) mark_ -= (branches_.depth(stretch_, *first) - task.beyond) * along_;
    beyond_ = task.beyond;
}

/// In the stretch, far enough behind its mouth, or in one that leaves it.
bool TaskTarget::is_beyond_mark(const Branches::Place& place) const
{
    if (place.stretch == stretch_) return place.depth >= beyond_;
    for (int at = place.stretch; at >= 0; at = branches_.stretch(at).from)
        if (at == stretch_) return true;
    return false;
}

/// In a branch: to the lumen's section as far behind the mouth as is asked for. There is no way back out of the target that the
/// reading `branch_depth_m` does not see, since both take the same foot on the axis.
double TaskTarget::distance(const Vec3& tip) const
{
    if (radius_ == 0) return -1;
    if (stretch_ < 0) return std::max(0.0, (tip - mark_).norm() - radius_);
    if (is_beyond_mark(branches_.locate(tip))) return 0;
    const double ahead = (mark_ - tip).dot(along_), aside = (mark_ - tip - ahead * along_).norm();
    return std::hypot(ahead, std::max(0.0, aside - radius_));
}

void add_step(const TaskSpec& task, const TaskTarget& target, const ScoreStep& step, ScoreNumbers& s)
{
    s.distance = target.distance(step.tip);
    if (s.reached) return;  // the sheet is closed
    if (step.inserted != s.inserted || step.turned != s.turned) s.begun = 1;
    s.turned = step.turned;
    count_path(step.tip, step.inserted, s);
    s.wall_force = step.wall_force;
    s.patch_force = step.patch_force;
    if (s.begun) count_forces(task, step, s);
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
    return leading_wire(world.setup(), first, end);
}

ScoreWatch::ScoreWatch(const Scene& scene, const World& world, Patch patch)
    : task_(scene.task), branches_(world), patch_(patch)
{
    for (const Branches& branches : branches_.all()) targets_.emplace_back(scene.task, branches, scene.source.string());
}

void ScoreWatch::begin(const World& world, int system, ScoreNumbers& score) const
{
    score = {};
    const int wire = leading_wire(world, system);
    score.inserted = world.readings(wire).inserted;
    score.turned = world.readings(wire).turned;
    score.distance = target(system).distance(world.rod(wire).pos(0));
}

/// No patch bears more than the sum of all forces but for rounding (LoadTally::may_rise): most steps need no pass over the
/// contacts.
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
        if (w == wire) step.inserted = r.inserted, step.turned = r.turned, step.hand_force = r.hand_force;
    }
    step.wall_force = std::max(step.wall_force, 0.0);
    step.dt = dt;
    step.time = world.time(wire);
    step.tip = world.rod(wire).pos(0);
    step.patch_force = score.reached ? 0 : patch_force(world, first, end, step.wall_force, score);
    step.fluoroscopy = fluoroscopy;
    step.contrast = contrast;
    add_step(task_, target(system), step, score);
}

const char* verdict_of(const TaskSpec& task, const ScoreNumbers& score)
{
    if (task.target == TaskSpec::Target::None) return score.failed ? "failed" : "free";
    if (score.failed) return "failed";
    return score.reached ? "passed" : "open";
}

std::string target_name(const TaskSpec& task)
{
    if (task.target != TaskSpec::Target::Branch) return task.target_name.empty() ? "the point" : task.target_name;
    const std::string branch =
        task.branch > 0 ? fmt::format("branch {}", task.branch) : fmt::format("branch \"{}\"", task.branch_path);
    // with its number: a name stays when --set asks for another branch
    return task.target_name.empty() ? branch : fmt::format("{} ({})", task.target_name, branch);
}

}  // namespace seldinger
