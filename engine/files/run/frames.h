#pragma once
// One moment of a run as VTK files: the wire, its contacts, and the wall.

#include "io/vtp_write.h"
#include "output.h"

#include <string>

namespace seldinger {

struct Scene;

/// "wire_000120.vtp"
[[nodiscard]] std::string frame_name(const std::string& stem, std::int64_t step);

/// What files of an instrument are called after: its name; "wire" of the one of [wire].
[[nodiscard]] std::string series_of(const Scene& scene, int instrument);

/// One polyline, tip first. Point data: radius [m], material_s [m], curvature [1/m] (|kb| per Voronoi length, 0 at the ends),
/// spin [rad], director (unit), contact_force [N], velocity [m/s].
/// @param wire  with Output::Shape
[[nodiscard]] std::string wire_vtp(const WireOutput& wire);

/// Points on the wall. Point data: normal_n [N], normal (unit, into the lumen), gap [m], friction [N], stuck (0/1),
/// body_a and body_b (indices of instruments, -1: the wall).
[[nodiscard]] std::string contacts_vtp(std::span<const ContactRow> rows);

/// The wall in metres, triangles facing the lumen.
[[nodiscard]] std::string wall_vtp(const WallMesh& mesh);

/// The same where it has moved to. Point data: displacement [m], stress (von Mises, the larger of both surfaces) [Pa].
/// @param wall  with Output::WallShape
[[nodiscard]] std::string moved_wall_vtp(const WallMesh& mesh, const WallOutput& wall);

}  // namespace seldinger
