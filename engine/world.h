#pragma once
// What a World owns. Private to the engine: step.cpp and the stages read and write it, nobody else includes it (tests may).

#include "contact/contact_system.h"
#include "device/device.h"
#include "energy_audit.h"
#include "engine.h"
#include "rod/adapt.h"
#include "solve/constraints.h"
#include "solve/feed.h"
#include "solve/solver.h"
#include "vessel/inside.h"

#include <optional>

namespace seldinger {

/// What was read off a wire when its step was accepted.
struct WireResult {
    ContactTotals contact;
    std::vector<Vec3> nodal_contact;  // [capacity] [N]
    double hand_force = 0, hand_torque = 0;
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

/// What contact is made from.
[[nodiscard]] ContactSetup contact_setup(const WorldSetup& setup, const WallModel& wall);

struct World::Impl {
    explicit Impl(WorldSetup from);

    WorldSetup setup;
    double time = 0;
    long steps = 0;
    std::vector<double> wire_time;             // per wire [s]; differs from `time` inside a halved step only
    std::unique_ptr<device::Context> context;  // none without a vessel
    RodArrays rods;
    std::vector<WireHolds> holds;            // per wire
    std::vector<FeedState> feeds;            // per wire
    std::vector<double> remesh_energy;       // per wire, accumulated [J]
    std::vector<EnergyAudit> audits;         // per wire
    std::vector<NodeAdapter> adapters;       // per wire; no state, only what it works with
    std::optional<WallModel> wall;           // none without a vessel
    std::unique_ptr<ContactMethod> contact;  // none without a vessel
    ForceTerms terms;                        // what acts on the wires: contact
    std::unique_ptr<Solver> solver;
    // scratch of a step
    std::vector<WireConstraints> constraints;
    std::vector<SolveReport> reports;
    std::vector<std::uint8_t> active, live;
    std::vector<std::uint8_t> retired;        // per wire: left out of every step
    std::vector<WireReport> wire_reports;     // per wire, of the present step
    std::vector<std::vector<double>> backup;  // per wire: its arrays before the step
    std::vector<FeedState> feed_backup;
    std::vector<int> parts;  // per wire, of advance()
    HubScratch hub_scratch;
    std::vector<int> count_backup;
    std::vector<double> time_backup;
    std::vector<Vec3> nodal_backup;                               // of the wire whose nodes are being changed
    std::vector<MomentumStart> momentum_start;                    // per wire, of the present sub-step
    std::vector<WireResult> results;                              // per wire
    std::vector<ContactRow> rows;                                 // what contacts() last returned
    double solve_time = 0, adapt_time = 0, contact_in_solve = 0;  // of the present step [s]

    std::unique_ptr<LumenQuery> lumen;  // made when first needed; see audit_outside

    [[nodiscard]] int wire_count() const { return rods.wire_count(); }
    void save_wire(int wire);
    void restore_wire(int wire);
    /// @param h  of the sub-step that was taken [s], 0: an equilibrium
    void read_results(int wire, double h);
    void put_wire(std::vector<std::uint8_t>& bytes, int wire) const;
    [[nodiscard]] std::vector<std::uint8_t> state_bytes() const;
};

}  // namespace seldinger
