#pragma once
// The engine's energy balance (energy_balance.h): one audit per wire at the end of every sub-step, before it is accepted.
// Everything it needs is on the host when a sub-step ends, and costs a pass over the nodes.
//
// Work of one sub-step, by the forces that its equations hold at:
//   holds        reaction . move                     backward Euler: the end's; Newmark: mean of both ends; energy-momentum: the
//   clamps       torque . turn                       step's own reaction, and means of the readings at the ends; explicit: the
//   hand         dE/d(rest length) . length fed      start's reaction, as for holds
//   loads        force . move, moment . turn         the end's
//                                                    a path of equilibria: holds and clamps by means of both ends
//   links        pull . move                         backward Euler: the end's; else at the mean position
//   given forces Q . move (given_forces.h)           backward Euler: the end's; explicit: the start's; else means of both ends
//   residual     Newton's residual on the free unknowns . move: allowed within the tolerance. A linearised or explicit step and a best
//                effort are not exempt.
// In backward Euler each of these is the end value of a convex function's slope (a strain energy in length and rest length
// together, a contact spring in its depth). So energy plus work can only be lost, except where the potential is concave.
// Material brings in (1/2) rho A v^2 and its height per metre, as the masses of the base edge's nodes have them.
//
// The ledger (EnergyLedger) has the same numbers, and the losses that contact, damping and the scheme report. Backward Euler
// takes (1/2) m (v - v_0)^2 of the kinetic energy. It takes from the elastic energy the excess of its end force's work over the
// change: F(q) . (q - q_0) + dE/d(rest length) fed + dE/d(clamps' turn) turned - (E - E_0).
//
// Energy of splits and merges between sub-steps, elastic (`remesh_energy_j`), kinetic and of height, is logged separately.

#include "model.h"
#include "output.h"
#include "solve/energy_balance.h"
#include "solve/force_term.h"

#include <cstdint>
#include <vector>

namespace seldinger {

struct WorldData;  // world/world.h
class WorldRod;    // world/world_rod.h

struct EnergyAudit {
    EnergyBalance balance;
    bool known = false;  // the balance has begun
    EnergyLimits limits;

    // at the end of the last accepted sub-step, for means over the next one
    double moving = 0, remeshed = 0;       // kinetic + gravitational, logged by remeshing [J]
    double hand_force = 0, speed = 0;      // [N], of the feed [m/s]
    std::vector<double> held, held_speed;  // per prescribed unknown: reaction and velocity
    std::vector<double> torque, turns;  // per clamp [N m], [rad]; the former of a common centreline: merged_forces() of merged.h

    EnergyLedger ledger;
    double wire_then = 0, elastic_then = 0;  // energy in all, and elastic, at the end of the last accepted sub-step [J]

    // of the present sub-step
    EnergyBalance next;
    EnergyLedger next_ledger;
    EnergyInput fed;                                     // by feeding, and by splits and merges before it
    double remeshed_now = 0;                             // the second part of it [J]
    double kinetic = 0, elastic = 0, gravitational = 0;  // at its end [J]
    TermEnergies terms;                                  // likewise, of all of a common centreline
};

/// EnergyLimits::floor of a wire [J]: 0.1 % of the energy that lifts all of it by its own length and bends it to a radius of
/// that.
[[nodiscard]] double energy_floor(const WireSpec& wire, const Vec3& gravity);

/// Before a sub-step: changes of the wire by splits and merges since the last one.
void audit_remeshing(WorldData& world, int wire);

/// Before and after the feed has moved on by a sub-step.
class FeedingAudit {
public:
    explicit FeedingAudit(const WorldRod& rod);
    void after() const;

private:
    const WorldRod& rod_;
    bool inside_;
    int first_;  // node from which material changes: of one wire that before the hub
};

/// Of all wires, before the first step. Contacts of the initial placement are not known yet: with them, energies are counted from
/// the end of the first step.
void begin_audits(WorldData& world);
/// The wire as it has been placed, touching nothing, or at rest in an equilibrium that was just found: its energies are counted
/// from there.
void begin_audit(WorldData& world, int wire, bool placed);
/// Of a static run, at an equilibrium: work since the last one. The first is where the balance begins, if it has not begun.
void count_equilibrium(WorldData& world, int wire);
/// At the end of a sub-step of h [s] that the solver has taken. @return false: the wire has more energy than was put in
[[nodiscard]] bool energy_adds_up(WorldData& world, int wire, double h);
/// The same has been accepted.
void accept_energy(WorldData& world, int wire, double h);

}  // namespace seldinger
