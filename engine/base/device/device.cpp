// Contexts, buffers, kernels and launches by OpenCL 1.2 calls, each checked; names of OpenCL's error codes.
#include "device/device.h"

#include "core/clock.h"
#include "core/error.h"
#include "core/parallel.h"
#include "device/enumerate.h"
#include "device/profile_record.h"
#include "device/shared_context.h"

#include <fmt/format.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>

namespace seldinger::device {

const char* error_name(cl_int status)
{
    switch (status) {
        case CL_DEVICE_NOT_FOUND: return "CL_DEVICE_NOT_FOUND";
        case CL_DEVICE_NOT_AVAILABLE: return "CL_DEVICE_NOT_AVAILABLE";
        case CL_COMPILER_NOT_AVAILABLE: return "CL_COMPILER_NOT_AVAILABLE";
        case CL_MEM_OBJECT_ALLOCATION_FAILURE: return "CL_MEM_OBJECT_ALLOCATION_FAILURE";
        case CL_OUT_OF_RESOURCES: return "CL_OUT_OF_RESOURCES";
        case CL_OUT_OF_HOST_MEMORY: return "CL_OUT_OF_HOST_MEMORY";
        case CL_BUILD_PROGRAM_FAILURE: return "CL_BUILD_PROGRAM_FAILURE";
        case CL_INVALID_VALUE: return "CL_INVALID_VALUE";
        case CL_INVALID_DEVICE: return "CL_INVALID_DEVICE";
        case CL_INVALID_BUFFER_SIZE: return "CL_INVALID_BUFFER_SIZE";
        case CL_INVALID_ARG_SIZE: return "CL_INVALID_ARG_SIZE";
        case CL_INVALID_ARG_INDEX: return "CL_INVALID_ARG_INDEX";
        case CL_INVALID_KERNEL_ARGS: return "CL_INVALID_KERNEL_ARGS";
        case CL_INVALID_WORK_GROUP_SIZE: return "CL_INVALID_WORK_GROUP_SIZE";
        case CL_INVALID_KERNEL_NAME: return "CL_INVALID_KERNEL_NAME";
        default:
            return "OpenCL error";
    }
}

namespace {

/// SEL_OWN_MEMORY in the environment: a CPU is taken for a device with separate memory, so that tests see its copies.
bool asked_own_memory()
{
    static const bool asked = std::getenv("SEL_OWN_MEMORY") != nullptr;
    return asked;
}

/// SEL_WORKGROUP in the environment (1 to 1024): nothing may depend on it, and bench/pocl_variants.sh looks. 0: it is not there
std::size_t asked_workgroup()
{
    static const std::size_t asked = [] {
        const char* text = std::getenv("SEL_WORKGROUP");
        const long size = text ? std::strtol(text, nullptr, 10) : 0;
        return static_cast<std::size_t>(size >= 1 && size <= 1024 ? size : 0);
    }();
    return asked;
}

}  // namespace

void check(cl_int status, const char* call)
{
    if (status == CL_SUCCESS) return;
    const std::string name(call, std::strcspn(call, "("));
    throw Error(ErrorKind::NoDevice, fmt::format("OpenCL: {} failed with {} ({}); `seldinger devices` lists usable devices", name,
                                                error_name(status), status));
}

namespace {

std::uint64_t next_buffer()
{
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
}

}  // namespace

Buffer::Buffer(Context& context, std::size_t bytes) : bytes_(bytes == 0 ? 16 : bytes), id_(next_buffer())
{
    cl_int status = CL_SUCCESS;
    // a graphics card would go over the bus for each access to memory of the host
    const cl_mem_flags where = context.on_cpu() ? CL_MEM_ALLOC_HOST_PTR : 0;
    memory_ = clCreateBuffer(context.handle(), CL_MEM_READ_WRITE | where, bytes_, nullptr, &status);
    check(status, "clCreateBuffer");
    context.counters().buffers_created++;
    const std::vector<char> zeros(bytes_, 0);
    context.write(Queue::Inline, *this, zeros.data(), bytes_);
    context.finish(Queue::Inline);
}

Buffer::Buffer(Context& context, void* host, std::size_t bytes) : id_(next_buffer())
{
    if (!context.on_cpu() || bytes == 0) {
        *this = Buffer(context, bytes);
        if (bytes > 0) pinned_ = context.pin(host, bytes);
        return;
    }
    bytes_ = bytes;
    host_ = host;
    cl_int status = CL_SUCCESS;
    memory_ = clCreateBuffer(context.handle(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes_, host, &status);
    check(status, "clCreateBuffer");
    context.counters().buffers_created++;
}

Buffer::~Buffer()
{
    for (const cl_mem memory : {memory_, pinned_})
        if (memory) clReleaseMemObject(memory);
}

Buffer::Buffer(Buffer&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)),
      pinned_(std::exchange(other.pinned_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      host_(std::exchange(other.host_, nullptr)),
      id_(std::exchange(other.id_, 0))
{
}

Buffer& Buffer::operator=(Buffer&& other) noexcept
{
    std::swap(memory_, other.memory_);
    std::swap(pinned_, other.pinned_);
    std::swap(bytes_, other.bytes_);
    std::swap(host_, other.host_);
    std::swap(id_, other.id_);
    return *this;
}

namespace {

// PoCL 3.1 keeps one table of loaded kernels for the whole process and loses count of their users when two threads launch the
// same kernel at once (abort in pocl_release_dlhandle_cache). With more than one context alive launches take turns: none begins
// before the one before has ended.
std::mutex launching;
std::vector<Context*> alive;  // under `launching`

}  // namespace

Context::Context(int index, bool float32) : float32_(float32)
{
    const auto all = all_devices();
    if (all.empty())
        throw Error(
            ErrorKind::NoDevice,
            "no OpenCL device was found; install one, for example `apt-get install pocl-opencl-icd`, or in a Python environment "
            "`pip install 'seldinger[cpu]'`");
    check_device_index(index);
    cl_device_id heavy = all[index < 0 ? default_device(all) : index];
    cl_device_id light = heavy;
    const PoclDevice of_pocl = pocl_device(heavy);
    if (index < 0 && of_pocl == PoclDevice::Pool)
        for (cl_device_id other : all)
            if (pocl_device(other) == PoclDevice::Caller) light = other;
    if (thread_count() == 1) heavy = light;  // a pool of one would only be handed what the caller can do
    cl_device_type type = 0;
    CL_CHECK(clGetDeviceInfo(heavy, CL_DEVICE_TYPE, sizeof type, &type, nullptr));
    const bool cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
    cpu_ = cpu && !asked_own_memory();
    single_items_ = cpu && platform_name(heavy) != "rusticl";
    sees_host_ = cpu_ && of_pocl != PoclDevice::None;
    // else division and square root in float may be off by a few units in the last place, and results are another device's no
    // more
    cl_device_fp_config single = 0;
    clGetDeviceInfo(heavy, CL_DEVICE_SINGLE_FP_CONFIG, sizeof single, &single, nullptr);
    if (!cpu && (single & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)) rounding_ = " -cl-fp32-correctly-rounded-divide-sqrt";
    name_ = device_text(heavy, CL_DEVICE_NAME);
    if (!float32 && device_text(heavy, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") == std::string::npos)
        throw Error(ErrorKind::NoDevice,
                    fmt::format("device \"{}\": got no double precision (cl_khr_fp64); expected it for contact.precision = "
                                "\"float64\". Fix: set contact.precision = \"float32\", or choose another device with --device "
                                "(`seldinger devices` lists them).",
                                name_));

    std::vector<cl_device_id> devices = {heavy};
    if (light != heavy) devices.push_back(light);
    shared_ = &SharedContext::of(devices);
    cl_int status = CL_SUCCESS;
    const cl_command_queue_properties timed = profiling() ? CL_QUEUE_PROFILING_ENABLE : 0;
    queues_[1] = clCreateCommandQueue(shared_->handle(), heavy, timed, &status);
    check(status, "clCreateCommandQueue");
    queues_[0] = light == heavy ? queues_[1] : clCreateCommandQueue(shared_->handle(), light, timed, &status);
    check(status, "clCreateCommandQueue");
    const std::lock_guard<std::mutex> turn(launching);
    for (Context* other : alive) {  // who was alone until now has not waited for its last launches
        other->finish(Queue::Inline);
        other->finish(Queue::Pool);
    }
    alive.push_back(this);
}

Context::~Context()
{
    {
        const std::lock_guard<std::mutex> turn(launching);
        for (cl_command_queue queue : queues_) clFinish(queue);  // what is left of its launches is not the next one's to wait for
        std::erase(alive, this);
    }
    if (queues_[0] && queues_[0] != queues_[1]) clReleaseCommandQueue(queues_[0]);
    if (queues_[1]) clReleaseCommandQueue(queues_[1]);
}

cl_context Context::handle() const { return shared_->handle(); }

void Context::enter(Queue queue)
{
    if (queue != queue_ && queues_[0] != queues_[1]) finish(queue_);
    queue_ = queue;
}

void Context::write(Queue queue, const Buffer& to, const void* source, std::size_t bytes, std::size_t offset)
{
    if (bytes == 0) return;
    SEL_ASSERT(offset + bytes <= to.bytes());
    if (sees_host_ && to.host() && static_cast<const char*>(to.host()) + offset == source) return;
    const auto start = profiling() ? Clock::now() : Clock::time_point();
    CL_CHECK(clEnqueueWriteBuffer(command_queue(queue), to.handle(), CL_FALSE, offset, bytes, source, 0, nullptr, nullptr));
    counters_.writes++;
    if (profiling()) note_written(bytes, seconds_since(start));
}

void Context::read(Queue queue, const Buffer& from, void* target, std::size_t bytes, std::size_t offset)
{
    if (bytes == 0) return;
    SEL_ASSERT(offset + bytes <= from.bytes());
    const auto start = profiling() ? Clock::now() : Clock::time_point();
    CL_CHECK(clEnqueueReadBuffer(command_queue(queue), from.handle(), CL_TRUE, offset, bytes, target, 0, nullptr, nullptr));
    counters_.reads++;
    if (profiling()) note_read(bytes, seconds_since(start));
}

void Context::copy(Queue queue, const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t offset)
{
    if (bytes == 0) return;
    SEL_ASSERT(offset + bytes <= from.bytes() && offset + bytes <= to.bytes());
    CL_CHECK(clEnqueueCopyBuffer(command_queue(queue), from.handle(), to.handle(), offset, offset, bytes, 0, nullptr, nullptr));
}

cl_mem Context::pin(void* host, std::size_t bytes)
{
    cl_int status = CL_SUCCESS;
    const cl_mem memory = clCreateBuffer(handle(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, host, &status);
    check(status, "clCreateBuffer");
    // mapped for good: the host may use its memory all the while
    (void)clEnqueueMapBuffer(queues_[0], memory, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes, 0, nullptr, nullptr, &status);
    check(status, "clEnqueueMapBuffer");
    return memory;
}

void Context::finish(Queue queue) { CL_CHECK(clFinish(command_queue(queue))); }

void Context::enqueue(Queue queue, cl_kernel kernel, std::size_t items, std::size_t workgroup, bool first)
{
    if (first) {
        cl_device_id device = nullptr;
        CL_CHECK(clGetCommandQueueInfo(command_queue(queue), CL_QUEUE_DEVICE, sizeof device, &device, nullptr));
        return shared_->first_launch(kernel, device, [&] {
            enqueue(queue, kernel, items, workgroup, false);
            finish(queue);
        });
    }
    const std::size_t global = (items + workgroup - 1) / workgroup * workgroup;
    const std::lock_guard<std::mutex> turn(launching);
    cl_event event = nullptr;
    const bool timed = profiling();
    CL_CHECK(clEnqueueNDRangeKernel(command_queue(queue), kernel, 1, nullptr, &global, &workgroup, 0, nullptr,
                                    timed ? &event : nullptr));
    if (timed) note_launch(kernel, items, workgroup, event);
    if (alive.size() > 1) CL_CHECK(clFinish(command_queue(queue)));
    counters_.launches++;
}

std::size_t Context::workgroup(Items items) const
{
    if (asked_workgroup() > 0) return asked_workgroup();
    return single_items_ && items == Items::Branching ? 1 : 64;
}

cl_program Context::program(const std::string& file, std::size_t workgroup, const std::string& defines)
{
    for (const auto& [known_file, known_size, known_defines, program] : programs_)
        if (known_file == file && known_size == workgroup && known_defines == defines) return program;
    const std::string options =
        fmt::format("-cl-std=CL1.2 -DSEL_WORKGROUP={}{}{}{}", workgroup, float32_ ? " -DSEL_FLOAT32" : "", rounding_, defines);
    const auto [program, fresh] = shared_->program(file, assemble_source(file), options);
    if (fresh) counters_.programs_built++;
    programs_.emplace_back(file, workgroup, defines, program);
    return program;
}

Kernel::Kernel(Context& context, const std::string& file, const char* name, Items items, const std::string& defines)
    : context_(&context), workgroup_(context.workgroup(items))
{
    cl_int status = CL_SUCCESS;
    kernel_ = clCreateKernel(context.program(file, workgroup_, defines), name, &status);
    check(status, "clCreateKernel");
}

Kernel::~Kernel()
{
    if (kernel_) clReleaseKernel(kernel_);
}

Kernel::Kernel(Kernel&& other) noexcept
    : context_(other.context_),
      kernel_(std::exchange(other.kernel_, nullptr)),
      workgroup_(other.workgroup_),
      launched_{other.launched_[0], other.launched_[1]},
      arguments_(std::move(other.arguments_))
{
}

Kernel& Kernel::operator=(Kernel&& other) noexcept
{
    std::swap(context_, other.context_);
    std::swap(kernel_, other.kernel_);
    std::swap(workgroup_, other.workgroup_);
    std::swap(launched_, other.launched_);
    std::swap(arguments_, other.arguments_);
    return *this;
}

void Kernel::set(cl_uint index, const void* value, std::size_t size, const void* seen, std::size_t seen_size)
{
    if (index >= arguments_.size()) arguments_.resize(index + 1);
    Argument& last = arguments_[index];
    if (last.size == seen_size && std::memcmp(last.bytes, seen, seen_size) == 0) return;
    last.size = seen_size;
    std::memcpy(last.bytes, seen, seen_size);
    CL_CHECK(clSetKernelArg(kernel_, index, size, value));
}

}  // namespace seldinger::device
