#pragma once
// A run of the study: the engine's World, or a baseline that an application registers (bench/baselines). Both are stepped, read
// and timed in the same way. With several instruments it measures the first one's shape and hand, and forces, energies and
// overlaps of all (joint_readings.h).

#include "models/model.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace seldinger {

/// Normal contact force on a point of the wire.
struct ForceAt {
    double s = 0;      // from the tip along the unstressed wire [m]
    double force = 0;  // [N], >= 0
};

class Simulation {
public:
    virtual ~Simulation() = default;
    /// One step of length dt [s]. A simulation that cannot go on says so in the report's flags, as the engine does.
    [[nodiscard]] virtual StepReport step(double dt) = 0;
    /// Static equilibrium of the present state, for scenes that start settled or are static. Baselines may leave it out:
    /// the report then says StepNotConverged.
    [[nodiscard]] virtual StepReport settle() = 0;
    [[nodiscard]] virtual WireReadings readings() const = 0;
    /// The wire's axis, tip first [m].
    [[nodiscard]] virtual std::vector<Vec3> shape() const = 0;
    /// Normal forces on the wire, in any order.
    [[nodiscard]] virtual std::vector<ForceAt> contact_forces() const = 0;
    /// Largest force per length of any wire on the wall [N/m].
    [[nodiscard]] virtual double force_per_length() const { return 0; }
    /// How far the wall has gone where it has gone farthest [m]; 0 of a rigid one. Takes milliseconds.
    [[nodiscard]] virtual double wall_move() const { return 0; }
};

/// A scene with its vessel loaded: read once, run under many models.
struct StudyScene {
    Scene scene;
    WorldSetup setup;  // of the scene as it stands

    /// What a World is made from under `model`: the vessel and the feed's place stay.
    [[nodiscard]] WorldSetup setup_under(const Model& model) const;
};

/// @throws Error BadFile, BadScene, as make_setup
[[nodiscard]] StudyScene load_study_scene(Scene scene, int device_index = -1);

/// A simulation that is not the engine's.
struct Baseline {
    std::string name;  // as in Model::baseline
    std::function<std::unique_ptr<Simulation>(const StudyScene&, const Model&)> make;
    std::function<std::string(const Scene&)> why_not;  // empty when it can run the scene
    bool own_step = false;                             // divides every step into as many of its own as it needs to be stable
};

/// @param baselines  searched for model.baseline. @throws Error BadScene: no baseline of that name, or the model cannot run
[[nodiscard]] std::unique_ptr<Simulation> make_simulation(const StudyScene& scene, const Model& model,
                                                          const std::vector<Baseline>& baselines = {});

}  // namespace seldinger
