// Static equilibrium of all systems: a continuation path along which holds and links are moved, and births and merges of nodes
// until none is needed.
#include "core/clock.h"
#include "stages/step_stages.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace seldinger {
namespace {

constexpr int most_static_halvings = 6;
constexpr int most_adapt_rounds = 60;  // of one equilibrium; each takes out a few nodes at most

/// How a system comes to its equilibrium. Holds and links that move are followed in parts (solve/constraints.h), so that it ends
/// on the branch that it is on: a wire wound up and then pushed together has others. A part that does not converge is halved.
struct ContinuationPath {
    std::vector<double> times;  // [s] to be reached, one after the other
    std::size_t next = 0;
    double reached = 0, target = 0;
    double end = 0;  // when the last move ends, which infinity stands for
    int halvings = 0, rounds = 0;
    bool adapting = false;  // at times[next], with nodes that have changed
    [[nodiscard]] bool done() const { return next == times.size(); }
};

ContinuationPath path_of(const WorldData& world, int system)
{
    ContinuationPath path;
    for (const int w : world.systems.wires_of(system)) {
        const bool is_static = world.setup.integrator.scheme == Scheme::Static;
        const std::vector<double> own =
            is_static ? world.holds[w].path(world.setup.wires[w].wire.length) : std::vector<double>{world.state.wires[w].time};
        path.times.insert(path.times.end(), own.begin(), own.end());
        path.end = std::max(path.end, world.holds[w].moving_until());
    }
    std::sort(path.times.begin(), path.times.end());
    path.times.erase(std::unique(path.times.begin(), path.times.end()), path.times.end());
    path.target = path.times[0];
    return path;
}

/// Equilibrium of the wires of the mask at their paths' targets. @param settling  what friction does on the way
/// @param farthest  [radii] a wire of which a node has moved farther has found none  @return wires that found none; they are
/// where they were
WireMask balance(WorldData& world, const std::vector<ContinuationPath>& paths, const WireMask& mask, Settling settling,
                 double farthest = INFINITY)
{
    std::optional<RodArrays> placed;
    if (std::isfinite(farthest)) placed = world.state.rods;
    const auto too_far = [&](int w) {
        if (!placed) return false;
        const RodView now = world.rod(w), then = placed->view(w);
        double most = 0;
        for (int i = 0; i < now.n; ++i) most = std::max(most, (now.pos(i) - then.pos(i)).norm());
        return most > farthest * now.radius[0];
    };
    set_exposures(world);
    stop_hands(world);
    world.forces.terms.begin_step(world.state.rods, settling);
    for (int w = 0; w < world.wire_count(); ++w) {
        world.work.live[w] = world.work.active[w] = mask[w] && world.state.is_solved(w);
        const double target = paths[world.systems.of(w)].target;
        constrain_at(world, w, target);
        world.forces.set_time(w, std::isfinite(target) ? target : world.state.wires[w].time, 0);
    }
    world.forces.terms.prepare(world.state.rods, world.work.live);
    const auto start = Clock::now();
    world.solver->equilibrium(world.work.constraints, world.forces.terms, world.work.active, world.work.reports);
    world.work.solve_time += seconds_since(start);
    WireMask done = mask, failed(mask.size(), 0);
    for (int w = 0; w < world.wire_count(); ++w)
        failed[w] = world.work.active[w] && (!world.work.reports[w].converged || too_far(w));
    world.systems.spread(mask, failed);
    put_back_wires(world, failed);
    for (int w = 0; w < world.wire_count(); ++w) done[w] = done[w] && !failed[w];
    (void)world.forces.conclude(done);
    world.forces.terms.commit(done);
    for (int w = 0; w < world.wire_count(); ++w)
        if (done[w]) {
            keep_wire(world, w);
            read_results(world, w, 0);
        }
    return failed;
}

/// Nodes of a wire at rest, the rest length that they made taken out at once. @return whether any came or went
bool adapt_wire_at_rest(WorldData& world, int w)
{
    constexpr int at_once = 8;
    bool changed = false;
    for (int k = 0; k < at_once; ++k) {
        const int n = world.state.rods.node_count(w);
        if (!adapt_rod(WorldRod(world, w), INFINITY, true)) break;
        changed = true;
        if (world.state.rods.node_count(w) > n) break;  // moments beside a new node are off until it is at rest
    }
    if (!world.feed(w).on) fade_surplus_of(world, w, INFINITY);
    return changed;
}

/// Nodes of an equilibrium until none has to come or go. @return whether any did: the equilibrium is to be found anew
bool adapt_at_rest(WorldData& world, int system, ContinuationPath& path)
{
    const auto adapts = [&](int w) { return world.adapter(w).on && world.state.is_solved(w); };
    const auto wires = world.systems.wires_of(system);
    if (std::none_of(wires.begin(), wires.end(), adapts) || ++path.rounds > most_adapt_rounds) return false;
    bool changed = false;
    for (const int w : wires) changed = (adapts(w) && adapt_wire_at_rest(world, w)) || changed;
    return changed;
}

/// Takes in what became of the system's part: the next one, or its nodes, or half of it. @return false: there is no equilibrium
bool go_on(WorldData& world, int system, ContinuationPath& path, bool failed)
{
    if (failed) {
        if (path.adapting) {  // the nodes it had will do
            path.adapting = false;
            ++path.next;
            return true;
        }
        path.target = 0.5 * (path.reached + std::min(path.target, path.end));
        return path.target > path.reached && ++path.halvings <= most_static_halvings;
    }
    path.reached = path.target;
    if (path.target == path.times[path.next]) {
        path.adapting = adapt_at_rest(world, system, path);
        if (path.adapting) return true;
        path.rounds = path.halvings = 0;
        ++path.next;
    }
    if (!path.done()) path.target = path.times[path.next];
    return true;
}

/// Solver iterations of the wires of the mask into their reports.
void note_solves(WorldData& world, StepReport& report, const WireMask& mask)
{
    for (int w = 0; w < world.wire_count(); ++w)
        if (mask[w] && world.work.active[w]) note(world, report, w, StepOk, world.work.reports[w].iterations);
}

/// The first equilibrium of wires that start settled: all contacts stuck. @return wires that found none
WireMask balance_stuck(WorldData& world, const std::vector<ContinuationPath>& paths, const WireMask& mask, StepReport& report)
{
    WireMask failed = balance(world, paths, mask, Settling::Stuck, 1);
    note_solves(world, report, mask);
    if (!failed.any()) return failed;
    // Placed off the wall, a wire that springs against it would be held by where it touches first, by slips as long as its
    // way there. It slides to rest instead, and holds from there on.
    WireMask rested = failed;
    failed = balance(world, paths, failed, Settling::Sliding);
    note_solves(world, report, rested);
    for (std::size_t w = 0; w < failed.size(); ++w) rested[w] = rested[w] && !failed[w];
    if (rested.any()) {
        (void)balance(world, paths, rested, Settling::Stuck);  // where that fails the wire is at rest all the same
        note_solves(world, report, rested);
    }
    return failed;
}

/// Whether the balance may begin where the wires were placed, unloaded: the work of a moment over the whole turn is not known
/// from its two ends.
bool counts_from_placement(const WorldData& world)
{
    const auto has_moment = [](const WireSetup& wire) {
        return std::ranges::any_of(wire.loads, [](const LoadSpec& load) { return !load.moment.isZero(); });
    };
    return world.setup.integrator.scheme == Scheme::Static && !world.forces.given &&
           std::ranges::none_of(world.setup.wires, has_moment);
}

}  // namespace

void find_equilibrium(WorldData& world, StepReport& report, const std::function<void(int system, double time)>& passed)
{
    WireMask going = world.systems.running();
    std::vector<ContinuationPath> paths;
    for (int s = 0; s < world.systems.count(); ++s) paths.push_back(path_of(world, s));
    if (counts_from_placement(world)) begin_audits(world);
    bool stuck = world.setup.start_settled && world.state.steps == 0;
    while (going.any()) {
        const WireMask failed = stuck ? balance_stuck(world, paths, going, report) : balance(world, paths, going, Settling::Off);
        if (!stuck) note_solves(world, report, going);
        stuck = false;
        for (int s = 0; s < world.systems.count(); ++s) {
            const auto wires = world.systems.wires_of(s);
            if (!going[wires.front()]) continue;
            const bool any_failed = std::any_of(wires.begin(), wires.end(), [&](int w) { return failed[w]; });
            const std::size_t reached = paths[s].next;
            const bool found = go_on(world, s, paths[s], any_failed);
            if (passed && found && paths[s].next > reached && !paths[s].done()) {
                world.output.loads_known = false;  // those of the equilibrium before
                show_instruments(world);
                passed(s, paths[s].reached);
            }
            for (const int w : wires) {
                if (!found) note(world, report, w, why_lost(world, w));
                going[w] = found && !paths[s].done();
            }
        }
    }
}

}  // namespace seldinger
