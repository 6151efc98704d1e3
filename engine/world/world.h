#pragma once
// Data of a World. Private to the engine: step.cpp and its stages read and write it, nobody else includes it (tests may).
//
//   model     setup, wall, holds, adapters       constant from the constructor on
//   state     rods, feeds, wire_time, contact's and solver's memory, remesh_energy, audits      saved; all but audits hashed
//   control   hub_requests                       of the present step
//   output    results, wire_reports, rows        of the accepted state

#include "world/carried.h"
#include "contact/contact_sums.h"
#include "contact/instrument_contact.h"
#include "contact/yielding_wall.h"
#include "device/device.h"
#include "world/energy_audit.h"
#include "engine.h"
#include "rod/adapt.h"
#include "solve/constraints.h"
#include "solve/feed.h"
#include "solve/momentum.h"
#include "solve/solver.h"
#include "world/sub_steps.h"
#include "vessel/inside.h"
#include "wall/wall_shape.h"

#include <array>
#include <functional>
#include <optional>

namespace seldinger {

class CoaxialFriction;  // contact/coaxial_friction.h
class LineHolds;        // solve/line_holds.h
struct MergedGroup;     // merged.h

/// Readings of a wire when its step was accepted.
struct WireResult {
    ContactTotals contact;
    double normal_between = 0;           // WireReadings::normal_between
    double overlap_share = 0;            // WireReadings::overlap_share
    Vec3 overlap_at = Vec3::Zero();      // [m]
    std::vector<Vec3> nodal_contact;  // [capacity] [N]
    double hand_force = 0, hand_torque = 0, hand_stiffness = 0;
    Vec3 base_force = Vec3::Zero();
    double kinetic = 0, elastic = 0, gravitational = 0;
    double residual = 0;
    MomentumBalance momentum;
};

/// What a wire's nodes are adapted with.
struct NodeAdapter {
    bool on = false;  // nodes = "adaptive" and a detection that does not sit on the nodes
    NodePlanner planner;
    std::vector<double> kept;  // material distances whose nodes must stay: holds, loads, links [m]
    RodFrames frames;          // scratch
};

/// What a control asks of a hub in this step.
struct HubRequest {
    std::array<FeedKey, 3> own{};   // where it is, is to be, and is thought to go on to: used unless `keys` are given
    std::span<const FeedKey> keys;  // of a path that is known beforehand
    [[nodiscard]] HubPath path() const { return HubPath(keys.empty() ? std::span<const FeedKey>(own) : keys); }
};

/// What contact is made from.
[[nodiscard]] ContactSetup contact_setup(const WorldSetup& setup, const WallModel& wall);
[[nodiscard]] InstrumentSetup instrument_setup(const WorldSetup& setup, std::span<const int> system_of);

struct World::Impl {
    explicit Impl(WorldSetup from);
    ~Impl();
    void divide_into_systems();

    WorldSetup setup;
    std::vector<int> wire_list;     // 0, 1, 2, ...: instruments in the order of their systems
    std::vector<int> system_begin;  // [systems + 1] in wire_list
    std::vector<int> system_of;     // per wire
    double time = 0;
    long steps = 0;
    std::vector<double> wire_time;             // per wire [s]; where a system failed or was retired, it stopped
    std::unique_ptr<device::Context> context;  // none without a vessel and without instruments that touch
    RodArrays rods;
    std::vector<WireHolds> holds;               // per wire
    std::vector<FeedState> feeds;               // per wire
    std::vector<HubRequest> hub_requests;       // per wire
    std::vector<double> remesh_energy;          // per wire, accumulated [J]
    std::vector<std::vector<CarriedImpulse>> carried, left;  // per wire: of the step before; of the present one
    std::vector<EnergyAudit> audits;            // per wire
    std::vector<std::unique_ptr<MergedGroup>> merged;  // instruments that share one centreline
    std::vector<int> merged_of;                        // per wire: place in `merged`, -1: a rod of its own
    std::vector<NodeAdapter> adapters;          // per wire; no state, only what it works with
    std::optional<WallModel> wall;              // none without a vessel
    std::unique_ptr<ElasticWall> elastic_wall;  // only of a vessel that yields, and so what is next
    std::unique_ptr<RodArrays> unmoved_rods;    // the wires as the wall sees them where it has not moved
    std::unique_ptr<ContactMethod> contact;     // none without a vessel
    std::unique_ptr<YieldingWall> yielding;     // contact as it acts on the wires and the moving wall
    std::unique_ptr<InstrumentContact> instruments;  // of those that can touch each other
    std::unique_ptr<CoaxialFriction> coaxial_friction;  // between those that share a centreline
    std::unique_ptr<LineHolds> line_holds;              // of instruments that share a centreline; none without
    ForceTerms terms;                           // what acts on the wires: contact, friction
    std::unique_ptr<Solver> solver;
    // scratch of a step
    std::vector<WireConstraints> constraints;
    std::vector<SolveReport> reports;
    std::vector<std::uint8_t> active, live;
    std::vector<std::uint8_t> retired;        // per wire: its system is left out of every step
    std::vector<WireReport> wire_reports;     // per wire, of the last step
    std::vector<std::vector<std::uint8_t>> kept;  // per wire: what of it a failed attempt returns to
    std::vector<StepParts> parts;  // per wire: sub-steps that feeding asks for
    SubSteps pending;
    HubScratch hub_scratch;
    std::vector<Vec3> nodal_backup;                             // of the wire whose nodes are being changed
    std::vector<std::uint8_t> bowed;                            // likewise, see YieldingWall::note_bowed
    std::vector<MomentumStart> momentum_start;                  // per wire, of the present sub-step
    std::vector<WireResult> results;                            // per wire
    std::vector<ContactRow> rows;                               // what contacts() last returned
    std::vector<ContactAlong> on_wall, on_instruments;          // per wire: what those come to
    std::vector<WireLoads> wall_loads, instrument_loads;        // per wire: what the samples of contact bear
    bool loads_known = false;                                   // of the present state
    bool hand_stiffness_watched = false;
    std::function<bool()> stop_asked;       // whether to end the present step; empty: never
    std::vector<std::uint8_t> step_start;   // the whole state there, of a step of several sub-steps that may be ended
    double step_length = 0;                 // of the present step [s]
    double solve_time = 0, adapt_time = 0, terms_in_solve = 0;  // of the present step [s]

    std::unique_ptr<RodArrays> shown;  // of instruments that share a centreline, each by itself; none without
    std::vector<int> shown_from;       // per wire: edge of the line that its tip is on
    std::unique_ptr<WallShape> wall_shape;  // made when first asked for
    std::unique_ptr<LumenQuery> lumen;      // made when first needed; see audit_outside

    [[nodiscard]] int wire_count() const { return rods.wire_count(); }
    [[nodiscard]] int system_count() const { return static_cast<int>(system_begin.size()) - 1; }
    [[nodiscard]] std::span<const int> wires_of(int system) const
    {
        return std::span(wire_list).subspan(system_begin[system], system_begin[system + 1] - system_begin[system]);
    }
    /// Whether a wire is among those that are solved: one that is still in its introducer is not.
    [[nodiscard]] bool is_solved(int wire) const { return !feeds[wire].on || feeds[wire].inside; }
    [[nodiscard]] MergedGroup* group_of(int wire) { return merged_of[wire] < 0 ? nullptr : merged[merged_of[wire]].get(); }
    /// Whether its nodes are those of another one, the line of its group.
    [[nodiscard]] bool is_passenger(int wire) const;
    void make_groups();
    void make_coaxial_friction();
    void make_line_holds();
    /// A system with one instrument in the mask is in it with all of them, as far as it takes part.
    void spread_over_systems(const WireMask& part, WireMask& mask) const;
    /// Whether a wire on its present nodes is clear of the wall; asked where the law never overlaps.
    [[nodiscard]] bool is_clear(int wire);
    /// What a failed attempt returns to.
    void keep_wire(int wire);
    void put_back_wire(int wire);
    /// @param h  of the sub-step that was taken [s], 0: an equilibrium
    void read_results(int wire, double h);
    /// Fills wall_loads and instrument_loads, once for each state.
    void gather_loads();
    /// After it, where hand stiffness is watched.
    void read_hand_stiffness(int wire);
    void read_merged(int wire, double h);
    // What must survive a step, row by row (core/state_walk.h): of one wire, of wires with what their force terms hold, of the
    // world. Audits affect no motion, and are not hashed.
    void walk_wire(StateWalk& walk, int wire);
    void walk_wires(StateWalk& walk, std::span<const int> wires, bool with_audits);
    void walk_all(StateWalk& walk, bool with_audits);
    /// Everything that World::save_state() returns, put back unchecked.
    void put_back(std::span<const std::uint8_t> bytes);
};

/// @throws Error BadScene: dt, or the input of a hub. Nothing has changed then
void check_request(const World::Impl& state, const Control& control, double dt);

/// Whether nodes of a wire come and go by themselves (nodes = "adaptive").
[[nodiscard]] bool nodes_adapt(const WireSetup& setup);

}  // namespace seldinger
