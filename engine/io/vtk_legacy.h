#pragma once
// Reads legacy VTK polydata (.vtk).

#include "io/vtp_read.h"

namespace seldinger {

/// Legacy DATASET POLYDATA, ASCII or BINARY, cells in the old (count first) and the 5.1 (OFFSETS, CONNECTIVITY) form.
/// Attributes after the cells are not read. @param name  of the file, for messages     @throws Error BadFile
[[nodiscard]] PolyData parse_legacy_vtk(const std::string& bytes, const std::string& name);

}  // namespace seldinger
