// Cache of the wall near each quadrature point, and its renewal.
#include "contact/near_wall.h"

#include "contact/device_records.h"
#include "contact/programs.h"
#include "core/parallel.h"

#include <algorithm>
#include <limits>

namespace seldinger {
namespace {

// quadrature points below which the caller's thread is faster than waking the pool (15 us)
constexpr std::size_t pool_find = 256;
constexpr uint first_slots = 24;

constexpr std::size_t bytes_of(const std::vector<std::uint32_t>& v) { return v.size() * sizeof(std::uint32_t); }

}  // namespace

NearWall::NearWall(device::Context& context, const QuadratureSet& points, const DeviceWall& wall, DeviceNodes& nodes,
                   const PointStates& states, const Lengths& lengths)
    : context_(context),
      quadrature_(points),
      wall_(wall),
      nodes_(nodes),
      states_(states),
      lengths_(lengths),
      slots_(first_slots),
      find_(context, programs::quadrature, "contact_find", device::Items::Branching),
      distance_(context, programs::quadrature, "contact_distance", device::Items::Branching)
{
    const std::size_t n = points.models.size();
    at_.resize(n);
    keep_.assign(n, 0);
    clear_.resize(n);
    counts_.resize(n);
    forget();
    stale_.resize(n);
    stale_count_.resize(points.wires.size());
    to_find_.reserve(n);
    found_.resize(n);
    distances_.resize(n);
    near_cells_ = device::Buffer(context, n * slots_ * sizeof(std::uint32_t));
    count_buffer_ = device::Buffer(context, n * sizeof(std::uint32_t));
    clearances_ = device::Buffer(context, n * device_size<Clearance>(context));
    list_ = device::Buffer(context, to_find_.data(), n * sizeof(std::uint32_t));
    found_buffer_ = device::Buffer(context, found_.data(), n * sizeof(std::uint32_t));
    distance_buffer_ = record_buffer(context, distances_, n);
}

void NearWall::warm_up(device::Queue at, const ContactParams& none)
{
    launch_find(at, 1, none);
    launch_distance(at, 0);
}

void NearWall::launch_find(device::Queue at, std::size_t items, const ContactParams& par)
{
    const auto launch = [&](const auto& params, const auto& margin) {
        find_.launch(at, items, params, margin, list_, states_.models(), states_.places(), nodes_, wall_, near_cells_,
                     count_buffer_, found_buffer_, clearances_);
    };
    if (context_.float32()) launch(narrow(par), static_cast<float>(lengths_.margin));
    else launch(par, lengths_.margin);
}

void NearWall::launch_distance(device::Queue at, std::size_t items)
{
    const auto launch = [&](const auto& most) {
        distance_.launch(at, std::max<std::size_t>(items, 1), static_cast<cl_uint>(items), most, list_, states_.places(), nodes_,
                         wall_, distance_buffer_);
    };
    if (context_.float32()) launch(static_cast<float>(lengths_.farthest));
    else launch(lengths_.farthest);
}

/// What a launch over to_find_ reads. @return where to launch it
device::Queue NearWall::upload_list()
{
    const device::Queue at = to_find_.size() < pool_find ? device::Queue::Inline : device::Queue::Pool;
    context_.enter(at);
    nodes_.upload(context_, at);
    context_.write(at, list_, to_find_.data(), bytes_of(to_find_));
    return at;
}

Vec3 NearWall::node(uint i) const
{
    const float* hi = &nodes_.hi[3 * i];
    const double* lo = &nodes_.lo[3 * i];
    return {hi[0] + lo[0], hi[1] + lo[1], hi[2] + lo[2]};
}

Vec3 NearWall::position(int point) const
{
    const QuadraturePlace& place = quadrature_.places[point];
    return (1 - place.bary) * node(place.edge) + place.bary * node(place.edge + 1);
}

bool NearWall::renew(const ContactParams& par)
{
    if (!mark(false)) return false;
    probe(8);
    probe(2);
    if (find_listed(par)) return true;
    // a denser mesh than the lists were made for: there is room now, and all are found again
    forget();
    (void)mark(true);
    (void)find_listed(par);
    return true;
}

void NearWall::forget()
{
    std::fill(at_.begin(), at_.end(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    std::fill(clear_.begin(), clear_.end(), 0.0);
    std::fill(counts_.begin(), counts_.end(), 0u);
}

void NearWall::forget(const WireQuadrature& wire)
{
    std::fill_n(at_.begin() + wire.begin, wire.capacity, Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    std::fill_n(clear_.begin() + wire.begin, wire.capacity, 0.0);
    std::fill_n(counts_.begin() + wire.begin, wire.capacity, 0u);
}

/// Quadrature points of which nothing is known any more. @return whether there are any
bool NearWall::mark(bool all)
{
    for_each_item(static_cast<int>(quadrature_.wires.size()), wire_grain, [&](int w) { mark_stale(w, all); });
    return std::any_of(stale_count_.begin(), stale_count_.end(), [](int count) { return count > 0; });
}

// Quadrature points that have left their sphere, and are in none of a neighbour's.
void NearWall::mark_stale(int w, bool all)
{
    const WireQuadrature& wire = quadrature_.wires[w];
    int count = 0;
    uint edge = SEL_NO_EDGE;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    for (int s = wire.begin; s < wire.begin + wire.live; ++s) {
        const QuadraturePlace& place = quadrature_.places[s];
        if (place.edge != edge) {
            edge = place.edge;
            from = node(edge);
            to = node(edge + 1);
        }
        const double moved2 = ((1 - place.bary) * from + place.bary * to - at_[s]).squaredNorm();
        if (all || keep_[s] < 0 || !(moved2 <= keep_[s] * keep_[s])) stale_[wire.begin + count++] = static_cast<std::uint32_t>(s);
    }
    stale_count_[w] = count;
    if (!all) take_spheres(w);
}

// Stale quadrature points within a neighbour's sphere take it for their own, from the tip on and back.
void NearWall::take_spheres(int w)
{
    const WireQuadrature& wire = quadrature_.wires[w];
    std::uint32_t* const stale = stale_.data() + wire.begin;
    const auto covered = [&](int s, int neighbour) {
        if (neighbour < wire.begin || neighbour >= wire.begin + wire.live || !(clear_[neighbour] > 0)) return false;
        const double keep = clear_[neighbour] - need(s);
        if (!((position(s) - at_[neighbour]).squaredNorm() <= keep * keep) || keep < 0) return false;
        at_[s] = at_[neighbour];
        clear_[s] = clear_[neighbour];
        keep_[s] = keep;
        counts_[s] = 0;
        return true;
    };
    for (const int way : {-1, +1}) {
        int left = 0;
        const int count = stale_count_[w];
        for (int i = 0; i < count; ++i) {  // against the way, so that a sphere is handed on
            const int at = way < 0 ? i : count - 1 - i;
            const int s = static_cast<int>(stale[at]);
            if (covered(s, s + way)) continue;
            stale[way < 0 ? left : count - 1 - left] = static_cast<std::uint32_t>(s);
            ++left;
        }
        if (way > 0) std::copy(stale + count - left, stale + count, stale);
        stale_count_[w] = left;
    }
}

// Distances from the wall of every `stride`-th stale quadrature point, but for those that had cells the last time.
void NearWall::probe(int stride)
{
    to_find_.clear();
    for (std::size_t w = 0; w < quadrature_.wires.size(); ++w)
        for (int i = 0; i < stale_count_[w]; ++i) {
            const std::uint32_t s = stale_[quadrature_.wires[w].begin + i];
            if (i % stride == stride / 2 && counts_[s] == 0) to_find_.push_back(s);
        }
    if (to_find_.empty()) return;
    const device::Queue at = upload_list();
    launch_distance(at, to_find_.size());
    read_records(context_, at, distance_buffer_, distances_.data(), to_find_.size(), 0, narrow_);
    for (std::size_t i = 0; i < to_find_.size(); ++i) {
        const int s = static_cast<int>(to_find_[i]);
        const double clear = distances_[i] - 1e-3 * quadrature_.models[s].radius;  // rounding is far below that
        if (clear < need(s) + lengths_.slack) continue;
        at_[s] = position(s);
        clear_[s] = clear;
        keep_[s] = clear - need(s);
        counts_[s] = 0;
    }
    for_each_item(static_cast<int>(quadrature_.wires.size()), wire_grain, [&](int w) { take_spheres(w); });
}

/// Lists of the quadrature points that are stale still. Slacks differ a little from quadrature point to quadrature point, so that
/// renewals spread over steps instead of coming all at once. @return false: one did not have room; now it has
bool NearWall::find_listed(const ContactParams& params)
{
    to_find_.clear();
    for (std::size_t w = 0; w < quadrature_.wires.size(); ++w) {
        const WireQuadrature& wire = quadrature_.wires[w];
        for (int i = 0; i < stale_count_[w]; ++i) {
            const std::uint32_t s = stale_[wire.begin + i];
            const int k = static_cast<int>(s) - wire.begin;
            to_find_.push_back(s);
            at_[s] = position(static_cast<int>(s));
            clear_[s] = 0;
            keep_[s] = lengths_.slack * (0.5 + 0.5 * ((k * 7) % 16) / 16.0);
        }
    }
    if (to_find_.empty()) return true;
    ContactParams par = params;
    par.slots = slots_;
    par.item_count = static_cast<uint>(to_find_.size());
    const device::Queue at = upload_list();
    launch_find(at, to_find_.size(), par);
    context_.read(at, found_buffer_, found_.data(), bytes_of(to_find_));
    std::uint32_t most = 0;
    for (std::size_t i = 0; i < to_find_.size(); ++i) most = std::max(most, counts_[to_find_[i]] = found_[i]);
    if (most <= slots_) return true;
    slots_ = (most + most / 2 + 7) / 8 * 8;
    near_cells_ = device::Buffer(context_, counts_.size() * slots_ * sizeof(std::uint32_t));
    return false;
}

}  // namespace seldinger
