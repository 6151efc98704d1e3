// Peak rates of a device, by kernels that do nothing else.

#include "roofline/peaks.h"

#include "device/kernel_sources.h"

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace seldinger::device {

const std::vector<KernelSource>& bench_kernels();  // generated, cmake/EmbedKernels.cmake

namespace {

const char* const file = "roofline/peaks.cl";
constexpr std::size_t fma_items = 1u << 14;
constexpr double fma_operations = 2.0 * 8 * 128;  // per item and component, as in peaks.cl
constexpr double least_time = 2e-3;               // [s], a hundred times the resolution that matters

using Clock = std::chrono::steady_clock;

/// The best of the vector widths: a processor wants a cache line an item, a graphics card 16 bytes.
double triad(Context& context, Queue queue, std::size_t bytes, int repeats, double launch)
{
    constexpr std::size_t widest = 16 * sizeof(float) * 1024;  // whole work-groups of any size
    const std::size_t size = std::max<std::size_t>(bytes / 3 / widest, 1) * widest;
    const Buffer a(context, size), b(context, size), c(context, size);
    double best = 0;
    for (const std::size_t width : {1, 4, 16}) {
        Kernel kernel(context, file, ("peak_triad_float" + (width > 1 ? std::to_string(width) : "")).c_str(), Items::Short);
        const double time = median_time(
            [&] {
                kernel.launch(queue, size / sizeof(float) / width, a, b, c, 0.5f);
                context.finish(queue);
            },
            repeats, least_time, 0);
        best = std::max(best, 3.0 * static_cast<double>(size) / std::max(time - launch, time / 10));
    }
    return best;
}

double fma_rate(Context& context, Queue queue, const std::string& type, int width, std::size_t size, int repeats)
{
    const Buffer out(context, fma_items * static_cast<std::size_t>(width) * size);
    Kernel kernel(context, file, ("peak_fma_" + type + (width > 1 ? std::to_string(width) : "")).c_str(), Items::Short);
    const double time = median_time(
        [&] {
            kernel.launch(queue, fma_items, out, 0.999f);
            context.finish(queue);
        },
        repeats, least_time, 0);
    return fma_operations * width * static_cast<double>(fma_items) / time;
}

}  // namespace

double median_time(const std::function<void()>& call, int repeats, double least, double rank)
{
    call();  // the first launch of a kernel compiles it
    long calls = 1;
    std::vector<double> times;
    while (static_cast<int>(times.size()) < repeats) {
        const auto start = Clock::now();
        for (long k = 0; k < calls; ++k) call();
        const double time = std::chrono::duration<double>(Clock::now() - start).count();
        if (time < least && calls < 1000000) {
            calls = std::max(2 * calls,
                             static_cast<long>(static_cast<double>(calls) * std::min(100.0, 1.2 * least / std::max(time, 1e-9))));
            times.clear();
            continue;
        }
        times.push_back(time / static_cast<double>(calls));
    }
    std::sort(times.begin(), times.end());
    return times[static_cast<std::size_t>(rank * (repeats - 1) + 0.5)];
}

Peaks measure_peaks(Context& context, Queue queue, int repeats, int mega_bytes)
{
    device::add_kernel_sources(device::bench_kernels());
    Peaks peaks;
    peaks.queue = queue == Queue::Inline ? "light" : "heavy";
    context.enter(queue);
    const Buffer data(context, 4096);
    std::vector<char> host(4096, 0);
    Kernel nothing(context, file, "peak_nothing", Items::Short);
    peaks.launch = median_time(
        [&] {
            nothing.launch(queue, 1, std::uint32_t{0}, data);
            context.finish(queue);
        },
        repeats, least_time);
    const std::size_t memory = static_cast<std::size_t>(mega_bytes) << 20;
    peaks.bandwidth = triad(context, queue, memory, repeats, 0);
    peaks.cached_bandwidth = triad(context, queue, 384 << 10, repeats, peaks.launch);
    for (const int width : {1, 4, 8, 16}) {
        const double rate = fma_rate(context, queue, "float", width, 4, repeats);
        if (width == 1) peaks.scalar_float = rate;
        if (rate > peaks.flops_float) peaks.flops_float = rate, peaks.width_float = width;
    }
    if (!context.float32()) {
        for (const int width : {1, 2, 4, 8}) {
            const double rate = fma_rate(context, queue, "double", width, 8, repeats);
            if (width == 1) peaks.scalar_double = rate;
            if (rate > peaks.flops_double) peaks.flops_double = rate, peaks.width_double = width;
        }
    }

    constexpr int chain = 64;
    const double chained = median_time(
        [&] {
            for (int k = 0; k < chain; ++k) nothing.launch(queue, 1, std::uint32_t{0}, data);
            context.finish(queue);
        },
        repeats, least_time);
    peaks.chained = (chained - peaks.launch) / (chain - 1);
    peaks.round_trip = median_time(
        [&] {
            context.write(queue, data, host.data(), host.size());
            nothing.launch(queue, 1, std::uint32_t{0}, data);
            context.read(queue, data, host.data(), host.size());
        },
        repeats, least_time);
    return peaks;
}

}  // namespace seldinger::device
