// Readings of the accepted state of a sub-step: contact, hands, energies, momentum.
#include "contact/contact_system.h"
#include "contact/rods/instrument_contact.h"
#include "stages/step_stages.h"

#include <algorithm>

namespace seldinger {
namespace {

/// Tangent of the wire at its hub, from tip to hub, to second order in the edge length. It is the clamp's direction, else that of
/// the edge's middle, turned on by half an edge of the curvature next to it.
Vec3 hub_tangent(const RodView& rod, std::span<const RodClamp> clamps)
{
    const int hub = rod.n - 1;
    for (const RodClamp& clamp : clamps)
        if (clamp.node == hub && clamp.direction) return clamp.tangent;
    const Vec3 last = rod.tangent(hub - 1);
    if (rod.n < 3) return last;
    const double onward = 0.5 * rod.rest_length[hub - 1] / rod.voronoi_length(hub - 1);
    return (last + onward * (last - rod.tangent(hub - 2))).normalized();
}

/// Where the deepest overlap with the wall is, and how much of the wire that is.
void read_overlap(WireResult& result, const RodView& rod)
{
    const int edge = result.contact.deepest;
    result.overlap_share = 0;
    if (edge < 0 || edge > rod.n - 2 || !(result.contact.depth > 0)) return;
    result.overlap_share = result.contact.depth / rod.radius[edge];
    result.overlap_at = (rod.pos(edge) + rod.pos(edge + 1)) / 2;
}

/// Removes the readings and keeps the memory.
void clear(WireResult& result)
{
    std::vector<Vec3> forces = std::move(result.nodal_contact);
    result = {};
    result.nodal_contact = std::move(forces);
    std::ranges::fill(result.nodal_contact, Vec3::Zero());
}

/// Contact of an instrument. @param line  whose nodes its forces are on
void read_contact(WorldData& world, int wire, const RodView& line)
{
    WireResult& result = world.output.results[wire];
    const std::span<Vec3> forces = std::span(result.nodal_contact).first(static_cast<std::size_t>(line.n));
    if (world.forces.contact) {
        result.contact = world.forces.contact->totals(wire);
        read_overlap(result, line);
        world.forces.wall_contact->add_nodal_forces(wire, forces);
    }
    if (!world.forces.instruments) return;
    const ContactTotals between = world.forces.instruments->totals(wire);
    result.contact += between;
    result.normal_between = between.normal;
    world.forces.instruments->add_nodal_forces(wire, forces);
}

/// Energies and momentum. @param contact_force  on the nodes [N]
void read_motion(WorldData& world, int wire, std::span<const Vec3> contact_force, double h)
{
    WireResult& result = world.output.results[wire];
    if (world.setup.integrator.scheme == Scheme::Static) count_equilibrium(world, wire);
    else if (h == 0) begin_audit(world, wire, false);
    result.kinetic = world.audit(wire).kinetic;
    result.elastic = world.audit(wire).elastic;
    result.gravitational = world.audit(wire).gravitational;
    result.momentum =
        world.solver->momentum_balance(wire, world.constraints(wire), contact_force, world.work.wires[wire].start, h);
}

Vec3 force_at_hub(WorldData& world, int wire)
{
    const int hub = world.state.rods.node_count(wire) - 1;
    Vec3 force;
    for (int k = 0; k < 3; ++k) force[k] = world.solver->reaction(wire, RodDofs::position(hub, k));
    return force;
}

/// Force and torque of the hand at a wire's hub.
void read_hand(WorldData& world, int wire)
{
    WireResult& result = world.output.results[wire];
    const RodView rod = world.rod(wire);
    const std::vector<RodClamp>& clamps = world.constraints(wire).clamps;
    result.hand_torque = 0;
    for (std::size_t c = 0; c < clamps.size(); ++c)
        if (clamps[c].node == rod.n - 1 && clamps[c].spin)
            result.hand_torque = -clamp_torque(rod, clamps, world.solver->frames(wire), static_cast<int>(c));
    if (world.feed(wire).on)
        result.hand_force =
            feed_force(rod, world.setup.wires[wire].wire, clamps, world.solver->frames(wire), world.setup.gravity) +
            world.solver->base_tension_excess(wire);
    else
        result.hand_force = -result.base_force.dot(hub_tangent(rod, clamps));
}

}  // namespace

// Energies and momentum are the line's, contacts and hands each instrument's own.
void read_results(WorldData& world, int line, double h)
{
    if (!world.is_line(line)) return;
    const WorldRod rod(world, line);
    const bool solved = world.state.is_solved(line);
    for (const int w : rod.wires()) {
        WireResult& result = world.output.results[w];
        const double stiffness = result.hand_stiffness;
        clear(result);
        if (!solved) continue;
        result.hand_stiffness = stiffness;  // until it is read anew
        result.residual = world.work.reports[w].residual;
        read_contact(world, w, rod.view());
    }
    if (!solved) return;
    WireResult& result = world.output.results[line];
    result.base_force = force_at_hub(world, line);
    if (rod.wires().size() > 1) read_hands(rod);
    else read_hand(world, line);
    read_motion(world, line, rod.contact(), h);
    result.momentum.held += world.audit(line).terms.applied_force;
    result.momentum.loads += world.audit(line).terms.given_force;
}

std::pair<double, double> hand_answer(WorldData& world, int wire)
{
    const WorldRod rod(world, world.line_of(wire));
    if (!world.state.is_solved(rod.line())) return {0, 0};
    if (rod.wires().size() > 1) read_hands(rod);
    else read_hand(world, wire);
    read_hand_stiffness(world, rod.line());
    return {world.output.results[wire].hand_force, world.output.results[rod.line()].hand_stiffness};
}

// hand_force is H = -EA e (1 + e/2), e = l/s - 1 the strain of the base edge of rest length s. Feeding raises s, and the node
// before the hub answers: dH/ds = c l/s - c^2 t.(A^-1 t), c = EA l/s^2, A the step's tangent, t the edge's direction. The
// curvature of the hub's cell, whose length is s too, is neglected: its part is B kappa^2/s, at most 0.1 % of EA/s.
void read_hand_stiffness(WorldData& world, int wire)
{
    double& stiffness = world.output.results[wire].hand_stiffness;
    if (!world.feed(wire).on || !world.feed(wire).inside) return void(stiffness = 0);
    if (world.work.reports[wire].iterations == 0) return;  // nothing was factorised: what was said last holds
    const RodView rod = world.rod(wire);
    const int base = rod.n - 2;
    const Vec3 edge = rod.pos(base + 1) - rod.pos(base);
    const double rest = rod.rest_length[base], length = edge.norm();
    const double pull = rod.stretch_stiffness[base] * length / (rest * rest);
    const double give = world.solver->compliance(wire, base, edge / length);
    stiffness = std::max(0.0, pull * (length / rest - pull * give));
}

}  // namespace seldinger
