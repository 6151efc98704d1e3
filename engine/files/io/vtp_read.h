#pragma once
// Reads VTK PolyData (.vtp): ascii, base64 and appended raw or base64 arrays, plain or zlib-compressed, of either header width.
// Little-endian only, as every writer of the last decades makes on common machines. What a file unpacks to is bounded by its size
// (most_unpacked), whatever its headers promise.

#include "core/folder.h"

#include <array>
#include <concepts>
#include <cstdint>
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
    std::map<std::string, std::vector<std::string>> cell_names;  // strings of the cells; of .vtp alone
    std::string remarks;  // VTK: the legacy title, and strings of the field data as NAME=value
    std::string note;     // what was wrong with the file, and what was read; one sentence for people, or empty
};

constexpr std::size_t most_remarks = 4096;  // a file may be nothing but comments [bytes]

/// Geometry leaves point, cell and field data packed: nobody asks for them, and a constant array packs a thousandfold. Remarks
/// stops before the first point.
enum class PolyParts { All, Geometry, Remarks };

/// Times the file's size that its arrays may take in memory, every value as eight bytes, with the bytes that are read to find
/// them. VTK's own writer reaches 14 at best, with regular tubes, planes and spheres of float32 and 32-bit indices, and 4 with
/// patients' vessels. Compression alone would reach a thousand, and many pieces on one block have no limit.
constexpr std::uint64_t most_unpacked = 32;
constexpr std::uint64_t kLeastUnpacked = 1 << 20;  // small files may, whatever their size [bytes]

/// @throws Error BadFile: missing, not PolyData, cut short, an index outside the points, or more than most_unpacked
[[nodiscard]] PolyData read_poly_data(const FilePlace& place, PolyParts parts = PolyParts::All);

/// Same, from the bytes of a file; `name` is for messages.
[[nodiscard]] PolyData parse_poly_data(const std::string& bytes, const std::string& name, PolyParts parts = PolyParts::All);

// Converts numbers of files from one type to another without undefined values.

/// As static_cast, but a real number that no index can be (beyond 2^53, or none at all) becomes -1, which readers refuse as one.
template <class Wanted, class Stored>
[[nodiscard]] Wanted safe_cast(Stored value)
{
    if constexpr (std::integral<Wanted> && std::floating_point<Stored>) {
        if (!(value > Stored(-9007199254740992.0) && value < Stored(9007199254740992.0))) return Wanted(-1);
    }
    return static_cast<Wanted>(value);
}

/// Legacy DATASET POLYDATA, ASCII or BINARY, cells in the old (count first) and the 5.1 (OFFSETS, CONNECTIVITY) form, FIELD data
/// and METADATA wherever a writer puts them.
/// @param name   of the file, for messages
/// @param parts  Geometry skips the numbers of FIELD data and stops at the attributes of points and cells
/// @throws Error BadFile
[[nodiscard]] PolyData parse_legacy_vtk(const std::string& bytes, const std::string& name, PolyParts parts = PolyParts::Geometry);

}  // namespace seldinger
