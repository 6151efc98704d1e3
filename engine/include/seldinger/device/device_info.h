#pragma once
// Description of an OpenCL device for users. Names no type of OpenCL.

#include <cstdint>
#include <string>

namespace seldinger {

/// One OpenCL device, as `seldinger devices` lists it.
struct DeviceInfo {
    int index = 0;
    std::string name, platform, type, version, driver;
    bool fp64 = false;
    int compute_units = 0;
    std::uint64_t memory_bytes = 0;
};

}  // namespace seldinger
