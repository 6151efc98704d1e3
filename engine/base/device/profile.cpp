// Sums of a profile, by kernel.
#include "device/profile.h"

#include "device/device.h"
#include "device/profile_record.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace seldinger::device {
namespace {

std::optional<Profile> sums;

double seconds_of(cl_event event)
{
    cl_ulong from = 0, until = 0;
    CL_CHECK(clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof from, &from, nullptr));
    CL_CHECK(clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof until, &until, nullptr));
    return 1e-9 * static_cast<double>(until - from);
}

std::string name_of(cl_kernel kernel)
{
    char name[128] = {};
    CL_CHECK(clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name - 1, name, nullptr));
    return name;
}

}  // namespace

void begin_profile() { sums.emplace(); }
Profile end_profile() { return *std::exchange(sums, std::nullopt); }
void restart_profile() { sums.emplace(); }

bool profiling() { return sums.has_value(); }

void note_written(std::size_t bytes, double seconds)
{
    sums->bytes_written += bytes;
    sums->write_seconds += seconds;
}

void note_read(std::size_t bytes, double seconds)
{
    sums->bytes_read += bytes;
    sums->read_seconds += seconds;
}

void note_launch(cl_kernel kernel, std::size_t items, std::size_t workgroup, cl_event event)
{
    CL_CHECK(clWaitForEvents(1, &event));
    const double seconds = seconds_of(event);
    clReleaseEvent(event);
    const std::string name = name_of(kernel);
    auto found =
        std::find_if(sums->kernels.begin(), sums->kernels.end(), [&](const KernelProfile& k) { return k.kernel == name; });
    if (found == sums->kernels.end()) found = sums->kernels.insert(found, {name, workgroup, 0, 0, 0});
    ++found->launches;
    found->items += items;
    found->seconds += seconds;
}

}  // namespace seldinger::device
