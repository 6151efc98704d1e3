// The elastic wall behind the engine's door.
#include "contact/wall_body.h"
#include "coupling/elastic_contact.h"
#include "shell/elastic_wall.h"
#include "shell/wall_compliance.h"
#include "surface/control_mesh.h"
#include "wall/wall_model.h"

#include <fmt/format.h>

namespace seldinger {
namespace {

/// The vessel's mesh as an elastic wall carries it along: vertices follow the nearest point of the wall's smooth surface.
class WallShape final : public CarriedMesh {
public:
    /// Finds every vertex's place on the surface: some microseconds each.
    WallShape(const ElasticWall& wall, const WallMesh& mesh)
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

    [[nodiscard]] std::vector<Vec3> displacement(std::span<const double> w) const override
    {
        return sums(Vec3(Vec3::Zero()), [&](std::size_t k) { return Vec3(&w[3 * k]); });
    }
    [[nodiscard]] std::vector<double> spread(std::span<const double> at_control) const override
    {
        return sums(0.0, [&](std::size_t k) { return at_control[k]; });
    }

private:
    /// At each vertex of the mesh, of values of the control vertices.
    template <class T, class At>
    std::vector<T> sums(const T& zero, At at) const
    {
        std::vector<T> list(begin_.size() - 1, zero);
        for (std::size_t v = 0; v < list.size(); ++v)
            for (std::uint32_t k = begin_[v]; k < begin_[v + 1]; ++k)
                list[v] += double(weight_[k]) * at(static_cast<std::size_t>(control_[k]));
        return list;
    }

    std::vector<std::uint32_t> begin_;   // [mesh vertices + 1] in the two below
    std::vector<std::int32_t> control_;  // control vertices
    std::vector<float> weight_;
};

class ElasticBody final : public WallBody {
public:
    explicit ElasticBody(const WallModel& wall) : wall_(wall) {}

    [[nodiscard]] WallMechanics mechanics() const override { return wall_.mechanics(); }
    [[nodiscard]] std::string describe() const override
    {
        return fmt::format("{} control vertices, edge {}", wall_.compliance().vertex_count(), wall_.edge_reason());
    }
    [[nodiscard]] std::unique_ptr<CarriedMesh> carry(const WallMesh& mesh) const override
    {
        return std::make_unique<WallShape>(wall_, mesh);
    }
    [[nodiscard]] std::unique_ptr<WallContact> contact(ContactMethod& undeformed, RodArrays& rods, RodArrays& unmoved,
                                                       std::span<const int> systems) const override
    {
        return std::make_unique<ElasticContact>(wall_, undeformed, rods, unmoved, systems);
    }

private:
    ElasticWall wall_;
};

}  // namespace

std::shared_ptr<const WallBody> make_wall_body(const WallModel& wall) { return std::make_shared<ElasticBody>(wall); }

DefaultEdge default_wall_edge(const WallModel& wall)
{
    const WallEdge chosen = choose_wall_edge(wall);
    return {chosen.edge, chosen.vertices};
}

}  // namespace seldinger
