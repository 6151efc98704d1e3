#pragma once
// Length of each pixel's ray inside wires and catheters, as the mean over the pixel's area.
//
// An instrument is a chain of tapered cylinders cut at the planes that halve its kinks. A ray's chord of a cylinder of radius r
// at the distance d, at the angle psi, is L = 2 sqrt(r^2 - d^2)/sin psi. For a taper it is the root of the cone's quadratic. A
// pixel is an n x n grid of rays, with n so that at least 24 rays cross the thickness (the midpoint rule then misses a half
// circle by under 0.3 %). So a wire thinner than a pixel has the right sum wherever it lies.

#include "xray/c_arm.h"

#include <cstdint>
#include <vector>

namespace seldinger {

/// One station along an instrument, tip to hub.
struct DeviceStation {
    Vec3 place;         // [m]
    double radius = 0;  // outer [m]
    double lumen = 0;   // inner [m]; 0: solid
    int material = 0;   // of the piece from here to the next station
    float value = 0;    // carried along, as a mesh's vertices do
};

using Device = std::vector<DeviceStation>;

/// One pixel's path in one material, in pieces that follow the instrument.
struct DevicePath {
    std::int32_t pixel;
    std::int32_t material;
    float length;  // mean over the pixel [m]
    float value;
};

/// @return row by row, a row's in the order of the pieces. @throws Error BadScene: not between source and detector
[[nodiscard]] std::vector<DevicePath> trace_devices(const CArmView& view, const std::vector<Device>& devices);

/// Which device covers a pixel: by the same pieces as the paths, where at least half of 7 x 7 rays of the pixel meet one.
struct DeviceMask {
    std::vector<std::uint8_t> label;  // [rows x columns] 1 + index of the device, 0: none
    std::vector<float> depth;  // [rows x columns] of the nearest surface along the central ray [m], 0: none; empty: not asked for
};

/// @param devices  at most 255; where several cover a pixel the thinnest wins, which is the inner one of coaxial ones. An empty
/// device has no pixel. @throws Error BadScene, as trace_devices
[[nodiscard]] DeviceMask mask_devices(const CArmView& view, const std::vector<Device>& devices, bool with_depth);

}  // namespace seldinger
