#pragma once
// A scene: everything that a run needs to know, as read from a TOML file (docs/scene-file.md) with every default filled in.
// SI throughout; angles in radians.

#include "engine.h"
#include "scene/scene_xray.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace seldinger {

enum class Until { Time, Rest, Reached };

/// [contact] of a scene: friction is a property of the wire's sections (WireSection), these are what a section has that says
/// nothing.
struct SceneContact : ContactSpec {
    double mu_static = 0.12, mu_sliding = 0.10;
};

/// [feed] of a scene.
struct SceneFeed {
    bool on = false;
    bool inlet_auto = false;  // an inlet of the vessel; else point and direction
    int inlet_number = 0;     // with inlet_auto: which one, counted from 1 (vessel/inlets.h); 0: "auto", the first
    Vec3 point = Vec3::Zero(), direction = Vec3::UnitX();
    bool along_centreline = false;  // what is inside at t = 0 lies along the vessel's centreline; else straight ahead
    double behind = 0;          // FeedSpec::behind [m]
    HubSpec hub;
    // piecewise linear, times strictly increasing; held constant outside. Of a driven hub all have the `advance` that it starts
    // with
    std::vector<FeedKey> keys;

    /// The inlet, with the hub where the keys have it at t = 0.
    [[nodiscard]] FeedSpec inlet() const;
    /// Where the hub is asked to be at time t.
    [[nodiscard]] FeedKey at(double t) const;
};

inline constexpr std::size_t most_scene_instruments = 16;

/// [[force]] of a scene.
struct SceneForce {
    std::string plugin, name;
    ForceKeys keys;
};

/// One instrument of a scene, and what [[hold]], [[load]], [[link]] and [[force]] say of it.
struct SceneInstrument {
    std::string label;  // `name` of its [[instrument]]; empty: it is the one of [wire] and [feed]
    WireSpec wire;
    SceneFeed feed;
    std::vector<HoldSpec> holds;
    std::vector<LoadSpec> loads;
    std::vector<LinkSpec> links;
    std::vector<SceneForce> forces;
};

/// As an instrument, the first one: the only one of most scenes.
struct Scene : SceneInstrument {
    std::filesystem::path source;  // file that it was read from, for messages
    std::string name;
    std::string planned;           // what `seldinger plan` chose this model for (summary.json, `model`); else empty
    Vec3 gravity = {0, 0, -9.81};  // [m/s^2]
    double duration = 0;           // [s]; 0 only for scheme = "static" without duration_s
    double dt = 1e-3;              // [s]
    Until until = Until::Time;
    int record_every = 10;  // steps between rows of trace.csv
    std::int64_t seed = 0;  // of whatever draws at random (batch)
    bool start_settled = false;
    std::vector<SceneInstrument> others;  // the instruments after the first
    std::optional<CoaxialSpec> coaxial;   // which of them are inside each other
    IntegratorSpec integrator;
    VesselSpec vessel;  // paths absolute
    SceneContact contact;
    bool instruments_touch = false;                          // WorldSetup's
    TaskSpec task;
    int wire_every = 1;                                      // steps between frames of the wire; 0: none
    int contacts_every = 1;                                  // steps between frames of the contacts; 0: none
    double force_window = 0, force_patch = 5e-3;             // WorldSetup's [m]
    SceneCArm carm;                                          // how it is looked at by X-ray
    SceneContrast contrast;
    bool bands = false;  // in a batch: each run a second time with half the step
    bool keep_traces = false, keep_last_frame = false;  // of each run of a batch
    std::vector<std::string> warnings;  // found on reading: sentences for every output
    std::vector<std::pair<std::string, std::string>> notes;  // what was changed on reading, and why (summary.json, `model`)

    /// That take the run to its end; sub-steps are not counted. Where dt does not go into the duration the last one is shorter.
    [[nodiscard]] long steps() const;
    /// Length of the step after `taken` steps [s].
    [[nodiscard]] double step_length(long taken) const;
    [[nodiscard]] int instrument_count() const { return 1 + static_cast<int>(others.size()); }
    [[nodiscard]] SceneInstrument& instrument(int k) { return k == 0 ? *this : others[static_cast<std::size_t>(k) - 1]; }
    [[nodiscard]] const SceneInstrument& instrument(int k) const
    {
        return k == 0 ? *this : others[static_cast<std::size_t>(k) - 1];
    }
};

/// When the last thing that the scene prescribes has come to its end [s]; rest before that is a pause.
[[nodiscard]] double prescribed_until(const Scene& scene);

/// The wall's modulus where the scene gives none. An elastic wall is soft tissue, 1 MPa. A rigid one is as hard as a fortieth of
/// the hardest instrument, to a power of ten: a guidewire bent through a vessel then sinks in by some 0.02 of its radius,
/// and a harder wall would cost steps and show nothing. Beams of one shape carry loads of 4 B/(pi r^4), an instrument's modulus
/// as a solid one, times lengths; so their share of overlap goes by the ratio of the two moduli. Between 1 MPa and 1 GPa: below,
/// a wall that is called rigid would be softer than tissue; above, steps are halved.
void choose_wall_youngs(Scene& scene);
// A moving wire can stand still for a step where it turns round; that it does so for this many in a row is rest.
inline constexpr long steps_at_rest = 10;

/// Reads a scene file. @param overrides  texts of --set, "table.key=value", applied in order before anything is checked
/// @throws Error BadFile (file missing), BadScene: one line, "file:line:column: key: expected value; fix"
[[nodiscard]] Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides = {});

/// The same from text; `file` names it in messages, and relative mesh paths start at its folder.
[[nodiscard]] Scene read_scene_text(const std::string& text, const std::filesystem::path& file,
                                    std::span<const std::string> overrides = {});

/// The scene as TOML with every default written out and mesh paths relative to `folder`, where the text is to be saved.
/// Reading it back gives the same Scene, bit for bit.
[[nodiscard]] std::string write_scene(const Scene& scene, const std::filesystem::path& folder);

/// Bending, twisting and stretching stiffness of a round solid wire: B = E pi r^4 / 4, C = G pi r^4 / 2 with
/// G = E / (2 (1 + nu)), EA = E pi r^2. Overwrites the three in `section` from its youngs, poisson and radius.
void set_stiffness_from_material(WireSection& section);

}  // namespace seldinger
