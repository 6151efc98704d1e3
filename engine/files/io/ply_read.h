#pragma once
// Reads PLY: ascii, binary of either byte order; coordinates of any type, doubles as doubles. What a header announces is held
// against the bytes that are there before anything is made room for.

#include "io/vtp_read.h"

namespace seldinger {

/// Vertices and faces; other elements and properties are skipped. @param name  of the file, for messages
/// @throws Error BadFile: a header that is none or announces more than there is, a vertex that is not there, cut short
[[nodiscard]] PolyData parse_ply(const std::string& bytes, const std::string& name);

}  // namespace seldinger
