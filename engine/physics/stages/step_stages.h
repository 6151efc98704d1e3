#pragma once
// The stages of step.cpp, one group for each of the files step_*.cpp.

#include "control.h"
#include "output.h"
#include "world/world_rod.h"

namespace seldinger {

// ---- step_feed.cpp: input of the hubs

/// Resolves the control to the path of each hub through the step.
void take_control(WorldData& world, const Control& control, double dt);
/// In how many parts a step feeds each wire [wires]: one birth can follow a push by an edge, and pulling back must leave some of
/// the base edge. It is cut where another instrument of a common centreline gets ahead. All instruments of a system go in as
/// many.
[[nodiscard]] std::span<const StepParts> feed_parts(WorldData& world, double dt, StepReport& report);
/// The hubs' advance and turn at the end of the sub-step: the base edge grows, or the piece in the introducer moves.
void feed_hubs(WorldData& world, const SubStep& sub);
/// Holds, loads and links at the end of the sub-step; `live` wires are the ones that are solved and may touch the wall.
void hold_and_load(WorldData& world, const SubStep& sub);
/// The same for the accepted state on its present nodes.
void constrain_now(WorldData& world, int wire);
void constrain_at(WorldData& world, int wire, double time);

// ---- step_hub.cpp: hubs that a force drives

/// Where they are to go in the sub-step: the first trial, or the one that the last trial's answer asks for.
void aim_hubs(WorldData& world, const SubStep& sub);
/// Whether their equations hold with what the instruments answered. @param failed  systems that did not converge; those that are
/// to take the sub-step in halves for this reason join them. @return systems that take it again, with the next trial of their
/// hubs
[[nodiscard]] WireMask balance_hubs(WorldData& world, const SubStep& sub, WireMask& failed);
/// The last trial is accepted.
void take_hub(WorldData& world, int wire);

// ---- step_solve.cpp: from the start of a step to the states that are accepted

void clear_timers(WorldData& world);
void collect_timers(WorldData& world, StepReport& report);
/// Into the wire's own report and that of the step.
void note(WorldData& world, StepReport& report, int wire, unsigned flags, int newton_iterations = 0, int sub_steps = 1);

/// Flags of a wire for which the last solve has found no state.
[[nodiscard]] unsigned why_lost(const WorldData& world, int wire);

/// Nothing of the last step is needed any more; what a failed attempt returns to.
void begin_step(WorldData& world);
/// Keeps the state before the first of several sub-steps, where the step may be stopped.
void keep_start(WorldData& world, const SubStep& sub);
/// The same before an equilibrium, where a force of the program may raise.
void keep_start(WorldData& world);
/// Whether the step was stopped, or a force of the program has raised.
[[nodiscard]] bool ends_here(const WorldData& world);
/// The state before a step that ends so. @return its report @throws what the force has raised
StepReport put_back(WorldData& world, StepReport& report);
/// What a sub-step that follows another one starts from.
void begin_sub_step(WorldData& world, const SubStep& sub);
/// Quadrature points on the present nodes and what of the wall is near them.
void find_contacts(WorldData& world);
/// Newton on the equations of the sub-step: every system to its own trial state.
void solve(WorldData& world, const SubStep& sub);
/// Systems that converged, and whose energy adds up, take their trial as the accepted state. The others are put back: they take
/// the sub-step in two halves, or are lost where that has no sense any more.
void accept(WorldData& world, const SubStep& sub, StepReport& report);

/// What a step that was cut short has left for the next one.
void carry_on(WorldState& state);

// ---- step_read.cpp

/// Readings of a wire at the end of a sub-step of h [s]; 0: an equilibrium.
void read_results(WorldData& world, int wire, double h);
/// After it, where hand stiffness is watched.
void read_hand_stiffness(WorldData& world, int wire);
/// Force of the hand at a wire's hub in the trial that was solved, and how it grows with what is fed [N], [N/m]; of several
/// instruments on one centreline the latter is that of all together.
[[nodiscard]] std::pair<double, double> hand_answer(WorldData& world, int wire);

// ---- step_nodes.cpp

/// Splits and merges edges where the shape asks for it, after a step of dt [s]; rods of a given node number at the ends only.
void adapt_nodes(WorldData& world, double dt);
/// The same for one wire.
void adapt_nodes_of(WorldData& world, int wire, double dt);
/// Adaptive nodes of a rod. @return whether any came or went
bool adapt_rod(const WorldRod& rod, double dt, bool may_merge);
/// Takes the surplus of rest length that splits and merges have left out of a wire of constant length, as far as it fades in dt.
void fade_surplus_of(WorldData& world, int wire, double dt);

// ---- step_check.cpp, step_settle.cpp

/// Non-finite values, and points beyond the wall, after a step of dt [s]; 0: an equilibrium.
void check_state(WorldData& world, double dt, StepReport& report);
/// Static equilibrium with contact (scheme "static", start "settled").
void find_equilibrium(WorldData& world, StepReport& report, const std::function<void(int system, double time)>& passed);

}  // namespace seldinger
