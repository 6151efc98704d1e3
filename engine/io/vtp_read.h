#pragma once
// Reads VTK PolyData (.vtp): ascii, base64 and appended raw or base64 arrays, plain or zlib-compressed, of either header width.
// Little-endian only, as every writer of the last decades makes on common machines.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace seldinger {

/// A named array: `values` holds count x components numbers.
struct PolyArray {
    int components = 1;
    std::vector<double> values;
};

/// Cells of one kind: cell i has the point indices connectivity[offsets[i-1]] ... connectivity[offsets[i] - 1].
struct PolyCells {
    std::vector<std::int64_t> connectivity, offsets;
};

/// All pieces of the file, one after the other. Coordinates are as in the file: no unit is known here.
struct PolyData {
    std::vector<std::array<double, 3>> points;
    PolyCells verts, lines, strips, polys;
    std::map<std::string, PolyArray> point_data, cell_data, field_data;
};

/// @throws Error BadFile: missing, not PolyData, cut short, or an index outside the points
[[nodiscard]] PolyData read_poly_data(const std::filesystem::path& path);

/// Same, from the bytes of a file; `name` is for messages.
[[nodiscard]] PolyData parse_poly_data(const std::string& bytes, const std::string& name);

}  // namespace seldinger
