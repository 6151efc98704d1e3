#include "contact/capsule.h"

#include "contact/device_records.h"
#include "contact/wall_law.h"
#include "core/bytes.h"
#include "core/error.h"
#include "core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

namespace seldinger {

namespace {

// Below these counts the caller's thread is faster than waking the pool (15 us); by counts alone, so that the choice, and with it
// the order of nothing at all, is the same on every machine.
constexpr std::size_t heavy_evaluate = 2048;

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

template <class T>
std::size_t bytes_of(const std::vector<T>& v)
{
    return v.size() * sizeof(T);
}

NearWall::Lengths near_lengths(const SampleSet& samples, const WallTree& tree, uint law)
{
    double least = std::numeric_limits<double>::infinity();
    for (const SampleModel& m : samples.models) least = std::min(least, m.radius);
    const double slack = 0.4 * least;
    Vec3 low, high;
    for (int k = 0; k < 3; ++k) {
        low[k] = tree.nodes.front().lo[k];
        high[k] = tree.nodes.front().hi[k];
    }
    // the barrier looks at the whole way of an update, which may begin that far from where the list was made
    return {slack, slack + (law == SEL_NORMAL_BARRIER ? 0.3 * least : 0.0), (high - low).norm() + 1};
}

}  // namespace

CapsuleContact::CapsuleContact(device::Context& context, const ContactSetup& setup, RodArrays& rods, const WallTree& tree)
    : ContactMethod(context, setup, rods, tree),
      swept_(setup.method().detection == Detection::Swept),
      samples_(make_samples(setup.wires, setup.contacts, setup.wall)),
      near_(context, samples_, wall_, nodes_, models_, places_,
            near_lengths(samples_, tree, kernel_law(setup.method().normal))),
      evaluate_(context, "contact/capsule.cl", "contact_evaluate"),
      reduce_(context, "contact/capsule.cl", "contact_reduce")
{
    const std::size_t n = samples_.models.size();
    params_.friction = static_cast<uint>(setup.method().friction);
    params_.normal_law = kernel_law(setup.method().normal);
    params_.blend = 0.002;        // 1 um for a 0.035 inch wire: bias of the depth at most a quarter of it times the facets' angle
    params_.smooth_speed = 1e-3;  // usual in regularised laws; creeps at mu_sliding * this / 2 under half the cone
    for (const WireSamples& wire : samples_.wires) {
        double limit = std::numeric_limits<double>::infinity();
        for (int k = wire.begin; k < wire.begin + wire.capacity && (swept_ || params_.normal_law == SEL_NORMAL_BARRIER); ++k)
            limit = std::min(limit, 0.45 * samples_.models[k].radius);
        move_limit_.push_back(limit);
    }
    listed_.assign(n, 0);
    active_.reserve(n);
    const std::size_t most_edges = rods.total_capacity();
    edge_first_.reserve(most_edges + 1);
    sums_.edge_node.reserve(most_edges);
    sums_.edges.resize(most_edges);
    last_edges_.resize(most_edges);
    sums_.wire_edges.assign(rods.wire_count() + 1, 0);
    for (const WireSamples& wire : samples_.wires)
        storage_.emplace_back(std::span(samples_.models).subspan(wire.begin, wire.capacity), params_.normal_law);
    last_wire_edges_ = sums_.wire_edges;
    some_.reserve(n);
    some_first_.reserve(most_edges + 1);
    models_ = device::Buffer(context, n * device_size<SampleModel>(context));
    places_ = device::Buffer(context, n * device_size<SamplePlace>(context));
    params_.slots = near_.slots();
    active_list_ = device::Buffer(context, n * sizeof(std::uint32_t));
    first_buffer_ = device::Buffer(context, (most_edges + 1) * sizeof(std::uint32_t));
    some_list_ = device::Buffer(context, n * sizeof(std::uint32_t));
    some_first_buffer_ = device::Buffer(context, (most_edges + 1) * sizeof(std::uint32_t));
    forces_ = device::Buffer(context, n * device_size<SampleForce>(context));
    barys_ = device::Buffer(context, n * device_size<double>(context));
    const std::size_t sums = most_edges * device_size<EdgeForce>(context);
    edge_buffer_ = device::Buffer(context, sums_.edges.data(), sums);
    last_edge_buffer_ = device::Buffer(context, last_edges_.data(), sums);
    touches_t0_ = device::Buffer(context, 2 * n * device_size<TouchState>(context));
    touches_ = device::Buffer(context, 2 * n * device_size<TouchState>(context));
    no_multipliers_ = device::Buffer(context, sizeof(HardState));
    if (params_.normal_law == SEL_NORMAL_BARRIER) barrier_.emplace(context, samples_, rods.total_capacity());
    else if (params_.normal_law != SEL_NORMAL_DAMPED) multipliers_.emplace(context, samples_.total());
    write_records(context_, device::Lane::Light, models_, samples_.models, narrow_);
    context_.finish(device::Lane::Light);
    warm_up();
}

// The first launch of a kernel on each device compiles it (0.1 s and more): here, not in the step loop.
void CapsuleContact::warm_up()
{
    ContactParams none = params_;
    none.item_count = 0;
    for (const device::Lane at : {device::Lane::Light, device::Lane::Heavy}) {
        context_.enter(at);
        near_.warm_up(at, none);
        launch_evaluate(at, 1, none, active_list_);
        reduce_.launch(at, 1, cl_uint{0}, first_buffer_, forces_, barys_, edge_buffer_);
        if (multipliers_) multipliers_->warm_up(at, none, sample_buffers());
        if (barrier_) barrier_->warm_up(at, none, sample_buffers());
        context_.finish(at);
    }
}

void CapsuleContact::launch_evaluate(device::Lane at, std::size_t items, const ContactParams& par, const device::Buffer& list)
{
    const DeviceNodes& before = nodes_before();
    const auto launch = [&](const auto& params) {
        evaluate_.launch(at, items, params, list, models_, places_, near_.cells(), near_.counts(), wall_.nodes, wall_.vertices,
                         wall_.rims, nodes_.hi_buffer, nodes_.lo_buffer, nodes_.theta_buffer, before.hi_buffer,
                         before.lo_buffer, before.theta_buffer, touches_t0_, touches_, forces_, barys_,
                         multipliers_ ? multipliers_->states() : no_multipliers_, near_.clearances());
    };
    if (context_.float32()) launch(narrow(par));
    else launch(par);
}

SampleBuffers CapsuleContact::sample_buffers() const
{
    return {models_, places_, active_list_, near_.cells(), near_.counts(), touches_t0_, touches_, wall_, nodes_};
}

void CapsuleContact::write_places(device::Lane at) { write_records(context_, at, places_, samples_.places, narrow_places_); }

device::Lane CapsuleContact::lane(std::size_t samples) const
{
    return samples < heavy_evaluate ? device::Lane::Light : device::Lane::Heavy;
}

void CapsuleContact::begin_step(RodArrays& rods)
{
    for_each_item(rods.wire_count(), wire_grain, [&](int w) {
        const RodView rod = rods.view(w);
        const int begin = rods.node_begin(w);
        for (int i = 0; i < rod.n; ++i)
            nodes_t0_.set(begin + i, rod.x[i], rod.y[i], rod.z[i], i + 1 < rod.n ? rod.theta[i] : 0.0, wall_.centre);
        place_samples(samples_, w, rod, begin, true);
    });
}

void CapsuleContact::prepare(RodArrays& rods, std::span<const std::uint8_t> live)
{
    const auto start = Clock::now();
    for_each_item(rods.wire_count(), wire_grain, [&](int w) {
        const RodView rod = rods.view(w);
        const int begin = rods.node_begin(w);
        place_new_samples(samples_, w, rod, begin);
        if (!live[w]) samples_.wires[w].live = 0;
        for (int i = 0; i < rod.n; ++i)
            nodes_.set(begin + i, rod.x[i], rod.y[i], rod.z[i], i + 1 < rod.n ? rod.theta[i] : 0.0, wall_.centre);
    });
    list_stale_ = true;
    context_.enter(device::Lane::Light);
    nodes_t0_.upload(context_, device::Lane::Light);
    upload_places();
    find_near({});
    if (multipliers_) multipliers_->begin();
    if (barrier_) start_barrier();
    times_.detect += since(start);
}

// Those of samples that are inside: they change with every step.
void CapsuleContact::upload_places()
{
    if (context_.float32()) return write_places(device::Lane::Light);
    for (const WireSamples& wire : samples_.wires)
        if (wire.live > 0)
            context_.write(device::Lane::Light, places_, &samples_.places[wire.begin], wire.live * sizeof(SamplePlace),
                           wire.begin * sizeof(SamplePlace));
}

void CapsuleContact::start_barrier()
{
    const device::Lane at = lane(active_.size());
    context_.enter(at);
    nodes_.upload(context_, at);
    barrier_->begin(at, params_, sample_buffers(), samples_, active_);
    barrier_->take(nodes_, 0, static_cast<int>(nodes_.theta.size()));
    write_places(at);
    context_.finish(at);
}

// Between steps: places and lists are made anew when the next one begins.
bool CapsuleContact::is_clear(RodArrays& rods, int wire)
{
    const RodView rod = rods.view(wire);
    const int begin = rods.node_begin(wire);
    place_samples(samples_, wire, rod, begin, false);
    for (int i = 0; i < rod.n; ++i) nodes_.set(begin + i, rod.x[i], rod.y[i], rod.z[i], 0, wall_.centre);
    list_stale_ = true;
    context_.enter(device::Lane::Light);
    write_places(device::Lane::Light);
    find_near({});
    const device::Lane at = lane(active_.size());
    context_.enter(at);
    nodes_.upload(context_, at);
    return barrier_->is_clear(at, params_, sample_buffers(), samples_, active_, wire);
}

void CapsuleContact::take(int wire)
{
    if (barrier_) barrier_->take(nodes_, rods_.node_begin(wire), rods_.node_begin(wire) + rods_.node_count(wire));
}

bool CapsuleContact::refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again)
{
    if (!multipliers_ || active_.empty()) return false;
    const auto start = Clock::now();
    const bool any = multipliers_->update(lane(active_.size()), params_, sample_buffers(), samples_, solved, again);
    times_.evaluate += since(start);
    return any;
}

/// The samples that have cells, and what the kernels need to know of them. @param active  wires that are evaluated next; empty:
/// not said
void CapsuleContact::find_near(std::span<const std::uint8_t> active)
{
    const bool renewed = near_.renew(params_);
    params_.slots = near_.slots();
    if (renewed || list_stale_) rebuild_active_list(active);
}

void CapsuleContact::rebuild_active_list(std::span<const std::uint8_t> active)
{
    active_.clear();
    edge_first_.clear();
    std::swap(sums_.wire_edges, last_wire_edges_);
    sums_.edges.swap(last_edges_);
    std::swap(edge_buffer_, last_edge_buffer_);
    sums_.edge_node.clear();
    for (std::size_t w = 0; w < samples_.wires.size(); ++w) {
        const WireSamples& wire = samples_.wires[w];
        sums_.wire_edges[w] = static_cast<int>(sums_.edge_node.size());
        for (int k = 0; k < wire.live; ++k) {
            const std::uint32_t s = static_cast<std::uint32_t>(wire.begin + k);
            // once evaluated in this step, always: a record that an earlier trial wrote would pass for the last one's
            if (!near_.has_cells(static_cast<int>(s)) && listed_[s] != wire.stamp) continue;
            listed_[s] = wire.stamp;
            const std::uint32_t edge = samples_.places[s].edge;
            if (sums_.wire_edges[w] == static_cast<int>(sums_.edge_node.size()) || sums_.edge_node.back() != edge) {
                sums_.edge_node.push_back(edge);
                edge_first_.push_back(static_cast<std::uint32_t>(active_.size()));
            }
            active_.push_back(s);
        }
    }
    sums_.wire_edges.back() = static_cast<int>(sums_.edge_node.size());
    edge_first_.push_back(static_cast<std::uint32_t>(active_.size()));
    // wires that are not evaluated again in this step keep their sums; their edges are the ones they had
    for (std::size_t w = 0; w < samples_.wires.size() && !list_stale_; ++w) {
        if (!active.empty() && active[w]) continue;
        const int first = sums_.wire_edges[w], count = sums_.wire_edges[w + 1] - first;
        if (count == last_wire_edges_[w + 1] - last_wire_edges_[w])
            std::copy_n(last_edges_.begin() + last_wire_edges_[w], count, sums_.edges.begin() + first);
    }
    const device::Lane at = lane(active_.size());
    context_.enter(at);
    context_.write(at, active_list_, active_.data(), bytes_of(active_));
    context_.write(at, first_buffer_, edge_first_.data(), bytes_of(edge_first_));
    context_.finish(at);
    list_stale_ = false;
}

// What was read back of some wires goes where these wires' sums are.
void CapsuleContact::spread_sums(std::span<const std::uint8_t> active)
{
    auto from = last_edges_.begin();
    for (std::size_t w = 0; w < samples_.wires.size(); ++w) {
        if (!active[w]) continue;
        const int first = sums_.wire_edges[w], count = sums_.wire_edges[w + 1] - first;
        std::copy_n(from, count, sums_.edges.begin() + first);
        from += count;
    }
}

/// The samples and edges of the wires that are evaluated now, when those are not all: a world of many wires solves on until its
/// last one has converged. @return false: all
bool CapsuleContact::pick_some(std::span<const std::uint8_t> active)
{
    if (multipliers_ || barrier_) return false;
    const auto left_out = [&](std::size_t w) { return !active[w] && sums_.wire_edges[w + 1] > sums_.wire_edges[w]; };
    std::size_t w = 0;
    while (w < samples_.wires.size() && !left_out(w)) ++w;
    if (w == samples_.wires.size()) return false;
    some_.clear();
    some_first_.clear();
    for (w = 0; w < samples_.wires.size(); ++w) {
        if (!active[w]) continue;
        for (int e = sums_.wire_edges[w]; e < sums_.wire_edges[w + 1]; ++e) {
            some_first_.push_back(static_cast<std::uint32_t>(some_.size()));
            some_.insert(some_.end(), active_.begin() + edge_first_[e], active_.begin() + edge_first_[e + 1]);
        }
    }
    some_first_.push_back(static_cast<std::uint32_t>(some_.size()));
    return true;
}

void CapsuleContact::evaluate(const TrialState& trial, double h, std::span<const std::uint8_t> active)
{
    auto start = Clock::now();
    set_nodes(nodes_, trial);
    find_near(active);
    const bool part = pick_some(active);
    const std::size_t samples = part ? some_.size() : active_.size();
    times_.detect += since(start);
    start = Clock::now();
    const device::Lane at = lane(samples);
    if (samples > 0) {
        context_.enter(at);
        upload_nodes(at);
        if (part) {
            context_.write(at, some_list_, some_.data(), bytes_of(some_));
            context_.write(at, some_first_buffer_, some_first_.data(), bytes_of(some_first_));
        }
        params_.item_count = static_cast<uint>(samples);
        params_.inv_dt = h > 0 ? 1 / h : 0;
        if (multipliers_) multipliers_->before_evaluation(at, params_, sample_buffers());
        launch_evaluate(at, samples, params_, part ? some_list_ : active_list_);
        if (at == device::Lane::Light) {  // waiting costs nothing there, and tells the two stages apart; else both are `evaluate`
            context_.finish(at);
            times_.evaluate += since(start);
            start = Clock::now();
        }
        const std::size_t edges = part ? some_first_.size() - 1 : sums_.edge_node.size();
        const device::Buffer& sums = part ? last_edge_buffer_ : edge_buffer_;
        reduce_.launch(at, edges, static_cast<cl_uint>(edges), part ? some_first_buffer_ : first_buffer_, forces_, barys_, sums);
        read_records(context_, at, sums, part ? last_edges_.data() : sums_.edges.data(), edges, 0, narrow_);
        if (part) spread_sums(active);
        (at == device::Lane::Light ? times_.reduce : times_.evaluate) += since(start);
    }
    if (!barrier_) return;
    start = Clock::now();
    barrier_->sweep(at, params_, sample_buffers(), samples_, active_);
    times_.detect += since(start);
}

// Samples of an accepted state are at least r - depth_max >= r/2 from the wall, so a move of less than r/2 cannot take
// one across it unseen: the trial there finds the wall nearer than depth_max allows, and is refused.
double CapsuleContact::move_limit(int wire) const { return move_limit_[wire]; }

double CapsuleContact::stored_energy(int wire) const
{
    return storage_[wire].most(sums_, wire, rods_.node_begin(wire), rods_.view(wire));
}

void CapsuleContact::commit(std::span<const std::uint8_t> active)
{
    if (std::all_of(active.begin(), active.end(), [](std::uint8_t on) { return on != 0; })) {
        std::swap(touches_t0_, touches_);
    } else {
        context_.enter(device::Lane::Light);
        const std::size_t record = 2 * device_size<TouchState>(context_);
        for (std::size_t w = 0; w < active.size();) {  // neighbours go together
            const std::size_t first = w;
            std::size_t samples = 0;
            for (; w < active.size() && active[w]; ++w) samples += samples_.wires[w].capacity;
            context_.copy(device::Lane::Light, touches_, touches_t0_, samples * record, samples_.wires[first].begin * record);
            while (w < active.size() && !active[w]) ++w;
        }
        context_.finish(device::Lane::Light);
    }
    if (barrier_) barrier_->commit(samples_, active);
    for (std::size_t w = 0; w < active.size(); ++w)
        if (active[w]) samples_.wires[w].stamp++;
}

std::vector<ContactRow> CapsuleContact::rows(RodArrays& rods)
{
    const std::vector<TouchState> touches = living_touches(0, rods.wire_count());
    std::vector<ContactRow> rows;
    for (int w = 0; w < rods.wire_count(); ++w) {
        const WireSamples& wire = samples_.wires[w];
        const RodView rod = rods.view(w);  // whose nodes may be others than those of the step
        int edge = 0;
        // by the records, not by `live`: in the last sub-step this wire may have had no part
        for (int k = 0; k < wire.capacity; ++k) {
            const int s = wire.begin + k;
            while (edge < rod.n - 2 && wire.s[k] > rod.material_s[edge + 1]) ++edge;
            for (int side = 0; side < 2; ++side) {
                const TouchState& touch = touches[2 * s + side];
                if (!(touch.flags & SEL_TOUCH_ACTIVE)) continue;
                ContactRow row;
                row.wire = w;
                row.edge = edge;
                row.triangle = static_cast<int>(wall_.original[touch.triangle]);
                row.point = wall_.centre + Vec3(touch.point[0], touch.point[1], touch.point[2]);
                row.normal = {touch.normal[0], touch.normal[1], touch.normal[2]};
                row.gap = touch.gap;
                row.normal_force = touch.normal_force;
                row.friction = {touch.friction[0], touch.friction[1], touch.friction[2]};
                row.rolling_moment = touch.moment;
                row.stuck = touch.flags & SEL_TOUCH_STUCK;
                row.length = samples_.models[s].length;
                rows.push_back(row);
            }
        }
    }
    std::stable_sort(rows.begin(), rows.end(), [](const ContactRow& a, const ContactRow& b) {
        return std::tie(a.wire, a.edge, a.triangle) < std::tie(b.wire, b.edge, b.triangle);
    });
    return rows;
}

std::string CapsuleContact::describe_law(const SampleModel& m) const
{
    const double k = m.hard_stiffness, um = 1e6 * m.hard_length;
    switch (params_.normal_law) {
        case SEL_NORMAL_AUGMENTED:
            return fmt::format("augmented, k from {:.3g} N/m^2 per metre, overlap to {:.3g} um", k, um);
        case SEL_NORMAL_CONSTRAINT:
            return fmt::format("constraint, to {:.3g} um of overlap and of stuck slip", um);
        case SEL_NORMAL_IMPULSE:
            return fmt::format("impulse, restitution {:.3g} to {:.3g} mm/s", m.restitution, 1e3 * m.hard_length);
        case SEL_NORMAL_BARRIER:
            return fmt::format("barrier, from a gap of {:.3g} um, kappa {:.3g} N/m^2 per metre", um, k);
        default:
            return "damped";
    }
}

namespace {

std::string describe_limit(const SampleModel& m)
{
    if (m.depth_exact <= 0) return fmt::format("{:.3g} mm, half the smaller of wall thickness and radius", 1e3 * m.depth_limit);
    return fmt::format("{:.3g} mm, half the radius; the stiffness as given to {:.3g} mm", 1e3 * m.depth_limit,
                       1e3 * m.depth_exact);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> CapsuleContact::describe() const
{
    const WireSamples& wire = samples_.wires[0];
    const SampleModel& m = samples_.models[wire.begin + wire.capacity - 1];
    return {{"contact samples", fmt::format("{} over the whole wire, {:.3g} mm apart", wire.capacity, 1e3 * wire.spacing)},
            {"contact kernels", context_.float32() ? "float32 (asked for)" : "float64"},
            {"normal law", describe_law(m)},
            {"line stiffness", fmt::format("{:.4g} N/m^{:.3g} per metre, exponent {}", m.stiffness, m.exponent + 1, m.exponent)},
            {"damping", fmt::format("beta {:.4g}, approach speed not below {:.3g} m/s", m.damping, m.speed_floor)},
            {"friction stiffness",
             fmt::format("{:.4g} N/m^2 per metre (2/3 of the normal one under the wire's own weight)", m.friction_stiffness)},
            {"overlap limit", describe_limit(m)}};
}

// Records that no contact of the last step wrote are leftovers: they have no say in what comes, nor may they in the bytes saved.
std::vector<TouchState> CapsuleContact::living_touches(int first_wire, int end_wire)
{
    const int first = 2 * samples_.wires[first_wire].begin;
    const int end = 2 * (samples_.wires[end_wire - 1].begin + samples_.wires[end_wire - 1].capacity);
    std::vector<TouchState> touches(end - first);
    context_.enter(device::Lane::Light);
    read_records(context_, device::Lane::Light, touches_t0_, touches.data(), touches.size(), first, narrow_);
    for (int w = first_wire; w < end_wire; ++w) {
        const WireSamples& wire = samples_.wires[w];
        for (int k = 2 * wire.begin - first; k < 2 * (wire.begin + wire.capacity) - first; ++k)
            if (touches[k].stamp + 1 != wire.stamp) std::memset(&touches[k], 0, sizeof touches[k]);
    }
    return touches;
}

void CapsuleContact::save(std::vector<std::uint8_t>& bytes)
{
    const std::vector<TouchState> touches = living_touches(0, static_cast<int>(samples_.wires.size()));
    put_bytes(bytes, touches.data(), touches.size());
    for (const WireSamples& wire : samples_.wires) put_bytes(bytes, &wire.stamp, 1);
    if (barrier_) barrier_->save(bytes);
}

void CapsuleContact::save_wire(std::vector<std::uint8_t>& bytes, int wire)
{
    const std::vector<TouchState> touches = living_touches(wire, wire + 1);
    put_bytes(bytes, touches.data(), touches.size());
    put_bytes(bytes, &samples_.wires[wire].stamp, 1);
    if (barrier_) barrier_->save(bytes, samples_.wires[wire]);
}

// Candidates are found anew: results do not depend on where they were found (nearest_touch reports nothing beyond the reach).
void CapsuleContact::restore(const std::uint8_t*& bytes, const std::uint8_t* end)
{
    std::vector<TouchState> touches(2 * samples_.models.size());
    take_bytes(bytes, end, touches.data(), touches.size());
    for (WireSamples& wire : samples_.wires) take_bytes(bytes, end, &wire.stamp, 1);
    if (barrier_) barrier_->restore(bytes, end);
    std::fill(listed_.begin(), listed_.end(), 0);
    near_.forget();
    context_.enter(device::Lane::Light);
    write_records(context_, device::Lane::Light, touches_t0_, touches, narrow_);
    context_.finish(device::Lane::Light);
}

}  // namespace seldinger
