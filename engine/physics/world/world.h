#pragma once
// Data of a World, in the order in which it comes about. Private to the engine: step.cpp and its stages read and write it, nobody
// else includes it (tests may).
//
//   model     setup, systems, groups, holds      constant from the constructor on
//   state     WorldState                         survives a step: saved, all but the audits hashed
//   forces    WorldForces, Solver                made once, with memory of their own that is saved with the state
//   work      StepWork                           of the present step, worth nothing after it
//   output    WorldOutput                        of the accepted state

#include "contact/edge_sums.h"
#include "contact/force_per_length.h"
#include "engine.h"
#include "newton/momentum.h"
#include "newton/solver.h"
#include "nodes/adapt.h"
#include "solve/constraints.h"
#include "solve/driven_hub.h"
#include "solve/feed.h"
#include "vessel/inside.h"
#include "contact/wall_body.h"
#include "world/carried.h"
#include "world/energy_audit.h"
#include "world/sub_steps.h"
#include "world/systems.h"
#include "world/world_forces.h"

#include <array>
#include <functional>

namespace seldinger {

struct MergedGroup;  // merged.h

/// The instruments that share one centreline, group by group.
struct MergedGroups {
    MergedGroups();
    ~MergedGroups();
    std::vector<std::unique_ptr<MergedGroup>> list;
    std::vector<int> place;            // [wires] in `list`; -1: a rod of its own
    std::vector<int> line;             // [wires] whose arrays hold its nodes; -1 likewise
    std::unique_ptr<RodArrays> shown;  // each instrument by itself; none without a group
    std::vector<int> shown_from;       // [wires] edge of the line that its tip is on

    [[nodiscard]] bool has(int wire) const { return place[wire] >= 0; }
    [[nodiscard]] MergedGroup* of(int wire) const { return has(wire) ? list[place[wire]].get() : nullptr; }
};

// ---- state

/// What of a wire survives a step, beside its arrays.
struct WireState {
    double time = 0;  // [s]; where its system failed or was retired, it stopped
    FeedState feed;
    HubState hub;                               // where a force drives it
    double remesh_energy = 0;                   // accumulated [J]
    std::vector<CarriedImpulse> carried, left;  // of the step before; of the present one
    EnergyAudit audit;
};

struct WorldState {
    explicit WorldState(std::span<const int> capacities) : rods(capacities), wires(capacities.size()) {}
    double time = 0;
    long steps = 0;
    RodArrays rods;
    std::vector<WireState> wires;

    [[nodiscard]] FeedState& feed(int wire) { return wires[wire].feed; }
    [[nodiscard]] const FeedState& feed(int wire) const { return wires[wire].feed; }
    /// Whether a wire is among those that are solved: one that is still in its introducer is not.
    [[nodiscard]] bool is_solved(int wire) const { return !feed(wire).on || feed(wire).inside; }
};

// ---- work

/// What a wire's nodes are adapted with.
struct NodeAdapter {
    bool on = false;  // nodes = "adaptive" and a detection that does not sit on the nodes
    NodePlanner planner;
    std::vector<double> kept;  // material distances whose nodes must stay: holds, loads, links [m]
};

/// What a control asks of a hub in this step.
struct HubRequest {
    std::array<FeedKey, 3> own{};   // where it is, is to be, and is thought to go on to: used unless `keys` are given
    std::span<const FeedKey> keys;  // of a path that is known beforehand
    // of a hub that a force drives: `own` has where it is thought to go, and `keys`, if any, have forces and turns
    bool driven = false;
    double force = 0, spring = 0, turn = 0;  // without keys: Control::push
    double from = 0, until = 0;              // where the hub is at the start of the step [m], when that ends [s]
    [[nodiscard]] HubPath path() const { return HubPath(keys.empty() || driven ? std::span<const FeedKey>(own) : keys); }
};

/// A driven hub in the present sub-step.
struct HubTrial {
    HubEquation equation;
    HubEquation::Answer answer;  // `at`: how far the hub goes [m]
    int trials = 0;              // 0: none yet
};

struct WireWork {
    HubRequest hub;
    std::vector<LoadSpec> loads;  // of the control
    HubTrial trial;
    NodeAdapter adapter;
    MomentumStart start;             // of the present sub-step
    std::vector<std::uint8_t> kept;  // what of the wire a failed attempt returns to
    std::vector<Vec3> nodal_backup;  // of WireResult::nodal_contact, while nodes are tried
    std::vector<double> mass, inertia;  // of a fed wire's nodes and edges before it is fed [capacity] [kg], [kg m^2]
};

struct StepWork {
    double length = 0;  // of the present step [s]
    std::vector<WireWork> wires;
    std::vector<StepParts> parts;  // per wire: sub-steps that feeding asks for
    SubSteps pending;
    // what the solver reads and writes, per wire
    std::vector<WireConstraints> constraints;
    std::vector<SolveReport> reports;
    std::vector<std::uint8_t> active, live;
    // of the rod whose nodes are being changed
    SplitScratch split;
    std::vector<std::uint8_t> bowed;  // ElasticContact::mark_bowed
    // a step that may be stopped
    std::function<bool()> stop_asked;      // empty: never
    std::vector<std::uint8_t> step_start;  // the whole state there, of a step of several sub-steps
    double solve_time = 0, adapt_time = 0, terms_in_solve = 0;  // [s]
};

// ---- output

/// Readings of a wire when its step was accepted.
struct WireResult {
    ContactTotals contact;
    double normal_between = 0;         // WireReadings::normal_between
    double overlap_share = 0;          // WireReadings::overlap_share
    Vec3 overlap_at = Vec3::Zero();    // [m]
    std::vector<Vec3> nodal_contact;   // [capacity] [N]
    double hand_force = 0, hand_torque = 0, hand_stiffness = 0;
    Vec3 base_force = Vec3::Zero();
    double kinetic = 0, elastic = 0, gravitational = 0;
    double residual = 0;
    MomentumBalance momentum;
};

struct WorldOutput {
    std::vector<WireResult> results;  // per wire
    std::vector<WireReport> reports;  // per wire, of the last step
    bool hand_stiffness_watched = false;
    // loads: what the samples of contact bear, per wire
    bool loads_known = false;  // of the present state
    std::vector<WireLoads> wall_loads, instrument_loads;
    std::vector<ContactRow> rows;                        // what contacts() last returned
    std::vector<ContactAlong> on_wall, on_instruments;   // what those come to
    // made when first asked for
    std::unique_ptr<CarriedMesh> wall_shape;
    std::unique_ptr<LumenQuery> lumen;  // audit_outside
};

struct WorldData {
    /// @param wall  the elastic wall of this setup, if there is one already
    explicit WorldData(WorldSetup from, std::shared_ptr<const WallBody> wall = {});

    WorldSetup setup;
    SystemList systems;
    MergedGroups groups;
    std::vector<WireHolds> holds;  // per wire
    WorldState state;
    WorldForces forces;
    std::unique_ptr<Solver> solver;
    StepWork work;
    WorldOutput output;

    void add_force(int instrument, std::shared_ptr<const Force> force);  // checked, and not yet in the setup
    [[nodiscard]] int wire_count() const { return state.rods.wire_count(); }
    /// The wire whose arrays hold the nodes of this one's rod (world_rod.h).
    [[nodiscard]] int line_of(int wire) const { return groups.has(wire) ? groups.line[wire] : wire; }
    [[nodiscard]] bool is_alone(int wire) const { return !groups.has(wire); }
    /// Whether it is that wire: alone in its rod, or the line of a group.
    [[nodiscard]] bool is_line(int wire) const { return line_of(wire) == wire; }
    [[nodiscard]] RodView rod(int wire) { return state.rods.view(wire); }
    /// An instrument by itself, from its own tip to the hub.
    [[nodiscard]] RodView shown(int wire) { return (groups.has(wire) ? *groups.shown : state.rods).view(wire); }
    /// Edge of its rod that its tip is on.
    [[nodiscard]] int shown_from(int wire) const { return groups.has(wire) ? groups.shown_from[wire] : 0; }
    [[nodiscard]] FeedState& feed(int wire) { return state.feed(wire); }
    [[nodiscard]] const FeedState& feed(int wire) const { return state.feed(wire); }
    /// Whether a force drives its hub (D16).
    [[nodiscard]] bool is_driven(int wire) const { return setup.wires[wire].feed.on && setup.wires[wire].feed.hub.driven(); }
    [[nodiscard]] EnergyAudit& audit(int wire) { return state.wires[wire].audit; }
    [[nodiscard]] WireConstraints& constraints(int wire) { return work.constraints[wire]; }
    [[nodiscard]] NodeAdapter& adapter(int wire) { return work.wires[wire].adapter; }
    [[nodiscard]] const NodeAdapter& adapter(int wire) const { return work.wires[wire].adapter; }
};

/// For step.cpp, for readings that renew the scratch of a group, and for tests that look inside.
[[nodiscard]] inline WorldData& data_of(const World& world) { return *world.data_; }

/// @throws Error BadScene: dt, the input of a hub, or a load. Nothing has changed then
void check_request(const WorldData& world, const Control& control, double dt);
/// @throws Error BadScene: no such instrument, or a place that is not on it [m]
void check_on_wire(const WorldData& world, int instrument, double at, const char* where, const char* what);

/// Whether nodes of a wire come and go by themselves (nodes = "adaptive").
[[nodiscard]] bool nodes_adapt(const WireSetup& setup);

/// A step ends where it is asked to (World::stop_when), or a force of the program has raised.
void watch_ends(WorldData& world);

// ---- world_state.cpp: the state, row by row (core/state_walk.h)

/// What a failed attempt returns to.
void keep_wire(WorldData& world, int wire);
void put_back_wire(WorldData& world, int wire);
void put_back_wires(WorldData& world, const WireMask& wires);
/// Everything that World::save_state() returns; put back unchecked.
void save_state(WorldData& world, std::vector<std::uint8_t>& to);
void put_back_saved(WorldData& world, std::span<const std::uint8_t> bytes);

/// Fills wall_loads and instrument_loads, once for each state.
void gather_loads(WorldData& world);

}  // namespace seldinger
