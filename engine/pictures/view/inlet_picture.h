#pragma once
// A picture of a vessel with its inlets and its branches, numbered: which one a scene enters by, which one a task is to reach.

#include "vessel/inlets.h"
#include "vessel/wall_mesh.h"

#include <filesystem>
#include <vector>

namespace seldinger {

struct PicturePoint {
    double x = 0, y = 0;  // [pixels]
};
struct PictureStroke {
    PicturePoint from, to;
};

/// Places of numbers in a picture, near where they are wanted: they cover neither a stroke nor each other while there is room.
[[nodiscard]] std::vector<PicturePoint> place_numbers(const std::vector<PicturePoint>& wanted,
                                                      const std::vector<PictureStroke>& strokes, double columns, double rows);

/// @param branches  ends of the branches, in the order of their numbers (vessel/branches.h); the trunk's own end is the last
/// @param chosen    of `inlets`, counted from 1: drawn in another colour
/// @throws Error NoDevice (no off-screen OpenGL), BadFile (no font; cannot be written)
void draw_inlets(const std::filesystem::path& file, const WallMesh& mesh, const std::vector<Inlet>& inlets,
                 const std::vector<Vec3>& branches, int chosen);

}  // namespace seldinger
