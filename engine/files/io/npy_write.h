#pragma once
// NumPy's .npy of float32 pictures, as numpy.load() reads it. [NEP 1, version 1.0]

#include "core/folder.h"

#include <span>
#include <vector>

namespace seldinger {

/// @param shape  e.g. {rows, columns}; its product is the number of values. The file appears only when it is complete.
/// @throws Error BadFile
void write_npy(const FilePlace& place, std::span<const float> values, const std::vector<std::size_t>& shape);

}  // namespace seldinger
