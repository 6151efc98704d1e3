// Building a World: rods and feeds placed, holds resolved, contact and solver made. What happens in a step is in step.cpp.

#include "world/world.h"

#include "contact/coaxial_friction.h"
#include "core/error.h"
#include "device/enumerate.h"
#include "world/merged.h"
#include "rod/place.h"
#include "rod/rod_arrays.h"
#include "world/setup_check.h"
#include "solve/line_holds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace seldinger {

// `nodes` has its samples on the nodes of a uniform wire, and the pairs of `layer` are known by their edges; the samples of the
// others are fixed in the material.
bool nodes_adapt(const WireSetup& setup)
{
    const Detection detection = setup.contact.detection;
    return setup.wire.nodes == 0 && detection != Detection::Nodes && detection != Detection::Layer;
}

namespace {

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
    // edges of min_edge everywhere, surpluses of rest length included
    if (nodes_adapt(setup)) return static_cast<int>(std::ceil(1.01 * setup.wire.length / setup.wire.min_edge)) + 4;
    return setup.feed.on ? nodes + 4 : nodes;  // a fed wire's base edge may be split before the last is merged
}

std::vector<int> capacities(const WorldSetup& setup)
{
    std::vector<int> list;
    for (std::size_t w = 0; w < setup.wires.size(); ++w) {
        const CoaxialSpec* merged = merged_spec_of(setup, static_cast<int>(w));
        list.push_back(merged ? merged_capacity(setup, *merged) : node_capacity(setup.wires[w]));
    }
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

InstrumentSetup instrument_setup(const WorldSetup& setup, std::span<const int> system_of)
{
    InstrumentSetup made;
    for (const WireSetup& wire : setup.wires) {
        made.wires.push_back(wire.wire);
        made.contacts.push_back(wire.contact);
    }
    made.system_of.assign(system_of.begin(), system_of.end());
    for (const CoaxialSpec& nest : setup.coaxial)
        if (nest.model == CoaxialSpec::Model::Separate)
            made.nested.push_back({nest.order, nest.mu_static, nest.mu_sliding, nest.stiffness});
    made.from_outside = setup.instruments_touch;
    return made;
}

namespace {

WorldSetup checked(WorldSetup setup)
{
    check_setup(setup);
    return setup;
}

}  // namespace

void World::Impl::divide_into_systems()
{
    const int count = wire_count();
    system_begin = {0};
    if (setup.systems.empty())
        for (int w = 0; w < count; ++w) system_begin.push_back(w + 1);
    for (const int size : setup.systems) system_begin.push_back(system_begin.back() + size);
    wire_list.resize(count);
    std::iota(wire_list.begin(), wire_list.end(), 0);
    for (int s = 0; s < system_count(); ++s)
        for (std::size_t k = 0; k < wires_of(s).size(); ++k) system_of.push_back(s);
}

World::Impl::Impl(WorldSetup from) : setup(checked(std::move(from))), rods(capacities(setup))
{
    const int count = static_cast<int>(setup.wires.size());
    divide_into_systems();
    feeds.resize(count);
    hub_requests.resize(count);
    parts.assign(count, StepParts{});
    if (!setup.mesh.triangles.empty()) {
        wall.emplace(setup.vessel, setup.mesh, setup.centreline);
        if (setup.vessel.elastic) elastic_wall = std::make_unique<ElasticWall>(*wall);
    }
    for (int w = 0; w < count; ++w) {
        WireSetup& wire = setup.wires[w];
        close_ring(wire);
        if (merged_spec_of(setup, w)) {
            rods.set_node_count(w, 2);
        } else if (wire.feed.on) {
            feeds[w].edge = uniform_edge(wire.wire);
            start_feed(feeds[w], wire.feed, wire.wire, rods, w);
        } else {
            place_wire(rods, w, wire.wire, setup.centreline.main_points());
        }
        const bool own = !merged_spec_of(setup, w);  // else its holds are taken once its line has been placed
        holds.emplace_back(own ? std::span<const HoldSpec>(wire.holds) : std::span<const HoldSpec>(), wire.loads, wire.links,
                           rods.view(w), wire.wire.length);
        if (merged_spec_of(setup, w)) adapters.emplace_back();
        else adapters.push_back(make_adapter(wire, holds[w].held_distances(), rods.capacity(w)));
    }
    retired.assign(count, 0);
    remesh_energy.assign(count, 0.0);
    carried.resize(static_cast<std::size_t>(count));
    left.resize(static_cast<std::size_t>(count));
    make_groups();
    solver = std::make_unique<Solver>(rods, setup.integrator, setup.gravity, setup.systems);
    for (const auto& group : merged) solver->join(group->shared);
    if (setup.device_index >= 0) device::check_device_index(setup.device_index);  // also where no vessel needs one
    if (!setup.mesh.triangles.empty()) {
        context = std::make_unique<device::Context>(setup.device_index, setup.wires[0].contact.precision == Precision::Float32);
        if (elastic_wall) unmoved_rods = std::make_unique<RodArrays>(rods);
        contact = make_contact(*context, contact_setup(setup, *wall), unmoved_rods ? *unmoved_rods : rods);
        if (elastic_wall) yielding = std::make_unique<YieldingWall>(*elastic_wall, *contact, rods, *unmoved_rods, system_of);
        terms.add(yielding ? static_cast<ForceTerm&>(*yielding) : *contact);
    }
    if (const InstrumentSetup touching = instrument_setup(setup, system_of); touching.any()) {
        if (!context) context = std::make_unique<device::Context>(setup.device_index);
        instruments = std::make_unique<InstrumentContact>(*context, touching, rods);
        terms.add(*instruments);
    }
    make_coaxial_friction();
    constraints.resize(count);
    make_line_holds();
    reports.resize(count);
    active.assign(count, 1);
    live.assign(count, 1);
    wire_reports.resize(count);
    wire_time.assign(count, 0.0);
    momentum_start.resize(count);
    results.resize(count);
    kept.resize(count);
    for (int w = 0; w < count; ++w)  // grows with the wire else
        kept[w].reserve(sizeof(double) * static_cast<std::size_t>(RodArrays::array_count) * static_cast<std::size_t>(rods.capacity(w)) + 512);
    for (int w = 0; w < count; ++w)
        if (feeds[w].on) hub_scratch.split.provide(rods.capacity(w));
    for (int w = 0; w < count; ++w) results[w].nodal_contact.assign(rods.capacity(w), Vec3::Zero());
    audits.resize(count);
    for (int w = 0; w < count; ++w) audits[w].limits = energy_limits(setup.wires[w].wire, setup.gravity);
    for (const auto& group : merged)
        for (const int w : group->wires().subspan(1)) audits[group->line()].limits.floor += audits[w].limits.floor;
    show_groups(*this);
}

World::Impl::~Impl() = default;

void World::Impl::make_groups()
{
    merged_of.assign(setup.wires.size(), -1);
    for (const CoaxialSpec& spec : setup.coaxial) {
        if (spec.model != CoaxialSpec::Model::Merged) continue;
        for (const int w : spec.order) merged_of[w] = static_cast<int>(merged.size());
        merged.push_back(std::make_unique<MergedGroup>());
        merged.back()->shared.wires = spec.order;
        MergedGroup& group = *merged.back();
        group.feed.edge = merged_edge(setup, spec);
        group.nodes = merged_nodes(setup, spec);
        NodeAdapter& adapter = adapters[group.line()];
        adapter.on = group.adapts();
        if (adapter.on) adapter.planner = NodePlanner(group.nodes, rods.capacity(group.line()));
        place_group(*this, group);
    }
    if (merged.empty()) return;
    shown = std::make_unique<RodArrays>(rods);
    shown_from.assign(setup.wires.size(), 0);
}

void World::Impl::make_coaxial_friction()
{
    std::size_t place = 0;
    for (const CoaxialSpec& spec : setup.coaxial) {
        if (spec.model != CoaxialSpec::Model::Merged) continue;
        MergedGroup& group = *merged[place++];
        const double pressed = spec.lumen_friction ? 1 : 0;
        const CoaxialFrictionSpec friction{spec.drag, spec.viscous, pressed * spec.mu_static, pressed * spec.mu_sliding};
        if (!friction.any()) continue;
        if (!coaxial_friction) coaxial_friction = std::make_unique<CoaxialFriction>(rods);
        coaxial_friction->add(group.shared, friction, group.adapts() ? group.nodes.min_edge : group.feed.edge);
    }
    if (coaxial_friction) terms.add(*coaxial_friction);
}

void World::Impl::make_line_holds()
{
    for (const auto& group : merged) {
        std::vector<int> held;
        for (const int w : group->wires()) held.push_back(static_cast<int>(setup.wires[w].holds.size()));
        if (std::ranges::all_of(held, [](int count) { return count == 0; })) continue;
        take_holds(*this, *group);
        if (!line_holds) line_holds = std::make_unique<LineHolds>(rods, constraints);
        line_holds->add(group->shared, held);
    }
    if (line_holds) terms.add(*line_holds);
}

bool World::Impl::is_passenger(int wire) const { return merged_of[wire] >= 0 && merged[merged_of[wire]]->line() != wire; }

bool World::Impl::is_clear(int wire) { return yielding ? yielding->is_clear(rods, wire) : contact->is_clear(rods, wire); }

void World::Impl::spread_over_systems(const WireMask& part, WireMask& mask) const
{
    for (int s = 0; s < system_count(); ++s) {
        bool any = false;
        for (const int w : wires_of(s)) any = any || mask[w];
        for (const int w : wires_of(s)) mask[w] = any && part[w];
    }
}

World::World(WorldSetup setup) : impl_(std::make_unique<Impl>(std::move(setup))) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

}  // namespace seldinger
