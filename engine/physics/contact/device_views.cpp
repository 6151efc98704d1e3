// Wall and nodes of the wires for kernels: made, filled, uploaded.
#include "contact/device_views.h"

#include "contact/device_records.h"

#include <algorithm>

namespace seldinger {
namespace {

// bits 0-2: edge k lies on an opening; bits 3-5: vertex k does (also where this triangle has no edge on it)
std::vector<std::uint32_t> boundary_bits(const WallTree& tree, const WallMesh& mesh)
{
    std::vector<std::uint8_t> at_boundary(mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < tree.triangle_count(); ++t)
        for (int e = 0; e < 3; ++e)
            if (tree.edge_bits[t] >> e & 1) {
                const auto& triangle = mesh.triangles[tree.original[t]];
                at_boundary[triangle[e]] = at_boundary[triangle[(e + 1) % 3]] = 1;
            }
    std::vector<std::uint32_t> bits(tree.triangle_count());
    for (std::size_t t = 0; t < bits.size(); ++t) {
        bits[t] = tree.edge_bits[t] & 7u;
        for (int v = 0; v < 3; ++v)
            if (at_boundary[mesh.triangles[tree.original[t]][v]]) bits[t] |= 8u << v;
    }
    return bits;
}

}  // namespace

DeviceWall::DeviceWall(device::Context& context, const WallTree& tree, const WallMesh& mesh)
    : nodes(context, tree.nodes.size() * sizeof(TreeNode)),
      vertices(context, tree.vertices.size() * sizeof(float)),
      boundary(context, tree.triangle_count() * sizeof(std::uint32_t)),
      centre(tree.centre),
      original(tree.original)
{
    const std::vector<std::uint32_t> bits = boundary_bits(tree, mesh);
    const device::Queue queue = device::Queue::Inline;
    context.write(queue, nodes, tree.nodes.data(), tree.nodes.size() * sizeof(TreeNode));
    context.write(queue, vertices, tree.vertices.data(), tree.vertices.size() * sizeof(float));
    context.write(queue, boundary, bits.data(), bits.size() * sizeof(std::uint32_t));
    context.finish(queue);
}

DeviceNodes::DeviceNodes(device::Context& context, int total_capacity)
    : hi(3 * (total_capacity + 1), 0.0f),  // one past the end: the last node has no edge, but its edge may be read
      lo(3 * (total_capacity + 1), 0.0),
      theta(total_capacity + 1, 0.0),
      hi_buffer(context, hi.data(), hi.size() * sizeof(float)),
      lo_buffer(record_buffer(context, lo, lo.size())),
      theta_buffer(record_buffer(context, theta, theta.size()))
{
}

void DeviceNodes::set(int node, double x, double y, double z, double angle, const Vec3& centre)
{
    const double p[3] = {x - centre.x(), y - centre.y(), z - centre.z()};
    for (int k = 0; k < 3; ++k) {
        hi[3 * node + k] = static_cast<float>(p[k]);
        lo[3 * node + k] = p[k] - hi[3 * node + k];
    }
    theta[node] = angle;
}

void DeviceNodes::upload(device::Context& context, device::Queue queue)
{
    context.write(queue, hi_buffer, hi.data(), hi.size() * sizeof(float));
    write_records(context, queue, lo_buffer, lo, narrow_lo);
    write_records(context, queue, theta_buffer, theta, narrow_theta);
}

}  // namespace seldinger
