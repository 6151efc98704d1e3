#pragma once
// `seldinger render`: pictures of a run from the files it wrote. To draw live state, use renderer.h.

#include <filesystem>
#include <vector>

namespace seldinger {

struct RenderOptions {
    int width = 1280, height = 720;  // [pixels]
    int first = -1, last = -1;       // frames A:B of wire.pvd, counted from 0, both included; -1: only the last frame
};

/// Draws the last frame into DIR/picture.png, or frames first ... last into DIR/frame_######.png. All frames of one call share
/// the camera and the force scale. Each file is complete when it appears.
/// @return the paths written
/// @throws Error BadFile (folder or files), BadScene (frames that are not there, an impossible size), NoDevice (no off-screen
/// OpenGL)
std::vector<std::filesystem::path> render_run(const std::filesystem::path& dir, const RenderOptions& options);

}  // namespace seldinger
