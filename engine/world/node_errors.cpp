// How far the finite length of edges has tip, energy and the forces at hands.

#include "world/node_errors.h"
#include "world/world_rod.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
    const WorldRod rod(*data_, data_->groups.line_of(wire));
    return rod.view().n > 2 ? planner_of(*data_, rod.line()).tip_error(rod.view(), wire_spec(*data_, rod.line()), judged_by(rod)) : 0;
}

BendingError World::bending_error(int wire) const
{
    if (data_->groups.is_passenger(wire)) return {};
    const WorldRod rod(*data_, wire);
    return rod.view().n > 2 ? planner_of(*data_, wire).bending_error(rod.view(), wire_spec(*data_, wire), judged_by(rod)) : BendingError{};
}

BendingError bending_error_between(const World& given, int wire, double from, double to)
{
    WorldData& world = data_of(const_cast<World&>(given));  // scratch of a group is made anew; the state is only read
    if (world.groups.is_passenger(wire)) return {};
    const WorldRod one(world, wire);
    const RodView rod = one.view();
    if (rod.n <= 2) return {};
    const auto s = rod.material_s.first(static_cast<std::size_t>(rod.n));
    const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, from), below = std::lower_bound(s.begin() + 1, s.end() - 1, to);
    return planner_of(world, wire).bending_error(rod, wire_spec(world, wire), judged_by(one), *(above - 1), *below);
}

namespace {

/// Jumps where a piece ends and instrument k with it, or its section: of the compliance of all together, and of their natural curvature.
std::pair<double, double> jumps_between(const CoaxialPiece& a, const CoaxialPiece& b, int k, int count)
{
    const auto stiffness_of = [&](const CoaxialPiece& piece) {
        double sum = 0;
        for (int j = 0; j < count; ++j) sum += piece.section[j] ? piece.section[j]->bend_stiffness : 0.0;
        return sum;
    };
    const double of_a = stiffness_of(a), of_b = stiffness_of(b);
    if (a.section[k] == b.section[k] || !(of_a > 0 && of_b > 0)) return {0, 0};
    const auto natural = [](const WireSection* section, double all) {
        return section ? Vec2(section->bend_stiffness / all * section->rest_curvature) : Vec2(Vec2::Zero());
    };
    double turn = 0;
    for (int j = 0; j < count; ++j) turn += (natural(a.section[j], of_a) - natural(b.section[j], of_b)).norm();
    return {std::abs(1 / of_a - 1 / of_b), turn};
}

/// hand_error() of instrument k, as if it did not lead.
double boundary_error(const MergedGroup& group, const RodView& line, std::span<const Vec3> moment, int k)
{
    const auto& pieces = group.shared.rod.pieces;
    const int hub = line.n - 1;
    double sum = 0;
    for (std::size_t p = 0; p + 1 < pieces.size(); ++p) {
        const auto [compliance, turn] = jumps_between(pieces[p], pieces[p + 1], k, group.shared.count());
        int i = 0;  // the cell that it is in
        while (i < hub && pieces[p].end >= 0.5 * (line.material_s[i] + line.material_s[i + 1])) ++i;
        double step = 0;
        if (i > 0) step = std::max(step, (moment[i] - moment[i - 1]).norm());
        if (i < hub) step = std::max(step, (moment[i + 1] - moment[i]).norm());
        sum += compliance * (moment[i].norm() * step + step * step / 4) / 2 + turn * step / 2;
    }
    return sum;
}

}  // namespace

double hand_error(const World& given, int wire)
{
    WorldData& world = data_of(const_cast<World&>(given));  // scratch of the group is made anew; the state is only read
    MergedGroup* group = world.groups.of(wire);
    if (!group || !group->feed.inside) return 0;
    const WorldRod rod(world, group->line());
    const NodeDemands demands = rod.demands();
    const auto wires = group->wires();
    double sum = 0;
    for (int k = 0; k < group->shared.count(); ++k)
        if (k != group->leader && (wires[k] == wire || wires[group->leader] == wire)) sum += boundary_error(*group, rod.view(), demands.moment, k);
    return sum;
}

}  // namespace seldinger
