#pragma once
// The public interface of the engine, and all that is installed. A World is made from a WorldSetup (model.h), gets a Control in
// every step (control.h), and is read as Output (output.h). No type of OpenCL, no private structure is seen here.
//
//     seldinger::World world(setup);
//     seldinger::Control control;
//     control.move_to(0, 0.05, 0.0);                         // push 5 cm in within this step
//     const seldinger::StepReport report = step(world, control, 1e-3);
//     const double force = world.readings(0).hand_force;     // [N]

#include "control.h"
#include "core/assertion.h"
#include "core/error.h"
#include "device/device_info.h"
#include "model.h"
#include "output.h"
#include "rod/rod_view.h"
#include "solve/force.h"
#include "task.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace seldinger {

/// Operations of the OpenCL device since the world was made.
struct DeviceCounts {
    std::uint64_t launches = 0, reads = 0, writes = 0, buffers_created = 0, programs_built = 0;
};

struct WorldData;    // the engine's own
struct SceneSource;  // likewise

class World {
public:
    /// @throws Error: a setup that contradicts itself or is out of range (one line that names the member), no usable device
    explicit World(WorldSetup setup);
    /// Another world of the same setup and forces, as it begins. It shares what is constant of an elastic wall: mesh, matrices,
    /// factors.
    [[nodiscard]] World twin() const;
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    [[nodiscard]] int wire_count() const;
    [[nodiscard]] int system_count() const;
    /// Which system an instrument belongs to.
    [[nodiscard]] int system_of(int wire) const;
    /// The instruments of a system: from the first up to, without it, the second number.
    [[nodiscard]] std::pair<int, int> wires_of(int system) const;
    [[nodiscard]] double time() const;
    [[nodiscard]] double time(int wire) const;  // of a wire that failed or retired, where it stopped
    [[nodiscard]] long step_count() const;
    [[nodiscard]] const WorldSetup& setup() const;

    /// Views of the accepted state, valid until the next step.
    [[nodiscard]] ConstRodView rod(int wire) const;
    [[nodiscard]] const std::vector<ContactRow>& contacts() const;  // all wires, fetched from the device on demand
    [[nodiscard]] WireReadings readings(int wire) const;
    /// From now on every step says in WireReadings::hand_stiffness how stiff its end is to the hand: one more solve of the step's
    /// own equations per fed wire. Changes no state.
    void watch_hand_stiffness();
    /// `asked` is called between the trials of Newton's method. When it returns true, the step ends there with StepStopped, and
    /// the state is that before the step, bit for bit. A step that is divided many times can take minutes. Not part of the saved
    /// state.
    void stop_when(std::function<bool()> asked);
    /// `due` is called between the trials of Newton's method. Once it returns true, the step ends with StepCutShort at the next
    /// trial that can be a state: contact admits it, holds are met, and the residual moves no node by more than its radius.
    /// The next step takes the forces that were left back, so momentum is late by a step and not lost. Part of the saved state
    /// where there are such forces; `due` is not. Instruments that share a centreline are always solved to the end.
    void cut_when(std::function<bool()> due);
    /// A force of the program acts on an instrument from the next step on (solve/force.h). Its state belongs to the saved and
    /// hashed one. @throws Error BadScene: no such instrument, no force, a place that is not on it, a state that is not finite
    void add_force(int instrument, std::shared_ptr<const Force> force);
    /// Readings of the wall that a system moves; zeros for a rigid wall. Stresses take a millisecond or so. Between a restored
    /// state and the next step stress is without what the mesh cuts off under the instruments (wall/wall_resolution.h).
    [[nodiscard]] WallReadings wall_readings(int system = 0) const;
    [[nodiscard]] WallMechanics wall_mechanics() const;
    /// How far the finite length of a wire's edges has its tip from its position, estimated from its shape (nodes/adapt.h) [m].
    [[nodiscard]] double node_error(int wire) const;
    /// Bending energy of a wire, and how far the finite length of its edges has it from that of a smooth one (nodes/adapt.h).
    /// Zeros for an instrument without nodes, because it shares another's centreline.
    [[nodiscard]] BendingError bending_error(int wire) const;
    /// How the last step() or settle() went.
    [[nodiscard]] const WireReport& report(int wire) const;
    /// Contact force on each node of a wire [n] [N].
    [[nodiscard]] std::vector<Vec3> nodal_contact_force(int wire) const;
    /// True when the wire is at rest: static residual met or kinetic energy below tolerance (scene until = "rest").
    [[nodiscard]] bool at_rest() const;
    [[nodiscard]] bool at_rest(int wire) const;
    /// A copy. @param parts  of Output::Parts   @param into  reused: no allocation once it has held as much
    void read(Output& into, unsigned parts = Output::Everything) const;
    [[nodiscard]] Output output(unsigned parts = Output::Everything) const;
    /// Output::Loads of one wire. Cheap enough for every step.
    void read_loads(int wire, WireOutput& into) const;

    /// Freezes a system: later steps leave it out, until its state is restored alone. Not part of the saved state.
    void retire(int system);
    [[nodiscard]] bool retired(int system) const;

    /// 64-bit FNV-1a over every byte of the final state, friction anchors included, as 16 hex digits.
    [[nodiscard]] std::string state_hash() const;
    /// Hash of one system, equal to state_hash() of a world that has this system only.
    [[nodiscard]] std::string state_hash(int system) const;
    /// Every changing byte, for checkpoints; restore() needs a world made from the same setup.
    [[nodiscard]] std::vector<std::uint8_t> save_state() const;
    /// @throws Error BadFile: not the state of such a world. The world is then unchanged
    void restore_state(const std::vector<std::uint8_t>& bytes);
    /// The same of one system, whatever else is in the world: it continues bit for bit as it did after save_state(system), from
    /// its own time then. @throws Error BadFile: not the state of such a system. The world is then unchanged
    [[nodiscard]] std::vector<std::uint8_t> save_state(int system) const;
    void restore_state(int system, const std::vector<std::uint8_t>& bytes);

    /// Choices of the model and why they were made, one "name: value (reason)" per entry, for summary.json.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> model() const;
    [[nodiscard]] std::string device_name() const;
    /// All zero for a world without a vessel.
    [[nodiscard]] DeviceCounts device_counts() const;

private:
    explicit World(std::unique_ptr<WorldData> data);
    friend WorldData& data_of(const World& world);  // world/world.h
    std::unique_ptr<WorldData> data_;
};

/// Advances every system by dt [s]. Numerical failure is reported in the StepReport, never thrown.
/// @throws Error: dt is not a positive number, or the control is impossible (no such instrument, one that is not fed, a value
/// that is not finite or not on the wire). The world is then unchanged
[[nodiscard]] StepReport step(World& world, const Control& control, double dt);
/// The same without a control: every hub stays where it is.
[[nodiscard]] StepReport step(World& world, double dt);

/// Static equilibrium of every system (scheme = "static", and start = "settled").
/// @param passed  called at each equilibrium on a system's path but the last, with the system and the time of its keys [s]; the
/// world may be read then
[[nodiscard]] StepReport settle(World& world, const std::function<void(int system, double time)>& passed = {});

/// Reads or generates what setup.vessel describes, repairs it, and sets setup.mesh and setup.centreline. @throws Error BadFile,
/// BadScene
void load_vessel(WorldSetup& setup);

/// A scene file for a program that links the library.
struct LoadedScene {
    WorldSetup setup;
    std::vector<std::vector<FeedKey>> keys;  // of each hub: control.follow(k, scene.keys[k]); empty: it is not fed
    double dt = 0, duration = 0;             // [s]
    TaskSpec task;                           // task.on: whether the scene has a [task]
    std::shared_ptr<const SceneSource> source;  // for a Recording (record/recording.h)
};

/// Reads a scene (docs/scene-file.md) and loads its vessel. @param file  or the name of a scene that comes with the program,
/// "aortic-arch"
/// @param overrides  as of --set, "table.key=value"  @throws Error BadFile, BadScene
[[nodiscard]] LoadedScene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

[[nodiscard]] std::vector<DeviceInfo> list_devices();

[[nodiscard]] const char* version();

}  // namespace seldinger
