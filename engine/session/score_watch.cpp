// Reads off a world, after each of its steps, what the score sheet counts.
#include "session/score_watch.h"

#include "session/session_limits.h"

#include <algorithm>

namespace seldinger {

std::vector<int> live_instruments(const WorldSetup& setup)
{
    const int of_first = setup.systems.empty() ? 1 : setup.systems.front();
    std::vector<int> fed;
    for (int w = 0; w < of_first && static_cast<int>(fed.size()) < most_instruments; ++w)
        if (setup.wires[static_cast<std::size_t>(w)].feed.on) fed.push_back(w);
    return fed;
}

ScoreWatch::ScoreWatch(const Scene& scene, const World& world)
    : scorer_(scene.task, TaskTarget(scene.task, world.setup().centreline, scene.source.string())), fed_(live_instruments(world.setup()))
{
}

void ScoreWatch::begin(const World& world)
{
    scorer_.reset();
    if (!fed_.empty()) inserted_ = world.readings(fed_.front()).inserted;
}

void ScoreWatch::stepped(const World& world, double dt, bool fluoroscopy, bool contrast)
{
    if (fed_.empty()) return;
    double wall_force = 0, patch_force = 0;
    for (const int w : fed_) wall_force += world.readings(w).normal;
    world.read(contacts_, Output::Contacts);
    for (const WireOutput& wire : contacts_.wires) patch_force = std::max(patch_force, wire.on_wall.patch_force);
    const double before = inserted_;
    inserted_ = world.readings(fed_.front()).inserted;
    scorer_.stepped(dt, world.rod(fed_.front()).pos(0), inserted_ - before, wall_force, patch_force, fluoroscopy, contrast);
}

}  // namespace seldinger
