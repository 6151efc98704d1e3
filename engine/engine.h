#pragma once
// The public face of the engine: a World of wires in a vessel, and step(). Everything else builds one, runs it or reads it.

#include "contact/contact_row.h"
#include "contact/contact_spec.h"
#include "core/stage_times.h"
#include "device/device_info.h"
#include "rod/rod_arrays.h"
#include "solve/momentum.h"
#include "solve/solve_spec.h"
#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace seldinger {

/// Everything that differs between two wires of a world.
struct WireSetup {
    WireSpec wire;
    FeedSpec feed;
    ContactSpec contact;  // detection and laws must agree between wires; coefficients may differ
    std::vector<HoldSpec> holds;
    std::vector<LoadSpec> loads;
    std::vector<LinkSpec> links;
    std::string start;  // what was done to have it start inside the lumen; empty: nothing
};

/// What a world is made from. The vessel has been read and repaired already.
struct WorldSetup {
    Vec3 gravity = {0, 0, -9.81};
    double dt = 1e-3;  // nominal step, for the contact laws' floors and the run's choices
    bool start_settled = false;
    std::vector<WireSetup> wires;  // at least one
    IntegratorSpec integrator;
    VesselSpec vessel;  // wall properties; shape None: no wall
    WallMesh mesh;      // repaired, normals into the lumen; empty without a vessel
    Centreline centreline;
    int device_index = -1;  // -1: the default device
};

/// Flags of a step; each says which setting to change.
enum StepFlag : unsigned {
    StepOk = 0,
    StepHalved = 1u << 0,        // tolerance not met in the iteration budget; sub-steps taken: fine unless frequent (scene.dt_s)
    StepNotConverged = 1u << 1,  // no state could be found even for the smallest sub-step; the state before it was kept
    StepContactOverflow = 1u << 2,  // candidate lists grew (handled; a hint that the mesh is very fine)
    StepWallPenetration = 1u << 3,  // a point of the axis is beyond the wall: contact.detection = "swept"
    StepBestEffort = 1u << 5,  // the smallest sub-step missed the tolerance and its best trial was taken: scene.dt_s, friction
    StepNonFinite = 1u << 4,   // a value is not finite; the state before the step was kept
    StepEnergy = 1u << 6,      // the wire has more energy than was put in (solve/energy_balance.h), in short sub-steps too; the
                           // state before was kept: backward Euler (no integrator.beta, no gamma), scheme = "newton", scene.dt_s
};

/// How one wire fared in a step.
struct WireReport {
    unsigned flags = StepOk;
    int newton_iterations = 0;  // of the worst sub-step
    int sub_steps = 1;
    [[nodiscard]] bool failed() const { return flags & (StepNotConverged | StepNonFinite | StepEnergy); }
};

/// The worst of all wires, all flags together.
struct StepReport {  // of one step
    unsigned flags = StepOk;
    int newton_iterations = 0;
    int sub_steps = 1;
    StageTimes times;
    [[nodiscard]] bool failed() const { return flags & (StepNotConverged | StepNonFinite | StepEnergy); }
};

/// Per-wire readings of the accepted state.
struct WireReadings {
    double inserted = 0;  // advance since the start [m]
    double turned = 0;    // by the feed, right-handed about the direction of insertion [rad]
    int nodes = 0, contacts = 0;
    double contact_length = 0;                                   // metres of wire in contact
    double normal = 0, friction = 0, sliding = 0, sticking = 0;  // sums of magnitudes [N]
    double rolling = 0;                                          // sum of |moment| [N m]
    double hand_force = 0, hand_torque = 0;  // its work per length pushed in [N], per angle turned as `turned` is [N m]
    Vec3 base_force = Vec3::Zero();
    double overlap = 0;                                  // deepest overlap [m] >= 0
    double outside = 0;                                  // farthest axis point beyond the wall [m] >= 0
    double kinetic = 0, elastic = 0, gravitational = 0;  // [J]
    double remesh_energy = 0;                            // accumulated [J]
    double energy_made = 0;                              // most that came from nowhere so far (energy_balance.h) [J]
    double force_residual = 0;                           // largest left on a free node [N]
    MomentumBalance momentum;                            // of the last sub-step
};

/// What was asked of the OpenCL device since the world was made.
struct DeviceCounts {
    std::uint64_t launches = 0, reads = 0, writes = 0, buffers_created = 0, programs_built = 0;
};

class World {
public:
    explicit World(WorldSetup setup);  // throws Error
    ~World();
    World(World&&) noexcept;

    [[nodiscard]] int wire_count() const;
    [[nodiscard]] double time() const;
    [[nodiscard]] double time(int wire) const;  // of a wire that failed or retired, where it stopped
    [[nodiscard]] long step_count() const;
    [[nodiscard]] const WorldSetup& setup() const;
    [[nodiscard]] RodView rod(int wire) const;
    [[nodiscard]] WireReadings readings(int wire) const;
    /// Of the last step() or settle().
    [[nodiscard]] const WireReport& report(int wire) const;
    /// The wire stays as it is from now on: later steps leave it out. Not part of the saved state.
    void retire(int wire);
    [[nodiscard]] bool retired(int wire) const;
    [[nodiscard]] const std::vector<ContactRow>& contacts() const;  // all wires, fetched from the device on demand
    /// Contact force on each node of a wire [n] [N].
    [[nodiscard]] std::vector<Vec3> nodal_contact_force(int wire) const;
    /// True when the wire is at rest: static residual met or kinetic energy below tolerance (scene until = "rest").
    [[nodiscard]] bool at_rest() const;
    [[nodiscard]] bool at_rest(int wire) const;
    /// 64-bit FNV-1a over every byte of the final state, friction anchors included, as 16 hex digits.
    [[nodiscard]] std::string state_hash() const;
    /// The hash that this wire would have in a world of its own.
    [[nodiscard]] std::string state_hash(int wire) const;
    /// Every changing byte, for checkpoints; restore() needs a world made from the same setup.
    [[nodiscard]] std::vector<std::uint8_t> save_state() const;
    void restore_state(const std::vector<std::uint8_t>& bytes);
    /// What was on and why, one "name: value (reason)" per entry, for summary.json.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> model() const;
    [[nodiscard]] std::string device_name() const;
    /// All zero for a world without a vessel.
    [[nodiscard]] DeviceCounts device_counts() const;

    struct Impl;
    [[nodiscard]] Impl& impl() { return *impl_; }
    [[nodiscard]] const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// Advances every wire by dt [s]. Never throws for numerical trouble: see StepReport.
[[nodiscard]] StepReport step(World& world, double dt);

/// Static equilibrium of every wire (scheme = "static", and start = "settled").
[[nodiscard]] StepReport settle(World& world);

[[nodiscard]] std::vector<DeviceInfo> list_devices();

[[nodiscard]] const char* version();

}  // namespace seldinger
