// The feed stage: the control's input for the hubs, and holds, loads and links for the rest of the wire.

#include "core/parallel.h"
#include "world/merged.h"
#include "world/step_stages.h"
#include "world/world.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr double most_feed_parts = 4096;

/// From where the hub is, steadily to where it is asked to be; and on at that speed, as far as anyone knows.
HubRequest steady(const FeedState& feed, double now, double dt, double advance, double turn)
{
    HubRequest request;
    const double fed = advance - feed.advance, turned = turn - feed.turn;
    request.own = {FeedKey{now, feed.advance, feed.turn}, FeedKey{now + dt, advance, turn},
                   FeedKey{now + 2 * dt, std::max(0.0, advance + fed), turn + turned}};
    return request;
}

int parts_of(World::Impl& state, int w, double dt)
{
    const FeedState& feed = state.feeds[w];
    if (!feed.on) return 1;
    const HubPath hub = state.hub_requests[w].path();
    const double t = state.wire_time[w];
    const double pushed = hub.travel(t, t + dt, +1), pulled = hub.travel(t, t + dt, -1);
    const MergedGroup* group = state.group_of(w);
    const double even = feed.edge / 2;
    const double shortest = group                  ? (group->adapts() ? group->nodes.min_edge : even)
                            : state.adapters[w].on ? state.setup.wires[w].wire.min_edge
                                                   : even;
    const RodView rod = state.rods.view(w);
    // a pull by more than half of the base edge takes it out in time where it is known beforehand
    const double base = feed.inside ? std::min(rod.rest_length[rod.n - 2], shortest) : shortest;
    // two instruments on one centreline may go opposite ways; the lead of one is then put before the tip in one piece
    const double most = group ? feed.edge / 4 : feed.edge;
    const double parts = std::ceil(std::max(pushed / most, pulled / (base / 2)) - 1e-9);
    return static_cast<int>(std::clamp(parts, 1.0, most_feed_parts));
}

void constrain(World::Impl& state, int w, double t)
{
    const RodView rod = state.rods.view(w);
    if (const MergedGroup* group = state.group_of(w)) return constrain_member(state, *group, w, t);
    state.holds[w].fill(t, rod, state.constraints[w]);
    if (state.feeds[w].on) add_feed_constraints(state.feeds[w], rod, state.constraints[w]);
}

/// All that is done to instruments that share a centreline is done when their line's turn comes.
void feed_merged(World::Impl& state, int line, double step, double h)
{
    MergedGroup& group = *state.group_of(line);
    lead_group(state, group, h);
    audit_remeshing(state, line);
    feed_group(state, group, step, h);
}

}  // namespace

void take_control(World::Impl& state, const Control& control, double dt)
{
    const std::span<const Control::Hub> hubs = control.hubs();
    state.step_length = dt;
    for (int w = 0; w < state.wire_count(); ++w) {
        const FeedState& feed = state.feeds[w];
        const Control::Hub hub = static_cast<std::size_t>(w) < hubs.size() ? hubs[w] : Control::Hub{};
        HubRequest& request = state.hub_requests[w];
        switch (hub.kind) {
            case Control::Hub::Kind::Stay:
                request = steady(feed, state.wire_time[w], dt, feed.advance, feed.turn);
                break;
            case Control::Hub::Kind::MoveTo:
                request = steady(feed, state.wire_time[w], dt, hub.advance, hub.turn);
                break;
            case Control::Hub::Kind::Follow:
                request.keys = hub.keys;
                break;
        }
    }
}

std::span<const StepParts> feed_parts(World::Impl& state, double dt, StepReport& report)
{
    std::vector<StepParts>& parts = state.parts;
    for (int s = 0; s < state.system_count(); ++s) {
        StepParts most;
        for (const int w : state.wires_of(s)) {
            most.count = std::max(most.count, parts_of(state, w, dt));
            if (const MergedGroup* group = state.group_of(w); group && w == group->line())
                most.cut = lead_change_after(state, *group, dt);
        }
        for (const int w : state.wires_of(s)) {
            parts[w] = most;
            if (!state.retired[w]) note(state, report, w, StepOk, 0, most.count + (most.cut > 0));
        }
    }
    return parts;
}

void feed_hubs(World::Impl& state, const SubStep& sub)
{
    // of an equilibrium a step's length is no time: no speed, and the rest length that births have left over is taken back at once
    const double h = state.setup.integrator.scheme == Scheme::Static ? INFINITY : sub.h;
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        if (!sub.wires[w] || state.is_passenger(w)) return;
        state.momentum_start[w] = {momentum(state.rods.view(w)), Vec3::Zero()};
        if (state.merged_of[w] >= 0) return feed_merged(state, w, sub.h, h);
        audit_remeshing(state, w);
        if (!state.feeds[w].on) return;
        FeedingAudit feeding(state, w);
        const FeedKey end = state.hub_requests[w].path().at(state.wire_time[w] + sub.h);
        feed_to(state.feeds[w], end, state.setup.wires[w].wire, state.rods, w, h);
        feeding.after(state);
    });
}

void hold_and_load(World::Impl& state, const SubStep& sub)
{
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        state.live[w] = state.active[w] = sub.wires[w] && state.is_solved(w);
        if (!sub.wires[w]) return;
        constrain(state, w, state.wire_time[w] + sub.h);
        if (!state.carried[w].empty()) carry(state.rods.view(w), state.carried[w], state.step_length, state.constraints[w]);
        if (state.is_passenger(w)) return;
        MomentumStart& start = state.momentum_start[w];
        start.fed = momentum(state.rods.view(w)) - start.momentum;
    });
}

void constrain_now(World::Impl& state, int w) { constrain(state, w, state.wire_time[w]); }

void constrain_at(World::Impl& state, int w, double t) { constrain(state, w, t); }

}  // namespace seldinger
