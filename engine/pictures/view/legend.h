#pragma once
// Text around the picture: readings, scale bars, the force scale; and the place of each part.

#include "view/camera.h"
#include "view/canvas.h"
#include "view/renderer.h"

namespace seldinger {

/// The parts of the sheet [pixels]. A wide sheet has its panel on the right, a tall one at the bottom.
struct Layout {
    Viewport main, panel, inset;  // inset lies in the panel
    double unit = 1;              // 1 at 1280 x 720; every length on the sheet is a multiple of it
    bool side_panel = true;
    bool panel_dropped = false;  // a thumbnail: letters could not be read
};

[[nodiscard]] Layout lay_out_sheet(int width, int height, const Look& look);

/// The smallest of 1, 2, 5 x 10^k that is not below `value` (> 0).
[[nodiscard]] double round_up_125(double value);

/// The same with more steps, for the top of a colour scale: half of it must be round too, and little of it may lie idle.
[[nodiscard]] double round_force_up(double value);

/// What the legend has to know about one picture.
struct LegendFacts {
    const WireFrame* frame = nullptr;
    Layout layout;
    Camera main_camera, inset_camera;
    bool inset = false;
    double force_scale = 0;  // [N] at the top of the scale; 0: no scale
    double load_scale = 0;   // [N/m] at the top of the scale that colours the wire; 0: it has its own colour
    bool ruler = true;       // scale bar and tip mark
    std::vector<Vec3> cube;  // the patient's left, back and head in the scene; empty: no cube
    const TargetMark* target = nullptr;
    WallScale wall_scale;    // top 0: the wall is not coloured
    double least_pixels = 3;
    bool widened = false;  // some wire was drawn wider than it is
};

/// sRGB of wire k: the wire's own, or one of several.
[[nodiscard]] std::uint32_t instrument_colour(const WireFrame& frame, std::size_t k);

void draw_legend(Canvas& canvas, const Font& font, const LegendFacts& facts);

}  // namespace seldinger
