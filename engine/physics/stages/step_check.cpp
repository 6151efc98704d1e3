// The check stage: non-finite values, axis points beyond the wall that detection could not see, and whether contact samples add
// up.
#include "contact/contact_sums.h"
#include "contact/wall_contact.h"
#include "device/device.h"
#include "repair/repair.h"
#include "stages/step_stages.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace seldinger {
namespace {

// Published detection does not know on which side of the wall it is, and a sample that crosses a wall within one step has never
// touched it. With it the axis is looked up in the lumen itself, nodes and middles of edges. `swept` never needs it
// (a sample that passes the wall has touched it before, and says so) but for explicit steps, whose length nothing limits, of fast
// wires. Contact with an elastic wall takes its displacement to
// be linear over a wire's edge and over a step. Where the wall has moved far, the axis is looked up beside the wall as it is.
bool needs_audit(WorldData& world, int wire, double dt, bool is_wall_far)
{
    const Detection detection = world.setup.wires[wire].contact.detection;
    if (!world.forces.wall || !world.state.is_solved(wire)) return false;
    if (is_wall_far) return true;
    if (detection != Detection::Swept) return world.state.steps % 10 == 0;
    if (world.setup.integrator.scheme != Scheme::Explicit) return false;
    const RodView rod = world.rod(wire);
    double fastest = 0;
    for (int i = 0; i < rod.n; ++i) fastest = std::max(fastest, rod.vel(i).norm());
    return fastest * dt > 0.5 * rod.radius[0];
}

void audit_outside(WorldData& world, int wire)
{
    if (!world.output.lumen) {
        const bool open = world.setup.vessel.shape != VesselShape::Plane;  // a plane's edge is no opening
        world.output.lumen =
            std::make_unique<LumenQuery>(world.setup.mesh, open ? describe(world.setup.mesh).loops : std::vector<BoundaryLoop>{});
    }
    std::vector<Vec3> places;  // beside the wall before it moved
    world.forces.wall_contact->list_seen(world.state.rods, wire, places);
    double& outside = world.output.results[wire].contact.outside;
    for (const Vec3& p : places) {
        const LumenPlace place = world.output.lumen->locate(p);
        if (place.opening < 0) outside = std::max(outside, -place.signed_distance);
    }
}

bool is_finite(const RodView& rod)
{
    for (int i = 0; i < rod.n; ++i)
        if (!std::isfinite(rod.x[i] + rod.y[i] + rod.z[i] + rod.vx[i] + rod.vy[i] + rod.vz[i])) return false;
    return true;
}

/// A reading can overflow where the state does not: whoever steps a world gets a flag instead of a NaN in a table.
bool is_finite(const WireResult& r)
{
    const double all =
        r.hand_force + r.hand_torque + r.contact.normal + r.contact.friction + r.kinetic + r.elastic + r.gravitational;
    return std::isfinite(all) && r.base_force.allFinite();
}

/// The samples that readings are taken from against the forces that the solver balanced (contact/contact_sums.h).
bool samples_add_up(const WorldData& world, int wire)
{
    const WireLoads &wall = world.output.wall_loads[wire], &others = world.output.instrument_loads[wire];
    return add_up(wall.normal + others.normal, wall.friction + others.friction, wall.samples.size() + others.samples.size(),
                  world.output.results[wire].contact, world.forces.context && world.forces.context->float32());
}

}  // namespace

void check_state(WorldData& world, double dt, StepReport& report)
{
    world.state.time = std::ranges::max_element(world.state.wires, {}, &WireState::time)->time;
    world.output.loads_known = false;
    gather_loads(world);
    for (int w = 0; w < world.wire_count(); ++w) {
        if (world.systems.is_retired(w)) continue;
        if (!is_finite(world.rod(w)) || !is_finite(world.output.results[w])) note(world, report, w, StepNonFinite);
        // readings of a failed wire belong to another state than the one that was restored
        if (!world.output.reports[w].failed() && !samples_add_up(world, w)) note(world, report, w, StepContactSums);
        // more than a fifth of the lumen's radius
        const bool is_wall_far = world.forces.wall_contact && world.forces.wall_contact->move_share(world.systems.of(w)) > 1;
        if (needs_audit(world, w, dt, is_wall_far)) audit_outside(world, w);
        if (is_wall_far) note(world, report, w, StepWallFar);
        if (world.output.results[w].contact.outside > 0) note(world, report, w, StepWallPenetration);
    }
}

}  // namespace seldinger
