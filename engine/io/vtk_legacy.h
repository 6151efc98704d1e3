#pragma once
// Reads legacy VTK polydata (.vtk).

#include "io/vtp_read.h"

#include <filesystem>

namespace seldinger {

/// Legacy DATASET POLYDATA, ASCII or BINARY, cells in the old (count first) and the 5.1 (OFFSETS, CONNECTIVITY) form.
/// Attributes after the cells are not read. @throws Error BadFile
[[nodiscard]] PolyData read_legacy_vtk(const std::filesystem::path& path);

}  // namespace seldinger
