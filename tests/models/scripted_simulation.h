#pragma once
// A simulation whose readings are written by the test: what the study makes of a run can be checked without one.

#include "models/run_model.h"

#include <functional>
#include <utility>

namespace seldinger::test {

struct Moment {
    WireReadings readings;
    StepReport report;
    std::vector<Vec3> shape = {{0.1, 0, 0}, {0, 0, 0}};
    std::vector<ForceAt> forces;
};

class ScriptedSimulation final : public Simulation {
public:
    explicit ScriptedSimulation(std::function<Moment(double t)> script) : script_(std::move(script)), now_(script_(0)) {}
    StepReport step(double dt) override
    {
        t_ += dt;
        now_ = script_(t_);
        return now_.report;
    }
    StepReport settle() override { return now_.report; }
    WireReadings readings() const override { return now_.readings; }
    std::vector<Vec3> shape() const override { return now_.shape; }
    std::vector<ForceAt> contact_forces() const override { return now_.forces; }

private:
    std::function<Moment(double)> script_;
    double t_ = 0;
    Moment now_;
};

/// A wire of 10 cm in a tube, fed at 1 cm/s, for `duration` seconds in steps of a millisecond.
inline StudyScene scripted_scene(double duration = 1)
{
    StudyScene study;
    Scene& scene = study.scene;
    scene.duration = duration;
    scene.dt = 1e-3;
    scene.wire.length = 0.1;
    scene.wire.nodes = 11;
    scene.wire.shaft.radius = 4e-4;
    scene.wire.shaft.density = 7900;
    scene.vessel.shape = VesselShape::Tube;
    scene.feed.on = true;
    scene.feed.keys = {{0, 0, 0}, {10, 0.1, 0}};
    study.setup.wires.push_back({scene.wire, scene.feed.inlet(), {}, {}, {}, {}, {}});
    return study;
}

inline std::vector<Baseline> scripted(std::function<Moment(double)> script)
{
    Baseline baseline;
    baseline.name = "scripted";
    baseline.make = [script](const StudyScene&, const Model&) { return std::make_unique<ScriptedSimulation>(script); };
    baseline.why_not = [](const Scene&) { return std::string(); };
    return {baseline};
}

inline Model scripted_model(double dt = 1e-3) { return {.baseline = "scripted", .dt = dt}; }

}  // namespace seldinger::test
