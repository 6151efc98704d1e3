// Residuals of steps cut short, from one step to the next.
#include "world/carried.h"

#include "core/state_walk.h"
#include "newton/solver.h"
#include "world/world.h"

#include <algorithm>

namespace seldinger {
namespace {

constexpr std::uint32_t most_carried = 1u << 20;  // places of one wire, in a file

}  // namespace

void add_left(const ConstRodView& rod, const Solver& solver, int wire, double h, std::vector<CarriedImpulse>& left)
{
    double s = 0;
    for (int i = 0; i < rod.n; ++i) {
        const Vec3 force = solver.force_left(wire, i);
        if (!force.isZero()) left.push_back({s, -h * force});
        if (i + 1 < rod.n) s += rod.rest_length[i];
    }
}

void carry(const ConstRodView& rod, const std::vector<CarriedImpulse>& left, double dt, WireConstraints& constraints)
{
    int edge = 0;
    double begin = 0;
    for (const CarriedImpulse& at : left) {  // from the tip on, but for those of several sub-steps
        if (at.s < begin) edge = 0, begin = 0;
        while (edge + 2 < rod.n && at.s >= begin + rod.rest_length[edge]) begin += rod.rest_length[edge++];
        const double bary = std::clamp((at.s - begin) / rod.rest_length[edge], 0.0, 1.0);
        constraints.carried.push_back({edge, bary, (1 / dt) * at.impulse, Vec3::Zero()});
    }
}

void walk_carried(StateWalk& walk, std::span<WireState> states, std::span<const int> wires)
{
    const bool rows =
        walk.reads() ? walk.left() > 0 : std::ranges::any_of(wires, [&](int w) { return !states[w].carried.empty(); });
    for (const int w : wires) {
        std::vector<CarriedImpulse>& of = states[w].carried;
        if (walk.reads()) of.clear();
        if (!rows) continue;
        walk.list<std::uint32_t>({"a force that is carried into the next step", "N s", "carry_on"}, of, most_carried);
        for (const CarriedImpulse& at : of)
            if (walk.checks()) StateWalk::need(at.s >= 0 && at.impulse.allFinite(), "a force that is carried into the next step");
    }
}

}  // namespace seldinger
