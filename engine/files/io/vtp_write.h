#pragma once
// Writes VTK PolyData (.vtp) for ParaView, Blender and our renderer: appended raw arrays, little-endian, 64-bit sizes.
// Coordinates in metres, double precision; indices are Int32, which halves the size of a wall.

#include "vessel/wall_mesh.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

class VtpWriter {
public:
    explicit VtpWriter(std::span<const Vec3> points);

    // Cells: `connectivity` indexes points, cell i ends before connectivity[offsets[i]].
    void set_verts();  // one vertex per point
    void set_line();   // one line through all points
    void set_polys(std::span<const std::array<std::int32_t, 3>> triangles);

    /// Point data: points x components numbers. A number that is not finite is written as it is: VTK reads NaN.
    void add_point_data(std::string_view name, int components, std::span<const double> values);
    void add_point_vectors(std::string_view name, std::span<const Vec3> values);

    /// The bytes of the whole file.
    [[nodiscard]] std::string bytes() const;

private:
    struct Cells {
        std::vector<std::int32_t> connectivity, offsets;
    };
    struct Array {
        std::string name;
        int components;
        std::vector<double> values;
    };
    std::vector<double> points_;  // [3 P]
    Cells verts_, lines_, polys_;
    std::vector<Array> point_data_;
};

/// One entry of a .pvd, ParaView's list of files over time.
struct PvdEntry {
    double time = 0;   // [s]
    std::string file;  // relative to the .pvd
    int part = 0;      // of several files of one time
    std::string name;  // of that part
};
[[nodiscard]] std::string pvd_text(std::span<const PvdEntry> entries);

}  // namespace seldinger
