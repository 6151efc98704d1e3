// Vertices of the vessel's mesh on the wall's surface.

#include "shell/wall_shape.h"

namespace seldinger {

WallShape::WallShape(const ElasticWall& wall, const WallMesh& mesh)
{
    begin_.reserve(mesh.vertices.size() + 1);
    begin_.push_back(0);
    LoopStencil stencil;
    for (const Vec3& vertex : mesh.vertices) {
        LoopFoot foot;
        wall.surface().closest(vertex, foot);
        wall.surface().basis(foot.triangle, foot.u, foot.v, stencil);
        for (int k = 0; k < stencil.size; ++k) {
            control_.push_back(stencil.vertex[k]);
            weight_.push_back(static_cast<float>(stencil.n[k]));
        }
        begin_.push_back(static_cast<std::uint32_t>(control_.size()));
    }
}

std::vector<Vec3> WallShape::displacement(std::span<const double> w) const
{
    std::vector<Vec3> list(begin_.size() - 1, Vec3::Zero());
    for (std::size_t v = 0; v < list.size(); ++v)
        for (std::uint32_t k = begin_[v]; k < begin_[v + 1]; ++k)
            list[v] += double(weight_[k]) * Vec3(&w[3 * static_cast<std::size_t>(control_[k])]);
    return list;
}

std::vector<double> WallShape::spread(std::span<const double> at_control) const
{
    std::vector<double> list(begin_.size() - 1, 0.0);
    for (std::size_t v = 0; v < list.size(); ++v)
        for (std::uint32_t k = begin_[v]; k < begin_[v + 1]; ++k)
            list[v] += double(weight_[k]) * at_control[static_cast<std::size_t>(control_[k])];
    return list;
}

}  // namespace seldinger
