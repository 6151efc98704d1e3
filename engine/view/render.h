#pragma once
// `seldinger render`: pictures of a run from the files it wrote. To draw live state, use renderer.h.

#include "view/renderer.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace seldinger {

struct RenderOptions {
    int width = 1280, height = 720;    // [pixels]
    int first = -1, last = -1;         // frames A:B of wire.pvd, counted from 0, both included; -1: only the last frame
    std::optional<WallQuantity> wall;  // of a wall that yields: drawn where it has moved to, coloured by this
    double wall_max = 0;               // at the top of its scale [m] or [Pa]; 0: a round number above the run's largest
};

/// Draws the last frame into DIR/picture.png, or frames first ... last into DIR/frame_######.png. All frames of one call share
/// the camera and the force scale; the wall's scale is that of the whole run, so that a frame drawn alone has it too. Each file
/// is complete when it appears.
/// @return the paths written
/// @throws Error BadFile (folder or files; a wall to be coloured that did not yield), BadScene (frames that are not there, an
/// impossible size), NoDevice (no off-screen OpenGL)
std::vector<std::filesystem::path> render_run(const std::filesystem::path& dir, const RenderOptions& options);

}  // namespace seldinger
