// Lists of the quadrature points to evaluate: made, picked from, uploaded.
#include "contact/active_set.h"

#include "contact/device_records.h"

#include <algorithm>

namespace seldinger {
namespace {

constexpr std::size_t pool_evaluate = 2048;

template <class T>
std::size_t bytes_of(const std::vector<T>& v)
{
    return v.size() * sizeof(T);
}

}  // namespace

device::Queue queue_for(std::size_t points) { return points < pool_evaluate ? device::Queue::Inline : device::Queue::Pool; }

// The vectors never grow beyond that: the buffers are their memory.
ActiveList::ActiveList(device::Context& context, std::size_t point_capacity, std::size_t edge_capacity)
{
    points.reserve(point_capacity);
    edge_first.reserve(edge_capacity + 1);
    point_buffer = device::Buffer(context, points.data(), point_capacity * sizeof(std::uint32_t));
    first_buffer = device::Buffer(context, edge_first.data(), (edge_capacity + 1) * sizeof(std::uint32_t));
}

void ActiveList::upload(device::Context& context, device::Queue queue) const
{
    context.write(queue, point_buffer, points.data(), bytes_of(points));
    context.write(queue, first_buffer, edge_first.data(), bytes_of(edge_first));
}

ActiveSet::ActiveSet(device::Context& context, const QuadratureSet& quadrature, EdgeSums& sums, std::size_t edges)
    : context_(context),
      quadrature_(quadrature),
      sums_(sums),
      all_(context, quadrature.models.size(), edges),
      some_(context, quadrature.models.size(), edges),
      listed_(quadrature.models.size(), 0),
      last_edges_(edges)
{
    sums_.edge_node.reserve(edges);
    sums_.edges.resize(edges);
    sums_.wire_edges.assign(quadrature.wires.size() + 1, 0);
    last_wire_edges_ = sums_.wire_edges;
    const std::size_t bytes = edges * device_size<EdgeForce>(context);
    edge_buffer_ = device::Buffer(context, sums_.edges.data(), bytes);
    last_edge_buffer_ = device::Buffer(context, last_edges_.data(), bytes);
}

void ActiveSet::forget(const WireQuadrature& wire) { std::fill_n(listed_.begin() + wire.begin, wire.capacity, 0); }

void ActiveSet::list_wire(std::size_t w, const NearWall& near)
{
    const WireQuadrature& wire = quadrature_.wires[w];
    for (int k = 0; k < wire.live; ++k) {
        const std::uint32_t s = static_cast<std::uint32_t>(wire.begin + k);
        // once evaluated in this step, always: a record that an earlier trial wrote would pass for the last one's
        if (!near.has_near_cells(static_cast<int>(s)) && listed_[s] != wire.epoch) continue;
        listed_[s] = wire.epoch;
        const std::uint32_t edge = quadrature_.places[s].edge;
        if (sums_.wire_edges[w] == static_cast<int>(sums_.edge_node.size()) || sums_.edge_node.back() != edge) {
            sums_.edge_node.push_back(edge);
            all_.edge_first.push_back(static_cast<std::uint32_t>(all_.points.size()));
        }
        all_.points.push_back(s);
    }
}

// Wires that are not evaluated again in this step keep their sums; their edges are the ones they had.
void ActiveSet::keep_sums(std::span<const std::uint8_t> active)
{
    for (std::size_t w = 0; w < quadrature_.wires.size() && !stale_; ++w) {
        if (!active.empty() && active[w]) continue;
        const int first = sums_.wire_edges[w], count = sums_.wire_edges[w + 1] - first;
        if (count == last_wire_edges_[w + 1] - last_wire_edges_[w])
            std::copy_n(last_edges_.begin() + last_wire_edges_[w], count, sums_.edges.begin() + first);
    }
}

void ActiveSet::rebuild(const NearWall& near, std::span<const std::uint8_t> active)
{
    all_.points.clear();
    all_.edge_first.clear();
    std::swap(sums_.wire_edges, last_wire_edges_);
    sums_.edges.swap(last_edges_);
    std::swap(edge_buffer_, last_edge_buffer_);
    sums_.edge_node.clear();
    for (std::size_t w = 0; w < quadrature_.wires.size(); ++w) {
        sums_.wire_edges[w] = static_cast<int>(sums_.edge_node.size());
        list_wire(w, near);
    }
    sums_.wire_edges.back() = static_cast<int>(sums_.edge_node.size());
    all_.edge_first.push_back(static_cast<std::uint32_t>(all_.points.size()));
    keep_sums(active);
    const device::Queue queue = queue_for(all_.points.size());
    context_.enter(queue);
    all_.upload(context_, queue);
    context_.finish(queue);
    stale_ = false;
}

const ActiveList* ActiveSet::pick(std::span<const std::uint8_t> active)
{
    const auto left_out = [&](std::size_t w) { return !active[w] && sums_.wire_edges[w + 1] > sums_.wire_edges[w]; };
    std::size_t w = 0;
    while (w < quadrature_.wires.size() && !left_out(w)) ++w;
    if (w == quadrature_.wires.size()) return nullptr;
    some_.points.clear();
    some_.edge_first.clear();
    for (w = 0; w < quadrature_.wires.size(); ++w) {
        if (!active[w]) continue;
        for (int e = sums_.wire_edges[w]; e < sums_.wire_edges[w + 1]; ++e) {
            some_.edge_first.push_back(static_cast<std::uint32_t>(some_.points.size()));
            some_.points.insert(some_.points.end(), all_.points.begin() + all_.edge_first[e],
                                all_.points.begin() + all_.edge_first[e + 1]);
        }
    }
    some_.edge_first.push_back(static_cast<std::uint32_t>(some_.points.size()));
    return &some_;
}

void ActiveSet::spread(std::span<const std::uint8_t> active)
{
    auto from = last_edges_.begin();
    for (std::size_t w = 0; w < quadrature_.wires.size(); ++w) {
        if (!active[w]) continue;
        const int first = sums_.wire_edges[w], count = sums_.wire_edges[w + 1] - first;
        std::copy_n(from, count, sums_.edges.begin() + first);
        from += count;
    }
}

}  // namespace seldinger
