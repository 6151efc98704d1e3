// The main loop: a list of stages and nothing else; read this first. engine/README.md tells the same in prose.
#include "core/check.h"
#include "stages/step_stages.h"
#include "world/world.h"

namespace seldinger {

StepReport step(World& given, const Control& control, double dt)
{
    WorldData& world = data_of(given);
    check_request(world, control, dt);  // throws; nothing has changed then
    StepReport report;
    clear_timers(world);

    take_control(world, control, dt);  // where each hub is to be, at every time of the step
    begin_step(world);                 // what a failed attempt returns to
    world.work.pending.begin(dt, world.systems.running(), feed_parts(world, dt, report));
    while (const SubStep* sub = world.work.pending.next()) {  // one sub-step where all goes well
        keep_start(world, *sub);         // what a step that is stopped returns to
        begin_sub_step(world, *sub);
        aim_hubs(world, *sub);           // hubs that a force drives: how far they go
        feed_hubs(world, *sub);          // feed: advance and turn at the hub; the base edge grows
        hold_and_load(world, *sub);      // holds, loads and links at the end of the sub-step
        find_contacts(world);            // detect: what of the wall is near
        solve(world, *sub);              // Newton: frames, forces and tangent of every trial; factor; step
        accept(world, *sub, report);     // or put back, to go on in two halves
        if (ends_here(world)) return put_back(world, report);
    }
    carry_on(world.state);           // what steps cut short have left to the next one
    adapt_nodes(world, dt);          // adapt: split and merge edges
    check_state(world, dt, report);  // check: non-finite values, points beyond the wall
    show_instruments(world);         // instruments that share a centreline, each by itself

    world.state.steps++;
    collect_timers(world, report);
    return report;
}

StepReport step(World& world, double dt) { return step(world, Control{}, dt); }

StepReport settle(World& given, const std::function<void(int system, double time)>& passed)
{
    WorldData& world = data_of(given);
    StepReport report;
    clear_timers(world);

    take_control(world, Control{}, 0);
    begin_step(world);
    keep_start(world);
    find_equilibrium(world, report, passed);
    if (world.forces.raised()) return put_back(world, report);
    check_state(world, 0, report);
    show_instruments(world);

    collect_timers(world, report);
    return report;
}

}  // namespace seldinger
