// The stages of contact with quadrature points, in the order in which a step calls them.
#include "contact/capsule.h"

#include "contact/device_records.h"
#include "contact/wall_law.h"
#include "core/clock.h"
#include "core/parallel.h"
#include "core/state_walk.h"

#include <algorithm>
#include <limits>

namespace seldinger {
namespace {

NearWall::Lengths near_lengths(const QuadratureSet& points, const WallTree& tree, uint law)
{
    double least = std::numeric_limits<double>::infinity();
    for (const QuadratureModel& m : points.models) least = std::min(least, m.radius);
    const double slack = 0.4 * least;
    Vec3 low, high;
    for (int k = 0; k < 3; ++k) {
        low[k] = tree.nodes.front().lo[k];
        high[k] = tree.nodes.front().hi[k];
    }
    // the barrier checks the whole path of an update, which may begin that far from the place of the search
    return {slack, slack + (law == SEL_NORMAL_BARRIER ? 0.3 * least : 0.0), (high - low).norm() + 1};
}

}  // namespace

CapsuleContact::CapsuleContact(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree)
    : ContactMethod(context, setup, rods, tree),
      swept_(setup.method().detection == Detection::Swept),
      quadrature_(make_quadrature(setup)),
      states_(context, quadrature_),
      near_(context, quadrature_, wall_, nodes_, states_, near_lengths(quadrature_, tree, kernel_law(setup.method().normal))),
      active_(context, quadrature_, sums_, rods.total_capacity()),
      evaluation_(context, quadrature_.models),
      valleys_(quadrature_, nodes_, sums_)
{
    params_.friction = kernel_law(setup.method().friction);
    params_.normal_law = kernel_law(setup.method().normal);
    params_.smoothing = 0.002;    // 1 um for a 0.035 inch wire: bias of the depth at most a quarter of it times the facets' angle
    params_.smooth_speed = smooth_friction_speed;
    params_.returns = setup.known_velocities;
    params_.slots = near_.slots();
    set_limits();
    if (params_.normal_law == SEL_NORMAL_BARRIER) barrier_.emplace(context, quadrature_, rods.total_capacity());
    else if (params_.normal_law != SEL_NORMAL_DAMPED) multipliers_.emplace(context, quadrature_.total());
    warm_up();
}

// Quadrature points of an accepted state are at least r - depth_max >= r/2 from the wall, so a move of less than r/2 cannot take
// one across it unseen. The trial there finds the wall nearer than depth_max allows, and is refused.
void CapsuleContact::set_limits()
{
    traits_.never_overlaps = params_.normal_law == SEL_NORMAL_BARRIER;
    const bool limited = swept_ || params_.normal_law == SEL_NORMAL_BARRIER;
    for (const WireQuadrature& wire : quadrature_.wires) {
        double limit = std::numeric_limits<double>::infinity();
        for (int k = wire.begin; k < wire.begin + wire.capacity && limited; ++k)
            limit = std::min(limit, 0.45 * quadrature_.models[k].radius);
        traits_.most_move.push_back(limit);
        storage_.emplace_back(std::span(quadrature_.models).subspan(wire.begin, wire.capacity), params_.normal_law);
    }
}

// The first launch of a kernel on each device compiles it (0.1 s and more): here, not in the step loop.
void CapsuleContact::warm_up()
{
    ContactParams none = params_;
    none.item_count = 0;
    for (const device::Queue at : {device::Queue::Inline, device::Queue::Pool}) {
        context_.enter(at);
        near_.warm_up(at, none);
        evaluation_.launch_forces(at, none, buffers(), nodes_before(), near_.clearances(), multiplier_states());
        evaluation_.launch_sums(at, 0, active_.all().first_buffer, active_.sums_buffer(false));
        if (multipliers_) multipliers_->warm_up(at, none, buffers());
        if (barrier_) barrier_->warm_up(at, none, buffers());
        context_.finish(at);
    }
}

QuadratureBuffers CapsuleContact::buffers(const ActiveList& list) const
{
    return {states_.models(),
            states_.places(),
            list.point_buffer,
            near_.near_cells(),
            near_.counts(),
            states_.states_t0(),
            states_.states(),
            wall_,
            nodes_};
}

void CapsuleContact::set_wire_nodes(DeviceNodes& nodes, int wire, const RodView& rod) const
{
    const int begin = rods_.node_begin(wire);
    for (int i = 0; i < rod.n; ++i)
        nodes.set(begin + i, rod.x[i], rod.y[i], rod.z[i], i + 1 < rod.n ? rod.theta[i] : 0.0, wall_.centre);
}

void CapsuleContact::begin(RodArrays& rods)
{
    for_each_item(rods.wire_count(), wire_grain, [&](int w) {
        const RodView rod = rods.view(w);
        set_wire_nodes(nodes_t0_, w, rod);
        place_quadrature(quadrature_, w, rod, rods.node_begin(w), true);
    });
}

void CapsuleContact::prepare(RodArrays& rods, std::span<const std::uint8_t> live)
{
    const auto start = Clock::now();
    for_each_item(rods.wire_count(), wire_grain, [&](int w) {
        const RodView rod = rods.view(w);
        place_new_quadrature(quadrature_, w, rod, rods.node_begin(w));
        if (!live[w]) quadrature_.wires[w].live = 0;
        set_wire_nodes(nodes_, w, rod);
    });
    active_.set_stale();
    context_.enter(device::Queue::Inline);
    nodes_t0_.upload(context_, device::Queue::Inline);
    states_.upload_places();
    find_near({});
    if (multipliers_) multipliers_->begin();
    if (barrier_) start_barrier();
    times.detect += seconds_since(start);
}

void CapsuleContact::start_barrier()
{
    const device::Queue at = queue_for(active_.all().points.size());
    context_.enter(at);
    nodes_.upload(context_, at);
    barrier_->begin(at, params_, buffers(), quadrature_, active_.all().points);
    barrier_->take(nodes_, 0, static_cast<int>(nodes_.theta.size()));
    states_.write_places(at);
    context_.finish(at);
}

// Between steps: places and lists are made anew when the next one begins.
bool CapsuleContact::is_clear(RodArrays& rods, int wire)
{
    const RodView rod = rods.view(wire);
    place_quadrature(quadrature_, wire, rod, rods.node_begin(wire), false);
    for (int i = 0; i < rod.n; ++i) nodes_.set(rods.node_begin(wire) + i, rod.x[i], rod.y[i], rod.z[i], 0, wall_.centre);
    active_.set_stale();
    context_.enter(device::Queue::Inline);
    states_.write_places(device::Queue::Inline);
    find_near({});
    const device::Queue at = queue_for(active_.all().points.size());
    context_.enter(at);
    nodes_.upload(context_, at);
    return barrier_->is_clear(at, params_, buffers(), quadrature_, active_.all().points, wire);
}

TermAnswer CapsuleContact::answer(int wire, Ask what)
{
    TermAnswer answer = ContactMethod::answer(wire, what);
    switch (what) {
        case Ask::Trial:
            if (barrier_) answer.open = barrier_->feasible_step(wire);
            answer.admissible = answer.admissible && answer.open == 1;
            break;
        case Ask::Kinks:
            if (valleys_known()) answer.kinks = valleys_.crossed(wire, states_.at_trial(), active_.all(), params_.smoothing);
            break;
        case Ask::Energies:
            answer.energies.stored = storage_[wire].most(sums_, wire, rods_.node_begin(wire), rods_.view(wire));
    }
    return answer;
}

void CapsuleContact::take(int wire, Base base, std::span<double> kinks)
{
    if (barrier_) {
        if (base == Base::Start) set_wire_nodes(nodes_, wire, rods_.view(wire));
        barrier_->take(nodes_, rods_.node_begin(wire), rods_.node_begin(wire) + rods_.node_count(wire));
    } else if (base == Base::Trial && valleys_known()) {
        if (!kinks.empty()) valleys_.admit(wire, rods_.node_begin(wire), kinks);
        valleys_.take(wire, states_.at_trial(), active_.all());
    }
}

bool CapsuleContact::refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again)
{
    const std::size_t points = active_.all().points.size();
    if (!multipliers_ || points == 0) return false;
    const auto start = Clock::now();
    const bool any = multipliers_->update(queue_for(points), params_, buffers(), quadrature_, solved, again);
    times.evaluate += seconds_since(start);
    return any;
}

/// The points that have the wall near them, and what the kernels need to know of them. @param active  wires that are evaluated
/// next; empty: not said
void CapsuleContact::find_near(std::span<const std::uint8_t> active)
{
    const bool renewed = near_.renew(params_);
    params_.slots = near_.slots();
    if (renewed || active_.stale()) active_.rebuild(near_, active);
}

void CapsuleContact::evaluate_forces(const TermTrial& trial)
{
    auto start = Clock::now();
    set_nodes(nodes_, trial.at);
    find_near(trial.active);
    const ActiveList* part = multipliers_ || barrier_ ? nullptr : active_.pick(trial.active);
    const ActiveList& list = part ? *part : active_.all();
    times.detect += seconds_since(start);
    if (!list.points.empty()) {
        evaluate_list(list, part != nullptr, trial.h);
        if (part) active_.spread(trial.active);
    }
    if (!barrier_) return;
    start = Clock::now();
    barrier_->sweep(queue_for(list.points.size()), params_, buffers(), quadrature_, list.points);
    times.detect += seconds_since(start);
}

/// @param part  the list is not of all wires
void CapsuleContact::evaluate_list(const ActiveList& list, bool part, double h)
{
    auto start = Clock::now();
    const device::Queue at = queue_for(list.points.size());
    context_.enter(at);
    upload_nodes(at);
    if (part) list.upload(context_, at);
    params_.item_count = static_cast<uint>(list.points.size());
    params_.inv_dt = h > 0 ? 1 / h : 0;
    if (multipliers_) multipliers_->before_evaluation(at, params_, buffers());
    evaluation_.launch_forces(at, params_, buffers(list), nodes_before(), near_.clearances(), multiplier_states());
    if (at == device::Queue::Inline) {  // waiting costs nothing there, and tells the two stages apart; else both are `evaluate`
        context_.finish(at);
        times.evaluate += seconds_since(start);
        start = Clock::now();
    }
    const device::Buffer& sums = active_.sums_buffer(part);
    evaluation_.launch_sums(at, list.edges(), list.first_buffer, sums);
    read_records(context_, at, sums, active_.sums_target(part), list.edges(), 0, narrow_);
    states_.bring_trial(at, list.points);
    (at == device::Queue::Inline ? times.reduce : times.evaluate) += seconds_since(start);
}

void CapsuleContact::commit(std::span<const std::uint8_t> active)
{
    if (barrier_) barrier_->commit(quadrature_, active);
    const ActiveList& list = active_.all();
    states_.commit(active, [&](std::size_t w) {
        const std::uint32_t first = list.edge_first[static_cast<std::size_t>(sums_.wire_edges[w])],
                            end = list.edge_first[static_cast<std::size_t>(sums_.wire_edges[w + 1])];
        return std::span(list.points).subspan(first, end - first);
    });
}

// Near nodes are found anew: results do not depend on where they were found (nearest_contact_point reports nothing beyond the
// reach).
void CapsuleContact::walk_state(StateWalk& walk, int wire)
{
    const WireQuadrature& points = quadrature_.wires[static_cast<std::size_t>(wire)];
    states_.walk_state(walk, wire, wall_.original.size());
    if (barrier_) barrier_->walk_state(walk, points);
    if (!walk.reads()) return;
    active_.forget(points);
    near_.forget(points);
}

}  // namespace seldinger
