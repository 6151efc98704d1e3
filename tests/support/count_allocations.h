#pragma once
// How often this program asked for heap memory: every operator new, and every malloc that its own code called (Eigen's). What the
// OpenCL library allocates for itself is not counted.

namespace seldinger::test {

/// False under a sanitizer, which has its own allocator.
[[nodiscard]] bool allocations_are_counted();
[[nodiscard]] long allocations();

}  // namespace seldinger::test
