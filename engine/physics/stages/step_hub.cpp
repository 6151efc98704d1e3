// Hubs that a force drives (D16, solve/driven_hub.h): how far they go in a sub-step, and whether that suits what instruments
// answer.
#include "stages/step_stages.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace seldinger {
namespace {

constexpr int most_trials = 40;          // Newton's method takes two to four; more where the answer jumps, as at the inlet
constexpr double rounding_share = 1e-9;  // of the forces in the equation

/// How far a sub-step may feed: what one birth can follow, and what leaves some of the base edge.
double within_reach(WorldData& world, int w, double u)
{
    const FeedState& feed = world.feed(w);
    const RodView line = world.rod(world.line_of(w));
    return std::clamp(u, feed.inside ? -0.9 * line.rest_length[line.n - 2] : -feed.edge, feed.edge);
}

/// How much of it may be inside now: nothing of one that waits for another to come out.
double most_inside(const WorldData& world, int w)
{
    for (const CoaxialSpec& spec : world.setup.coaxial) {
        const std::span<const int> turns = spec.turns();
        if (std::ranges::find(turns, w) == turns.end()) continue;
        if (std::ranges::any_of(turns, [&](int other) { return other != w && world.feed(other).advance > 0; })) return 0;
    }
    return world.setup.wires[w].wire.length;
}

void begin_trials(WorldData& world, int w, double h)
{
    const FeedState& feed = world.feed(w);
    const HubState& hub = world.state.wires[w].hub;
    HubRequest& request = world.work.wires[w].hub;
    HubTrial& trial = world.work.wires[w].trial;
    const double t = world.state.wires[w].time;
    FeedKey asked{0, 0, feed.turn + (request.turn - feed.turn) * h / std::max(h, request.until - t), request.force};
    if (!request.keys.empty()) asked = HubPath(request.keys).at(t + h);
    const double force = asked.force - request.spring * (feed.advance - request.from);
    const double farthest = most_inside(world, w) - feed.advance;
    trial.equation = HubEquation(world.setup.wires[w].feed.hub, hub, force, request.spring, h, -feed.advance, farthest);
    trial.answer = {within_reach(world, w, trial.equation.first()), 0, 0};
    request.own[1].turn = asked.turn;
}

/// The last trial's answer, and whether another one is needed.
enum class Balance { Holds, Again, Fails };
Balance balance(WorldData& world, int w, double h)
{
    HubTrial& trial = world.work.wires[w].trial;
    const SolveReport& report = world.work.reports[world.line_of(w)];
    const HubState& hub = world.state.wires[w].hub;
    const bool solved = world.work.active[w];
    std::tie(trial.answer.force, trial.answer.stiffness) = hand_answer(world, w);
    if (solved && report.iterations == 0) trial.answer.stiffness = hub.stiffness + hub.mass / (h * h);  // nothing was factorised
    ++trial.trials;
    const double speeds = std::abs(hub.speed) + std::abs(trial.answer.at) / h;
    const double force = world.setup.wires[w].feed.hub.mass * speeds / h + std::abs(trial.answer.force);
    const double tolerance = (solved ? report.tolerance : 0.0) + rounding_share * force;
    const double rest = trial.equation.rest(trial.answer.at, trial.answer.force);
    if (std::abs(rest) <= tolerance || (solved && report.cut_short)) return Balance::Holds;
    const double last = trial.answer.at, next = within_reach(world, w, trial.equation.next(trial.answer));
    if (trial.equation.closed()) return Balance::Holds;
    if (next == last || trial.trials == most_trials) return Balance::Fails;
    trial.answer.at = next;
    return Balance::Again;
}

double mass_inside(WorldData& world, int w)
{
    const RodView line = world.rod(world.line_of(w));
    double mass = 0;
    for (int i = 0; i < line.n && world.state.is_solved(w); ++i) mass += line.mass[i];
    return mass;
}

}  // namespace

void aim_hubs(WorldData& world, const SubStep& sub)
{
    for (int w = 0; w < world.wire_count(); ++w) {
        if (!sub.wires[w] || !world.is_driven(w)) continue;
        if (world.work.wires[w].trial.trials == 0) begin_trials(world, w, sub.h);
        const FeedState& feed = world.feed(w);
        const double t = world.state.wires[w].time, u = world.work.wires[w].trial.answer.at;
        auto& own = world.work.wires[w].hub.own;
        own[0] = {t, feed.advance, feed.turn};
        own[1] = {t + sub.h, feed.advance + u, own[1].turn};
        const double on = std::clamp(own[1].advance + world.work.length / sub.h * u, 0.0, world.setup.wires[w].wire.length);
        own[2] = {t + sub.h + world.work.length, on, own[1].turn};
    }
}

WireMask balance_hubs(WorldData& world, const SubStep& sub, WireMask& failed)
{
    WireMask again(sub.wires.size());
    for (int w = 0; w < world.wire_count(); ++w) {
        if (!sub.wires[w] || failed[w] || !world.is_driven(w)) continue;
        const Balance found = balance(world, w, sub.h);
        failed[w] = found == Balance::Fails && sub.halvings < most_halvings;
        again[w] = found == Balance::Again;
    }
    world.systems.spread(sub.wires, failed);
    for (std::size_t w = 0; w < again.size(); ++w) again[w] = again[w] && !failed[w];
    world.systems.spread(sub.wires, again);
    return again;
}

void take_hub(WorldData& world, int w)
{
    HubTrial& trial = world.work.wires[w].trial;
    if (trial.trials > 0) world.state.wires[w].hub = trial.equation.after(trial.answer, mass_inside(world, w));
    trial.trials = 0;
}

}  // namespace seldinger
