// Building a World, reading it, saving and restoring it. What happens in a step is in step.cpp.

#include "world.h"

#include "core/bytes.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "device/enumerate.h"
#include "rod/place.h"
#include "rod/rod_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {

namespace {

// `nodes` has its samples on the nodes of a uniform wire, and the pairs of `layer` are known by their edges; the samples of the
// others are fixed in the material.
bool nodes_adapt(const WireSetup& setup)
{
    const Detection detection = setup.contact.detection;
    return setup.wire.nodes == 0 && detection != Detection::Nodes && detection != Detection::Layer;
}

NodeAdapter make_adapter(const WireSetup& setup, std::span<const double> held, int capacity)
{
    NodeAdapter adapter;
    adapter.on = nodes_adapt(setup);
    if (!adapter.on) return adapter;
    adapter.planner = NodePlanner(setup.wire, capacity);
    adapter.kept.assign(held.begin(), held.end());
    // a point load is exact where it meets a node; once there is one, it stays
    for (const LoadSpec& load : setup.loads)
        if (load.at.kind == WirePoint::Kind::Distance) adapter.kept.push_back(load.at.from_tip);
    for (const LinkSpec& link : setup.links)
        if (link.at.kind == WirePoint::Kind::Distance) adapter.kept.push_back(link.at.from_tip);
    adapter.frames = RodFrames(capacity);
    return adapter;
}

int node_capacity(const WireSetup& setup)
{
    const int nodes = uniform_node_count(setup.wire);
    // edges of min_edge everywhere, debts of rest length included
    if (nodes_adapt(setup)) return static_cast<int>(std::ceil(1.01 * setup.wire.length / setup.wire.min_edge)) + 4;
    return setup.feed.on ? nodes + 4 : nodes;  // a fed wire's base edge may be split before the last is merged
}

std::vector<int> capacities(const WorldSetup& setup)
{
    std::vector<int> list;
    for (const WireSetup& wire : setup.wires) list.push_back(node_capacity(wire));
    return list;
}

// A closed ring is an open wire whose two ends are held in one point and one direction: rigid motion is all that this takes away.
void close_ring(WireSetup& wire)
{
    if (wire.wire.place.shape != PlaceShape::Ring || !wire.holds.empty()) return;
    for (const WirePoint::Kind kind : {WirePoint::Kind::Base, WirePoint::Kind::Tip}) {
        HoldSpec hold;
        hold.at.kind = kind;
        hold.position = hold.direction = hold.spin = true;
        wire.holds.push_back(hold);
    }
}

// What of a FeedState changes; the rest follows from the scene. A debt there is only where nodes come and go.
void put_feed(std::vector<std::uint8_t>& bytes, const FeedState& feed, bool nodes_change)
{
    put_bytes(bytes, &feed.advance, 1);
    put_bytes(bytes, &feed.turn, 1);
    put_bytes(bytes, &feed.debt, 1);
    put_bytes(bytes, &feed.inside, 1);
    if (nodes_change) put_bytes(bytes, &feed.debt_rate, 1);
}

void take_feed(const std::uint8_t*& bytes, const std::uint8_t* end, FeedState& feed, bool nodes_change)
{
    take_bytes(bytes, end, &feed.advance, 1);
    take_bytes(bytes, end, &feed.turn, 1);
    take_bytes(bytes, end, &feed.debt, 1);
    take_bytes(bytes, end, &feed.inside, 1);
    if (nodes_change) take_bytes(bytes, end, &feed.debt_rate, 1);
}

}  // namespace

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

// Of wire 0, as all of model() is.
std::string describe_spins(const World::Impl& s, const IntegratorSpec& integrator)
{
    if (integrator.spins == Spins::Kept) return "solved for (asked for)";
    const Solver::SpinRecord& record = s.solver->spin_record(0);
    return fmt::format("left out of {} of {} solves (straight, isotropic, no torque: their equations held to the tolerance)",
                       record.without, record.steps);
}

}  // namespace

ContactSetup contact_setup(const WorldSetup& setup, const WallModel& wall)
{
    ContactSetup made{{}, {}, wall, false};
    for (const WireSetup& wire : setup.wires) {
        made.wires.push_back(wire.wire);
        made.contacts.push_back(wire.contact);
    }
    const Scheme scheme = setup.integrator.scheme;
    made.known_velocities = scheme == Scheme::Linearised || scheme == Scheme::Explicit;
    return made;
}

World::Impl::Impl(WorldSetup from) : setup(std::move(from)), rods(capacities(setup))
{
    const int count = static_cast<int>(setup.wires.size());
    feeds.resize(count);
    for (int w = 0; w < count; ++w) {
        WireSetup& wire = setup.wires[w];
        close_ring(wire);
        if (wire.feed.on) {
            feeds[w].edge = uniform_edge(wire.wire);
            start_feed(feeds[w], wire.feed, wire.wire, rods, w);
        } else {
            place_wire(rods, w, wire.wire, setup.centreline.main_points());
        }
        holds.emplace_back(wire.holds, wire.loads, wire.links, rods.view(w), wire.wire.length);
        adapters.push_back(make_adapter(wire, holds[w].held_distances(), rods.capacity(w)));
    }
    solver = std::make_unique<Solver>(rods, setup.integrator, setup.gravity);
    if (setup.device_index >= 0) device::check_device_index(setup.device_index);  // also where no vessel needs one
    if (!setup.mesh.triangles.empty()) {
        context = std::make_unique<device::Context>(setup.device_index, setup.wires[0].contact.precision == Precision::Float32);
        wall.emplace(setup.vessel, setup.mesh, setup.centreline);
        contact = make_contact(*context, contact_setup(setup, *wall), rods);
        terms.add(*contact);
    }
    constraints.resize(count);
    reports.resize(count);
    active.assign(count, 1);
    live.assign(count, 1);
    retired.assign(count, 0);
    wire_reports.resize(count);
    wire_time.assign(count, 0.0);
    time_backup.assign(count, 0.0);
    momentum_start.resize(count);
    remesh_energy.assign(count, 0.0);
    results.resize(count);
    backup.resize(count);
    feed_backup = feeds;
    count_backup.assign(count, 0);
    for (int w = 0; w < count; ++w)
        backup[w].reserve(static_cast<std::size_t>(RodArrays::array_count) * rods.capacity(w));  // grows with the wire else
    for (int w = 0; w < count; ++w)
        if (feeds[w].on) hub_scratch.split.provide(rods.capacity(w));
    for (int w = 0; w < count; ++w) results[w].nodal_contact.assign(rods.capacity(w), Vec3::Zero());
    audits.resize(count);
    for (int w = 0; w < count; ++w) audits[w].limits = energy_limits(setup.wires[w].wire, setup.gravity);
}

void World::Impl::save_wire(int wire)
{
    std::vector<double>& to = backup[wire];
    to.clear();
    for (const std::span<double>& array : rods.arrays(wire)) to.insert(to.end(), array.begin(), array.end());
    feed_backup[wire] = feeds[wire];
    count_backup[wire] = rods.node_count(wire);
    time_backup[wire] = wire_time[wire];
}

void World::Impl::restore_wire(int wire)
{
    rods.set_node_count(wire, count_backup[wire]);
    const double* from = backup[wire].data();
    for (const std::span<double>& array : rods.arrays(wire)) {
        std::copy(from, from + array.size(), array.begin());
        from += array.size();
    }
    feeds[wire] = feed_backup[wire];
    wire_time[wire] = time_backup[wire];
}

namespace {

/// Tangent of the wire at its hub, from tip to hub, to second order in the edge length: what a clamp prescribes, else the edge's
/// own, which is that of its middle, turned on by half an edge of the curvature next to it.
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

void World::Impl::read_results(int wire, double h)
{
    WireResult& result = results[wire];
    const RodView rod = rods.view(wire);
    std::fill(result.nodal_contact.begin(), result.nodal_contact.end(), Vec3::Zero());
    result.contact = {};
    if (feeds[wire].on && !feeds[wire].inside) {
        result.hand_force = result.hand_torque = result.kinetic = result.elastic = result.gravitational = result.residual = 0;
        result.base_force = Vec3::Zero();
        result.momentum = {};
        return;
    }
    if (contact) {
        result.contact = contact->totals(wire);
        contact->add_nodal_forces(wire, std::span(result.nodal_contact).first(rod.n));
    }
    const int hub = rod.n - 1;
    for (int k = 0; k < 3; ++k) result.base_force[k] = solver->reaction(wire, RodDofs::position(hub, k));
    const std::vector<RodClamp>& clamps = constraints[wire].clamps;
    result.hand_torque = 0;
    for (std::size_t c = 0; c < clamps.size(); ++c)
        if (clamps[c].node == hub && clamps[c].spin)
            result.hand_torque = -clamp_torque(rod, clamps, solver->frames(wire), static_cast<int>(c));
    result.hand_force = feeds[wire].on ? feed_force(rod, clamps, solver->frames(wire), setup.gravity) +
                                             solver->base_tension_excess(wire)
                                       : -result.base_force.dot(hub_tangent(rod, clamps));
    if (h == 0 || setup.integrator.scheme == Scheme::Static) begin_audit(*this, wire, false);
    result.kinetic = audits[wire].kinetic;
    result.elastic = audits[wire].elastic;
    result.gravitational = audits[wire].gravitational;
    result.residual = reports[wire].residual;
    result.momentum = momentum_balance(rod, constraints[wire], *solver, wire, setup.integrator, setup.gravity,
                                       result.nodal_contact, momentum_start[wire], h);
}

World::World(WorldSetup setup)
{
    if (setup.wires.empty()) throw Error(ExitCode::BadScene, "a world needs at least one wire");
    impl_ = std::make_unique<Impl>(std::move(setup));
}

World::~World() = default;
World::World(World&&) noexcept = default;

int World::wire_count() const { return impl_->wire_count(); }
double World::time() const { return impl_->time; }
double World::time(int wire) const { return impl_->wire_time[wire]; }
long World::step_count() const { return impl_->steps; }
const WorldSetup& World::setup() const { return impl_->setup; }
RodView World::rod(int wire) const { return impl_->rods.view(wire); }

WireReadings World::readings(int wire) const
{
    const WireResult& result = impl_->results[wire];
    const FeedState& feed = impl_->feeds[wire];
    WireReadings r;
    if (feed.on) {
        r.inserted = feed.advance - impl_->setup.wires[wire].feed.at(0).advance;
        r.turned = feed.turn - impl_->setup.wires[wire].feed.at(0).turn;
    }
    r.nodes = impl_->rods.node_count(wire);
    r.contacts = result.contact.contacts;
    r.contact_length = result.contact.length;
    r.normal = result.contact.normal;
    r.friction = result.contact.friction;
    r.sliding = result.contact.sliding;
    r.sticking = result.contact.friction - result.contact.sliding;
    r.rolling = result.contact.rolling;
    r.hand_force = result.hand_force;
    r.hand_torque = result.hand_torque;
    r.base_force = result.base_force;
    r.overlap = result.contact.depth;
    r.outside = result.contact.outside;
    r.kinetic = result.kinetic;
    r.elastic = result.elastic;
    r.gravitational = result.gravitational;
    r.remesh_energy = impl_->remesh_energy[wire];
    r.energy_made = impl_->audits[wire].balance.made();
    r.force_residual = result.residual;
    r.momentum = result.momentum;
    return r;
}

const WireReport& World::report(int wire) const { return impl_->wire_reports[wire]; }
void World::retire(int wire) { impl_->retired[wire] = 1; }
bool World::retired(int wire) const { return impl_->retired[wire] != 0; }

const std::vector<ContactRow>& World::contacts() const
{
    impl_->rows.clear();
    if (impl_->contact) impl_->rows = impl_->contact->rows(impl_->rods);
    return impl_->rows;
}

std::vector<Vec3> World::nodal_contact_force(int wire) const
{
    const auto& all = impl_->results[wire].nodal_contact;
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

void World::Impl::put_wire(std::vector<std::uint8_t>& bytes, int wire) const
{
    const std::int32_t n = rods.node_count(wire);
    put_bytes(bytes, &n, 1);
    put_bytes(bytes, &wire_time[wire], 1);
    put_bytes(bytes, &remesh_energy[wire], 1);
    put_feed(bytes, feeds[wire], feeds[wire].on || adapters[wire].on);
    const Solver::SpinRecord& spins = solver->spin_record(wire);
    const std::int32_t waits[2] = {spins.wait, spins.last_wait};
    put_bytes(bytes, waits, 2);
    // views are of changeable arrays; these only read
    for (const std::span<double>& array : const_cast<RodArrays&>(rods).arrays(wire)) put_bytes(bytes, array.data(), array.size());
}

std::vector<std::uint8_t> World::Impl::state_bytes() const
{
    std::vector<std::uint8_t> bytes;
    put_bytes(bytes, &time, 1);
    const std::int64_t taken = steps;
    put_bytes(bytes, &taken, 1);
    for (int w = 0; w < wire_count(); ++w) put_wire(bytes, w);
    terms.save(bytes);
    return bytes;
}

std::vector<std::uint8_t> World::save_state() const
{
    std::vector<std::uint8_t> bytes = impl_->state_bytes();
    for (const EnergyAudit& audit : impl_->audits) put_audit(bytes, audit);
    return bytes;
}

void World::restore_state(const std::vector<std::uint8_t>& bytes)
{
    Impl& s = *impl_;
    const std::uint8_t* at = bytes.data();
    const std::uint8_t* end = at + bytes.size();
    take_bytes(at, end, &s.time, 1);
    std::int64_t steps = 0;
    take_bytes(at, end, &steps, 1);
    s.steps = static_cast<long>(steps);
    for (int w = 0; w < s.wire_count(); ++w) {
        std::int32_t n = 0;
        take_bytes(at, end, &n, 1);
        if (n < 2 || n > s.rods.capacity(w))
            throw Error(ExitCode::BadFile, "the saved state has another number of nodes than this scene's wire can have");
        s.rods.set_node_count(w, n);
        take_bytes(at, end, &s.wire_time[w], 1);
        take_bytes(at, end, &s.remesh_energy[w], 1);
        take_feed(at, end, s.feeds[w], s.feeds[w].on || s.adapters[w].on);
        std::int32_t waits[2] = {};
        take_bytes(at, end, waits, 2);
        s.solver->spin_record(w).wait = waits[0];
        s.solver->spin_record(w).last_wait = waits[1];
        for (const std::span<double>& array : s.rods.arrays(w)) take_bytes(at, end, array.data(), array.size());
    }
    s.terms.restore(at, end);
    for (EnergyAudit& audit : s.audits) take_audit(at, end, audit);
    if (at != end)
        throw Error(ExitCode::BadFile, "the saved state is longer than this scene's; it was written by another scene or version");
}

namespace {

std::string hash_of(const std::vector<std::uint8_t>& bytes) { return fmt::format("{:016x}", fnv1a(bytes.data(), bytes.size())); }

}  // namespace

std::string World::state_hash() const { return hash_of(impl_->state_bytes()); }

std::string World::state_hash(int wire) const
{
    const Impl& s = *impl_;
    std::vector<std::uint8_t> bytes;
    put_bytes(bytes, &s.wire_time[wire], 1);  // alone, its time is the world's
    const std::int64_t steps = s.steps;
    put_bytes(bytes, &steps, 1);
    s.put_wire(bytes, wire);
    s.terms.save_wire(bytes, wire);
    return hash_of(bytes);
}

std::vector<std::pair<std::string, std::string>> World::model() const
{
    const Impl& s = *impl_;
    const WireSetup& wire = s.setup.wires[0];
    std::vector<std::pair<std::string, std::string>> list;
    list.emplace_back("nodes", describe_nodes(wire));
    if (!wire.start.empty()) list.emplace_back("start", wire.start);
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
    if (!s.contact) {
        list.emplace_back("contact", "none (no vessel)");
        return list;
    }
    static const char* const detections[] = {"swept", "capsule", "layer", "nodes"};
    list.emplace_back("detection", detections[static_cast<int>(wire.contact.detection)]);
    list.emplace_back("rolling", !wire.contact.rolling ? "off" : "on (asked for)");
    list.emplace_back("wall", "rigid shape, elastic bed under each contact (D6b)");
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

const char* version() { return SELDINGER_VERSION; }

}  // namespace seldinger
