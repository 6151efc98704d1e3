#pragma once
// How contexts take part in a profile (profile.h).

#include <CL/cl.h>

#include <cstddef>

namespace seldinger::device {

[[nodiscard]] bool profiling();
void note_written(std::size_t bytes, double seconds);
void note_read(std::size_t bytes, double seconds);
/// Waits for the launch, and releases the event.
void note_launch(cl_kernel kernel, std::size_t items, std::size_t workgroup, cl_event event);

}  // namespace seldinger::device
