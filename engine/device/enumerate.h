#pragma once
// Lists the OpenCL devices, and chooses the default one.

#include <CL/cl.h>

#include <string>
#include <vector>

namespace seldinger::device {

/// Every device of every platform, in the order of their indices on the command line. Never throws; empty without OpenCL.
/// The first call asks PoCL, unless the user has set POCL_DEVICES, to offer its caller's-thread device beside the threaded one.
[[nodiscard]] std::vector<cl_device_id> all_devices();

/// PoCL's threaded CPU device where present (the built-in default), else the first device.
[[nodiscard]] int default_device(const std::vector<cl_device_id>& devices);

/// @throws Error NoDevice when there is no such device; -1, the default, always passes
void check_device_index(int index);

/// A textual property; empty where the device does not answer.
[[nodiscard]] std::string device_text(cl_device_id device, cl_device_info what);

}  // namespace seldinger::device
