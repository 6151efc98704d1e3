// Keeps one cl_context per set of devices and builds each program once; finds the first error in a compiler's log.
#include "device/shared_context.h"

#include "core/error.h"
#include "core/printable.h"
#include "device/compiler_watch.h"
#include "device/enumerate.h"
#include "device/kernel_cache.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>

namespace seldinger::device {

namespace {

/// The compiler's first error.
std::string first_error(cl_program program, cl_device_id device)
{
    std::size_t size = 0;
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    log.resize(std::strlen(log.c_str()));
    const std::size_t at = log.find("error");
    const std::string first = log.substr(at == std::string::npos ? 0 : at);
    return first.substr(0, first.find('\n'));
}

}  // namespace

SharedContext& SharedContext::of(const std::vector<cl_device_id>& devices)
{
    static std::mutex making;
    static std::map<std::vector<cl_device_id>, SharedContext*> all;
    const std::lock_guard<std::mutex> turn(making);
    SharedContext*& one = all[devices];
    if (!one) one = new SharedContext(devices);  // never deleted, see above
    return *one;
}

SharedContext::SharedContext(std::vector<cl_device_id> devices) : devices_(std::move(devices))
{
    cl_platform_id platform = nullptr;
    CL_CHECK(clGetDeviceInfo(devices_.front(), CL_DEVICE_PLATFORM, sizeof platform, &platform, nullptr));
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(platform), 0};
    cl_int status = CL_SUCCESS;
    context_ = clCreateContext(properties, static_cast<cl_uint>(devices_.size()), devices_.data(), nullptr, nullptr, &status);
    check(status, "clCreateContext");
}

std::pair<cl_program, bool> SharedContext::program(const std::string& file, const std::string& text, const std::string& options)
{
    const std::lock_guard<std::mutex> turn(building_);
    cl_program& known = programs_[{options, text}];
    if (known) return {known, false};
    known = build(file, text, options);  // stays null, to be tried again, where that throws
    return {known, true};
}

cl_program SharedContext::build(const std::string& file, const std::string& text, const std::string& options) const
{
    const char* source = text.c_str();
    const std::size_t length = text.size();
    cl_int status = CL_SUCCESS;
    cl_program built = clCreateProgramWithSource(context_, 1, &source, &length, &status);
    check(status, "clCreateProgramWithSource");
    {
        std::optional<CompilerCall> said;  // what others compile, and where they keep it, is not known
        if (device_text(devices_.front(), CL_DEVICE_VERSION).find("PoCL") != std::string::npos) said.emplace();
        const CompilerWatch watch(fmt::format(
            "seldinger: device \"{}\": its OpenCL driver ended the process while it compiled kernels/{}. Fix: choose another device "
            "with --device (`seldinger devices` lists them), or update the driver",
            printable(device_text(devices_.front(), CL_DEVICE_NAME)), file));
        status = clBuildProgram(built, static_cast<cl_uint>(devices_.size()), devices_.data(), options.c_str(), nullptr, nullptr);
    }
    if (status == CL_SUCCESS) return built;
    const std::string error = first_error(built, devices_.front());
    clReleaseProgram(built);
    throw Error(ExitCode::NoDevice, fmt::format("kernels/{} does not build on device \"{}\": {} ({}); {}", file,
                                                device_text(devices_.front(), CL_DEVICE_NAME), printable(error), error_name(status),
                                                kernel_cache_advice()));
}

}  // namespace seldinger::device
