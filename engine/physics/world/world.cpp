// Building a World: rods and feeds placed, holds resolved, contact and solver made. What happens in a step is in step.cpp.
#include "world/world.h"

#include "contact/wall_body.h"
#include "core/error.h"
#include "rod/place.h"
#include "rod/rod_arrays.h"
#include "solve/given_forces.h"
#include "wall/wall_model.h"
#include "world/setup_check.h"
#include "world/world_rod.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
    return adapter;
}

int node_capacity(const WireSetup& setup)
{
    const int nodes = uniform_node_count(setup.wire);
    // edges of min_edge everywhere, surpluses of rest length included
    if (nodes_adapt(setup)) return static_cast<int>(std::ceil(1.01 * setup.wire.length / setup.wire.min_edge)) + 4;
    // a fed wire's base edge may be split before the last is merged, and each end of a section may add half an edge
    // (solve/feed.h)
    return setup.feed.on ? nodes + 4 + static_cast<int>(setup.wire.sections.size()) : nodes;
}

std::vector<int> capacities(const WorldSetup& setup)
{
    std::vector<int> list;
    for (const WireSetup& wire : setup.wires) list.push_back(node_capacity(wire));
    set_group_capacities(setup, list);
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

WorldSetup checked(WorldSetup setup)
{
    check_setup(setup);
    return setup;
}

/// Places each wire as its scene says, with its holds. Instruments of a group get no rods here.
void place_wires(WorldData& world)
{
    const int count = world.wire_count();
    world.work.wires.resize(count);
    for (int w = 0; w < count; ++w) {
        WireSetup& wire = world.setup.wires[w];
        RodArrays& rods = world.state.rods;
        close_ring(wire);
        if (!world.is_alone(w)) {  // its holds are taken once its line has been placed
            rods.set_node_count(w, 2);
            world.holds.emplace_back(std::span<const HoldSpec>(), wire.loads, wire.links, rods.view(w), wire.wire.length);
            continue;
        }
        if (wire.feed.on) {
            world.feed(w).edge = uniform_edge(wire.wire);
            start_feed(world.feed(w), wire.feed, wire.wire, rods, w);
        } else {
            place_wire(rods, w, wire.wire, world.setup.centreline.main_points());
        }
        world.holds.emplace_back(wire.holds, wire.loads, wire.links, rods.view(w), wire.wire.length);
        world.adapter(w) = make_adapter(wire, world.holds[w].held_distances(), rods.capacity(w));
    }
}

/// All that steps write, as large as it can become: the step loop allocates nothing.
void provide_work(WorldData& world)
{
    const int count = world.wire_count();
    world.work.parts.assign(count, StepParts{});
    world.work.reports.resize(count);
    world.work.active.assign(count, 1);
    world.work.live.assign(count, 1);
    world.output.results.resize(count);
    world.output.reports.resize(count);
    for (int w = 0; w < count; ++w) {
        const auto capacity = static_cast<std::size_t>(world.state.rods.capacity(w));
        world.work.wires[w].kept.reserve(sizeof(double) * static_cast<std::size_t>(RodArrays::array_count) * capacity + 512);
        if (world.feed(w).on) world.work.wires[w].mass = world.work.wires[w].inertia = std::vector<double>(capacity);
        if (world.feed(w).on || world.adapter(w).on) world.work.split.provide(static_cast<int>(capacity));
        world.output.results[w].nodal_contact.assign(capacity, Vec3::Zero());
    }
}

}  // namespace

WorldData::WorldData(WorldSetup from, std::shared_ptr<const WallBody> wall)
    : setup(checked(std::move(from))),
      systems(static_cast<int>(setup.wires.size()), setup.systems),
      state(capacities(setup)),
      forces(setup, std::move(wall))
{
    make_groups(*this);
    place_wires(*this);
    place_groups(*this);
    solver = std::make_unique<Solver>(state.rods, setup.integrator, setup.gravity, setup.systems);
    forces.make_contacts(setup, systems, state.rods);
    work.constraints.resize(wire_count());
    join_groups(*this);
    provide_work(*this);
    for (int w = 0; w < wire_count(); ++w) {
        if (!is_line(w)) continue;
        double& floor = audit(w).limits.floor = 0;
        for (const int one : WorldRod(*this, w).wires()) floor += energy_floor(setup.wires[one].wire, setup.gravity);
    }
    show_instruments(*this);
    for (int w = 0; w < wire_count(); ++w)
        for (const std::shared_ptr<const Force>& force : setup.wires[w].forces) add_force(w, force);
}

void check_start(const WorldSetup& setup)
{
    check_setup(setup);
    if (setup.vessel.elastic) check_wall_body(WallModel(setup.vessel, setup.mesh, setup.centreline));
    WorldSetup bare;  // without contact, which needs a device and refuses nothing that the above has let pass
    bare.gravity = setup.gravity;
    bare.wires = setup.wires;
    bare.systems = setup.systems;
    bare.integrator = setup.integrator;
    bare.centreline = setup.centreline;
    for (const CoaxialSpec& spec : setup.coaxial)
        if (spec.model == CoaxialSpec::Model::Merged) bare.coaxial.push_back(spec);
    (void)WorldData(std::move(bare), nullptr);
}

World::World(WorldSetup setup) : data_(std::make_unique<WorldData>(std::move(setup))) {}
World World::twin() const { return World(std::make_unique<WorldData>(data_->setup, data_->forces.wall_body)); }

void World::add_force(int instrument, std::shared_ptr<const Force> force)
{
    data_->add_force(instrument, force);
    data_->setup.wires[static_cast<std::size_t>(instrument)].forces.push_back(std::move(force));
}

void WorldData::add_force(int instrument, std::shared_ptr<const Force> force)
{
    if (!force) throw Error(ErrorKind::BadScene, "add_force: got no force; expected one");
    const std::string where = fmt::format("force \"{}\"", force->name);
    check_on_wire(*this, instrument, 0, where.c_str(), "places");
    for (const double at : force->places) check_on_wire(*this, instrument, at, where.c_str(), "places");
    if (force->on == Force::On::Points && force->places.empty())
        throw Error(ErrorKind::BadScene, where + ": places: got none; expected at least one, or every node or edge");
    if (!std::ranges::all_of(force->state, [](double value) { return std::isfinite(value); }))
        throw Error(ErrorKind::BadScene, where + ": state: got a number that is not finite; expected finite numbers");
    if (force->together && !force->state.empty())
        throw Error(ErrorKind::BadScene, where + ": state: got some, and together; expected no state");
    if (force->record.size() > force->state.size())
        throw Error(ErrorKind::BadScene, fmt::format("{}: record: got {} names; expected at most {}, the numbers of its state",
                                                     where, force->record.size(), force->state.size()));
    if (!forces.given) {
        forces.given = std::make_unique<GivenForces>(state.rods, setup.integrator);
        forces.terms.add(*forces.given);
        watch_ends(*this);
    }
    const MergedGroup* group = groups.of(instrument);
    const int member = group ? static_cast<int>(std::ranges::find(group->wires(), instrument) - group->wires().begin()) : 0;
    forces.given->add(instrument, std::move(force), group ? &group->shared : nullptr, member);
    forces.given->set_time(instrument, state.wires[instrument].time, 0);
}
World::World(std::unique_ptr<WorldData> data) : data_(std::move(data)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

}  // namespace seldinger
