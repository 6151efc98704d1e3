#include "step_stages.h"

#include "core/parallel.h"
#include "core/prefetch.h"
#include "vessel/repair.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace seldinger {

namespace {

constexpr double most_feed_parts = 4096;
constexpr int most_halvings = 9;  // h / 512: an update moves no node by more than half a radius, so 20 m/s at 1/60 s takes that
constexpr int most_energy_halvings = 3;  // energy that steps eight times as short make too is none of the step's length

using Clock = std::chrono::steady_clock;

/// What a loop over the wires comes to next: the arrays of the wire after this one.
void prefetch_after(World::Impl& state, int w)
{
    if (w + 1 >= state.wire_count()) return;
    for (const std::span<double>& array : state.rods.arrays(w + 1)) prefetch(array.data(), array.size_bytes());
}

// Feeding and holds at the end of the sub-step; `live` wires are the ones that are solved and may touch the wall.
void feed_and_constrain(World::Impl& state, double h, const WireMask& mask)
{
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        state.live[w] = state.active[w] = mask[w];
        if (!mask[w]) return;
        const WireSetup& setup = state.setup.wires[w];
        const double t = state.wire_time[w] + h;
        const Vec3 before = momentum(state.rods.view(w));
        audit_remeshing(state, w);
        if (state.feeds[w].on) {
            FeedingAudit feeding(state, w);
            feed_to(state.feeds[w], setup.feed, setup.wire, state.rods, w, t, h);
            feeding.after(state);
        }
        if (state.feeds[w].on && !state.feeds[w].inside) state.live[w] = state.active[w] = 0;
        const RodView rod = state.rods.view(w);
        state.holds[w].fill(t, rod, state.constraints[w]);
        if (state.feeds[w].on) add_feed_constraints(state.feeds[w], rod, state.constraints[w]);
        state.momentum_start[w] = {before, momentum(rod) - before};
    });
}

// Constraints of the accepted state on the present node set.
void constrain_now(World::Impl& state, int w)
{
    const RodView rod = state.rods.view(w);
    state.holds[w].fill(state.wire_time[w], rod, state.constraints[w]);
    if (state.feeds[w].on) add_feed_constraints(state.feeds[w], rod, state.constraints[w]);
}

// Newmark's first step needs the acceleration at its start: that of the forces on the wire as placed.
void start_acceleration(World::Impl& state)
{
    for (int w = 0; w < state.wire_count(); ++w) {
        state.live[w] = state.active[w] = !state.feeds[w].on || state.feeds[w].inside;
        constrain_now(state, w);
    }
    state.terms.begin_step(state.rods);
    state.terms.prepare(state.rods, state.live);
    state.solver->initialise_acceleration(state.constraints, state.terms, state.active);
}

}  // namespace

namespace {

// A step holds some four masks, a halved one four more at each level.
std::vector<std::vector<std::uint8_t>>& mask_pool()
{
    thread_local std::vector<std::vector<std::uint8_t>> pool;
    return pool;
}

}  // namespace

std::vector<std::uint8_t> WireMask::borrow()
{
    auto& pool = mask_pool();
    if (pool.empty()) return {};
    std::vector<std::uint8_t> bytes = std::move(pool.back());
    pool.pop_back();
    return bytes;
}

void WireMask::give_back()
{
    if (bytes_.capacity() > 0) mask_pool().push_back(std::move(bytes_));
}

WireMask everyone(const World::Impl& state)
{
    WireMask mask(state.wire_count());
    for (int w = 0; w < state.wire_count(); ++w) mask[w] = !state.retired[w];
    return mask;
}

void clear_timers(World::Impl& state)
{
    state.solve_time = state.adapt_time = 0;
    if (state.contact) state.contact->times = {};
}

void collect_timers(World::Impl& state, StepReport& report)
{
    if (state.contact) report.times = state.contact->times;
    // the solver's own share: what it took less what contact took inside it
    report.times.solve = std::max(0.0, state.solve_time - (state.contact ? state.contact_in_solve : 0.0));
    report.times.adapt = state.adapt_time;
}

void begin_step(World::Impl& state)
{
    if (state.steps == 0 && state.setup.integrator.newmark) start_acceleration(state);
    // what touches as placed is not known yet: there energies are counted from the end of the first step
    for (int w = 0; w < state.wire_count() && state.steps == 0 && !state.contact; ++w) {
        if (state.audits[w].known || (state.feeds[w].on && !state.feeds[w].inside)) continue;
        constrain_now(state, w);
        begin_audit(state, w, true);
    }
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        prefetch_after(state, w);
        state.save_wire(w);
    });
    state.contact_in_solve = 0;
    state.wire_reports.assign(state.wire_count(), WireReport{});
}

namespace {

/// Into the wire's own report and that of the step.
void note(World::Impl& state, StepReport& report, int wire, unsigned flags, int newton_iterations = 0, int sub_steps = 1)
{
    const auto add_to = [&](auto& to) {
        to.flags |= flags;
        to.newton_iterations = std::max(to.newton_iterations, newton_iterations);
        to.sub_steps = std::max(to.sub_steps, sub_steps);
    };
    add_to(state.wire_reports[wire]);
    add_to(report);
}

bool audited(const World::Impl& state) { return state.setup.integrator.scheme != Scheme::Static; }

WireMask advance_or_halve(World::Impl& state, double h, const WireMask& mask, StepReport& report, int depth)
{
    state.terms.begin_step(state.rods);
    feed_and_constrain(state, h, mask);
    state.terms.prepare(state.rods, state.live);

    const auto start = Clock::now();
    const StageTimes before = state.contact ? state.contact->times : StageTimes{};
    state.solver->set_best_effort(depth == most_halvings);
    state.solver->step(h, state.constraints, state.terms, state.active, state.reports);
    state.solve_time += std::chrono::duration<double>(Clock::now() - start).count();
    if (state.contact) {
        const StageTimes& after = state.contact->times;
        state.contact_in_solve += after.detect - before.detect + after.evaluate - before.evaluate + after.reduce - before.reduce;
    }

    WireMask done = mask, failed(mask.size(), 0), ended(mask.size(), 0), adds_up(mask.size(), 1);
    if (audited(state))
        for_each_item(state.wire_count(), wire_grain, [&](int w) {
            if (state.active[w] && state.reports[w].converged) adds_up[w] = energy_adds_up(state, w, h);
        });
    bool any_failed = false;
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!state.active[w]) continue;
        const SolveReport& solved = state.reports[w];
        note(state, report, w, solved.best_effort ? StepBestEffort : StepOk, solved.iterations);
        if (solved.converged && adds_up[w]) continue;
        if (solved.converged && depth >= most_energy_halvings) {
            ended[w] = 1;
            done[w] = 0;
            state.restore_wire(w);
            note(state, report, w, StepEnergy);
            continue;
        }
        failed[w] = 1;
        done[w] = 0;
        any_failed = true;
        if (depth == most_halvings) note(state, report, w, solved.non_finite ? StepNonFinite : StepNotConverged);
        else note(state, report, w, StepHalved, 0, 2 << depth);
    }
    state.terms.commit(done);
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        prefetch_after(state, w);
        if (!done[w]) return;
        state.wire_time[w] += h;
        if (state.active[w] && audited(state)) accept_energy(state, w, h);
        state.read_results(w, h);
    });
    if (!any_failed) return ended;
    for (int w = 0; w < state.wire_count(); ++w)
        if (failed[w]) state.restore_wire(w);
    const auto with_ended = [&](WireMask lost) {
        for (std::size_t w = 0; w < ended.size(); ++w) lost[w] = lost[w] || ended[w];
        return lost;
    };
    if (depth == most_halvings) return with_ended(failed);
    WireMask lost = advance_or_halve(state, h / 2, failed, report, depth + 1), rest = failed;
    bool any_left = false;
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!failed[w]) continue;
        state.save_wire(w);
        rest[w] = !lost[w];
        any_left = any_left || rest[w];
    }
    if (!any_left) return with_ended(lost);
    const WireMask lost_later = advance_or_halve(state, h / 2, rest, report, depth + 1);
    for (int w = 0; w < state.wire_count(); ++w) lost[w] = lost[w] || lost_later[w];
    return with_ended(lost);
}

}  // namespace

namespace {

// Nodes come at once and go slowly: a wire that shivers is not to lose and get the same node over and over.
constexpr int merge_period = 16;  // steps

void drain_debt(World::Impl& state, int w, double dt)
{
    const WireSpec& spec = state.setup.wires[w].wire;
    const double added = fade_debt(state.feeds[w], dt);
    if (added != 0) shorten_evenly(state.rods.view(w), spec, -added, spec.place.rest_is_placed);
}

// What was read off the nodes follows them, sums kept, until the next step reads them anew. @param n  nodes before
void renumber_forces(std::vector<Vec3>& force, int n, const NodeChange& change)
{
    const auto at = force.begin() + change.at;
    if (change.split) {
        std::copy_backward(at + 1, force.begin() + n, force.begin() + n + 1);
        *(at + 1) = Vec3::Zero();
    } else {
        *(at - 1) += 0.5 * *at;
        *(at + 1) += 0.5 * *at;
        std::copy(at + 1, force.begin() + n, at);
    }
}

// @return whether it did anything
bool adapt_base(World::Impl& state, int w, const BaseEdge& limits)
{
    const int n = state.rods.node_count(w);
    const HubChange change = adapt_hub(state.feeds[w], state.setup.wires[w].wire, state.rods, w, limits, state.hub_scratch);
    if (!change.changed) return false;
    state.remesh_energy[w] += change.energy;
    renumber_forces(state.results[w].nodal_contact, n, {state.rods.node_count(w) > n, n - 2, 0});
    return true;
}

// When a fed wire's base edge changes: a node is born when `whole` is inside, and goes when it is pulled back to the inlet.
BaseEdge base_limits(const World::Impl& state, int w, double whole, double dt)
{
    const FeedSpec& feed = state.setup.wires[w].feed;
    const double t = state.wire_time[w], next = std::isfinite(dt) ? t + dt : t;
    // symplectic Euler follows no axial wave along an edge that is much shorter than the others, and one linearised step no turn of it
    const Scheme scheme = state.setup.integrator.scheme;
    if (scheme == Scheme::Explicit || scheme == Scheme::Linearised) return {whole, 0.5 * whole, 0.5 * whole};
    return base_edge_limits(whole, feed_travel(feed, t, next, +1), feed_travel(feed, t, next, -1));
}

void change_nodes(World::Impl& state, int w, std::span<const NodeChange> changes)
{
    const WireSpec& spec = state.setup.wires[w].wire;
    NodeAdapter& adapter = state.adapters[w];
    constrain_now(state, w);
    const double before = energy_now(state.rods.view(w), state.constraints[w].clamps, adapter.frames);
    state.feeds[w].debt +=
        apply_changes(state.rods, w, changes, spec, state.constraints[w].clamps, spec.place.rest_is_placed && !state.feeds[w].on);
    constrain_now(state, w);
    int n = state.rods.node_count(w) - static_cast<int>(changes.size()) * (changes.front().split ? 1 : -1);
    for (const NodeChange& change : changes) renumber_forces(state.results[w].nodal_contact, change.split ? n++ : n--, change);
    state.remesh_energy[w] += energy_now(state.rods.view(w), state.constraints[w].clamps, adapter.frames) - before;
}

// A law that never overlaps takes no change of nodes that would put the wire into the wall: it waits until the wire has moved on.
// @param change  returns whether it did anything     @return whether something was done, and stands
template <class Change>
bool where_clear(World::Impl& state, int w, Change change)
{
    if (!state.terms.never_overlaps()) return change();
    state.save_wire(w);
    state.nodal_backup = state.results[w].nodal_contact;
    const double energy = state.remesh_energy[w];
    if (!change()) return false;
    if (state.terms.is_clear(state.rods, w)) return true;
    state.restore_wire(w);
    state.results[w].nodal_contact = state.nodal_backup;
    state.remesh_energy[w] = energy;
    return false;
}

/// @return whether nodes came or went
bool adapt_wire(World::Impl& state, int w, double dt, bool may_merge)
{
    const WireSpec& spec = state.setup.wires[w].wire;
    const bool fed = state.feeds[w].on;
    NodeAdapter& adapter = state.adapters[w];
    if (!fed) drain_debt(state, w, dt);
    NodeDemands demands;
    demands.kept = adapter.kept;
    demands.fed = fed;
    demands.may_merge = may_merge;
    for (const RodClamp& clamp : state.constraints[w].clamps)
        if (clamp.direction && clamp.node == state.rods.node_count(w) - 1) demands.hub_tangent = clamp.tangent;
    // the moments beside a new node settle within the next step; until then only lengths are judged
    bool changed = fed && where_clear(state, w, [&] {
                       const double whole = adapter.planner.base_edge(state.rods.view(w), spec, demands.hub_tangent);
                       return adapt_base(state, w, base_limits(state, w, whole, dt));
                   });
    if (changed) demands.may_refine = demands.may_merge = false;
    const auto changes = adapter.planner.plan(state.rods.view(w), spec, demands, state.rods.capacity(w));
    if (changes.empty()) return changed;
    if (!state.terms.never_overlaps()) return change_nodes(state, w, changes), true;
    for (std::size_t k = 0; k < changes.size(); ++k)
        changed = where_clear(state, w, [&] { return change_nodes(state, w, changes.subspan(k, 1)), true; }) || changed;
    return changed;
}

void adapt_one(World::Impl& state, int w, double dt)
{
    FeedState& feed = state.feeds[w];
    if (feed.on && !feed.inside) return;
    if (state.adapters[w].on) (void)adapt_wire(state, w, dt, state.steps % merge_period == 0);
    else if (feed.on) (void)where_clear(state, w, [&] { return adapt_base(state, w, base_limits(state, w, feed.edge, dt)); });
}

}  // namespace

namespace {

constexpr int most_static_halvings = 6;
constexpr int most_adapt_rounds = 60;  // of one equilibrium; each takes out a few nodes at most

/// How a wire comes to its equilibrium. Holds and links that move are followed in parts (solve/constraints.h), so that the wire
/// ends on the branch that it is on: a wire wound up and then pushed together has others. A part that does not converge is
/// halved.
struct Approach {
    std::vector<double> times;  // [s] to be reached, one after the other
    std::size_t next = 0;
    double reached = 0, target = 0;
    double end = 0;  // when the last move ends, which infinity stands for
    int halvings = 0, rounds = 0;
    bool adapting = false;  // at times[next], with nodes that have changed
    [[nodiscard]] bool done() const { return next == times.size(); }
};

Approach approach_of(const World::Impl& state, int w)
{
    Approach approach;
    if (state.setup.integrator.scheme == Scheme::Static) approach.times = state.holds[w].path(state.setup.wires[w].wire.length);
    else approach.times = {state.wire_time[w]};
    approach.target = approach.times[0];
    approach.end = state.holds[w].moving_until();
    return approach;
}

/// Equilibrium of the wires of the mask at their approaches' targets. @param settling  0 or SEL_SETTLE_*
/// @param farthest  [radii] a wire of which a node has moved farther has found none  @return wires that found none; they are
/// where they were
WireMask balance(World::Impl& state, const std::vector<Approach>& approaches, const WireMask& mask, uint settling,
                 double farthest = INFINITY)
{
    std::optional<RodArrays> placed;
    if (std::isfinite(farthest)) placed = state.rods;
    const auto too_far = [&](int w) {
        if (!placed) return false;
        const RodView now = state.rods.view(w), then = placed->view(w);
        double most = 0;
        for (int i = 0; i < now.n; ++i) most = std::max(most, (now.pos(i) - then.pos(i)).norm());
        return most > farthest * now.radius[0];
    };
    if (state.contact) state.contact->set_settling(settling);
    state.terms.begin_step(state.rods);
    for (int w = 0; w < state.wire_count(); ++w) {
        state.live[w] = state.active[w] = mask[w] && (!state.feeds[w].on || state.feeds[w].inside);
        const RodView rod = state.rods.view(w);
        state.holds[w].fill(approaches[w].target, rod, state.constraints[w]);
        if (state.feeds[w].on) add_feed_constraints(state.feeds[w], rod, state.constraints[w]);
    }
    state.terms.prepare(state.rods, state.live);
    const auto start = Clock::now();
    state.solver->equilibrium(state.constraints, state.terms, state.active, state.reports);
    state.solve_time += std::chrono::duration<double>(Clock::now() - start).count();
    WireMask done = mask, failed(mask.size(), 0);
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!state.active[w]) continue;
        if (state.reports[w].converged && !too_far(w)) continue;
        done[w] = 0;
        failed[w] = 1;
        state.restore_wire(w);
    }
    state.terms.commit(done);
    if (state.contact) state.contact->set_settling(0);
    for (int w = 0; w < state.wire_count(); ++w)
        if (done[w]) {
            state.save_wire(w);
            state.read_results(w, 0);
        }
    return failed;
}

bool any_of(std::span<const std::uint8_t> mask) { return std::find(mask.begin(), mask.end(), 1) != mask.end(); }

/// Nodes of an equilibrium until none has to come or go, the rest length that they made taken out at once.
/// @return whether any did: the equilibrium is to be found anew
bool adapt_at_rest(World::Impl& state, int w, Approach& approach)
{
    constexpr int at_once = 8;
    if (!state.adapters[w].on || (state.feeds[w].on && !state.feeds[w].inside) || ++approach.rounds > most_adapt_rounds)
        return false;
    bool changed = false;
    for (int k = 0; k < at_once; ++k) {
        const int n = state.rods.node_count(w);
        if (!adapt_wire(state, w, INFINITY, true)) break;
        changed = true;
        if (state.rods.node_count(w) > n) break;  // moments beside a new node are off until it is at rest
    }
    if (!state.feeds[w].on) drain_debt(state, w, INFINITY);
    return changed;
}

/// Takes in what became of the wire's part: the next one, or its nodes, or half of it. @return false: there is no equilibrium
bool go_on(World::Impl& state, int w, Approach& approach, bool failed)
{
    if (failed) {
        if (approach.adapting) {  // the nodes it had will do
            approach.adapting = false;
            ++approach.next;
            return true;
        }
        approach.target = 0.5 * (approach.reached + std::min(approach.target, approach.end));
        return approach.target > approach.reached && ++approach.halvings <= most_static_halvings;
    }
    approach.reached = approach.target;
    if (approach.target == approach.times[approach.next]) {
        approach.adapting = adapt_at_rest(state, w, approach);
        if (approach.adapting) return true;
        approach.rounds = approach.halvings = 0;
        ++approach.next;
    }
    if (!approach.done()) approach.target = approach.times[approach.next];
    return true;
}

/// Solver iterations of the wires of the mask into their reports.
void note_solves(World::Impl& state, StepReport& report, const WireMask& mask)
{
    for (int w = 0; w < state.wire_count(); ++w)
        if (mask[w] && state.active[w]) note(state, report, w, StepOk, state.reports[w].iterations);
}

/// The first equilibrium of wires that start settled: all contacts stuck. @return wires that found none
WireMask balance_stuck(World::Impl& state, const std::vector<Approach>& approaches, const WireMask& mask, StepReport& report)
{
    WireMask failed = balance(state, approaches, mask, SEL_SETTLE_STUCK, 1);
    note_solves(state, report, mask);
    if (!any_of(failed)) return failed;
    // Placed off the wall, a wire that springs against it would be held by where it touches first, by slips as long as its
    // way there. It slides to rest instead, and holds from there on.
    WireMask rested = failed;
    failed = balance(state, approaches, failed, SEL_SETTLE_SLIDING);
    note_solves(state, report, rested);
    for (std::size_t w = 0; w < failed.size(); ++w) rested[w] = rested[w] && !failed[w];
    if (any_of(rested)) {
        (void)balance(state, approaches, rested, SEL_SETTLE_STUCK);  // where that fails the wire is at rest all the same
        note_solves(state, report, rested);
    }
    return failed;
}

}  // namespace

void find_equilibrium(World::Impl& state, StepReport& report)
{
    WireMask going = everyone(state);
    std::vector<Approach> approaches;
    for (int w = 0; w < state.wire_count(); ++w) approaches.push_back(approach_of(state, w));
    bool stuck = state.setup.start_settled && state.steps == 0;
    while (any_of(going)) {
        const WireMask failed = stuck ? balance_stuck(state, approaches, going, report) : balance(state, approaches, going, 0);
        if (!stuck) note_solves(state, report, going);
        stuck = false;
        for (int w = 0; w < state.wire_count(); ++w) {
            if (!going[w]) continue;
            const bool found = go_on(state, w, approaches[w], failed[w]);
            if (!found) note(state, report, w, state.reports[w].non_finite ? StepNonFinite : StepNotConverged);
            going[w] = found && !approaches[w].done();
        }
    }
}

namespace {

// In how many parts a step of h feeds the wire: one birth can follow a push by an edge, and pulling back must leave some of the
// base edge, which is merged in time where the pull is known beforehand.
int feed_parts(World::Impl& state, int w, double h)
{
    const FeedState& feed = state.feeds[w];
    if (!feed.on) return 1;
    const FeedSpec& spec = state.setup.wires[w].feed;
    const double pushed = feed_travel(spec, state.wire_time[w], state.wire_time[w] + h, +1);
    const double pulled = feed_travel(spec, state.wire_time[w], state.wire_time[w] + h, -1);
    const RodView rod = state.rods.view(w);
    const double shortest = state.adapters[w].on ? state.setup.wires[w].wire.min_edge : feed.edge / 2;
    const double base = feed.inside ? std::min(rod.rest_length[rod.n - 2], shortest) : shortest;
    const double parts = std::ceil(std::max(pushed / feed.edge, pulled / (base / 2)) - 1e-9);
    return static_cast<int>(std::clamp(parts, 1.0, most_feed_parts));
}

WireMask advance_in_parts(World::Impl& state, double h, int parts, WireMask going, StepReport& report)
{
    const WireMask asked = going;
    for (int k = 0; k < parts; ++k) {
        for (int w = 0; w < state.wire_count() && k > 0; ++w) {
            if (!going[w]) continue;
            adapt_one(state, w, h / parts);
            state.save_wire(w);
        }
        const WireMask lost = advance_or_halve(state, h / parts, going, report, 0);
        for (int w = 0; w < state.wire_count(); ++w) going[w] = going[w] && !lost[w];
    }
    WireMask lost(asked.size(), 0);
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!asked[w]) continue;
        lost[w] = !going[w];
        note(state, report, w, StepOk, 0, parts);
    }
    return lost;
}

}  // namespace

WireMask advance(World::Impl& state, double h, const WireMask& mask, StepReport& report)
{
    std::vector<int>& parts = state.parts;  // 0: not asked for, or done
    parts.assign(mask.size(), 0);
    int most = 0;
    for (int w = 0; w < state.wire_count(); ++w)
        if (mask[w]) most = std::max(most, parts[w] = feed_parts(state, w, h));
    if (most == 1) return advance_or_halve(state, h, mask, report, 0);
    WireMask lost(mask.size(), 0);
    for (int w = 0; w < state.wire_count(); ++w) {  // all that go in as many parts go together
        const int here = parts[w];
        if (here == 0) continue;
        WireMask together(mask.size(), 0);
        for (int other = w; other < state.wire_count(); ++other)
            if (parts[other] == here) together[other] = 1, parts[other] = 0;
        const WireMask now = advance_in_parts(state, h, here, together, report);
        for (int other = 0; other < state.wire_count(); ++other) lost[other] = lost[other] || now[other];
    }
    return lost;
}

void adapt_nodes(World::Impl& state, double dt)
{
    const auto start = Clock::now();
    for (int w = 0; w < state.wire_count(); ++w)
        if (!state.retired[w]) adapt_one(state, w, dt);
    state.adapt_time += std::chrono::duration<double>(Clock::now() - start).count();
}

namespace {

// Published detection does not know on which side of the wall it is, and a sample that crosses a wall within one step has never
// touched it: there the axis is looked up in the lumen itself, nodes and middles of edges. `swept` and slow capsules never need
// it (a sample that passes the wall has touched it before, and says so).
bool needs_audit(World::Impl& state, int wire)
{
    const Detection detection = state.setup.wires[wire].contact.detection;
    if (!state.contact || detection == Detection::Swept || !state.live[wire]) return false;
    if (detection != Detection::Capsule) return state.steps % 10 == 0;
    const RodView rod = state.rods.view(wire);
    double fastest = 0;
    for (int i = 0; i < rod.n; ++i) fastest = std::max(fastest, rod.vel(i).norm());
    return fastest * state.setup.dt > 0.5 * rod.radius[0];
}

void audit_outside(World::Impl& state, int wire)
{
    if (!state.lumen) {
        const bool open = state.setup.vessel.shape != VesselShape::Plane;  // a plane's edge is no opening
        state.lumen =
            std::make_unique<LumenQuery>(state.setup.mesh, open ? describe(state.setup.mesh).loops : std::vector<BoundaryLoop>{});
    }
    const RodView rod = state.rods.view(wire);
    double& outside = state.results[wire].contact.outside;
    const auto look = [&](const Vec3& p) {
        const LumenPlace place = state.lumen->locate(p);
        if (place.opening < 0) outside = std::max(outside, -place.signed_distance);
    };
    for (int j = 0; j + 1 < rod.n; ++j) {
        look(rod.pos(j));
        look((rod.pos(j) + rod.pos(j + 1)) / 2);
    }
}

}  // namespace

void check_state(World::Impl& state, StepReport& report)
{
    state.time = *std::max_element(state.wire_time.begin(), state.wire_time.end());
    for (int w = 0; w < state.wire_count(); ++w) {
        if (state.retired[w]) continue;
        const RodView rod = state.rods.view(w);
        for (int i = 0; i < rod.n; ++i)
            if (!std::isfinite(rod.x[i] + rod.y[i] + rod.z[i] + rod.vx[i] + rod.vy[i] + rod.vz[i]))
                note(state, report, w, StepNonFinite);
        if (needs_audit(state, w)) audit_outside(state, w);
        if (state.results[w].contact.outside > 0) note(state, report, w, StepWallPenetration);
    }
}

}  // namespace seldinger
