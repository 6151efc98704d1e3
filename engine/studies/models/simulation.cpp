// The engine's World as a Simulation, and the look-up of registered baselines.
#include "models/simulation.h"

#include "core/error.h"
#include "setup/joint_readings.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

namespace seldinger {
namespace {

/// The engine itself.
class WorldSimulation final : public Simulation {
public:
    WorldSimulation(WorldSetup setup, const Scene& scene) : world_(std::move(setup)), key_frames_(scene) {}

    StepReport step(double dt) override { return seldinger::step(world_, key_frames_.control(), dt); }
    StepReport settle() override { return seldinger::settle(world_); }
    WireReadings readings() const override { return joint_readings(world_, 0); }

    std::vector<Vec3> shape() const override
    {
        const ConstRodView rod = world_.rod(0);
        std::vector<Vec3> points(static_cast<std::size_t>(rod.n));
        for (int i = 0; i < rod.n; ++i) points[static_cast<std::size_t>(i)] = rod.pos(i);
        // a wire that is still in its introducer reaches behind the inlet by a length that depends on its edges; that is not
        // there
        const FeedSpec& feed = world_.setup().wires.front().feed;
        if (feed.on && (points.back() - feed.point).dot(feed.direction) < 0) points.back() = feed.point;
        return points;
    }

    double wall_move() const override { return world_.setup().vessel.elastic ? world_.wall_readings().move_max : 0; }

    double force_per_length() const override
    {
        Output now;
        world_.read(now, Output::Contacts);
        return joint_along(now.wires, &WireOutput::on_wall).per_length_max;
    }

    std::vector<ForceAt> contact_forces() const override
    {
        const ConstRodView rod = world_.rod(0);
        std::vector<ForceAt> forces;
        for (const ContactRow& row : world_.contacts()) {
            if (row.a.body != 0 || row.a.element + 1 >= rod.n) continue;
            const Vec3 edge = rod.pos(row.a.element + 1) - rod.pos(row.a.element);
            const double along = std::clamp((row.point - rod.pos(row.a.element)).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
            forces.push_back({rod.material_s[row.a.element] + along * rod.rest_length[row.a.element], row.normal_force});
        }
        return forces;
    }

private:
    World world_;
    KeyFrames key_frames_;
};

}  // namespace

WorldSetup StudyScene::setup_under(const Model& model) const
{
    const Scene changed = apply(model, scene);
    WorldSetup made = setup;
    made.integrator = changed.integrator;
    made.vessel.elastic = changed.vessel.elastic;
    made.vessel.wall_edge = changed.vessel.wall_edge;
    if (changed.coaxial) {
        made.coaxial.front().model = changed.coaxial->model;
        made.coaxial.front().lumen_friction = changed.coaxial->lumen_friction;
    }
    for (int k = 0; k < changed.instrument_count(); ++k) {
        WireSetup& wire = made.wires[static_cast<std::size_t>(k)];
        wire.wire = changed.instrument(k).wire;
        wire.contact = changed.contact;
    }
    return made;
}

StudyScene load_study_scene(Scene scene, int device_index)
{
    StudyScene study;
    study.setup = make_setup(scene, device_index);
    study.scene = std::move(scene);
    return study;
}

std::unique_ptr<Simulation> make_simulation(const StudyScene& scene, const Model& model, const std::vector<Baseline>& baselines)
{
    if (model.baseline.empty()) return std::make_unique<WorldSimulation>(scene.setup_under(model), scene.scene);
    const auto found = std::find_if(baselines.begin(), baselines.end(),
                                    [&](const Baseline& baseline) { return baseline.name == model.baseline; });
    if (found == baselines.end())
        throw Error(ErrorKind::BadScene,
                    fmt::format("model \"{}\": no baseline \"{}\" is registered", label(model), model.baseline));
    if (const std::string reason = found->why_not(scene.scene); !reason.empty())
        throw Error(ErrorKind::BadScene, fmt::format("model \"{}\": {}", label(model), reason));
    return found->make(scene, model);
}

}  // namespace seldinger
