#pragma once
// Readers of STL (binary, ASCII), OBJ and PLY. Coordinates written as text arrive as the nearest double; most mesh libraries
// round to float32 first. For a vessel a metre from its origin, that error is as large as the indentation of a wire under its
// weight.

#include "io/vtp_read.h"

namespace seldinger {

/// One point per corner, in the order of the file. Binary STL holds float32 and no more.
/// A binary file's count may be missing or too small, and bytes may follow the facets: PolyData::note says so.
/// @param name  of the file, for messages     @throws Error BadFile: more announced than there, cut short, no number where one is
/// due
[[nodiscard]] PolyData parse_stl(const std::string& bytes, const std::string& name);

/// Vertices and faces; everything else in the file (normals, texture, groups, materials, lines) is left out.
/// @throws Error BadFile: a face names a vertex that is not there, no number where one is due
[[nodiscard]] PolyData parse_obj(const std::string& bytes, const std::string& name);

/// Ascii, binary of either byte order; coordinates of any type. Vertices and faces; other elements and properties are skipped.
/// What a header announces is held against the bytes that are there before anything is made room for.
/// @throws Error BadFile: a header that is none or announces more than there is, a vertex that is not there, cut short
[[nodiscard]] PolyData parse_ply(const std::string& bytes, const std::string& name);

}  // namespace seldinger
