// How far the finite length of edges has tip and energy.
#include "world/node_errors.h"
#include "world/world_rod.h"

#include <algorithm>
#include <limits>

namespace seldinger {
namespace {

/// What a rod's shape is judged by.
NodeDemands judged_by(const WorldRod& rod)
{
    NodeDemands demands = rod.demands();
    demands.contact = rod.contact();
    return demands;
}

const WireSpec& wire_spec(const WorldData& world, int wire) { return world.setup.wires[wire].wire; }

NodePlanner planner_of(const WorldData& world, int line) { return {wire_spec(world, line), world.state.rods.capacity(line)}; }

}  // namespace

double World::node_error(int wire) const
{
    const WorldRod rod(*data_, data_->line_of(wire));
    return rod.view().n > 2 ? planner_of(*data_, rod.line()).tip_error(rod.view(), wire_spec(*data_, rod.line()), judged_by(rod))
                            : 0;
}

BendingError World::bending_error(int wire) const
{
    return bending_error_between(*this, wire, 0, std::numeric_limits<double>::infinity());
}

BendingError bending_error_between(const World& given, int wire, double from, double to)
{
    WorldData& world = data_of(given);
    if (!world.is_line(wire)) return {};
    const WorldRod one(world, wire);
    const RodView rod = one.view();
    if (rod.n <= 2) return {};
    const auto s = rod.material_s.first(static_cast<std::size_t>(rod.n));
    const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, from),
               below = std::lower_bound(s.begin() + 1, s.end() - 1, to);
    return planner_of(world, wire).bending_error(rod, wire_spec(world, wire), judged_by(one), *(above - 1), *below);
}

}  // namespace seldinger
