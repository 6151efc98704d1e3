#pragma once
// A picture of a vessel with its ways in, numbered: which one a scene enters by.

#include "vessel/inlets.h"
#include "vessel/wall_mesh.h"

#include <filesystem>
#include <vector>

namespace seldinger {

/// @param chosen  of `inlets`, counted from 1: drawn in another colour
/// @throws Error NoDevice (no off-screen OpenGL), BadFile (no font; cannot be written)
void draw_ways_in(const std::filesystem::path& file, const WallMesh& mesh, const std::vector<Inlet>& inlets, int chosen);

}  // namespace seldinger
