#pragma once
// Lists the OpenCL devices, and chooses the default one.

#include <CL/cl.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger::device {

/// Every device of every platform, in the order of their indices on the command line. Never throws; empty without OpenCL.
/// The first call asks PoCL, unless the user has set POCL_DEVICES, to offer its caller's-thread device beside the threaded one.
[[nodiscard]] std::vector<cl_device_id> all_devices();

/// PoCL offers a processor twice: `Caller` computes in the thread that launches, `Pool` in a thread for each core.
enum class PoclDevice { None, Caller, Pool };

/// By its name: `basic` and `pthread` up to PoCL 3, `cpu-minimal` and `cpu` from PoCL 4 on. `None`: a device of another platform.
[[nodiscard]] PoclDevice pocl_device(cl_device_id device);

/// The same for a name that is known already.
[[nodiscard]] PoclDevice pocl_device(std::string_view platform, std::string_view device);

/// Name of a device of PoCL's without its kind: what both devices of a processor are called.
[[nodiscard]] std::string_view processor_name(std::string_view device);

/// PoCL's threaded CPU device where present (the built-in default), else the first device.
[[nodiscard]] int default_device(const std::vector<cl_device_id>& devices);
/// Of all devices.
[[nodiscard]] int default_device();

/// What a benchmark says of a device beside its DeviceInfo.
struct DeviceDetails {
    std::string vendor;
    std::uint64_t local_memory_bytes = 0;
    std::uint32_t clock_mhz = 0;
    std::size_t timer_ns = 0;
};
[[nodiscard]] DeviceDetails device_details(int index);

/// @throws Error NoDevice when there is no such device; -1, the default, always passes
void check_device_index(int index);

/// A textual property; empty where the device does not answer.
[[nodiscard]] std::string device_text(cl_device_id device, cl_device_info what);

/// A text of the platform that the device belongs to, and its name.
[[nodiscard]] std::string platform_text(cl_device_id device, cl_platform_info what);
[[nodiscard]] std::string platform_name(cl_device_id device);

}  // namespace seldinger::device
