// Records narrowed for a float32 device, and widened again.
#include "contact/device_records.h"

#include "core/parallel.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace seldinger {
namespace {

// Records that one thread takes at a time, as words: 20 us of work for a hand-over of 1 us.
constexpr int piece_words = 1 << 14;

/// f(k) for each of many records of so many words, on all cores.
template <class F>
void for_each_record(std::size_t records, std::size_t words, const F& f)
{
    for_each_item(static_cast<int>(records), std::max(1, piece_words / static_cast<int>(words)),
                  [&](int k) { f(static_cast<std::size_t>(k)); });
}

void narrow_record(std::span<const WordRun> runs, const char* at, std::uint32_t* out)
{
    for (const WordRun& run : runs) {
        const auto count = static_cast<std::size_t>(run.count);
        if (run.reals) {
            const auto* values = reinterpret_cast<const double*>(at);
            for (std::size_t i = 0; i < count; ++i) out[i] = std::bit_cast<std::uint32_t>(static_cast<float>(values[i]));
            at += count * sizeof(double);
        } else {
            std::memcpy(out, at, count * sizeof(std::uint32_t));
            at += count * sizeof(std::uint32_t);
        }
        out += count;
    }
}

void widen_record(std::span<const WordRun> runs, const std::uint32_t* from, char* at)
{
    for (const WordRun& run : runs) {
        const auto count = static_cast<std::size_t>(run.count);
        if (run.reals) {
            auto* values = reinterpret_cast<double*>(at);
            for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(std::bit_cast<float>(from[i]));
            at += count * sizeof(double);
        } else {
            std::memcpy(at, from, count * sizeof(std::uint32_t));
            at += count * sizeof(std::uint32_t);
        }
        from += count;
    }
}

}  // namespace

void narrow_words(std::span<const WordRun> runs, const void* from, std::size_t records, std::vector<std::uint32_t>& to)
{
    const std::size_t words = words_of(runs), bytes = bytes_of(runs);
    to.resize(records * words);
    for_each_record(records, words, [&](std::size_t k) {
        narrow_record(runs, static_cast<const char*>(from) + k * bytes, to.data() + k * words);
    });
}

void widen_words(std::span<const WordRun> runs, const std::uint32_t* from, std::size_t records, void* to)
{
    const std::size_t words = words_of(runs), bytes = bytes_of(runs);
    for_each_record(records, words,
                    [&](std::size_t k) { widen_record(runs, from + k * words, static_cast<char*>(to) + k * bytes); });
}

NarrowParams narrow(const ContactParams& par)
{
    NarrowParams narrowed;
    narrow_record(record_words<ContactParams>, reinterpret_cast<const char*>(&par), narrowed.words);
    return narrowed;
}

}  // namespace seldinger
