// Records narrowed for a float32 device, and widened again.

#include "contact/device_records.h"

#include <bit>
#include <cstring>

namespace seldinger {

namespace {

/// One record to `out`. @return where the next one begins
const char* narrow_record(std::span<const WordRun> runs, const char* at, std::uint32_t*& out)
{
    for (const WordRun& run : runs)
        for (int i = 0; i < run.count; ++i) {
            if (run.reals) {
                double value;
                std::memcpy(&value, at, sizeof value);
                *out++ = std::bit_cast<std::uint32_t>(static_cast<float>(value));
                at += sizeof value;
            } else {
                std::memcpy(out++, at, sizeof(std::uint32_t));
                at += sizeof(std::uint32_t);
            }
        }
    return at;
}

}  // namespace

void narrow_words(std::span<const WordRun> runs, const void* from, std::size_t records, std::vector<std::uint32_t>& to)
{
    std::size_t words = 0;
    for (const WordRun& run : runs) words += run.count;
    to.resize(records * words);
    const char* at = static_cast<const char*>(from);
    std::uint32_t* out = to.data();
    for (std::size_t k = 0; k < records; ++k) at = narrow_record(runs, at, out);
}

void widen_words(std::span<const WordRun> runs, const std::uint32_t* from, std::size_t records, void* to)
{
    char* at = static_cast<char*>(to);
    for (std::size_t k = 0; k < records; ++k)
        for (const WordRun& run : runs)
            for (int i = 0; i < run.count; ++i) {
                if (run.reals) {
                    const double value = static_cast<double>(std::bit_cast<float>(*from++));
                    std::memcpy(at, &value, sizeof value);
                    at += sizeof value;
                } else {
                    std::memcpy(at, from++, sizeof(std::uint32_t));
                    at += sizeof(std::uint32_t);
                }
            }
}

NarrowParams narrow(const ContactParams& par)
{
    NarrowParams narrowed;
    std::uint32_t* out = narrowed.words;
    (void)narrow_record(record_words<ContactParams>, reinterpret_cast<const char*>(&par), out);
    return narrowed;
}

}  // namespace seldinger
