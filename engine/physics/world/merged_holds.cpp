// Constraints and loads of instruments on one centreline: the hub, and the scene's points on their material.
#include "core/error.h"
#include "solve/given_forces.h"
#include "solve/line_holds.h"
#include "world/merged.h"

#include <fmt/format.h>

namespace seldinger {
namespace {

int nearest_line_node(const RodView& line, double s)
{
    int node = 0;
    while (node + 1 < line.n && 0.5 * (line.material_s[node] + line.material_s[node + 1]) < s) ++node;
    return node;
}

/// A hold, as it is placed.
struct Taken {
    int wire, index, node;  // node: of the line, the nearest
    const HoldSpec* spec;
};

void refuse_both(const Taken& a, const Taken& b)
{
    if (a.node != b.node) return;
    const char* what = a.spec->position && b.spec->position                  ? "position"
                       : a.spec->direction && b.spec->direction              ? "direction"
                       : a.spec->spin && b.spec->spin && a.wire == b.wire ? "spin"
                                                                             : nullptr;
    if (!what) return;
    throw Error(ErrorKind::BadScene,
                fmt::format("wires[{}].holds[{}], wires[{}].holds[{}]: got two holds of the {} of one centreline (merged) at one "
                            "position; expected one. Fix: keep one of them, or place them farther apart than the node spacing",
                            a.wire, a.index, b.wire, b.index, what));
}

/// Puts what acts on material of the line between the nodes of the edge that the material goes on with.
template <class Acting>
void take_along(const CoaxialRod& rod, const RodView& line, std::vector<Acting>& all)
{
    for (Acting& acting : all) {
        const double s = line.material_s[acting.edge] + acting.bary * line.rest_length[acting.edge];
        const int edge = coaxial_edge_of(rod, line, s, acting.edge);
        if (edge == acting.edge) continue;
        acting.edge = edge;
        acting.bary = (s - line.material_s[edge]) / line.rest_length[edge];
    }
}

}  // namespace

void take_holds(WorldData& world, MergedGroup& group)
{
    const RodView line = world.rod(group.line());
    std::vector<Taken> taken;
    for (int k = 0; k < group.shared.count(); ++k) {
        const int w = group.wires()[k];
        const std::vector<HoldSpec>& specs = world.setup.wires[w].holds;
        if (!specs.empty() && !group.feed.inside)
            throw Error(
                ErrorKind::BadScene,
                fmt::format("wires[{}].holds: got a wire that is outside at the start; expected the held point inside. Fix: feed "
                            "some of it in (feed.advance)",
                            w));
        const double offset = group.shared.rod.instrument[k].offset;
        world.holds[w].take_line_holds(specs, world.rod(w), offset);
        for (std::size_t h = 0; h < specs.size(); ++h) {
            const double from_tip = specs[h].at.kind == WirePoint::Kind::Tip ? 0.0 : specs[h].at.from_tip;
            const Taken now{w, static_cast<int>(h), nearest_line_node(line, from_tip - offset), &specs[h]};
            for (const Taken& other : taken) refuse_both(other, now);
            taken.push_back(now);
        }
    }
}

void constrain_member(WorldData& world, const MergedGroup& group, int wire, double t)
{
    WireConstraints& out = world.constraints(wire);
    out.clear();
    const RodView line = world.rod(group.line());
    for (int k = 0; k < group.shared.count(); ++k)
        if (group.wires()[k] == wire && group.feed.inside)
            world.holds[wire].add_line_holds(t, line, group.shared.rod.instrument[k].offset, out);
    if (wire != group.line()) return;
    add_feed_constraints(group.feed, line, out);
    for (int k = 0; k < group.shared.count(); ++k)
        world.holds[group.wires()[k]].add_loads(t, line, group.shared.rod.instrument[k].offset, k, out);
    take_along(group.shared.rod, line, out.loads);
    take_along(group.shared.rod, line, out.springs);
}

void load_members(WorldData& world, const MergedGroup& group)
{
    const RodView line = world.rod(group.line());
    WireConstraints& out = world.constraints(group.line());
    for (int k = 0; k < group.shared.count(); ++k)
        for (const LoadSpec& load : world.work.wires[group.wires()[k]].loads)
            WireHolds::add_load(load, 0, line, group.shared.rod.instrument[k].offset, k, out);
    take_along(group.shared.rod, line, out.loads);
}

double axial_load(WorldData& world, const MergedGroup& group, int k)
{
    const WireConstraints& constraints = world.constraints(group.line());
    const RodView line = world.rod(group.line());
    const auto forwards = [&](int edge) { return (line.pos(edge) - line.pos(edge + 1)).normalized(); };
    double force = 0;
    for (const auto& load : constraints.loads)
        if (load.member == k) force += load.force.dot(forwards(load.edge));
    for (const auto& spring : constraints.springs)
        if (spring.member == k) force += spring.pull(line).dot(forwards(spring.edge));
    if (world.forces.line_holds) force += world.forces.line_holds->along(group.wires()[k]);
    if (world.forces.given) force += world.forces.given->along(group.wires()[k]);
    return force;
}

}  // namespace seldinger
