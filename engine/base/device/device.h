#pragma once
// The only C++ that names OpenCL: devices, a context with its queues, buffers, programs and launches.
//
// On PoCL the context holds two devices on the same buffers: its pool (15 us a launch, all cores) and the caller's thread (0.35
// us). A chain of launches goes to one of them, chosen by the amount of work alone (never by measured time or thread count), and
// ends with one blocking read. Results are the same bits on both.

#include "core/check.h"

#include <CL/cl.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace seldinger::device {

/// Throws Error(NoDevice) naming the call, the OpenCL error and the device.
void check(cl_int status, const char* call);
#define CL_CHECK(call) ::seldinger::device::check((call), #call)
/// OpenCL's own name for it.
[[nodiscard]] const char* error_name(cl_int status);

/// What the step loop did on the device, counted to prove that it neither allocates nor builds.
struct Counters {
    std::uint64_t launches = 0, reads = 0, writes = 0, buffers_created = 0, programs_built = 0;
};

class Context;
class SharedContext;

/// Device memory of fixed size, zero-filled. Grows only through a new Buffer.
class Buffer {
public:
    Buffer() = default;
    Buffer(Context& context, std::size_t bytes);
    /// On a CPU the host's memory itself: to write() it from where it is, or to read() it back to there, copies nothing.
    /// Elsewhere memory of the device's own, and copies between the two go without a detour (5 times as fast over PCIe 5).
    /// @param host  of `bytes`, which outlives the buffer
    Buffer(Context& context, void* host, std::size_t bytes);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    [[nodiscard]] cl_mem handle() const { return memory_; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    /// The host's memory where the buffer is made of it; else nullptr.
    [[nodiscard]] const void* host() const { return host_; }
    /// No other buffer of the process has or had it: handles of OpenCL are given out again.
    [[nodiscard]] std::uint64_t id() const { return id_; }

private:
    cl_mem memory_ = nullptr, pinned_ = nullptr;  // pinned_: the host's memory, known to the driver of a device with its own
    std::size_t bytes_ = 0;
    const void* host_ = nullptr;
    std::uint64_t id_ = 0;
};

/// Which queue a chain of launches goes to.
enum class Queue { Inline, Pool };

/// What a kernel's items are like. Branching: long, each with its own path (walks, contact laws). On a CPU one item is a
/// work-group, because private arrays of many items at once stay neither in registers nor in the first cache (1/6 of the time of
/// an evaluation).
/// Short: vector loops and queries of half a microsecond, the cost of a separate group.
enum class Items { Branching, Short };

class Context {
public:
    /// @param index  as listed by list_devices(); -1: PoCL's CPU pair where present, of which one thread (core/parallel.h) takes
    /// `basic` alone; else the first suitable device
    /// @param float32  build kernels for `float` arithmetic
    explicit Context(int index = -1, bool float32 = false);
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Copies without waiting: `source` must stay as it is until the next read() or finish() on the queue. PoCL's kernels see
    /// memory of the host as it is: a buffer made of `source` is not written, which would take half a microsecond.
    void write(Queue queue, const Buffer& to, const void* source, std::size_t bytes, std::size_t offset = 0);
    /// Copies and waits for everything enqueued on the queue before.
    void read(Queue queue, const Buffer& from, void* target, std::size_t bytes, std::size_t offset = 0);
    void copy(Queue queue, const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t offset = 0);
    void finish(Queue queue);
    /// Memory of the host that the driver may copy from and to directly; it must outlive the returned object.
    [[nodiscard]] cl_mem pin(void* host, std::size_t bytes);
    /// Waits for the other queue when the queue changes, so that buffers written there are seen here.
    void enter(Queue queue);

    /// Builds the .cl file (name relative to kernels/) for work-groups of that size, once per process (shared_context.h).
    /// @param defines  further compiler options, as " -DNAME"
    [[nodiscard]] cl_program program(const std::string& file, std::size_t workgroup, const std::string& defines = "");
    [[nodiscard]] cl_program program(const std::string& file) { return program(file, workgroup(Items::Branching)); }
    /// Items of a work-group for kernels of this sort.
    [[nodiscard]] std::size_t workgroup(Items items) const;
    /// @param first  of this kernel on this queue: it may be compiled here
    void enqueue(Queue queue, cl_kernel kernel, std::size_t items, std::size_t workgroup, bool first = false);

    [[nodiscard]] cl_context handle() const;
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool float32() const { return float32_; }
    /// Whether the device works in the host's memory.
    [[nodiscard]] bool on_cpu() const { return cpu_; }
    /// Whether the queues are two devices; else both name the same queue.
    [[nodiscard]] bool two_queues() const { return queues_[0] != queues_[1]; }
    [[nodiscard]] Counters& counters() { return counters_; }

private:
    [[nodiscard]] cl_command_queue command_queue(Queue queue) const { return queues_[queue == Queue::Inline ? 0 : 1]; }
    SharedContext* shared_ = nullptr;
    cl_command_queue queues_[2] = {nullptr, nullptr};  // light, heavy; the same queue on one device
    std::vector<std::tuple<std::string, std::size_t, std::string, cl_program>> programs_;  // file, work-group size, defines
    std::string name_;
    std::string rounding_;  // compiler option
    bool float32_ = false, cpu_ = false;
    bool sees_host_ = false;  // kernels see what the host writes to its memory without a copy
    // Branching items are groups of their own. Not in Mesa's rusticl on the CPU: its vectors hold eight items, and in a group of
    // one (Mesa 22.3) loops within loops end early for the only item, without an error.
    bool single_items_ = false;
    Queue queue_ = Queue::Inline;
    Counters counters_;
};

/// One kernel with its fixed work-group size. Arguments are given at every launch, in order; those that have not changed are not
/// set again.
class Kernel {
public:
    Kernel() = default;
    Kernel(Context& context, const std::string& file, const char* name, Items items = Items::Branching,
           const std::string& defines = "");
    ~Kernel();
    Kernel(Kernel&& other) noexcept;
    Kernel& operator=(Kernel&& other) noexcept;

    /// Enqueues over `items` work-items (rounded up to the work-group size); nothing for 0 items. A type with
    /// for_each_argument(f) is a group of kernel arguments (contact/device_views.h): f is called with each.
    template <class... Args>
    void launch(Queue queue, std::size_t items, const Args&... args)
    {
        if (items == 0) return;
        cl_uint index = 0;
        (set_next(index, args), ...);
        context_->enqueue(queue, kernel_, items, workgroup_, !std::exchange(launched_[queue == Queue::Inline ? 0 : 1], true));
    }

private:
    template <class T>
    void set_next(cl_uint& index, const T& argument)
    {
        if constexpr (requires { argument.for_each_argument([](const auto&) {}); })
            argument.for_each_argument([&](const auto& part) { set(index++, part); });
        else set(index++, argument);
    }
    void set(cl_uint index, const Buffer& buffer)
    {
        const cl_mem memory = buffer.handle();
        const std::uint64_t id = buffer.id();
        set(index, &memory, sizeof memory, &id, sizeof id);  // NOLINT(bugprone-sizeof-expression): the handle
    }
    template <class T>
    void set(cl_uint index, const T& value)
    {
        static_assert(sizeof value <= sizeof(Argument::bytes));
        set(index, &value, sizeof value, &value, sizeof value);
    }
    /// @param seen,seen_size  by which a value is known to be that of the last launch
    void set(cl_uint index, const void* value, std::size_t size, const void* seen, std::size_t seen_size);

    /// What an argument was last set to: bytes of a value, or the id of a buffer.
    struct Argument {
        std::size_t size = 0;
        std::byte bytes[96];
    };
    Context* context_ = nullptr;
    cl_kernel kernel_ = nullptr;
    std::size_t workgroup_ = 1;
    bool launched_[2] = {false, false};  // on each queue
    std::vector<Argument> arguments_;
};

/// The text that the OpenCL compiler is given for a kernel file: includes replaced by their text, once each.
[[nodiscard]] std::string assemble_source(const std::string& file);

}  // namespace seldinger::device
