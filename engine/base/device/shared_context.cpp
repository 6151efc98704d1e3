// Keeps one cl_context per set of devices and builds each program once; finds the first error in a compiler's log.
#include "device/shared_context.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "core/sealed_file.h"
#include "device/compiler_watch.h"
#include "device/enumerate.h"
#include "device/kernel_cache.h"

#include <fmt/format.h>

#include <cstring>
#include <ctime>
#include <functional>
#include <optional>

namespace seldinger::device {
namespace {

constexpr long first_start = 600;  // [s] programs that young may have been built by another process of the same first start

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
    pocl_ = device_text(devices_.front(), CL_DEVICE_VERSION).find("PoCL") != std::string::npos;
    // 3.0, as PyPI has it, makes kernels of its own code that lack its library's functions; later ones have not been tried
    takes_code_ = pocl_device(devices_.front()) != PoclDevice::None &&
                  platform_text(devices_.front(), CL_PLATFORM_VERSION).find("PoCL 3.1") != std::string::npos;
}

std::pair<cl_program, bool> SharedContext::program(const std::string& file, const std::string& text, const std::string& options)
{
    const std::lock_guard<std::mutex> turn(building_);
    cl_program& known = programs_[{options, text}];
    if (known) return {known, false};
    known = build(file, text, options);  // stays null, to be tried again, where that throws
    return {known, true};
}

namespace {

cl_program source_program(cl_context context, const std::string& text)
{
    const char* source = text.c_str();
    const std::size_t length = text.size();
    cl_int status = CL_SUCCESS;
    cl_program program = clCreateProgramWithSource(context, 1, &source, &length, &status);
    check(status, "clCreateProgramWithSource");
    return program;
}

}  // namespace

std::vector<std::uint8_t> SharedContext::bitcode(const std::string& text, const std::string& options,
                                                 const std::string& mark) const
{
    constexpr std::string_view magic = "SELCODE1";
    const std::filesystem::path kept = kernel_cache_folder() / (mark + ".program");
    try {
        return read_sealed(kept, magic);
    } catch (const Error&) {  // not there yet, or damaged
    }
    timespec begun{};
    ::clock_gettime(CLOCK_REALTIME_COARSE, &begun);  // the clock of file dates
    cl_program program = source_program(context_, text);
    (void)clCompileProgram(program, 1, devices_.data(), options.c_str(), 0, nullptr, nullptr, nullptr, nullptr);
    clReleaseProgram(program);
    const std::vector<std::filesystem::path> fresh = new_programs(begun, mark);
    if (fresh.empty()) return {};
    try {
        const std::string code = read_file(fresh.front() / "program.bc");
        std::error_code ignored;
        std::filesystem::remove_all(fresh.front(), ignored);  // it gets no kernel
        std::vector<std::uint8_t> bytes(code.begin(), code.end());
        write_sealed(kept, magic, bytes);
        return bytes;
    } catch (const Error&) {
        return {};
    }
}

cl_program SharedContext::from_bitcode(const std::vector<std::uint8_t>& code, const std::string& options) const
{
    if (code.empty()) return nullptr;
    std::vector<const unsigned char*> codes(devices_.size(), code.data());
    const std::vector<std::size_t> sizes(devices_.size(), code.size());
    const auto count = static_cast<cl_uint>(devices_.size());
    cl_int status = CL_SUCCESS;
    cl_program program =
        clCreateProgramWithBinary(context_, count, devices_.data(), sizes.data(), codes.data(), nullptr, &status);
    if (status != CL_SUCCESS) return nullptr;
    if (clBuildProgram(program, count, devices_.data(), options.c_str(), nullptr, nullptr) == CL_SUCCESS) return program;
    clReleaseProgram(program);
    return nullptr;
}

cl_program SharedContext::build(const std::string& file, std::string text, const std::string& options)
{
    const std::string name = device_text(devices_.front(), CL_DEVICE_NAME);
    Compiled compiled;
    timespec begun{};
    std::optional<CompilerCall> said;  // what others compile, and where they keep it, is not known
    std::optional<CompilerTurn> turn;
    if (pocl_) {
        // a kernel that does nothing, by whose name the program's folders in the cache are known
        const std::string made_for =
            std::string(processor_name(name)) + platform_text(devices_.front(), CL_PLATFORM_VERSION);  // and LLVM's version
        compiled.mark = fmt::format("seldinger_{:016x}", std::hash<std::string>()(text + options + made_for));
        text += fmt::format("__kernel void {}(void) {{}}\n", compiled.mark);
        said.emplace();
        turn.emplace(compiled.mark);
    }
    cl_int status = CL_SUCCESS;
    cl_program built = nullptr;
    {
        const CompilerWatch watch(
            fmt::format("seldinger: device \"{}\": its OpenCL driver ended the process while it compiled kernels/{}. Fix: choose "
                        "another device "
                        "with --device (`seldinger devices` lists them), or update the driver",
                        printable(name), file));
        const std::vector<std::uint8_t> code = takes_code_ ? bitcode(text, options, compiled.mark) : std::vector<std::uint8_t>();
        ::clock_gettime(CLOCK_REALTIME_COARSE, &begun);  // the clock of file dates
        built = from_bitcode(code, options);
        if (!built) {
            built = source_program(context_, text);
            const auto count = static_cast<cl_uint>(devices_.size());
            status = clBuildProgram(built, count, devices_.data(), options.c_str(), nullptr, nullptr);
        }
    }
    if (status == CL_SUCCESS && pocl_) {
        begun.tv_sec -= first_start;
        if (devices_.size() == 2) compiled.folders = new_programs(begun, compiled.mark);
        const std::lock_guard<std::mutex> one(launching_);
        compiled_[built] = std::move(compiled);
    }
    if (status == CL_SUCCESS) return built;
    const std::string error = first_error(built, devices_.front());
    clReleaseProgram(built);
    throw Error(ErrorKind::NoDevice, fmt::format("kernels/{} does not build on device \"{}\": {} ({}); {}", file, name,
                                                printable(error), error_name(status), kernel_cache_advice()));
}

void SharedContext::first_launch(cl_kernel kernel, cl_device_id device, const std::function<void()>& launch)
{
    if (!pocl_) return launch();
    cl_program program = nullptr;
    CL_CHECK(clGetKernelInfo(kernel, CL_KERNEL_PROGRAM, sizeof program, &program, nullptr));
    char name[128] = {};
    CL_CHECK(clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name - 1, name, nullptr));
    const std::lock_guard<std::mutex> one(launching_);
    Compiled& compiled = compiled_.at(program);
    if (compiled.kernels.contains({name, device})) return launch();
    const CompilerTurn turn(fmt::format("{} {} {}", compiled.mark, name, device == devices_.front()));
    // the two devices are one processor, for which PoCL makes the same code
    const std::vector<std::filesystem::path>& folders = compiled.folders;
    const auto share = [&] {
        if (folders.size() == 2) copy_kernel(folders[0], folders[1], name), copy_kernel(folders[1], folders[0], name);
    };
    share();  // what another process has compiled
    launch();
    share();
    compiled.kernels.insert({name, device});
}

}  // namespace seldinger::device
