#pragma once
// The wall of the reference tests as a wide tree. Includes nothing of kernels/shared, like host_reference_support.h and for its
// reason.

#include "contact/host_reference_support.h"

namespace seldinger::test {

struct WideWall {
    std::vector<unsigned char> nodes;  // WideNode
    std::vector<float> vertices;       // of the leaves
};
/// The bench's kernels are known to the device layer afterwards.
[[nodiscard]] const WideWall& wide_wall();

}  // namespace seldinger::test
