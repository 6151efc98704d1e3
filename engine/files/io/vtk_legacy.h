#pragma once
// Reads legacy VTK polydata (.vtk).

#include "io/vtp_read.h"

namespace seldinger {

/// Legacy DATASET POLYDATA, ASCII or BINARY, cells in the old (count first) and the 5.1 (OFFSETS, CONNECTIVITY) form, FIELD data
/// and METADATA wherever a writer puts them.
/// @param name   of the file, for messages
/// @param parts  Geometry skips the numbers of FIELD data and stops at the attributes of points and cells
/// @throws Error BadFile
[[nodiscard]] PolyData parse_legacy_vtk(const std::string& bytes, const std::string& name, PolyParts parts = PolyParts::Geometry);

}  // namespace seldinger
