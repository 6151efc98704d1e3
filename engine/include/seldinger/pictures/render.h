#pragma once
// `seldinger render`: pictures of a run from the files it wrote. To draw a world of your own, record it (record/recording.h).
//
//     seldinger::render_run("out", {});                      // out/picture.png

#include "view/frame_choice.h"
#include "view/view_from.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace seldinger {

enum class Ground { Shaded, White, Transparent };

struct RenderOptions : FrameChoice {
    ViewFrom from = ViewFrom::Auto;
    CameraMotion motion;
    std::optional<PatientAxes> patient;  // none: as the run's scene says, [carm] head and back
    Ground ground = Ground::Shaded;
    bool legend = true;
    double load_max = 0;  // at the top of the scale of contact force per length, which colours the wire [N/m]; 0: as force_max
    int width = 1280, height = 720;    // [pixels]
    std::optional<WallQuantity> wall;  // of an elastic wall: drawn where it has moved to, coloured by this
    double wall_max = 0;               // at the top of its scale [m] or [Pa]; 0: a round number above the run's largest
    double force_max = 0;              // at the top of the scale of contact force [N]; > 0: contacts are coloured, not the wire
};

/// How the patient of a run lies: as its scene says, else as by default.
[[nodiscard]] PatientAxes patient_of(const std::filesystem::path& dir);

/// Whether scale and legend have room on a picture of this size: letters of six pixels at least.
[[nodiscard]] bool legend_fits(int width, int height);

/// Draws the last frame into DIR/picture.png, or frames first ... last into DIR/frame_######.png, or where
/// options.output says; into a film alone when that is all that is asked for. Camera and scales are those of
/// the whole run, so that a frame is the same bytes alone, in a series and in any part of one. Each file is complete when it
/// appears.
/// @throws Error BadFile (folder or files; a wall to be coloured that is rigid), BadScene (frames that are not there, an
/// impossible size), NoDevice (no off-screen OpenGL)
PictureFiles render_run(const std::filesystem::path& dir, const RenderOptions& options, const FrameProgress& progress = {});

}  // namespace seldinger
