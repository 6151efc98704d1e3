// The elastic wall behind the engine's door.

#include "contact/wall_body.h"
#include "coupling/elastic_contact.h"
#include "shell/elastic_wall.h"
#include "shell/wall_compliance.h"
#include "shell/wall_shape.h"
#include "surface/control_mesh.h"
#include "wall/wall_model.h"

#include <fmt/format.h>

namespace seldinger {
namespace {

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
