// The check stage: non-finite values, axis points beyond the wall that detection could not see, and whether contact samples add up.

#include "world/step_stages.h"
#include "vessel/repair.h"
#include "world/world.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

// Published detection does not know on which side of the wall it is, and a sample that crosses a wall within one step has never
// touched it. With it the axis is looked up in the lumen itself, nodes and middles of edges. `swept` and slow capsules never need
// it (a sample that passes the wall has touched it before, and says so).
bool needs_audit(World::Impl& state, int wire, double dt)
{
    const Detection detection = state.setup.wires[wire].contact.detection;
    if (!state.wall || detection == Detection::Swept || !state.is_solved(wire)) return false;
    if (detection != Detection::Capsule) return state.steps % 10 == 0;
    const RodView rod = state.rods.view(wire);
    double fastest = 0;
    for (int i = 0; i < rod.n; ++i) fastest = std::max(fastest, rod.vel(i).norm());
    return fastest * dt > 0.5 * rod.radius[0];
}

void audit_outside(World::Impl& state, int wire)
{
    if (!state.lumen) {
        const bool open = state.setup.vessel.shape != VesselShape::Plane;  // a plane's edge is no opening
        state.lumen =
            std::make_unique<LumenQuery>(state.setup.mesh, open ? describe(state.setup.mesh).loops : std::vector<BoundaryLoop>{});
    }
    const RodView rod = state.rods.view(wire);
    if (state.yielding) state.yielding->carry_back(state.rods, wire);
    double& outside = state.results[wire].contact.outside;
    // where the wall was before it moved
    const RodView seen = state.unmoved_rods ? state.unmoved_rods->view(wire) : rod;
    const auto look = [&](const Vec3& p) {
        const LumenPlace place = state.lumen->locate(p);
        if (place.opening < 0) outside = std::max(outside, -place.signed_distance);
    };
    for (int j = 0; j + 1 < rod.n; ++j) {
        look(seen.pos(j));
        look((seen.pos(j) + seen.pos(j + 1)) / 2);
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
    const double all = r.hand_force + r.hand_torque + r.contact.normal + r.contact.friction + r.kinetic + r.elastic + r.gravitational;
    return std::isfinite(all) && r.base_force.allFinite();
}

/// The samples that readings are taken from against the forces that the solver balanced (contact/contact_sums.h).
bool samples_add_up(const World::Impl& state, int wire)
{
    const WireLoads &wall = state.wall_loads[wire], &others = state.instrument_loads[wire];
    return add_up(wall.normal + others.normal, wall.friction + others.friction, wall.samples.size() + others.samples.size(),
                  state.results[wire].contact, state.context && state.context->float32());
}

}  // namespace

void check_state(World::Impl& state, double dt, StepReport& report)
{
    state.time = *std::max_element(state.wire_time.begin(), state.wire_time.end());
    state.loads_known = false;
    state.gather_loads();
    for (int w = 0; w < state.wire_count(); ++w) {
        if (state.retired[w]) continue;
        if (!is_finite(state.rods.view(w)) || !is_finite(state.results[w])) note(state, report, w, StepNonFinite);
        // readings of a failed wire belong to another state than the one that was restored
        if (!state.wire_reports[w].failed() && !samples_add_up(state, w)) note(state, report, w, StepContactSums);
        if (needs_audit(state, w, dt)) audit_outside(state, w);
        if (state.yielding && state.yielding->move_share(state.system_of[w]) > 1)
            note(state, report, w, StepWallFar);
        if (state.results[w].contact.outside > 0) note(state, report, w, StepWallPenetration);
    }
}

}  // namespace seldinger
