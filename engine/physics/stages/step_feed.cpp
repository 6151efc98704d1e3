// The feed stage: the control's input for the hubs, and holds, loads and links for the rest of the wire.
#include "core/parallel.h"
#include "stages/step_stages.h"

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

int parts_of(WorldData& world, int w, double dt)
{
    const FeedState& feed = world.feed(w);
    if (!feed.on) return 1;
    const HubPath hub = world.work.wires[w].hub.path();
    const double t = world.state.wires[w].time;
    const double pushed = hub.travel(t, t + dt, +1), pulled = hub.travel(t, t + dt, -1);
    const WorldRod one(world, world.line_of(w));
    const double shortest = one.adapts() ? one.bounds().min_edge : feed.edge / 2;
    const RodView rod = world.rod(w);
    // a pull by more than half of the base edge takes it out in time where it is known beforehand
    const double base = feed.inside ? std::min(rod.rest_length[rod.n - 2], shortest) : shortest;
    // two instruments on one centreline may go opposite ways; the lead of one is then put before the tip in one piece
    const double most = one.wires().size() > 1 ? feed.edge / 4 : feed.edge;
    const double parts = std::ceil(std::max(pushed / most, pulled / (base / 2)) - 1e-9);
    return static_cast<int>(std::clamp(parts, 1.0, most_feed_parts));
}

/// All instruments of a rod, when its line's turn comes.
void feed_rod(const WorldRod& rod, double step, double h)
{
    WorldData& world = rod.world();
    rod.lead(h);
    audit_remeshing(world, rod.line());
    if (!rod.feed().on) return;
    const FeedingAudit feeding(rod);
    rod.push(step, h);
    feeding.after();
}

}  // namespace

void take_control(WorldData& world, const Control& control, double dt)
{
    const std::span<const Control::Hub> hubs = control.hubs();
    world.work.length = dt;
    for (WireWork& wire : world.work.wires) wire.loads.clear();
    for (const Control::Load& load : control.loads()) world.work.wires[load.instrument].loads.push_back(load.spec);
    for (int w = 0; w < world.wire_count(); ++w) {
        const FeedState& feed = world.feed(w);
        const Control::Hub hub = static_cast<std::size_t>(w) < hubs.size() ? hubs[w] : Control::Hub{};
        HubRequest& request = world.work.wires[w].hub;
        if (world.is_driven(w)) {
            const double now = world.state.wires[w].time, length = world.setup.wires[w].wire.length;
            const double on = std::clamp(feed.advance + dt * world.state.wires[w].hub.speed, 0.0, length);
            request = steady(feed, now, dt, on, feed.turn);
            request.keys = hub.keys;
            request.driven = true;
            request.force = hub.force;
            request.spring = hub.spring;
            request.turn = hub.kind == Control::Hub::Kind::Push ? hub.turn : feed.turn;
            request.from = feed.advance;
            request.until = now + dt;
            world.work.wires[w].trial.trials = 0;
            continue;
        }
        switch (hub.kind) {
            case Control::Hub::Kind::Stay:
                request = steady(feed, world.state.wires[w].time, dt, feed.advance, feed.turn);
                break;
            case Control::Hub::Kind::MoveTo:
                request = steady(feed, world.state.wires[w].time, dt, hub.advance, hub.turn);
                break;
            case Control::Hub::Kind::Follow:
                request.keys = hub.keys;
                break;
            case Control::Hub::Kind::Push: break;  // of a driven one
        }
    }
}

std::span<const StepParts> feed_parts(WorldData& world, double dt, StepReport& report)
{
    std::vector<StepParts>& parts = world.work.parts;
    for (int s = 0; s < world.systems.count(); ++s) {
        StepParts most;
        for (const int w : world.systems.wires_of(s)) {
            most.count = std::max(most.count, parts_of(world, w, dt));
            const double cut = world.is_line(w) ? WorldRod(world, w).lead_change(dt) : 0;
            if (cut > 0 && !(most.cut > 0 && most.cut < cut)) most.cut = cut;
        }
        for (const int w : world.systems.wires_of(s)) {
            parts[w] = most;
            if (!world.systems.is_retired(w)) note(world, report, w, StepOk, 0, most.count + (most.cut > 0));
        }
    }
    return parts;
}

void feed_hubs(WorldData& world, const SubStep& sub)
{
    // of an equilibrium a step's length is no time: no speed, and the rest length that births have left over is taken back at
    // once
    const double h = world.setup.integrator.scheme == Scheme::Static ? INFINITY : sub.h;
    for_each_item(world.wire_count(), wire_grain, [&](int w) {
        if (!sub.wires[w] || !world.is_line(w)) return;
        world.work.wires[w].start = {momentum(world.rod(w)), Vec3::Zero()};
        feed_rod(WorldRod(world, w), sub.h, h);
    });
}

void hold_and_load(WorldData& world, const SubStep& sub)
{
    const double length = world.setup.integrator.scheme == Scheme::Static ? 0 : sub.h;
    for (int w = 0; w < world.wire_count(); ++w) world.forces.set_time(w, world.state.wires[w].time + sub.h, length);
    for_each_item(world.wire_count(), wire_grain, [&](int w) {
        world.work.live[w] = world.work.active[w] = sub.wires[w] && world.state.is_solved(w);
        if (!sub.wires[w]) return;
        constrain_at(world, w, world.state.wires[w].time + sub.h);
        if (!world.state.wires[w].carried.empty())
            carry(world.rod(w), world.state.wires[w].carried, world.work.length, world.constraints(w));
        if (!world.is_line(w)) return;
        WorldRod(world, w).load();
        MomentumStart& start = world.work.wires[w].start;
        start.fed = momentum(world.rod(w)) - start.momentum;
    });
}

void constrain_now(WorldData& world, int w) { constrain_at(world, w, world.state.wires[w].time); }

void constrain_at(WorldData& world, int w, double t) { WorldRod(world, world.line_of(w)).constrain(w, t); }

}  // namespace seldinger
