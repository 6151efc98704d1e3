#pragma once
// VTK polygonal data as read from a file: .vtp (XML) and legacy .vtk, without VTK.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

/// Cells as VTK stores them: cell i owns connectivity[offsets[i] .. offsets[i + 1]).
struct VtkCells {
    std::vector<std::int64_t> connectivity;
    std::vector<std::int64_t> offsets = {0};
    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
};

struct VtkPolyData {
    std::vector<double> points;                               // [3 P] file units
    VtkCells polygons, strips, lines;
    std::map<std::string, std::vector<double>> point_scalars;  // one-component point arrays, by name
};

/// All pieces of a .vtp joined: ascii, inline base64, appended base64 or raw; uncompressed or zlib; UInt32 or UInt64 headers;
/// either byte order. @throws Error BadFile naming the array at fault
[[nodiscard]] VtkPolyData read_vtp(const std::filesystem::path& path);

/// Legacy DATASET POLYDATA, ASCII or BINARY, cells in the old (count first) and the 5.1 (OFFSETS, CONNECTIVITY) form.
/// Attributes after the cells are not read. @throws Error BadFile
[[nodiscard]] VtkPolyData read_legacy_vtk(const std::filesystem::path& path);

/// The whole file. @throws Error BadFile when it is missing, unreadable or empty
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// @throws Error BadFile "path: message"
[[noreturn]] void bad_file(const std::filesystem::path& path, const std::string& message);

/// Checks that every index names a point and offsets increase. @throws Error BadFile
void check_cells(const std::filesystem::path& path, const VtkCells& cells, std::size_t point_count, const char* name);

[[nodiscard]] std::string base64_encode(std::string_view bytes);

}  // namespace seldinger
