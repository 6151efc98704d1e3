// Walks the grid of nodes and steps, exchanges one choice at a time for a cheaper one, and keeps what still meets the goals.
#include "plan/plan_search.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double grid_ratio = 1.25;  // between neighbours
constexpr int fewest_searched = 5;
constexpr double worth_it = 0.97;     // a cost that is not below this share is noise
constexpr double no_dearer = 1.25;    // what is left out is no work: more than the winner took is noise
constexpr double room = 0.7;          // a family with an error below this share of the winner's has room for coarser places
constexpr double no_change = 0.1;     // of the limit: an error that grows by less has not changed
constexpr int strides[] = {4, 2, 1};  // grid places
constexpr int patience = 3;           // dearer corners in a row that end a walk along the bounding curve
constexpr double widest_ratio = 1.3;  // between neighbours that are not neighbouring whole numbers

/// A place on the grid.
struct Place {
    int node = 0, step = 0;  // indices, growing towards coarse
};

class Search {
public:
    /// @param scene  whose reader says which families can be run; null: none but the first is tried
    Search(const SearchGrid& grid, TrialRunSource& trials, const std::function<bool()>& may_go_on, const Scene* scene = nullptr,
           bool touches = true)
        : grid_(grid), trials_(trials), may_go_on_(may_go_on), scene_(scene), touches_(touches)
    {
    }

    [[nodiscard]] bool ended() const { return ended_; }
    [[nodiscard]] const TrialRun* best() const { return best_; }

    /// Null when the search has ended or the place is off the grid.
    const TrialRun* look(const Model& family, Place place)
    {
        if (ended_ || !on_grid(family, place)) return nullptr;
        if (!may_go_on_()) return end();
        const TrialRun* trial = trials_.look_at(at_place(family, place));
        if (!trial) return end();
        if (trial->meets && (!best_ || trial->seconds < worth_it * best_->seconds)) best_ = trial, best_place_ = place;
        return trial;
    }

    [[nodiscard]] Place place_of(const Model& model) const
    {
        Place place;
        while (place.node + 1 < static_cast<int>(grid_.nodes.size()) &&
               grid_.nodes[static_cast<std::size_t>(place.node)] > model.nodes.value_or(0))
            ++place.node;
        while (place.step + 1 < static_cast<int>(grid_.steps.size()) &&
               grid_.steps[static_cast<std::size_t>(place.step) + 1] <= model.dt.value_or(0) * (1 + 1e-9))
            ++place.step;
        return place;
    }
    [[nodiscard]] Place best_place() const { return best_place_; }

    /// From a place that meets the goals to the cheapest of its family. Error grows with both indices, so a curve of corners
    /// bounds the places that meet the goals. The search goes down to one corner and then, if told to walk, along the curve, to
    /// longer steps and more nodes and back, as long as that pays.
    void optimise(const Model& family, Place from, bool walks)
    {
        Place corner = from;
        while (coarsen(family, corner, &Place::step) || coarsen(family, corner, &Place::node)) {
        }
        if (!walks || grid_.steps.empty() || family.nodes == 0) return;
        for (const int direction : {1, -1}) corner = walk(family, corner, direction);
    }

    /// A family at the winner's place: where it does not meet the goals there, at finer steps that would still be cheaper.
    void try_family(const Model& family, bool walks)
    {
        if (!best_ || ended_ || !can_run(family)) return;
        Place place = best_place_;
        const double cost = best_->seconds, error = best_->error;
        const TrialRun* trial = look(family, place);
        for (int finer = 2; trial && !trial->meets && finer <= 6; finer += 2) {
            if (trial->seconds * grid_ratio * grid_ratio > cost) return;
            place.step = best_place_.step - finer;
            trial = look(family, place);
        }
        if (!trial || !trial->meets) return;
        if (trial->seconds < worth_it * cost || trial->error < room * error) optimise(family, place, walks);
    }

    /// Whether a family is cheaper than the winner at a place, and leaves room for coarser ones.
    bool take_at_once(const Model& family, Place place, double limit)
    {
        if (!best_ || ended_ || !can_run(family)) return false;
        const double cost = best_->seconds;
        const TrialRun* trial = look(family, place);
        return trial && trial->meets && trial->seconds < worth_it * cost && trial->error < room * limit;
    }

    /// The winner with something left out, where that is no dearer and changes nothing.
    void leave_out(const PlanChoice& choice, double limit)
    {
        if (!best_ || ended_) return;
        Model family = best_->model;
        choice.make(family);
        if (!can_run(family)) return;
        const TrialRun before = *best_;
        const TrialRun* trial = look(family, best_place_);
        if (!trial || !trial->meets || trial->seconds > no_dearer * before.seconds ||
            trial->error > before.error + no_change * limit)
            return;
        best_ = trial;
    }

private:
    /// Each choice can be made in the scene as it stands, but not any two of them: float32 has no layer, impulses have neither.
    [[nodiscard]] bool can_run(const Model& family) const
    {
        return scene_ && not_vouched_for(family, *scene_, touches_).empty() && why_not(family, *scene_).empty();
    }

    const TrialRun* end()
    {
        ended_ = true;
        return nullptr;
    }

    [[nodiscard]] bool on_grid(const Model& family, Place place) const
    {
        const bool node = family.nodes == 0 || (place.node >= 0 && place.node < static_cast<int>(grid_.nodes.size()));
        return node && (grid_.steps.empty() || (place.step >= 0 && place.step < static_cast<int>(grid_.steps.size())));
    }

    [[nodiscard]] Model at_place(Model family, Place place) const
    {
        if (family.nodes != 0) family.nodes = grid_.nodes[static_cast<std::size_t>(place.node)];
        if (!grid_.steps.empty()) family.dt = grid_.steps[static_cast<std::size_t>(place.step)];
        return family;
    }

    bool try_move(const Model& family, Place& here, Place there)
    {
        const TrialRun* now = look(family, here);
        const TrialRun* then = now ? look(family, there) : nullptr;
        if (!then || !then->meets || then->seconds >= worth_it * now->seconds) return false;
        here = there;
        return true;
    }

    bool coarsen(const Model& family, Place& here, int Place::*axis)
    {
        if ((axis == &Place::node && family.nodes == 0) || (axis == &Place::step && grid_.steps.empty())) return false;
        bool moved = false;
        for (const int stride : strides)
            for (;;) {
                Place there = here;
                there.*axis += stride;
                if (!try_move(family, here, there)) break;
                moved = true;
            }
        return moved;
    }

    /// Along the bounding curve from a corner of it: at each next step, the fewest nodes that meet the goals.
    /// @return the cheapest place on the way, or `from`
    Place walk(const Model& family, Place from, int direction)
    {
        Place cheapest = from, here = from;
        const TrialRun* trial = look(family, from);
        if (!trial) return from;
        double least = trial->seconds;
        for (int dearer = 0; dearer < patience && !ended_;) {
            here.step += direction;
            if (here.step < 0 || here.step >= static_cast<int>(grid_.steps.size())) break;
            trial = nodes_that_meet(family, here, least);
            if (trial && trial->meets && trial->seconds < least) least = trial->seconds, cheapest = here, dearer = 0;
            else ++dearer;
        }
        return cheapest;
    }

    /// Moves `here` along its nodes to the fewest that meet the goals. Gives up where more nodes would cost more than `least`:
    /// `here` is then left there.
    const TrialRun* nodes_that_meet(const Model& family, Place& here, double least)
    {
        const TrialRun* trial = look(family, here);
        while (trial && !trial->meets && here.node > 0 && trial->seconds <= least) {
            --here.node;
            trial = look(family, here);
        }
        if (!trial || !trial->meets) return trial;
        for (;;) {
            const Place there = {here.node + 1, here.step};
            const TrialRun* then = look(family, there);
            if (!then || !then->meets) return trial;
            here = there;
            trial = then;
        }
    }

    const SearchGrid& grid_;
    TrialRunSource& trials_;
    const std::function<bool()>& may_go_on_;
    const Scene* scene_;
    bool touches_;
    const TrialRun* best_ = nullptr;
    Place best_place_;
    bool ended_ = false;
};

/// The next coarser whole number of edges, or of parts of an interval.
int next_coarser(int parts)
{
    const int rounded = static_cast<int>(std::lround(parts / grid_ratio));
    return std::min(parts - 1, parts > widest_ratio * rounded ? rounded + 1 : rounded);
}

template <class Enum, class Member>
PlanChoice exchange(std::string simpler, std::string fuller, Member member, Enum to, Enum from, bool leaves_out = false)
{
    return {std::move(simpler), std::move(fuller), [=](Model& m) { m.*member = to; }, [=](Model& m) { m.*member = from; }, true,
            leaves_out};
}

}  // namespace

SearchGrid search_grid(const Reference& reference, double interval, double longest_step)
{
    SearchGrid grid;
    for (int edges = reference.model.nodes.value_or(101) - 1; edges + 1 >= fewest_searched; edges = next_coarser(edges))
        grid.nodes.push_back(edges + 1);
    if (longest_step <= 0) return grid;
    const double finest = std::min(reference.model.dt.value_or(longest_step), longest_step);
    for (int parts = std::max(1, static_cast<int>(std::lround(interval / finest))); parts >= 1; parts = next_coarser(parts)) {
        const double step = interval / parts;
        if (step > longest_step * (1 + 1e-9)) break;
        grid.steps.push_back(step);
    }
    // the longest step itself is worth a place: what a display asks for
    const double longest = interval / std::ceil(interval / longest_step - 1e-9);
    if (grid.steps.empty() || longest > grid.steps.back() * (1 + 1e-9)) grid.steps.push_back(longest);
    return grid;
}

std::string not_vouched_for(const Model& model, const Scene& scene, bool touches)
{
    const IntegratorSpec integrator = apply(model, scene).integrator;
    if (integrator.scheme == Scheme::Linearised) return "one Newton iteration per step leaves an unbounded residual";
    if (integrator.scheme != Scheme::Static && integrator.newmark && touches) return "it makes energy in contact";
    return {};
}

namespace {

std::string edges_of(double edge) { return fmt::format("control edges of {:.3g} mm", 1e3 * edge); }

/// The wall rigid, or on a coarser control mesh. A model without an edge has the scene's own, the last of `walls`.
void add_walls(std::vector<PlanChoice>& all, const std::vector<double>& walls)
{
    if (walls.empty()) return;
    const double own = walls.back();
    const auto make_rigid = [](Model& m) { m.elastic_wall = false, m.wall_edge.reset(); };
    const auto undo_rigid = [](Model& m) {
        if (m.elastic_wall == false) m.elastic_wall = true;
    };
    all.push_back({"a rigid wall", "the elastic wall", make_rigid, undo_rigid, true, true, true});
    for (const double edge : walls) {
        const auto make = [=](Model& m) {
            if (!m.elastic_wall.value_or(true) || m.wall_edge.value_or(own) >= edge) return;
            m.wall_edge = edge;
            if (edge == own) m.wall_edge.reset();
        };
        const auto undo = [=](Model& m) {
            if (m.wall_edge == edge) m.wall_edge.reset();
        };
        all.push_back({edges_of(edge), edges_of(own), make, undo, true, false, true});
    }
}

/// One centreline in place of a rod each, with friction by what presses one instrument on the other's lumen, and without any:
/// that is cheaper, and its hands feel less. Whichever is chosen, the other one is named as its price.
void add_coaxial(std::vector<PlanChoice>& all, const CoaxialSpec& own)
{
    const bool merged = own.model == CoaxialSpec::Model::Merged, rubs = own.mu_static > 0;
    const auto is_merged = [=](const Model& m) { return m.coaxial.value_or(own.model) == CoaxialSpec::Model::Merged; };
    const auto apart = [](Model& m) { m.coaxial = CoaxialSpec::Model::Separate, m.lumen_friction.reset(); };
    const auto set_friction = [=](bool on) {
        return [=](Model& m) {
            if (is_merged(m)) m.lumen_friction = on;
        };
    };
    const std::string with = "friction between the instruments from contact force (coaxial.lumen_friction)";
    if (!merged && rubs)
        all.push_back({"one centreline for all instruments, " + with, "a rod for each instrument",
                       [](Model& m) { m.coaxial = CoaxialSpec::Model::Merged, m.lumen_friction = true; }, apart, false});
    if (!merged)
        all.push_back({"one centreline for all instruments", "a rod for each instrument",
                       [](Model& m) { m.coaxial = CoaxialSpec::Model::Merged, m.lumen_friction = false; }, apart, false});
    if (!rubs || (merged && !own.lumen_friction)) return;
    all.push_back({"no friction between the instruments", with, set_friction(false), set_friction(true), false});
    all.push_back({with, "no friction between the instruments", set_friction(true), set_friction(false), false});
}

}  // namespace

std::vector<PlanChoice> choices_in(const Scene& scene, const std::vector<double>& walls)
{
    const ContactSpec& own = scene.contact;
    std::vector<PlanChoice> all;
    add_walls(all, walls);
    all.push_back(
        exchange("one Newton step per step", "converged Newton steps", &Model::scheme, Scheme::Linearised, Scheme::Newton));
    all.back().needs_contact = false;
    all.push_back(exchange("detection at the nodes only", "detection along the whole wire", &Model::detection, Detection::Nodes,
                           Detection::Swept));
    all.push_back(exchange("the published layer", "the exact wall", &Model::detection, Detection::Layer, Detection::Swept));
    if (own.rolling) all.push_back(exchange("no rolling friction", "rolling friction", &Model::rolling, false, true, true));
    all.push_back(exchange("float32 contact", "float64 contact", &Model::precision, Precision::Float32, Precision::Float64));
    if (scene.integrator.spins == Spins::Kept)
        all.push_back({"spin angles left out where they do nothing", "spin angles always", [](Model& m) { m.spin = false; },
                       [](Model& m) { m.spin.reset(); }, false});
    if (own.friction != FrictionLaw::Smooth && own.friction != FrictionLaw::None)
        all.push_back(
            exchange("friction smooth in velocity", "friction that sticks", &Model::friction, FrictionLaw::Smooth, own.friction));
    if (own.friction != FrictionLaw::None)
        all.push_back(exchange("no friction", "friction", &Model::friction, FrictionLaw::None, own.friction));
    for (const NormalLaw law : {NormalLaw::LankaraniNikravesh, NormalLaw::Impulse})
        if (own.normal != law)
            all.push_back(exchange(law == NormalLaw::Impulse ? "contact by impulses" : "published damping of contact",
                                   "the scene's normal law", &Model::normal, law, own.normal));
    if (scene.coaxial) add_coaxial(all, *scene.coaxial);
    if (!scene.integrator.newmark)
        all.push_back({"the trapezoid rule", "backward Euler", [](Model& m) { m.trapezoid = true; },
                       [](Model& m) { m.trapezoid.reset(); }, false});
    all.push_back({"Newton steps to 1e-4", "Newton steps to 1e-6", [](Model& m) { m.tolerance = 1e-4; },
                   [t = scene.integrator.tolerance](Model& m) { m.tolerance = t; }, false});
    std::erase_if(all, [&](const PlanChoice& choice) {
        Model model;
        choice.make(model);
        if (choice.needs_contact && scene.vessel.shape == VesselShape::None) return true;
        if (scene.integrator.scheme == Scheme::Static && (model.scheme || model.trapezoid)) return true;
        return !why_not(model, scene).empty();
    });
    return all;
}

SearchResult search_models(const Scene& scene, const Model& from, const SearchGrid& grid, bool touches, TrialRunSource& trials,
                           const std::function<bool()>& may_go_on)
{
    Search search(grid, trials, may_go_on, &scene, touches);
    Model start = from;
    Place place = search.place_of(start);
    const TrialRun* first = search.look(start, place);
    while (first && !first->meets && (place.step > 0 || place.node > 0)) {
        place = {std::max(0, place.node - 2), std::max(0, place.step - 2)};
        first = search.look(start, place);
    }
    if (first && !first->meets && !grid.walls.empty() && grid.finest_wall > 0) {
        start.wall_edge = grid.finest_wall;
        first = search.look(start, place);
    }
    const std::vector<PlanChoice> choices = choices_in(scene, grid.walls);
    for (const PlanChoice& choice : choices) {
        if (!choice.of_wall || !touches || !first || !first->meets) continue;
        Model other = start;
        choice.make(other);
        if (search.take_at_once(other, place, trials.limit())) start = other;
    }
    if (first && first->meets) search.optimise(start, place, false);

    // Twice: a choice that did not pay before another was made may pay after it. Along bounding curves only then: a choice can
    // save half of every later trial, a walk hardly more than 20 %, and a budget may end the search anywhere.
    for (int round = 0; round < 2 && search.best(); ++round) {
        const bool walks = round > 0;
        const Model before = search.best()->model;
        for (const PlanChoice& choice : choices) {
            if (choice.needs_contact && !touches) continue;
            Model family = search.best()->model;
            choice.make(family);
            search.try_family(family, walks);
        }
        // adaptive nodes, their bounds in place of a number
        for (const auto& [shortest, longest] : {std::pair{1e-3, 10e-3}, {2e-3, 20e-3}, {0.5e-3, 5e-3}}) {
            Model family = search.best()->model;
            if (family.detection == Detection::Nodes || family.detection == Detection::Layer || scene.wire.length < 4 * shortest)
                continue;
            family.nodes = 0;
            family.min_edge = shortest;
            family.max_edge = longest;
            search.try_family(family, walks);
        }
        if (!walks) search.optimise(search.best()->model, search.best_place(), true);
        if (search.ended() || label(search.best()->model) == label(before)) break;
    }
    for (const PlanChoice& choice : choices)
        if (choice.leaves_out && touches) search.leave_out(choice, trials.limit());
    SearchResult result;
    if (search.best()) result.best = search.best()->model;
    result.complete = !search.ended();
    return result;
}

std::optional<Model> search_rate(const Model& start, const SearchGrid& grid, double seconds, TrialRunSource& trials,
                                 const std::function<bool()>& may_go_on)
{
    Search search(grid, trials, may_go_on);
    const Place from = search.place_of(start);
    std::optional<Model> best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](Place place) {
        const TrialRun* trial = search.look(start, place);
        if (!trial || !trial->sound || trial->seconds > seconds) return false;
        if (trial->error < least) least = trial->error, best = trial->model;
        return true;
    };
    // along each axis and the diagonal, the first that is fast enough
    for (const auto& [nodes, steps] : {std::pair{0, 1}, {1, 0}, {1, 1}})
        for (int k = 0; k < 40; k += 2)
            if (consider({from.node + k * nodes, from.step + k * steps}) || search.ended()) break;
    return best;
}

}  // namespace seldinger
