// The main loop: a list of stages and nothing else; read this first. engine/README.md tells the same in prose.

#include "core/check.h"
#include "step_stages.h"

namespace seldinger {

StepReport step(World& world, double dt)
{
    SEL_ASSERT(dt > 0.0);
    World::Impl& state = world.impl();
    StepReport report;
    clear_timers(state);

    begin_step(state);                                  // what a failed attempt returns to
    (void)advance(state, dt, everyone(state), report);  // feed -> frames -> detect -> solve; halved where it will not converge
    adapt_nodes(state, dt);                             // split and merge
    check_state(state, report);                         // non-finite values, worst gap

    state.steps++;
    collect_timers(state, report);
    return report;
}

StepReport settle(World& world)
{
    World::Impl& state = world.impl();
    StepReport report;
    clear_timers(state);

    begin_step(state);
    find_equilibrium(state, report);
    check_state(state, report);

    collect_timers(state, report);
    return report;
}

}  // namespace seldinger
