#pragma once
// A lumen as voxels of a label map: which are in it, where it is open, and its surface.

#include "vessel/wall_mesh.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace seldinger {

/// Where voxels lie. Steps may be oblique, sheared, of different lengths, and left-handed.
struct VoxelGrid {
    std::array<int, 3> size{};
    Mat3 step = Mat3::Identity();  // column a: from a voxel to the next one along index a
    Vec3 origin = Vec3::Zero();    // centre of the first voxel

    [[nodiscard]] Vec3 at(const Vec3& index) const { return origin + step * index; }
    [[nodiscard]] Vec3 spacing() const { return {step.col(0).norm(), step.col(1).norm(), step.col(2).norm()}; }
    [[nodiscard]] double volume() const { return step.col(0).cross(step.col(1)).dot(step.col(2)); }  // < 0: left-handed
};

/// Voxels [begin, end) of one row along the first index, which have one value. row = y + size[1] z.
struct VoxelRun {
    std::int32_t row, begin, end;
    double value;
};

/// One connected part in the box around it, with a margin of one voxel.
struct LumenVoxels {
    static constexpr std::uint8_t inside = 1, seen = 128;
    /// The flag of a voxel of the lumen whose face is no wall: the vessel goes on there, or was cut.
    [[nodiscard]] static std::uint8_t open_face(int axis, bool high)
    {
        return static_cast<std::uint8_t>(2 << (2 * axis + (high ? 1 : 0)));
    }
    std::array<int, 3> low{}, size{};
    std::vector<std::uint8_t> flags;  // [size]
    std::vector<std::string> notes;   // what was left out, filled and opened, for people

    [[nodiscard]] std::array<std::ptrdiff_t, 3> strides() const
    {
        return {1, size[0], static_cast<std::ptrdiff_t>(size[0]) * size[1]};
    }
};

/// The largest part of voxels that share faces, its small cavities filled. Its faces on the image's border are open, and those of
/// flat ends. @param runs  of the lumen, in order; not empty  @param grid  in millimetres
[[nodiscard]] LumenVoxels lumen_of(const VoxelGrid& grid, const std::vector<VoxelRun>& runs);

/// The surface between the lumen and the rest, in the grid's unit; normals point into the lumen.
/// @param fractions  of each voxel of the grid, 0 to 1: the surface is where they are 0.5. Empty: it is midway between voxels
[[nodiscard]] WallMesh surface_of(const VoxelGrid& grid, const LumenVoxels& lumen, const std::vector<float>& fractions);

}  // namespace seldinger
