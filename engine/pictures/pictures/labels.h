#pragma once
// Ground truth of a picture: the instrument of each pixel, the places of centrelines, tips and contacts in the scene and in the
// picture, and their forces. X-rays and ordinary views share it: both are pinhole pictures, and the mask comes from the
// same tapered cylinders that the X-ray's path lengths come from. Pixel centres are integers, columns right, rows down (c_arm.h).

#include "view/renderer.h"
#include "view/solids.h"
#include "xray/c_arm.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

/// 3 x 4, from (x, y, z, 1) in scene axes [m] to (column, row, 1) times a factor.
using Projection = std::array<std::array<double, 4>, 3>;

struct PixelPoint {
    double column = 0, row = 0;
    bool in_field = false;
};

struct ContactTruth {
    Vec3 position = Vec3::Zero();  // [m]
    PixelPoint pixel;
    Vec3 force = Vec3::Zero();  // on the instrument, normal and friction [N]
};

struct InstrumentTruth {
    std::string name;
    double radius = 0;               // largest [m]
    std::vector<Vec3> centreline;    // as it is drawn, tip to hub [m]; empty: not in the scene yet
    std::vector<PixelPoint> pixels;  // of the centreline
    double hand_force = 0, hand_torque = 0;  // [N], [N m]; NaN: not recorded
    std::vector<ContactTruth> contacts;
    double cut_off = 0;   // fraction of the centreline's length that lies outside of the field
    double narrowest = 0;  // width of the part in the field where it is narrowest [pixels]
};

struct PictureTruth {
    double time = 0;         // [s]; NaN: not known
    std::int64_t step = -1;  // -1: not known
    CArmView view;
    std::optional<CArm> arm;  // of an X-ray
    double fov_y = 0;         // of an ordinary view [rad]
    std::vector<InstrumentTruth> instruments;
    bool contacts_known = true;
    std::vector<std::uint8_t> mask;  // [rows x columns] 1 + index of the instrument, 0: none
    std::vector<float> depth;        // [rows x columns] of the instrument's surface along the line of sight [m]; empty: none
    std::vector<float> lumen;        // [rows x columns] of the vessel, along the ray [m]; empty: none
};

/// Lines of all wires of a frame as an X-ray draws them; empty where a wire has no edge.
[[nodiscard]] std::vector<std::vector<TubeStation>> drawn_lines(const WireFrame& frame);

/// An ordinary camera as a C-arm's view, so that both project alike; depths up to 1 km.
[[nodiscard]] CArmView pinhole_view(const Camera& camera, const Viewport& viewport);

[[nodiscard]] Projection projection_of(const CArmView& view);

/// Everything but the pictures' own: mask, depth and lumen are empty. @param lines  as drawn, one for each wire
[[nodiscard]] PictureTruth locate(const CArmView& view, const WireFrame& frame,
                                  const std::vector<std::vector<TubeStation>>& lines);

/// Fills the mask, and the depth where asked. @throws Error BadScene: an instrument is not in front of the camera
void add_mask(PictureTruth& truth, const std::vector<std::vector<TubeStation>>& lines, bool with_depth);

/// Gathers over pictures what their labels should warn of.
class LabelWarnings {
public:
    void take_in(const PictureTruth& truth);
    /// One line for each instrument that is cut off. @param masks  whether gaps in masks matter too
    [[nodiscard]] std::vector<std::string> lines(bool masks) const;

private:
    struct Tally {
        std::string name;
        int cut = 0, tip_outside = 0, pictures = 0;
        double most = 0, narrowest = 1e9;
    };
    std::vector<Tally> tallies_;
    bool x_ray_ = false;
};

}  // namespace seldinger
