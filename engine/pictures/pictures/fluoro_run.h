#pragma once
// `seldinger render --view fluoro`: X-ray pictures of a run from the files that it wrote.

#include "view/frame_range.h"
#include "view/renderer.h"
#include "xray/bolus.h"
#include "xray/c_arm.h"
#include "xray/device_paths.h"
#include "xray/materials.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

/// What an instrument is made of, from the tip on.
struct InstrumentMatter {
    std::string name;  // as in the run's files; "" of the only one
    double lumen = 0;  // inner radius [m]
    Material shaft;
    struct Stretch {
        double from = 0, to = 0;  // from the tip [m]
        Material material;
    };
    std::vector<Stretch> stretches;  // a later one wins
};

/// All materials of the instruments, numbered as by device_of().
[[nodiscard]] std::vector<Material> materials_of(const std::vector<InstrumentMatter>& instruments);

/// One of them, by its name, as it lies; of another name, solid and of the first material.
[[nodiscard]] Device device_of(const WireLine& wire, const std::vector<InstrumentMatter>& instruments);

struct AngleKey {
    double t = 0, primary = 0, secondary = 0;  // [s], [rad]
};

/// Default names of pictures: DIR/fluoro.png, DIR/fluoro_######.png.
struct FluoroOptions : FrameChoice {
    CArm arm;                       // isocentre: see auto_isocentre
    bool auto_isocentre = true;     // the middle of the vessel's box, or of the instruments'
    std::vector<AngleKey> turning;  // empty: the arm stands still
    std::vector<InstrumentMatter> instruments;
    Vec3 body = Vec3::Zero();    // half axes [m]; zero: no body
    std::filesystem::path bone;  // empty: none
    std::string bone_units = "mm";
    struct Injection {
        BolusSpec bolus;
        bool at_auto = true, inflow_auto = true;  // the centreline's root; where it is injected
    };
    std::optional<Injection> contrast;

    double kvp = 75, kev = 0;  // kev > 0: one energy instead
    double photons = 1e5, blur = 2e-4;
    std::uint64_t seed = 0;
    bool noise = true, logarithmic = false;
    std::optional<std::filesystem::path>
        mask;  // run that is subtracted, without contrast, frame by frame (its last from there on)

    std::filesystem::path raw, dicom;  // empty: none
    std::uint64_t noise_stream = 0;    // of the view among several, so that each has noise of its own
};

/// The arm's angles at a time. No keys: as they are
void turn_arm(CArm& arm, const std::vector<AngleKey>& keys, double time);

/// The bolus, in the vessel with this centreline.
[[nodiscard]] Bolus make_bolus(const Centreline& centreline, const FluoroOptions::Injection& injection);

/// The bones' mesh, repaired. @throws Error BadFile
[[nodiscard]] WallMesh load_bone(const FluoroOptions& options);

/// Draws the chosen frames and writes the chosen files, view after view: with several views, NAME_v1, NAME_v2 ... in place of
/// NAME. Each picture depends on its own files, its view's options and the seed alone. With a preview only that is written.
/// @param views  at least one; frames and files are those of the first
/// @throws Error BadFile, BadScene
PictureFiles render_fluoro(const std::filesystem::path& dir, const std::vector<FluoroOptions>& views,
                           const FrameProgress& progress = {});

}  // namespace seldinger
