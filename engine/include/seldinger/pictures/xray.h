#pragma once
// `seldinger render --view fluoro`: X-ray pictures of a run from the files that it wrote.
//
//     seldinger::XrayOptions view;
//     view.c_arm = "LAO 30, CRA 15";
//     seldinger::render_xray("out", {view});                 // out/fluoro.png

#include "view/frame_choice.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

/// One view. Absent: as the run's scene says, else by default (docs/fluoroscopy.md). Default names: DIR/fluoro.png,
/// DIR/fluoro_######.png.
struct XrayOptions : FrameChoice {
    int width = 1024, height = 1024;     // [pixels]
    std::vector<std::string> set;        // keys of [carm] and [contrast], as of --set
    std::optional<std::string> c_arm;    // position of the detector: "LAO 30, CRA 15"
    std::optional<double> sid, sod;      // source to detector, to isocentre [m]
    std::optional<double> field;         // width of the detector [m]
    std::optional<double> kvp, kev;      // tube voltage [kV], or one energy [keV]
    std::optional<double> photons;       // per pixel of the open beam
    std::optional<double> blur;          // on the detector, standard deviation [m]
    std::optional<std::string> body;     // "ellipsoid" or "none"
    std::optional<std::int64_t> seed;    // of the noise
    std::optional<std::filesystem::path> mask;  // folder of a run that is subtracted without contrast
    std::filesystem::path raw, dicom;    // NAME.npy of line integrals, NAME.dcm; empty: none
    bool noise = true, contrast = true, logarithmic = false;
};

/// Draws the chosen frames and writes the chosen files, view after view: with several views, NAME_v1, NAME_v2 ... in place of
/// NAME. Each picture depends on its own files, its view's options and the seed alone. With a preview only that is written.
/// @param views  at least one; frames and files are those of the first
/// @throws Error BadFile, BadScene
PictureFiles render_xray(const std::filesystem::path& dir, const std::vector<XrayOptions>& views,
                         const FrameProgress& progress = {});

}  // namespace seldinger
