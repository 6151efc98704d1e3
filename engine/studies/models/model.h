#pragma once
// A model: one way to compute a scene, as a named set of choices laid over it. What a model leaves empty stays as the scene has
// it. The chart, the stability map and the planner all use models; only apply() knows the scene key of a choice.

#include "scene/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace seldinger {

struct Model {
    std::string name;          // in tables and pictures; unique within a table. Empty: label() stands in
    std::string baseline;      // empty: the engine; else the name under which an application registered another simulation
    std::optional<int> nodes;  // over the whole (first) wire, others with edges as long; 0: adaptive
    std::optional<double> min_edge, max_edge;  // adaptive only [m]
    std::optional<double> dt;                  // [s]
    std::optional<Scheme> scheme;
    std::optional<bool> trapezoid;    // Newmark (1/4, 1/2); false: backward Euler
    std::optional<double> tolerance;  // of the converged step [-]
    std::optional<Detection> detection;
    std::optional<NormalLaw> normal;
    std::optional<FrictionLaw> friction;
    std::optional<bool> rolling;
    std::optional<bool> elastic_wall;
    std::optional<double> wall_edge;  // of its control mesh [m]
    std::optional<Precision> precision;
    std::optional<CoaxialSpec::Model> coaxial;  // of instruments inside each other
    std::optional<bool> lumen_friction;         // of those in one centreline: by what presses one on the other's lumen
    // what the published method leaves open, and is searched for its best (lab/published.h)
    std::optional<double> restitution;        // [-]
    std::optional<double> linear_stiffness;   // of a linear wall in place of the scene's law [N/m^2]
    std::optional<double> stretch_stiffness;  // EA of the whole wire [N]
    std::optional<double> damping_mass;       // [1/s]
    std::optional<double> radius;             // of the whole wire [m]
    std::optional<bool> spin;                 // false: spin angles held fixed in steps whose torques balance so
};

/// The scene under the model. A baseline's name changes nothing here: the simulation that it names reads the same scene.
[[nodiscard]] Scene apply(const Model& model, Scene scene);

/// Every choice of a scene, spelled out: apply(model_of(other), scene) runs `scene` as `other` is run.
[[nodiscard]] Model model_of(const Scene& scene);

/// The model as texts of `seldinger run SCENE --set`, so that any point of a chart can be run again.
[[nodiscard]] std::vector<std::string> set_texts(const Model& model, const Scene& scene);

/// Its choices in words, e.g. "101 nodes, 1 ms, newton, swept"; its name when it has one.
[[nodiscard]] std::string label(const Model& model);

/// Why this build cannot run the model in the scene, in one sentence; empty when it can. What the scene reader refuses is refused
/// here in the same words.
[[nodiscard]] std::string why_not(const Model& model, const Scene& scene);

}  // namespace seldinger
