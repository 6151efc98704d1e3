#pragma once
// Reads centrelines of other programs (VMTK, 3D Slicer, SimVascular, ParaView) into one tree per connected piece.

#include "vessel/centreline.h"

#include <filesystem>
#include <string>

namespace seldinger {

/// Polylines of a .vtp or legacy .vtk with a radius at each point. The radius is the point array MaximumInscribedSphereRadius
/// of VMTK, else Radius. Else it is the only array with "radius" in its name, or half of one called Diameter. Case does not
/// matter.
///
/// Lines are joined into a graph, so that neither the cuts of the lines nor their directions matter. Points at the same
/// coordinates are one. An end within the lumen of another piece is joined to that piece. The root is the first end (point of
/// one neighbour) of the file; a ring is cut opposite to the root.
/// @throws Error BadFile
[[nodiscard]] Centreline read_centreline(const std::filesystem::path& path, const std::string& units);
/// Same, from the bytes of a file. @param name  of it, for messages
[[nodiscard]] Centreline parse_centreline(const std::string& bytes, const std::string& name, const std::string& units);

}  // namespace seldinger
