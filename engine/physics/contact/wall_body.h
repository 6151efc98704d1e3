#pragma once
// A wall that deforms, as the engine knows it. The library that has one is optional (engine/elastic, SELDINGER_ELASTIC): it
// defines the functions below. Without it rigid_only.cpp does, and refuses.

#include "contact/wall_contact.h"
#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"
#include "wall/wall_readings.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

class ContactMethod;
struct WallModel;

/// The vessel's mesh as such a wall carries it along.
class CarriedMesh {
public:
    virtual ~CarriedMesh() = default;
    /// Displacement of the mesh's vertices. @param w  WallContact::displacement [m]
    [[nodiscard]] virtual std::vector<Vec3> displacement(std::span<const double> w) const = 0;
    /// Numbers at control vertices (WallContact::readings), at the mesh's vertices.
    [[nodiscard]] virtual std::vector<double> spread(std::span<const double> at_control) const = 0;
};

/// Constant part of a wall; all systems of a world and its twins share it.
class WallBody {
public:
    virtual ~WallBody() = default;
    [[nodiscard]] virtual WallMechanics mechanics() const = 0;
    /// Its mesh in words, as the summary's row about the model ends.
    [[nodiscard]] virtual std::string describe() const = 0;
    [[nodiscard]] virtual std::unique_ptr<CarriedMesh> carry(const WallMesh& mesh) const = 0;
    /// Contact with it, in front of contact with the wall where it has not moved. @param unmoved  what that was made with; as
    /// `rods`, carried back   @param systems  [wires]   All four outlive it.
    [[nodiscard]] virtual std::unique_ptr<WallContact> contact(ContactMethod& undeformed, RodArrays& rods, RodArrays& unmoved,
                                                               std::span<const int> systems) const = 0;
};

/// @throws Error BadFile: no shell can be made of the mesh; BadScene: the wall could fly away, or is too fine for the memory, or
/// this program has no wall that deforms
[[nodiscard]] std::shared_ptr<const WallBody> make_wall_body(const WallModel& wall);

/// Makes its control mesh alone, for what is refused of it. @throws Error  as make_wall_body
void check_wall_body(const WallModel& wall);

/// Vertices, mean edge and decay length of the control mesh that a world would make, by the scene's edge or the one that is
/// chosen. What only a made wall has is 0.
[[nodiscard]] WallMechanics expected_mechanics(const VesselSpec& spec, const WallMesh& mesh, const Centreline& centreline);

/// The edge of its control mesh that is taken where the scene gives none, and how many vertices that makes.
struct DefaultEdge {
    double edge = 0, vertices = 0;
};
[[nodiscard]] DefaultEdge default_wall_edge(const WallModel& wall);

}  // namespace seldinger
