// Reading a world: values of the accepted state of a sub-step, and their form for the user.

#include "world/merged.h"
#include "rod/adapt.h"
#include "rod/curvature.h"
#include "rod/place.h"
#include "solve/line_holds.h"
#include "world/world.h"
#include "wall/wall_compliance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

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

}  // namespace

namespace {

/// Where the deepest overlap with the wall is, and how much of the wire that is.
void read_overlap(WireResult& result, const RodView& rod)
{
    const int edge = result.contact.deepest;
    result.overlap_share = 0;
    if (edge < 0 || edge > rod.n - 2 || !(result.contact.depth > 0)) return;
    result.overlap_share = result.contact.depth / rod.radius[edge];
    result.overlap_at = (rod.pos(edge) + rod.pos(edge + 1)) / 2;
}

/// The wall's forces on the nodes of a wire, as the wire feels them.
void add_wall_forces(const World::Impl& state, int wire, std::span<Vec3> forces)
{
    if (state.yielding) state.yielding->add_nodal_forces(wire, forces);
    else state.contact->add_nodal_forces(wire, forces);
}

}  // namespace

void World::Impl::read_results(int wire, double h)
{
    if (merged_of[wire] >= 0) return read_merged(wire, h);
    WireResult& result = results[wire];
    const RodView rod = rods.view(wire);
    std::fill(result.nodal_contact.begin(), result.nodal_contact.end(), Vec3::Zero());
    result.contact = {};
    result.normal_between = result.overlap_share = 0;
    if (feeds[wire].on && !feeds[wire].inside) {
        result.hand_force = result.hand_torque = result.hand_stiffness = result.kinetic = result.elastic = result.gravitational = result.residual = 0;
        result.base_force = Vec3::Zero();
        result.momentum = {};
        return;
    }
    if (contact) {
        result.contact = contact->totals(wire);
        read_overlap(result, rods.view(wire));
        add_wall_forces(*this, wire, std::span(result.nodal_contact).first(rod.n));
    }
    if (instruments) {
        result.contact += instruments->totals(wire);
        result.normal_between = instruments->totals(wire).normal;
        instruments->add_nodal_forces(wire, std::span(result.nodal_contact).first(rod.n));
    }
    const int hub = rod.n - 1;
    for (int k = 0; k < 3; ++k) result.base_force[k] = solver->reaction(wire, RodDofs::position(hub, k));
    const std::vector<RodClamp>& clamps = constraints[wire].clamps;
    result.hand_torque = 0;
    for (std::size_t c = 0; c < clamps.size(); ++c)
        if (clamps[c].node == hub && clamps[c].spin)
            result.hand_torque = -clamp_torque(rod, clamps, solver->frames(wire), static_cast<int>(c));
    result.hand_force = feeds[wire].on
                            ? feed_force(rod, clamps, solver->frames(wire), setup.gravity) + solver->base_tension_excess(wire)
                            : -result.base_force.dot(hub_tangent(rod, clamps));
    if (h == 0 || setup.integrator.scheme == Scheme::Static) begin_audit(*this, wire, false);
    result.kinetic = audits[wire].kinetic;
    result.elastic = audits[wire].elastic;
    result.gravitational = audits[wire].gravitational;
    result.residual = reports[wire].residual;
    result.momentum = momentum_balance(rod, constraints[wire], *solver, wire, setup.integrator, setup.gravity,
                                       result.nodal_contact, momentum_start[wire], h);
}

// hand_force is H = -EA e (1 + e/2), e = l/s - 1 the strain of the base edge of rest length s. Feeding raises s, and the node
// before the hub answers: dH/ds = c l/s - c^2 t.(A^-1 t), c = EA l/s^2, A the step's tangent, t the edge's direction. The curvature
// of the hub's cell, whose length is s too, is neglected: its part is B kappa^2/s, at most 0.1 % of EA/s.
void World::Impl::read_hand_stiffness(int wire)
{
    double& stiffness = results[wire].hand_stiffness;
    if (!feeds[wire].on || !feeds[wire].inside) {
        stiffness = 0;
        return;
    }
    if (reports[wire].iterations == 0) return;  // nothing was factorised: what was said last holds
    const RodView rod = rods.view(wire);
    const int base = rod.n - 2;
    const Vec3 edge = rod.pos(base + 1) - rod.pos(base);
    const double rest = rod.rest_length[base], length = edge.norm();
    const double pull = rod.stretch_stiffness[base] * length / (rest * rest);
    const double give = solver->compliance(wire, base, edge / length);
    stiffness = std::max(0.0, pull * (length / rest - pull * give));
}

/// All of a group when its line's turn comes: energies and momentum are the line's, contacts and hands each instrument's own.
void World::Impl::read_merged(int wire, double h)
{
    if (is_passenger(wire)) return;
    MergedGroup& group = *group_of(wire);
    const RodView line = rods.view(wire);
    std::vector<Vec3> contact_force(static_cast<std::size_t>(line.n), Vec3::Zero());
    for (const int w : group.wires()) {
        WireResult& result = results[w];
        std::vector<Vec3> forces = std::move(result.nodal_contact);
        result = {};
        result.nodal_contact = std::move(forces);
        std::fill(result.nodal_contact.begin(), result.nodal_contact.end(), Vec3::Zero());
        if (!group.feed.inside) continue;
        result.residual = reports[w].residual;
        if (!contact) continue;
        result.contact = contact->totals(w);
        read_overlap(result, line);
        add_wall_forces(*this, w, std::span(result.nodal_contact).first(line.n));
        for (int i = 0; i < line.n; ++i) contact_force[i] += result.nodal_contact[i];
    }
    if (!group.feed.inside) return;
    WireResult& result = results[wire];
    for (int c = 0; c < 3; ++c) result.base_force[c] = solver->reaction(wire, RodDofs::position(line.n - 1, c));
    read_hands(*this, group);
    if (h == 0 || setup.integrator.scheme == Scheme::Static) begin_audit(*this, wire, false);
    result.kinetic = audits[wire].kinetic;
    result.elastic = audits[wire].elastic;
    result.gravitational = audits[wire].gravitational;
    result.momentum = momentum_balance(line, constraints[wire], *solver, wire, setup.integrator, setup.gravity, contact_force,
                                       momentum_start[wire], h);
    for (const int w : group.wires()) result.momentum.held += line_holds ? line_holds->force(w) : Vec3::Zero();
}

int World::wire_count() const { return impl_->wire_count(); }
int World::system_count() const { return impl_->system_count(); }
int World::system_of(int wire) const { return impl_->system_of[wire]; }
std::pair<int, int> World::wires_of(int system) const { return {impl_->system_begin[system], impl_->system_begin[system + 1]}; }
double World::time() const { return impl_->time; }
double World::time(int wire) const { return impl_->wire_time[wire]; }
long World::step_count() const { return impl_->steps; }
const WorldSetup& World::setup() const { return impl_->setup; }
ConstRodView World::rod(int wire) const
{
    return impl_->merged_of[wire] >= 0 ? impl_->shown->view(wire) : impl_->rods.view(wire);
}
const WireReport& World::report(int wire) const { return impl_->wire_reports[wire]; }

void World::retire(int system)
{
    for (const int w : impl_->wires_of(system)) impl_->retired[w] = 1;
}

bool World::retired(int system) const { return impl_->retired[impl_->wires_of(system).front()] != 0; }

void World::watch_hand_stiffness() { impl_->hand_stiffness_watched = true; }

WireReadings World::readings(int wire) const
{
    const WireResult& result = impl_->results[wire];
    const FeedState& feed = impl_->feeds[wire];
    WireReadings r;
    if (feed.on) {
        r.inserted = feed.advance - impl_->setup.wires[wire].feed.advance;
        r.turned = feed.turn - impl_->setup.wires[wire].feed.turn;
    }
    r.nodes = rod(wire).n;
    r.contacts = result.contact.contacts;
    r.contact_length = result.contact.length;
    r.normal = result.contact.normal;
    r.normal_between = result.normal_between;
    r.friction = result.contact.friction;
    r.sliding = result.contact.sliding;
    r.sticking = result.contact.friction - result.contact.sliding;
    r.rolling = result.contact.rolling;
    r.hand_force = result.hand_force;
    r.hand_torque = result.hand_torque;
    r.hand_stiffness = result.hand_stiffness;
    r.base_force = result.base_force;
    r.overlap = result.contact.depth;
    r.overlap_share = result.overlap_share;
    r.overlap_at = result.overlap_at;
    r.outside = result.contact.outside;
    r.kinetic = result.kinetic;
    r.elastic = result.elastic;
    r.gravitational = result.gravitational;
    r.remesh_energy = impl_->remesh_energy[wire];
    r.energy_made = impl_->audits[wire].balance.made();
    r.force_residual = result.residual;
    r.energy = impl_->audits[wire].ledger;
    r.momentum = result.momentum;
    return r;
}

namespace {

/// How loads along a wire are read.
AlongSpec along_spec(const World::Impl& s, int wire)
{
    const double asked = s.setup.force_window, radius = s.setup.wires[static_cast<std::size_t>(wire)].wire.shaft.radius;
    return {asked > 0 ? asked : 2 * radius, s.setup.force_patch, s.contact ? s.contact->spacing(wire) : 0};
}

/// Force per length and the like, of all wires and on each row.
void read_rows_along(World::Impl& s)
{
    const auto wires = static_cast<std::size_t>(s.wire_count());
    std::vector<AlongSpec> specs(wires);
    for (std::size_t w = 0; w < wires; ++w) specs[w] = along_spec(s, static_cast<int>(w));
    s.on_wall.resize(wires);
    s.on_instruments.resize(wires);
    read_along(s.rows, specs, s.on_wall, s.on_instruments);
}

}  // namespace

void World::Impl::gather_loads()
{
    if (loads_known) return;
    loads_known = true;
    for (auto* loads : {&wall_loads, &instrument_loads}) {
        loads->resize(static_cast<std::size_t>(wire_count()));
        for (WireLoads& wire : *loads) wire.clear();
    }
    if (contact) contact->add_loads(rods, wall_loads);
    if (instruments) instruments->add_loads(instrument_loads);
}

const std::vector<ContactRow>& World::contacts() const
{
    impl_->rows.clear();
    if (impl_->yielding) impl_->rows = impl_->yielding->rows(impl_->rods);
    else if (impl_->contact) impl_->rows = impl_->contact->rows(impl_->rods);
    if (impl_->instruments) {
        for (ContactRow& row : impl_->instruments->rows(impl_->rods)) impl_->rows.push_back(row);
        std::sort(impl_->rows.begin(), impl_->rows.end(), [](const ContactRow& p, const ContactRow& q) {
            const auto key = [](const ContactRow& row) {
                return std::tuple(row.a.body, row.a.element, row.b.kind, row.b.body, row.b.element, row.point.x(), row.point.y());
            };
            return key(p) < key(q);
        });
    }
    read_rows_along(*impl_);
    return impl_->rows;
}

std::vector<Vec3> World::nodal_contact_force(int wire) const
{
    const auto& all = impl_->results[wire].nodal_contact;
    if (impl_->merged_of[wire] >= 0) return shown_contact_force(*impl_, wire);
    return {all.begin(), all.begin() + impl_->rods.node_count(wire)};
}

// A wire is at rest when a static solve says so, or when its kinetic energy is a hundred-millionth of the energies it exchanges
// with (elastic, and its weight lifted by its own length).
bool World::at_rest(int wire) const
{
    if (impl_->setup.integrator.scheme == Scheme::Static) return true;
    if (impl_->steps == 0) return false;
    const WireResult& result = impl_->results[wire];
    const RodView rod = impl_->rods.view(wire);
    double mass = 0;
    for (int i = 0; i < rod.n; ++i) mass += rod.mass[i];
    const double scale = result.elastic + mass * impl_->setup.gravity.norm() * rod.material_s[rod.n - 1];
    return result.kinetic <= 1e-8 * scale;
}

bool World::at_rest() const
{
    for (int w = 0; w < impl_->wire_count(); ++w)
        if (!at_rest(w)) return false;
    return true;
}

namespace {

/// Curvature of (D2) per Voronoi length [1/m].
double curvature_at(const ConstRodView& rod, int node)
{
    if (node == 0 || node == rod.n - 1) return 0;
    const Vec3 e = rod.pos(node) - rod.pos(node - 1), f = rod.pos(node + 1) - rod.pos(node);
    const double chi = 1 + e.dot(f) / (e.norm() * f.norm());
    return curvature_factor(curvature_q(rod.curvature), chi) * 2 * e.cross(f).norm() /
           (chi * e.norm() * f.norm() * rod.voronoi_length(node));
}

void read_shape(const ConstRodView& rod, std::span<const Vec3> contact_force, WireOutput& into)
{
    const auto n = static_cast<std::size_t>(rod.n);
    into.material_s.assign(rod.material_s.begin(), rod.material_s.begin() + rod.n);
    into.contact_force.assign(contact_force.begin(), contact_force.begin() + rod.n);
    for (auto* array : {&into.radius, &into.curvature, &into.spin}) array->resize(n);
    for (auto* array : {&into.director, &into.position, &into.velocity}) array->resize(n);
    for (int i = 0; i < rod.n; ++i) {
        into.radius[i] = rod.radius[std::min(i, rod.n - 2)];
        into.curvature[i] = curvature_at(rod, i);
        const int edge = std::min(i, rod.n - 2);
        const double theta = rod.theta[edge];
        into.spin[i] = 0.0 - theta;
        into.director[i] = std::cos(theta) * rod.ref_d1(edge) + std::sin(theta) * rod.tangent(edge).cross(rod.ref_d1(edge));
        into.position[i] = rod.pos(i);
        into.velocity[i] = rod.vel(i);
    }
}

}  // namespace

WallReadings World::wall_readings(int system) const
{
    if (!impl_->yielding) return {};
    return impl_->yielding->readings(system, impl_->yielding->displacement(system));
}

namespace {

/// What a wire's shape is judged by.
NodeDemands demands_of(World::Impl& s, int wire, const RodView& rod)
{
    MergedGroup* group = s.group_of(wire);
    if (group && group->feed.inside) return group_demands(s, *group);
    NodeDemands demands;
    demands.contact = std::span(s.results[static_cast<std::size_t>(wire)].nodal_contact).first(static_cast<std::size_t>(rod.n));
    for (const RodClamp& clamp : s.constraints[static_cast<std::size_t>(wire)].clamps)
        if (clamp.direction && clamp.node == rod.n - 1) demands.hub_tangent = clamp.tangent;
    return demands;
}

NodePlanner planner_of(const World::Impl& s, int wire)
{
    return {s.setup.wires[static_cast<std::size_t>(wire)].wire, s.rods.capacity(wire)};
}

}  // namespace

double World::node_error(int wire) const
{
    const int line = impl_->group_of(wire) ? impl_->group_of(wire)->line() : wire;
    const RodView rod = impl_->rods.view(line);
    return rod.n > 2 ? planner_of(*impl_, line).tip_error(rod, demands_of(*impl_, line, rod)) : 0;
}

BendingError World::bending_error(int wire) const
{
    const RodView rod = impl_->rods.view(wire);
    if (rod.n <= 2 || impl_->is_passenger(wire)) return {};
    return planner_of(*impl_, wire).bending_error(rod, demands_of(*impl_, wire, rod));
}

void World::stop_when(std::function<bool()> asked)
{
    impl_->stop_asked = std::move(asked);
    impl_->solver->stop_when(impl_->stop_asked);
}

void World::cut_when(std::function<bool()> due)
{
    for (int w = 0; w < wire_count() && due; ++w) {  // the step loop allocates nothing
        const auto most = 2 * static_cast<std::size_t>(impl_->rods.capacity(w));
        for (auto* carried : {&impl_->carried[w], &impl_->left[w]}) carried->reserve(most);
        impl_->constraints[w].carried.reserve(most);
    }
    impl_->solver->cut_when(std::move(due));
}

WallMechanics World::wall_mechanics() const { return impl_->elastic_wall ? impl_->elastic_wall->mechanics() : WallMechanics{}; }

namespace {

void read_walls(const World::Impl& s, unsigned parts, std::vector<WallOutput>& into)
{
    into.resize(static_cast<std::size_t>(s.system_count()));
    for (int system = 0; system < s.system_count(); ++system) {
        WallOutput& wall = into[static_cast<std::size_t>(system)];
        wall = {};
        if (!s.yielding) continue;
        if (!(parts & (Output::Wall | Output::WallShape))) {
            wall.readings = s.yielding->under(system);
            continue;
        }
        const std::vector<double> w = s.yielding->displacement(system);
        std::vector<double> stress;
        wall.readings = s.yielding->readings(system, w, &stress);
        if (!(parts & Output::WallShape)) continue;
        wall.displacement = s.wall_shape->displacement(w);
        wall.stress = s.wall_shape->spread(stress);
    }
}

}  // namespace

namespace {

/// Sets a flag where a load is more than all that the wire bears.
void check_loads(const World::Impl& s, int wire, WireOutput& into)
{
    const auto w = static_cast<std::size_t>(wire);
    if (!within_sum(into.on_wall, s.wall_loads[w]) || !within_sum(into.on_instruments, s.instrument_loads[w]))
        into.report.flags |= StepContactSums;
}

void read_contacts(const World& world, Output& into)
{
    into.contacts = world.contacts();
    for (std::size_t w = 0; w < into.wires.size(); ++w) {
        WireOutput& wire = into.wires[w];
        wire.contact_area = wire.contact_pressure_max = 0;
        wire.on_wall = world.impl().on_wall[w];
        wire.on_instruments = world.impl().on_instruments[w];
        check_loads(world.impl(), static_cast<int>(w), wire);
    }
    for (const ContactRow& row : into.contacts) {
        WireOutput& wire = into.wires[static_cast<std::size_t>(row.a.body)];
        wire.contact_area += row.area;
        wire.contact_pressure_max = std::max(wire.contact_pressure_max, row.pressure);
    }
}

}  // namespace

void World::read_loads(int wire, WireOutput& into) const
{
    const auto w = static_cast<std::size_t>(wire);
    impl_->gather_loads();
    AlongSpec spec = along_spec(*impl_, wire);
    into.on_wall = greatest_loads(impl_->wall_loads[w].samples, spec);
    spec.spacing = 0;  // a cell says which part of it touches
    into.on_instruments = greatest_loads(impl_->instrument_loads[w].samples, spec);
    check_loads(*impl_, wire, into);
}

void World::read(Output& into, unsigned parts) const
{
    into.time = time();
    into.step = step_count();
    into.parts = parts;
    into.wires.resize(static_cast<std::size_t>(wire_count()));
    for (int w = 0; w < wire_count(); ++w) {
        WireOutput& wire = into.wires[static_cast<std::size_t>(w)];
        wire.readings = readings(w);
        wire.report = report(w);
        wire.time = time(w);
        wire.at_rest = at_rest(w);
        wire.retired = impl_->retired[w] != 0;
        wire.tip = rod(w).pos(0);
        if (parts & Output::Shape)
            read_shape(rod(w), impl_->merged_of[w] >= 0 ? nodal_contact_force(w) : impl_->results[w].nodal_contact, wire);
    }
    if (parts & Output::Contacts) {
        impl_->gather_loads();
        read_contacts(*this, into);
    }
    for (int w = 0; w < wire_count() && (parts & (Output::Contacts | Output::Loads)) == Output::Loads; ++w)
        read_loads(w, into.wires[static_cast<std::size_t>(w)]);
    if ((parts & Output::WallShape) && impl_->yielding && !impl_->wall_shape)
        impl_->wall_shape = std::make_unique<WallShape>(*impl_->elastic_wall, impl_->setup.mesh);
    if (!(parts & (Output::Wall | Output::WallShape | Output::WallUnder))) return;
    read_walls(*impl_, parts, into.walls);
    if (!impl_->yielding || !(parts & (Output::Wall | Output::WallShape))) return;
    // a step looks under its wires only: loads may have moved the wall elsewhere
    for (int w = 0; w < wire_count(); ++w)
        if (into.walls[static_cast<std::size_t>(system_of(w))].readings.move_share > 1)
            into.wires[static_cast<std::size_t>(w)].report.flags |= StepWallFar;
}

Output World::output(unsigned parts) const
{
    Output made;
    read(made, parts);
    return made;
}

namespace {

std::string describe_nodes(const WireSetup& setup)
{
    const WireSpec& spec = setup.wire;
    if (spec.nodes > 0) return fmt::format("uniform, {} over the whole length (asked for)", spec.nodes);
    if (!nodes_adapt(setup))
        return fmt::format("uniform edges of {:.3g} mm (0.4 of max_edge_m; this detection sits on nodes or edges)",
                           1e3 * uniform_edge(spec));
    return fmt::format("adaptive, edges of {:.3g} to {:.3g} mm, {:.3g} um of tip error each (asked for)", 1e3 * spec.min_edge,
                       1e3 * spec.max_edge, 1e6 * spec.edge_error);
}

std::string describe_nodes(const MergedGroup& group)
{
    const WireSpec& spec = group.nodes;
    if (!group.adapts())
        return fmt::format("uniform edges of {:.3g} mm (instruments of one centreline)", 1e3 * group.feed.edge);
    return fmt::format("adaptive, edges of {:.3g} to {:.3g} mm, {:.3g} um of tip error each (instruments of one centreline)",
                       1e3 * spec.min_edge, 1e3 * spec.max_edge, 1e6 * spec.edge_error);
}

// Spins of wire 0, as all of model() describes it.
std::string describe_spins(const World::Impl& s, const IntegratorSpec& integrator)
{
    if (integrator.spins == Spins::Kept) return "solved for (asked for)";
    const Solver::SpinRecord& record = s.solver->spin_record(0);
    return fmt::format("left out of {} of {} solves (straight, isotropic, no torque: their equations held to the tolerance)",
                       record.without, record.steps);
}

std::string describe_wall(const World::Impl& s)
{
    if (!s.elastic_wall) return "rigid shape, elastic bed under each contact (D6b)";
    const VesselSpec& v = s.setup.vessel;
    return fmt::format(
        "elastic (D11): shell of {:.3g} MPa, {:.3g} mm on tissue of {:.3g} MPa/m, {} control vertices, edge {}; elastic bed "
        "under each contact (D6b) in series",
        1e-6 * v.youngs, 1e3 * v.thickness, 1e-6 * v.support, s.elastic_wall->compliance().vertex_count(),
        s.elastic_wall->edge_reason());
}

/// Friction of the first group.
std::string describe_coaxial_friction(const WorldSetup& setup)
{
    const auto merged = [](const CoaxialSpec& spec) { return spec.model == CoaxialSpec::Model::Merged; };
    const CoaxialSpec& spec = *std::ranges::find_if(setup.coaxial, merged);
    std::string text = fmt::format("{:.3g} N/m and {:.3g} Pa s", spec.drag, spec.viscous);
    if (spec.lumen_friction)
        text += fmt::format(", and {:.3g}, sliding {:.3g}, times the contact force at the clearance", spec.mu_static,
                            spec.mu_sliding);
    return text + " (asked for)";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> World::model() const
{
    const Impl& s = *impl_;
    const WireSetup& wire = s.setup.wires[0];
    std::vector<std::pair<std::string, std::string>> list;
    list.emplace_back("nodes", s.merged_of[0] >= 0 ? describe_nodes(*s.merged[s.merged_of[0]]) : describe_nodes(wire));
    if (!wire.start.empty()) list.emplace_back("start", wire.start);
    if (!wire.inlet.empty()) list.emplace_back("inlet", wire.inlet);
    static const char* const schemes[] = {"newton", "linearised", "static", "explicit"};
    const IntegratorSpec& integrator = s.setup.integrator;
    list.emplace_back("scheme",
                      fmt::format("{}, {}", schemes[static_cast<int>(integrator.scheme)],
                                  integrator.newmark ? fmt::format("Newmark beta {} gamma {}", integrator.beta, integrator.gamma)
                                  : integrator.conserve ? "energy-momentum (asked for)"
                                                        : "backward Euler"));
    if (integrator.scheme == Scheme::Newton || integrator.scheme == Scheme::Linearised)
        list.emplace_back("spins", describe_spins(s, integrator));
    list.emplace_back("curvature",
                      wire.wire.curvature == CurvatureMeasure::Angle ? "turning angle" : "2 tan(angle/2) (asked for)");
    if (s.coaxial_friction) list.emplace_back("friction between instruments", describe_coaxial_friction(s.setup));
    if (!s.contact) {
        list.emplace_back("contact", "none (no vessel)");
        return list;
    }
    static const char* const detections[] = {"swept", "capsule", "layer", "nodes"};
    list.emplace_back("detection", detections[static_cast<int>(wire.contact.detection)]);
    list.emplace_back("rolling", !wire.contact.rolling ? "off" : "on (asked for)");
    list.emplace_back("wall", describe_wall(s));
    list.emplace_back("precision", s.context->float32() ? "float32" : "float64");
    for (auto& entry : s.contact->describe()) list.push_back(std::move(entry));
    return list;
}

std::string World::device_name() const { return impl_->context ? impl_->context->name() : "none (no vessel, host only)"; }

DeviceCounts World::device_counts() const
{
    if (!impl_->context) return {};
    const device::Counters& c = impl_->context->counters();
    return {c.launches, c.reads, c.writes, c.buffers_created, c.programs_built};
}

}  // namespace seldinger
