// Reading a world: the accepted state in its form for the user.
#include "contact/contact_sums.h"
#include "contact/contact_system.h"
#include "contact/rods/instrument_contact.h"
#include "contact/wall_body.h"
#include "nodes/adapt.h"
#include "rod/curvature.h"
#include "solve/given_forces.h"
#include "world/node_errors.h"
#include "world/world.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

int World::wire_count() const { return data_->wire_count(); }
int World::system_count() const { return data_->systems.count(); }
int World::system_of(int wire) const { return data_->systems.of(wire); }
std::pair<int, int> World::wires_of(int system) const
{
    const std::span<const int> wires = data_->systems.wires_of(system);
    return {wires.front(), wires.back() + 1};
}
double World::time() const { return data_->state.time; }
double World::time(int wire) const { return data_->state.wires[wire].time; }
long World::step_count() const { return data_->state.steps; }
const WorldSetup& World::setup() const { return data_->setup; }
ConstRodView World::rod(int wire) const { return data_->shown(wire); }
const WireReport& World::report(int wire) const { return data_->output.reports[wire]; }

void World::retire(int system) { data_->systems.retire(system, true); }

bool World::retired(int system) const { return data_->systems.is_retired(data_->systems.wires_of(system).front()); }

void World::watch_hand_stiffness() { data_->output.hand_stiffness_watched = true; }

WireReadings World::readings(int wire) const
{
    const WireResult& result = data_->output.results[wire];
    const FeedState& feed = data_->feed(wire);
    WireReadings r;
    if (feed.on) {
        r.inserted = feed.advance - data_->setup.wires[wire].feed.advance;
        r.turned = feed.turn - data_->setup.wires[wire].feed.turn;
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
    r.force_energy = data_->forces.given ? data_->forces.given->energy(wire) : 0;
    r.remesh_energy = data_->state.wires[wire].remesh_energy;
    r.energy_made = data_->audit(wire).balance.made();
    r.force_residual = result.residual;
    r.energy = data_->audit(wire).ledger;
    r.hub = data_->state.wires[wire].hub.readings;
    r.momentum = result.momentum;
    return r;
}

namespace {

/// How loads along a wire are read.
AlongSpec along_spec(const WorldData& world, int wire)
{
    const double asked = world.setup.force_window, radius = world.setup.wires[static_cast<std::size_t>(wire)].wire.shaft.radius;
    return {asked > 0 ? asked : 2 * radius, world.setup.force_patch,
            world.forces.contact ? world.forces.contact->spacing(wire) : 0};
}

/// Force per length and the like, of all wires and on each row.
void read_rows_along(WorldData& world)
{
    const auto wires = static_cast<std::size_t>(world.wire_count());
    std::vector<AlongSpec> specs(wires);
    for (std::size_t w = 0; w < wires; ++w) specs[w] = along_spec(world, static_cast<int>(w));
    world.output.on_wall.resize(wires);
    world.output.on_instruments.resize(wires);
    read_along(world.output.rows, specs, world.output.on_wall, world.output.on_instruments);
}

}  // namespace

void gather_loads(WorldData& world)
{
    WorldOutput& output = world.output;
    if (output.loads_known) return;
    output.loads_known = true;
    for (auto* loads : {&output.wall_loads, &output.instrument_loads}) {
        loads->resize(static_cast<std::size_t>(world.wire_count()));
        for (WireLoads& wire : *loads) wire.clear();
    }
    if (world.forces.contact) world.forces.contact->add_loads(world.state.rods, output.wall_loads);
    if (world.forces.instruments) world.forces.instruments->add_loads(output.instrument_loads);
}

const std::vector<ContactRow>& World::contacts() const
{
    data_->output.rows = data_->forces.rows(data_->state.rods);
    read_rows_along(*data_);
    return data_->output.rows;
}

namespace {

/// Force of contact on the nodes of an instrument by itself. Values on the node before a tip within its line belong to the edge
/// with the tip.
std::span<const Vec3> shown_contact(WorldData& world, int wire)
{
    const std::span<const Vec3> all = world.output.results[wire].nodal_contact;
    return all.subspan(static_cast<std::size_t>(world.shown_from(wire)), static_cast<std::size_t>(world.shown(wire).n));
}

}  // namespace

std::vector<Vec3> World::nodal_contact_force(int wire) const
{
    const std::span<const Vec3> force = shown_contact(*data_, wire);
    return {force.begin(), force.end()};
}

// A wire is at rest when a static solve says so, or when its kinetic energy is a hundred-millionth of the energies it exchanges
// with (elastic, and its weight lifted by its own length).
bool World::at_rest(int wire) const
{
    if (data_->setup.integrator.scheme == Scheme::Static) return true;
    if (data_->state.steps == 0) return false;
    const WireResult& result = data_->output.results[wire];
    const RodView rod = data_->state.rods.view(wire);
    double mass = 0;
    for (int i = 0; i < rod.n; ++i) mass += rod.mass[i];
    const double scale = result.elastic + mass * data_->setup.gravity.norm() * rod.material_s[rod.n - 1];
    return result.kinetic <= 1e-8 * scale;
}

bool World::at_rest() const
{
    for (int w = 0; w < data_->wire_count(); ++w)
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
    into.contact_force.assign(contact_force.begin(), contact_force.end());
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
    const WallContact* wall = data_->forces.wall_contact;
    return wall ? wall->readings(system, wall->displacement(system)) : WallReadings{};
}

void World::stop_when(std::function<bool()> asked)
{
    data_->work.stop_asked = std::move(asked);
    watch_ends(*data_);
}

void watch_ends(WorldData& world)
{
    const bool any = world.work.stop_asked || world.forces.given;
    world.solver->stop_when(!any ? std::function<bool()>() : [&world] {
        return world.forces.raised() || (world.work.stop_asked && world.work.stop_asked());
    });
}

void World::cut_when(std::function<bool()> due)
{
    for (int w = 0; w < wire_count() && due; ++w) {  // the step loop allocates nothing
        const auto most = 2 * static_cast<std::size_t>(data_->state.rods.capacity(w));
        for (auto* carried : {&data_->state.wires[w].carried, &data_->state.wires[w].left}) carried->reserve(most);
        data_->constraints(w).carried.reserve(most);
    }
    data_->solver->cut_when(std::move(due));
}

WallMechanics World::wall_mechanics() const
{
    return data_->forces.wall_body ? data_->forces.wall_body->mechanics() : WallMechanics{};
}

namespace {

void read_walls(const WorldData& world, unsigned parts, std::vector<WallOutput>& into)
{
    into.resize(static_cast<std::size_t>(world.systems.count()));
    for (int system = 0; system < world.systems.count(); ++system) {
        WallOutput& wall = into[static_cast<std::size_t>(system)];
        wall = {};
        const WallContact* contact = world.forces.wall_contact;
        if (!contact) continue;
        if (!(parts & (Output::Wall | Output::WallShape))) {
            wall.readings = contact->under(system);
            continue;
        }
        const std::vector<double> w = contact->displacement(system);
        std::vector<double> stress;
        wall.readings = contact->readings(system, w, &stress);
        if (!world.output.wall_shape || !(parts & Output::WallShape)) continue;
        wall.displacement = world.output.wall_shape->displacement(w);
        wall.stress = world.output.wall_shape->spread(stress);
    }
}

/// Sets a flag where a load is more than all that the wire bears.
void check_loads(const WorldOutput& output, int wire, WireOutput& into)
{
    const auto w = static_cast<std::size_t>(wire);
    if (!within_sum(into.on_wall, output.wall_loads[w]) || !within_sum(into.on_instruments, output.instrument_loads[w]))
        into.report.flags |= StepContactSums;
}

void read_contacts(const WorldData& world, Output& into)
{
    for (std::size_t w = 0; w < into.wires.size(); ++w) {
        WireOutput& wire = into.wires[w];
        wire.contact_area = wire.contact_pressure_max = 0;
        wire.on_wall = world.output.on_wall[w];
        wire.on_instruments = world.output.on_instruments[w];
        check_loads(world.output, static_cast<int>(w), wire);
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
    gather_loads(*data_);
    AlongSpec spec = along_spec(*data_, wire);
    into.on_wall = greatest_loads(data_->output.wall_loads[w].samples, spec);
    spec.spacing = 0;  // a cell says which part of it touches
    into.on_instruments = greatest_loads(data_->output.instrument_loads[w].samples, spec);
    check_loads(data_->output, wire, into);
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
        wire.retired = data_->systems.is_retired(w);
        wire.tip = rod(w).pos(0);
        wire.sensors.clear();
        if (data_->forces.given)
            data_->forces.given->read_sensors(w, [&](const Force& sensor, std::span<const double> numbers) {
                wire.sensors.push_back({sensor.name, sensor.record, {numbers.begin(), numbers.end()}});
            });
        if (parts & Output::Shape) read_shape(rod(w), shown_contact(*data_, w), wire);
    }
    if (parts & Output::Contacts) {
        gather_loads(*data_);
        into.contacts = contacts();
        read_contacts(*data_, into);
    }
    for (int w = 0; w < wire_count() && (parts & (Output::Contacts | Output::Loads)) == Output::Loads; ++w)
        read_loads(w, into.wires[static_cast<std::size_t>(w)]);
    if ((parts & Output::WallShape) && data_->forces.wall_body && !data_->output.wall_shape)
        data_->output.wall_shape = data_->forces.wall_body->carry(data_->setup.mesh);
    if (!(parts & (Output::Wall | Output::WallShape | Output::WallUnder))) return;
    read_walls(*data_, parts, into.walls);
    if (!(parts & (Output::Wall | Output::WallShape))) return;
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

}  // namespace seldinger
