#pragma once
// The wall of the twin tests as a wide tree. Includes nothing of kernels/shared, like twin_support.h and for its reason.

#include "contact/twin_support.h"

namespace seldinger::test {

struct WideWall {
    std::vector<unsigned char> nodes;  // WideNode
    std::vector<float> vertices;       // of the leaves
};
/// The bench's kernels are known to the device layer afterwards.
[[nodiscard]] const WideWall& wide_wall();

}  // namespace seldinger::test
