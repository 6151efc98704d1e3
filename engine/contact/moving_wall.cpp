// Walls that move: refit and upload.

#include "contact/moving_wall.h"

#include "contact/device_records.h"
#include "core/check.h"

namespace seldinger {

MovingWall::MovingWall(device::Context& context, DeviceWall& wall, const WallTree& tree, const WallMesh& mesh)
    : context_(context), wall_(wall), mesh_(mesh), moved_(mesh), systems_(wall.path.size(), System{{}, tree})
{
}

void MovingWall::move(int system, std::span<const Vec3> displacement)
{
    System& own = systems_[system];
    own.state.move_to(displacement, mesh_.vertices.size());
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) moved_.vertices[v] = mesh_.vertices[v] + displacement[v];
    refit_wall_tree(own.tree, moved_);
    wall_.path[system] = own.state.moved;
    const device::Queue queue = device::Queue::Inline;
    const std::size_t tree_bytes = own.tree.nodes.size() * sizeof(TreeNode);
    const std::size_t vertex_bytes = own.tree.vertices.size() * sizeof(float);
    context_.enter(queue);
    context_.write(queue, wall_.nodes, own.tree.nodes.data(), tree_bytes, system * tree_bytes);
    context_.write(queue, wall_.vertices, own.tree.vertices.data(), vertex_bytes, system * vertex_bytes);
    write_records(context_, queue, wall_.moved, wall_.path, narrow_);
    context_.finish(queue);
}

void MovingWall::accept(int system)
{
    System& own = systems_[system];
    if (own.state.rigid() || !own.state.accept()) return;
    const device::Queue queue = device::Queue::Inline;
    const std::size_t bytes = own.tree.vertices.size() * sizeof(float);
    context_.enter(queue);
    context_.write(queue, wall_.vertices_t0, own.tree.vertices.data(), bytes, system * bytes);
    context_.finish(queue);
}

}  // namespace seldinger
