#pragma once
// Readings of a world after a step: how the step went, numbers per instrument, and a copy of its state that outlives it.

#include "contact/contact_row.h"
#include "contact/force_per_length.h"
#include "core/stage_times.h"
#include "solve/hub_readings.h"
#include "solve/momentum_balance.h"
#include "wall/wall_readings.h"

#include <string>
#include <vector>

namespace seldinger {

/// Flags of a step; each says which setting to change.
enum StepFlag : unsigned {
    StepOk = 0,
    StepHalved = 1u << 0,        // tolerance not met in the iteration budget; sub-steps taken: fine unless frequent (scene.dt_s)
    StepNotConverged = 1u << 1,  // no state could be found even for the smallest sub-step; the state before it was kept
    StepWallFar =
        1u << 2,  // the wall has moved by more than a fifth of the lumen's radius, or its large displacements did not settle
    StepWallPenetration = 1u << 3,  // a point of the axis is beyond the wall: contact.detection = "swept"
    StepNonFinite = 1u << 4,        // not finite: the state (that before the step was kept), or a reading of it
    StepBestEffort =
        1u << 5,            // smallest sub-step missed the tolerance, its last accepted iterate was taken: scene.dt_s, friction
    StepEnergy = 1u << 6,   // the wire has more energy than was put in (solve/energy_balance.h), in short sub-steps too; the
                            // state before was kept: backward Euler (no integrator.beta, no gamma), scheme = "newton", scene.dt_s
    StepStopped = 1u << 8,  // ended from outside (World::stop_when): the state is that before the step
    StepCutShort = 1u << 9,      // ended before its equations held, because its time was up (World::cut_when)
    StepWallBuckles = 1u << 10,  // with StepNotConverged: the elastic wall has no stable state in the smallest sub-step:
                                 // vessel.pressure_pa, support_pa_m, rims
    StepContactSums = 1u << 7,  // contact samples do not add up to the forces on the nodes (contact/contact_sums.h): do not trust
                                // readings of contact in this step, and report it
};

/// How one instrument fared in a step.
struct WireReport {
    unsigned flags = StepOk;
    int newton_iterations = 0;  // of the worst sub-step
    int sub_steps = 1;
    [[nodiscard]] bool failed() const { return flags & (StepNotConverged | StepNonFinite | StepEnergy); }
};

/// The worst of all instruments, all flags together.
struct StepReport {
    unsigned flags = StepOk;
    int newton_iterations = 0;
    int sub_steps = 1;
    StageTimes times;
    [[nodiscard]] bool failed() const { return flags & (StepNotConverged | StepNonFinite | StepEnergy); }
};

/// Energy balance of one instrument since it was placed or has left the introducer for the first time [J]. What goes out again
/// takes its energy along as material. With backward Euler and scheme "newton" each term is computed independently, and open() is
/// the residual; else `scheme` is the residual and open() is 0.
struct EnergyLedger {
    // in
    double hand = 0;      // feeding and turning
    double outside = 0;   // holds, loads, links
    double forces = 0;    // of the program (World::add_force)
    double material = 0;  // that was fed brings its height and speed along
    double remesh = 0;    // gained by changes of the nodes
    // there
    double wire = 0;  // more kinetic, elastic and gravitational energy than at first
    // out
    double friction = 0;  // sliding, and what stuck contacts hold; with rolling
    double contact = 0;   // normal forces: what overlaps hold, and their damping
    double wall = 0;      // done on an elastic wall: what it stores and dissipates
    double damping = 0;   // integrator.damping_*
    double scheme = 0;    // numerical dissipation of backward Euler

    [[nodiscard]] double in() const { return hand + outside + forces + material + remesh; }
    [[nodiscard]] double out() const { return friction + contact + wall + damping + scheme; }
    [[nodiscard]] double open() const { return in() - wire - out(); }
};

/// Numbers of one instrument in the accepted state.
struct WireReadings {
    double inserted = 0;  // advance since the start [m]
    double turned = 0;    // by the feed, right-handed about the direction of insertion [rad]
    int nodes = 0, contacts = 0;
    double contact_length = 0;                                   // metres of wire in contact
    double normal = 0, friction = 0, sliding = 0, sticking = 0;  // sums of magnitudes [N]
    double normal_between = 0;                                   // part of `normal`: instruments on each other [N]
    double rolling = 0;                                          // sum of |moment| [N m]
    double hand_force = 0, hand_torque = 0;  // along the wire, + pushes [N]; about it, + as `turned` [N m]
    double hand_stiffness = 0;  // how hand_force grows per length pushed in within the step, where watched [N/m] >= 0
    Vec3 base_force = Vec3::Zero();
    double overlap = 0;                                  // deepest overlap [m] >= 0
    double overlap_share = 0;                            // of the wire's radius there, of overlaps with the wall [-]
    Vec3 overlap_at = Vec3::Zero();                      // where that is, on the wire [m]
    double outside = 0;                                  // farthest axis point beyond the wall [m] >= 0
    double kinetic = 0, elastic = 0, gravitational = 0;  // [J]
    double force_energy = 0;                             // potential, of forces of the program that tell it [J]
    double remesh_energy = 0;                            // accumulated [J]
    double energy_made = 0;                              // most that no work accounts for (energy_balance.h) [J]
    double force_residual = 0;                           // largest left on a free node [N]
    EnergyLedger energy;
    HubReadings hub;           // zeros where no force drives it
    MomentumBalance momentum;  // of the last sub-step
};

/// What a sensor last measured (Force::record).
struct SensorOutput {
    std::string name;
    std::vector<std::string> columns;
    std::vector<double> values;
};

/// One instrument, copied. Arrays are per node, tip first.
struct WireOutput {
    WireReadings readings;
    WireReport report;
    double time = 0;  // its simulated time; of one that failed or was retired, when it stopped [s]
    bool at_rest = false, retired = false;
    Vec3 tip = Vec3::Zero();  // [m]
    std::vector<SensorOutput> sensors;
    // Output::Contacts; contact/loads/contact_patch.h
    double contact_area = 0;          // sum over its contacts [m^2]
    double contact_pressure_max = 0;  // of one of them [Pa]
    // Output::Contacts; of Output::Loads per_length_max and patch_force with their places; contact/force_per_length.h
    ContactAlong on_wall, on_instruments;
    // Output::Shape
    std::vector<double> material_s;   // arc length from the tip along the unstressed wire [m]
    std::vector<double> radius;       // of the edge that begins there [m]
    std::vector<double> curvature;    // |kb| per Voronoi length, 0 at the ends [1/m]
    std::vector<double> spin;         // of the material frame, right-handed about the direction of insertion [rad]
    std::vector<Vec3> director;       // first one of the material frame, unit
    std::vector<Vec3> position;       // [m]
    std::vector<Vec3> velocity;       // [m/s]
    std::vector<Vec3> contact_force;  // [N]
};

/// The wall of one system, copied.
struct WallOutput {
    WallReadings readings;
    // Output::WallShape; empty of a rigid wall
    std::vector<Vec3> displacement;  // of the vertices of WorldSetup::mesh [m]
    std::vector<double> stress;      // there: von Mises, the larger of both surfaces [Pa]
};

/// A copy of all readings, independent of its world: for a recorder, a picture, another thread.
struct Output {
    enum Parts : unsigned {
        Numbers = 0,
        Shape = 1u << 0,
        Contacts = 1u << 1,
        Wall = 1u << 2,       // readings of elastic walls
        WallShape = 1u << 3,  // and where they are
        Loads = 1u << 4,      // greatest loads of contact along each wire, without its rows; of Contacts, too
        WallUnder =
            1u << 5,  // of elastic walls the largest displacement and stress under the instruments; of Wall, those of all of it
        Everything = Shape | Contacts | Wall | WallShape
    };
    double time = 0;  // [s]
    long step = 0;
    unsigned parts = Numbers;          // that were read
    std::vector<WireOutput> wires;     // in the order of WorldSetup::wires
    std::vector<WallOutput> walls;     // Wall: of each system
    std::vector<ContactRow> contacts;  // Contacts; sorted by (wire, edge, triangle)
};

}  // namespace seldinger
