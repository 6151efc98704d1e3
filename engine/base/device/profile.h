#pragma once
// What a device did, kernel by kernel: times by OpenCL's own events, and bytes that were copied. For `seldinger bench --gpu`.

#include <cstdint>
#include <string>
#include <vector>

namespace seldinger::device {

struct KernelProfile {
    std::string kernel;
    std::size_t workgroup = 0;
    std::uint64_t launches = 0, items = 0;
    double seconds = 0;  // on the device, all launches
};

struct Profile {
    std::vector<KernelProfile> kernels;  // in the order of their first launch
    std::uint64_t bytes_written = 0, bytes_read = 0;
    double write_seconds = 0, read_seconds = 0;  // of the host, until the call came back
};

/// Contexts that are made between begin_profile() and end_profile() take part. Each launch is waited for, so that the host's
/// times mean nothing meanwhile. For one thread.
void begin_profile();
[[nodiscard]] Profile end_profile();
/// Sets all counts to zero.
void restart_profile();

}  // namespace seldinger::device
