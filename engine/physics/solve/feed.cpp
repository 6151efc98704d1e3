// Feeding a wire: the introducer, the growing base edge, births and merges of the node next to the inlet.
#include "solve/feed.h"

#include "core/check.h"
#include "rod/place.h"
#include "rod/transport.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace seldinger {
namespace {

// Surpluses of rest length fade over this time [s], or while an edge is fed: slow against axial waves, fast against a hand.
constexpr double surplus_time = 0.025;
// Length of a base edge when its node is born, of an edge. Shorter, and rounding of positions (1e-17 m) times EA/l would show in
// the force; longer, and so would the polygon's error.
constexpr double base_born = 0.005;

Vec3 turned_director(const FeedState& state) { return turned(state.director, state.direction, state.turn); }

// The piece of wire in the introducer: two nodes, half an edge long, its tip `advance` beyond the inlet.
void place_in_introducer(const FeedState& state, const WireSpec& wire, RodArrays& rods, int index, double speed, double spin)
{
    rods.set_node_count(index, 2);
    const RodView rod = rods.view(index);
    const double length = state.edge / 2;
    rod.set_pos(0, state.point + state.advance * state.direction);
    rod.set_pos(1, state.point + (state.advance - length) * state.direction);
    rod.material_s[0] = 0;
    rod.material_s[1] = length;
    for (int i = 0; i < 2; ++i) {
        rod.set_vel(i, speed * state.direction);
        rod.ax[i] = rod.ay[i] = rod.az[i] = rod.ref_twist[i] = rod.theta[i] = rod.spin_acc[i] = 0;
        rod.spin_rate[i] = -spin;  // theta turns about the edge's tangent, which points back at the hub
    }
    initialise_frames(rod, turned_director(state));
    // the frame is the turned one, so the angle from it is none; but the count of turns must go on
    rod.theta[0] = -state.turn;
    rod.set_ref_d1(0, state.director - state.director.dot(state.direction) * state.direction);
    set_rest_shape(rod, wire, false);
}

/// The way from s to the next end of a section that is at least half an edge of h away, infinite without one [m].
double way_to_boundary(const WireSpec& wire, double s, double h)
{
    double way = INFINITY;
    wire.for_each_end([&](double end) {
        if (end - s >= 0.5 * h && end < wire.length) way = std::min(way, end - s);
    });
    return way;
}

double edges_in(double way, double h) { return std::max(1.0, std::round(way / h)); }

/// material_s of a wire that starts with a length inside: even between ends of sections; adaptive nodes come to these by
/// themselves.
std::vector<double> start_nodes(const WireSpec& wire, double inside, double h)
{
    std::vector<double> at{0};
    while (at.back() < inside) {
        const double from = at.back(), to = wire.nodes > 0 ? from + way_to_boundary(wire, from, h) : INFINITY;
        const bool last = to > inside - 0.5 * h;
        const double way = last ? inside - from : to - from, edges = edges_in(way, h);
        for (int i = 1; i <= edges; ++i) at.push_back(from + way * i / edges);
        if (last) break;
    }
    return at;
}

}  // namespace

double even_edge(const WireSpec& wire, double s, double h)
{
    const double way = way_to_boundary(wire, s, h);
    return std::isfinite(way) ? way / edges_in(way, h) : h;
}

void start_feed(FeedState& state, const FeedSpec& spec, const WireSpec& wire, RodArrays& rods, int index)
{
    state.on = 1;
    rods.set_curvature(index, wire.curvature);
    state.point = spec.point;
    state.direction = spec.direction.normalized();
    // first director: the upright side of the wire as it lies in the introducer
    Vec3 up = Vec3::UnitZ() - state.direction.z() * state.direction;
    if (up.norm() < 0.1) up = Vec3::UnitX() - state.direction.x() * state.direction;
    state.director = up.normalized();
    state.advance = spec.advance;
    state.turn = spec.turn;
    place_in_introducer(state, wire, rods, index, 0, 0);
    if (state.advance > state.edge / 2) {  // starts with a length inside: along the path that is given, or straight ahead
        const double inside = state.advance;
        const std::vector<double> nodes = start_nodes(wire, inside, state.edge);
        const int count = static_cast<int>(nodes.size());
        rods.set_node_count(index, count);
        const RodView rod = rods.view(index);
        for (int i = 0; i < count; ++i) {
            rod.material_s[i] = nodes[i];
            rod.set_pos(i, state.point + (inside - rod.material_s[i]) * state.direction);
            rod.set_vel(i, Vec3::Zero());
            rod.ax[i] = rod.ay[i] = rod.az[i] = rod.ref_twist[i] = rod.spin_rate[i] = rod.spin_acc[i] = 0;
        }
        if (!spec.path.empty()) lay_along(rod, spec.path);
        initialise_frames(rod, state.director);
        for (int j = 0; j + 1 < count; ++j) rod.theta[j] = -state.turn;
        set_rest_shape(rod, wire, false);
        state.inside = 1;
    }
}

void feed_to(FeedState& state, const FeedKey& end, const WireSpec& wire, RodArrays& rods, int index, double h)
{
    const double fed = end.advance - state.advance, turned = end.turn - state.turn;
    state.advance = end.advance;
    state.turn = end.turn;
    state.speed = fed / h;
    state.grown = fed;
    if (!state.inside) {
        place_in_introducer(state, wire, rods, index, fed / h, turned / h);
        state.inside = state.advance >= state.edge / 2;
        if (state.inside) {  // what is beyond half an edge is already base edge
            const RodView rod = rods.view(index);
            // the step that follows takes the tip to where the introducer has it at its end, and turns it
            rod.set_pos(0, state.point + (state.advance - fed) * state.direction);
            rod.set_pos(1, state.point);
            rod.theta[0] += turned;
            rod.material_s[1] = state.advance;
            set_rest_shape(rod, wire, false);
        }
        return;
    }
    const RodView rod = rods.view(index);
    const int hub = rod.n - 1;
    if (hub == 1 && state.advance < state.edge / 2) {  // pulled back into the introducer
        state.inside = 0;
        state.surplus = state.surplus_rate = 0;
        place_in_introducer(state, wire, rods, index, fed / h, turned / h);
        return;
    }
    // the surplus of a wire that flies apart may have any length: the base edge keeps half of its length, and gains no more
    const double faded = fade_surplus(state, h), most = 0.5 * std::abs(rod.rest_length[hub - 1] + fed);
    const double taken = std::clamp(faded, -most, most);
    state.surplus += taken - faded;
    state.grown = fed + taken;
    // nor is more of it pulled out than there is: keys that begin elsewhere than the hub is ask for that
    const double least = -0.9 * rod.rest_length[hub - 1];
    if (state.grown < least) {
        state.surplus += least - state.grown;
        state.grown = least;
    }
    rod.material_s[hub] += state.grown;
    set_rest_shape(rod, wire, false);
}

double fade_surplus(FeedState& state, double h)
{
    const double before = state.surplus, w = 1 / surplus_time + (state.on ? std::abs(state.speed) / state.edge : 0.0);
    if (before == 0 && state.surplus_rate == 0) return 0;
    if (std::isfinite(h)) {
        const double slope = state.surplus_rate + w * before, left = std::exp(-w * h);
        state.surplus = (before + slope * h) * left;
        state.surplus_rate = (state.surplus_rate - w * slope * h) * left;
    } else {
        state.surplus = state.surplus_rate = 0;
    }
    return state.surplus - before;
}

BaseEdge base_edge_limits(double whole, double pushed, double pulled)
{
    const double half = 0.5 * whole;
    return {whole, pushed > 0 ? std::clamp(pushed, base_born * whole, half) : half,
            std::clamp(2 * pulled, 0.5 * base_born * whole, half)};
}

void add_feed_constraints(const FeedState& state, const RodView& rod, WireConstraints& out)
{
    const int hub = rod.n - 1;
    for (int k = 0; k < 3; ++k) out.prescribed.emplace_back(RodDofs::position(hub, k), state.point[k]);
    out.hub_flow = state.speed * state.direction;
    out.base_grown = state.grown;
    RodClamp clamp;
    clamp.node = hub;
    clamp.direction = clamp.spin = true;
    clamp.tangent = -state.direction;
    clamp.director = turned_director(state);
    clamp.turns = -state.turn;
    out.clamps.push_back(clamp);
}

double energy_now(const RodView& rod, std::span<const RodClamp> clamps, RodFrames& frames)
{
    const RodTrial now{rod.x, rod.y, rod.z, rod.theta};
    return update_frames(rod, now, clamps, frames) ? elastic_energy(rod, clamps, frames) : 0.0;
}

BaseChange base_change(const RodView& rod, const BaseEdge& limits, int capacity)
{
    const double length = rod.rest_length[rod.n - 2];
    if (limits.whole > 0 && length >= limits.whole + limits.born && rod.n < capacity) return BaseChange::Split;
    return length < limits.least && rod.n > 2 ? BaseChange::Merge : BaseChange::None;
}

void change_base(FeedState& state, const RodNodes& rod, BaseChange change, const BaseEdge& limits, SplitScratch& scratch)
{
    const double length = rod.line().rest_length[rod.line().n - 2];
    const SplitResult result =
        change == BaseChange::Split ? split_base_edge(rod, limits.whole / length, scratch) : merge_base_edges(rod);
    state.surplus += result.rest_length_added;
    state.surplus_rate = std::clamp(result.base_rate - state.speed, -std::abs(state.speed), std::abs(state.speed));
}

}  // namespace seldinger
