// Lists the devices of all OpenCL platforms, asking PoCL for its single-thread device too, and picks the default one.
#include "device/enumerate.h"

#include "core/error.h"
#include "core/system_needs.h"
#include "device/device_info.h"
#include "device/kernel_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>

namespace seldinger::device {
namespace {

constexpr std::string_view pocl = "Portable Computing Language";

/// PoCL 3.1 with LLVM 14: 650 MB while a kernel is compiled, a thread for each core, and two processes that link it. Without them
/// it ends the process by a signal.
SystemNeeds needs_of_opencl() { return {"OpenCL", std::size_t{700} << 20, library_threads("POCL_MAX_PTHREAD_COUNT") + 2}; }

/// 0 where the device does not answer.
template <class T>
T device_number(cl_device_id device, cl_device_info what)
{
    T value{};
    clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
    return value;
}

}  // namespace

std::vector<cl_device_id> all_devices()
{
    static std::once_flag once;
    std::call_once(once, [] {
        try_system_needs(needs_of_opencl());
        setenv("POCL_DEVICES", "basic pthread", 0);
        setenv("POCL_SIGFPE_HANDLER", "0", 0);  // else an integer division by zero in our own code would go unseen
        // else ocl-icd counts the devices of every platform to sort them, and PoCL without a usable kernel cache then has none
        // for good
        setenv("OCL_ICD_PLATFORM_SORT", "none", 0);
    });
    std::vector<cl_device_id> devices;
    cl_uint platform_count = 0;
    if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS || platform_count == 0) return devices;
    std::vector<cl_platform_id> platforms(platform_count);
    clGetPlatformIDs(platform_count, platforms.data(), nullptr);
    static std::once_flag prepared;
    for (cl_platform_id platform : platforms) {
        char name[64] = {};
        clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof name - 1, name, nullptr);
        if (name == pocl) std::call_once(prepared, prepare_kernel_cache);
    }
    std::vector<std::vector<cl_device_id>> by_platform;
    for (cl_platform_id platform : platforms) {
        cl_uint count = 0;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS || count == 0) continue;
        by_platform.emplace_back(count);
        clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, by_platform.back().data(), nullptr);
    }
    // the loader's own order, but the same in every process: the platform with the most devices first, then by the device's name
    std::sort(by_platform.begin(), by_platform.end(), [](const auto& a, const auto& b) {
        if (a.size() != b.size()) return a.size() > b.size();
        return device_text(a.front(), CL_DEVICE_NAME) < device_text(b.front(), CL_DEVICE_NAME);
    });
    for (const auto& of_platform : by_platform) devices.insert(devices.end(), of_platform.begin(), of_platform.end());
    return devices;
}

std::string device_text(cl_device_id device, cl_device_info what)
{
    std::size_t size = 0;
    if (clGetDeviceInfo(device, what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return {};
    std::string text(size, '\0');
    clGetDeviceInfo(device, what, size, text.data(), nullptr);
    text.resize(std::strlen(text.c_str()));
    return text;
}

void check_device_index(int index)
{
    const int count = static_cast<int>(all_devices().size());
    if (index < count) return;
    throw Error(ErrorKind::NoDevice,
                fmt::format("--device {}: there are only devices 0 to {}; `seldinger devices` lists them", index, count - 1));
}

std::string platform_text(cl_device_id device, cl_platform_info what)
{
    cl_platform_id platform = nullptr;
    clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, &platform, nullptr);
    char text[512] = {};
    if (platform) clGetPlatformInfo(platform, what, sizeof text - 1, text, nullptr);
    return text;
}

std::string platform_name(cl_device_id device) { return platform_text(device, CL_PLATFORM_NAME); }

PoclDevice pocl_device(std::string_view platform, std::string_view device)
{
    if (platform != pocl) return PoclDevice::None;
    if (device.starts_with("basic") || device.starts_with("cpu-minimal")) return PoclDevice::Caller;
    return device.starts_with("pthread") || device.starts_with("cpu") ? PoclDevice::Pool : PoclDevice::None;
}

std::string_view processor_name(std::string_view device)
{
    for (const std::string_view kind : {"basic-", "pthread-", "cpu-minimal-", "cpu-"})
        if (device.starts_with(kind)) return device.substr(kind.size());
    return device;
}

PoclDevice pocl_device(cl_device_id device) { return pocl_device(platform_name(device), device_text(device, CL_DEVICE_NAME)); }

int default_device(const std::vector<cl_device_id>& devices)
{
    const auto pool =
        std::find_if(devices.begin(), devices.end(), [](auto* device) { return pocl_device(device) == PoclDevice::Pool; });
    return pool == devices.end() ? 0 : static_cast<int>(pool - devices.begin());
}

int default_device() { return default_device(all_devices()); }

DeviceDetails device_details(int index)
{
    const cl_device_id device = all_devices().at(static_cast<std::size_t>(index));
    return {device_text(device, CL_DEVICE_VENDOR), device_number<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE),
            device_number<cl_uint>(device, CL_DEVICE_MAX_CLOCK_FREQUENCY),
            device_number<std::size_t>(device, CL_DEVICE_PROFILING_TIMER_RESOLUTION)};
}

}  // namespace seldinger::device

namespace seldinger {

std::vector<DeviceInfo> list_devices()
{
    std::vector<DeviceInfo> list;
    for (cl_device_id id : device::all_devices()) {
        DeviceInfo info;
        info.index = static_cast<int>(list.size());
        info.name = device::device_text(id, CL_DEVICE_NAME);
        info.version = device::device_text(id, CL_DEVICE_VERSION);
        info.driver = device::device_text(id, CL_DRIVER_VERSION);
        info.fp64 = device::device_text(id, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
        const auto type = device::device_number<cl_device_type>(id, CL_DEVICE_TYPE);
        info.type = type & CL_DEVICE_TYPE_GPU ? "GPU" : type & CL_DEVICE_TYPE_CPU ? "CPU" : "accelerator";
        info.compute_units = static_cast<int>(device::device_number<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS));
        info.memory_bytes = device::device_number<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
        info.platform = device::platform_name(id);
        list.push_back(info);
    }
    return list;
}

}  // namespace seldinger
