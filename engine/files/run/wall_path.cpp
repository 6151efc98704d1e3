// The trial run and the cells of the wall that it touches.
#include "run/wall_path.h"

#include "core/error.h"
#include "setup/key_frames.h"
#include "run/scene_run.h"
#include "scene/scene.h"
#include "wall/wall_model.h"
#include "wall/wall_resolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace seldinger {
namespace {

constexpr double trial_step = 4e-3;  // [s]; contacts move by far less than a dent's width in it
constexpr double cell_share = 0.5;   // of the decay length

/// One point for each cell that a contact was in, in the order of time.
class Touched {
public:
    explicit Touched(double cell) : cell_(cell) {}
    void take_in(const std::vector<ContactRow>& contacts)
    {
        for (const ContactRow& row : contacts) {
            if (row.b.kind != BodyKind::Wall || !(row.normal_force > 0)) continue;
            std::array<long, 3> place;
            for (int c = 0; c < 3; ++c)
                place[static_cast<std::size_t>(c)] = std::lround(row.point[static_cast<std::size_t>(c)] / cell_);
            if (seen_.insert(place).second) points.push_back(row.point);
        }
    }
    std::vector<Vec3> points;

private:
    double cell_;
    std::set<std::array<long, 3>> seen_;
};

WorldSetup with_rigid_wall(const WorldSetup& setup)
{
    WorldSetup rigid = setup;
    rigid.vessel.elastic = false;
    rigid.vessel.loads.clear();
    return rigid;
}

}  // namespace

void find_wall_path(std::span<const Scene> scenes, WorldSetup& setup, const std::function<bool()>& asked)
{
    if (!setup.vessel.elastic || setup.vessel.wall_edge > 0 || setup.mesh.triangles.empty()) return;
    const WallModel wall(setup.vessel, setup.mesh, setup.centreline);
    const double decay = decay_length(setup.vessel, wall.typical_lumen_radius);
    if (!std::isfinite(decay)) return;
    Touched touched(cell_share * decay);
    World trial(with_rigid_wall(setup));
    if (asked) trial.stop_when(asked);
    const auto check = [&](const StepReport& report) {
        if (report.flags & StepStopped || (asked && asked()))
            throw Error(ErrorKind::Interrupted, "interrupted in the trial run with a rigid wall, before the first step");
        return !report.failed();
    };
    const Scene& scene = scenes.front();
    const KeyFrames keys(scenes);
    bool goes_on = true;
    if (settles_first(scene)) {
        goes_on = check(settle(trial));
        touched.take_in(trial.contacts());
    }
    double moving_until = 0;
    for (const Scene& one : scenes) moving_until = std::max(moving_until, prescribed_until(one));
    const double dt = scene.dt * std::max(1.0, std::floor(trial_step / scene.dt));
    const double end = scene.integrator.scheme == Scheme::Static ? 0 : scene.duration;
    for (double time = 0; goes_on && time < (1 - 1e-9) * end; time = trial.time()) {
        goes_on = check(step(trial, keys.control(), std::min(dt, end - time)));
        touched.take_in(trial.contacts());
        if (scene.until == Until::Rest && trial.at_rest() && trial.time() >= moving_until) break;
    }
    setup.vessel.touched = std::move(touched.points);
}

}  // namespace seldinger
