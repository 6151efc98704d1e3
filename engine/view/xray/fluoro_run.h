#pragma once
// `seldinger render --view fluoro`: X-ray pictures of a run from the files that it wrote.

#include "view/run_folder.h"
#include "view/xray/bolus.h"
#include "view/xray/c_arm.h"
#include "view/xray/materials.h"

#include <cstdint>
#include <filesystem>
#include <functional>
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

struct AngleKey {
    double t = 0, primary = 0, secondary = 0;  // [s], [rad]
};

struct FluoroOptions {
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

    int first = -1, last = -1;                       // frames A:B counted from 0; -1: the last one
    std::filesystem::path output, raw, film, dicom;  // empty: none, but output: DIR/fluoro.png or DIR/fluoro_######.png
    bool resume = false;                             // pictures that are there already stay
    double rate = 0;                                 // of the film [1/s]; 0: as fast as it happened
};

/// Draws the frames asked for and writes what was asked for. Each frame depends on its own files, the options and the seed alone.
/// @param progress  may be null: frames done, of how many, seconds since the start
/// @return the paths written
/// @throws Error BadFile, BadScene
std::vector<std::filesystem::path> render_fluoro(const std::filesystem::path& dir, const FluoroOptions& options,
                                                 const std::function<void(std::size_t, std::size_t, double)>& progress = {});

}  // namespace seldinger
