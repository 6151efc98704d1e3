// The main loop: a list of stages and nothing else; read this first. engine/README.md tells the same in prose.

#include "core/check.h"
#include "world/merged.h"
#include "world/step_stages.h"
#include "world/world.h"

namespace seldinger {

StepReport step(World& world, const Control& control, double dt)
{
    World::Impl& state = world.impl();
    check_request(state, control, dt);  // throws; nothing has changed then
    StepReport report;
    clear_timers(state);

    take_control(state, control, dt);  // where each hub is to be, at every time of the step
    begin_step(state);                 // what a failed attempt returns to
    state.pending.begin(dt, everyone(state), feed_parts(state, dt, report));
    while (const SubStep* sub = state.pending.next()) {  // one sub-step where all goes well
        keep_start(world, *sub, dt);     // what a step that is stopped returns to
        begin_sub_step(state, *sub);
        feed_hubs(state, *sub);          // feed: advance and turn at the hub; the base edge grows
        hold_and_load(state, *sub);      // holds, loads and links at the end of the sub-step
        find_contacts(state);            // detect: what of the wall is near
        solve(state, *sub);              // Newton: frames, forces and tangent of every trial; factor; step
        accept(state, *sub, report);     // or put back, to go on in two halves
        if (state.solver->stopped()) return put_back(state, report);
    }
    carry_on(state);                 // what steps cut short have left to the next one
    adapt_nodes(state, dt);          // adapt: split and merge edges
    check_state(state, dt, report);  // check: non-finite values, points beyond the wall
    show_groups(state);              // instruments that share a centreline, each by itself

    state.steps++;
    collect_timers(state, report);
    return report;
}

StepReport step(World& world, double dt) { return step(world, Control{}, dt); }

StepReport settle(World& world, const std::function<void(int system, double time)>& passed)
{
    World::Impl& state = world.impl();
    StepReport report;
    clear_timers(state);

    take_control(state, Control{}, 0);
    begin_step(state);
    find_equilibrium(state, report, passed);
    check_state(state, 0, report);
    show_groups(state);

    collect_timers(state, report);
    return report;
}

}  // namespace seldinger
