#pragma once
// Records of kernels/shared as the device has them: in double as they stand; in a float32 context with every real narrowed, which
// is how the same structs are laid out when `real` is float. The host keeps double throughout.
//
// Positions are hi (float) + lo, so narrowing lo loses 6e-8 of 4 nm; edges and gaps are differences near the segment
// (portable.h).

#include "device/device.h"
#include "shared/clearance.h"
#include "shared/contact_types.h"
#include "shared/wall_memory.h"

#include <span>
#include <vector>

namespace seldinger {

/// A run of words of one kind in a record.
struct WordRun {
    int count;
    bool reals;
};
template <class Record>
inline constexpr int record_words = 0;
template <>
inline constexpr WordRun record_words<double>[] = {{1, true}};
template <>
inline constexpr WordRun record_words<QuadratureModel>[] = {{21, true}};
template <>
inline constexpr WordRun record_words<QuadraturePlace>[] = {{2, false}, {2, true}, {2, false}, {1, true}};
template <>
inline constexpr WordRun record_words<ContactState>[] = {{18, true}, {4, false}};
template <>
inline constexpr WordRun record_words<ContactForce>[] = {{65, true}, {2, false}};
template <>
inline constexpr WordRun record_words<MultiplierState>[] = {{9, true}, {2, false}};
template <>
inline constexpr WordRun record_words<EdgeForce>[] = {{86, true}, {2, false}};
template <>
inline constexpr WordRun record_words<Clearance>[] = {{8, true}};
template <>
inline constexpr WordRun record_words<WallMemory>[] = {{23, true}, {14, false}, {19, true}, {2, false}};
template <>
inline constexpr WordRun record_words<ContactParams>[] = {{8, false}, {3, true}};

/// Words of a record on a float32 device, and its bytes on the host.
[[nodiscard]] constexpr std::size_t words_of(std::span<const WordRun> runs)
{
    std::size_t words = 0;
    for (const WordRun& run : runs) words += static_cast<std::size_t>(run.count);
    return words;
}
[[nodiscard]] constexpr std::size_t bytes_of(std::span<const WordRun> runs)
{
    std::size_t bytes = 0;
    for (const WordRun& run : runs)
        bytes += static_cast<std::size_t>(run.count) * (run.reals ? sizeof(double) : sizeof(std::uint32_t));
    return bytes;
}
template <class Record>
constexpr std::size_t float_size()
{
    return words_of(record_words<Record>) * sizeof(float);
}

/// Size of a record on the device. A record that has grown needs its words above put right.
template <class Record>
[[nodiscard]] std::size_t device_size(const device::Context& context)
{
    static_assert(bytes_of(record_words<Record>) == sizeof(Record), "record_words does not describe this record");
    return context.float32() ? float_size<Record>() : sizeof(Record);
}

/// A buffer of the vector's own memory, where its records are the device's own: what the host writes costs nothing there. The
/// vector must outlive it and stay where it is.
/// @param count  of records, where the device has its own
template <class Record>
[[nodiscard]] device::Buffer record_buffer(device::Context& context, std::vector<Record>& host, std::size_t count)
{
    if (context.float32()) return device::Buffer(context, count * device_size<Record>(context));
    return device::Buffer(context, host.data(), count * sizeof(Record));
}

void narrow_words(std::span<const WordRun> runs, const void* from, std::size_t records, std::vector<std::uint32_t>& to);
void widen_words(std::span<const WordRun> runs, const std::uint32_t* from, std::size_t records, void* to);

/// Type of a record that goes to a kernel by value.
struct NarrowParams {
    std::uint32_t words[float_size<ContactParams>() / sizeof(std::uint32_t)];
};
[[nodiscard]] NarrowParams narrow(const ContactParams& par);

/// Writes records from the first-th on, narrowed where the context asks for it. `scratch` must stay as it is until the next
/// read() or finish() on the queue.
template <class Record>
void write_records(device::Context& context, device::Queue queue, const device::Buffer& to, const std::vector<Record>& from,
                   std::vector<std::uint32_t>& scratch, std::size_t first = 0)
{
    const std::size_t size = device_size<Record>(context);
    if (!context.float32()) return context.write(queue, to, from.data(), from.size() * size, first * size);
    narrow_words(record_words<Record>, from.data(), from.size(), scratch);
    context.write(queue, to, scratch.data(), scratch.size() * sizeof(std::uint32_t), first * size);
}

/// Reads `count` records from the first-th on, and waits.
template <class Record>
void read_records(device::Context& context, device::Queue queue, const device::Buffer& from, Record* to, std::size_t count,
                  std::size_t first, std::vector<std::uint32_t>& scratch)
{
    const std::size_t size = device_size<Record>(context);
    if (!context.float32()) return context.read(queue, from, to, count * size, first * size);
    scratch.resize(count * size / sizeof(std::uint32_t));
    context.read(queue, from, scratch.data(), count * size, first * size);
    widen_words(record_words<Record>, scratch.data(), count, to);
}

}  // namespace seldinger
