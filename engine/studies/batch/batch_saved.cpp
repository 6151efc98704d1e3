// Bytes of a saved batch, and back from a file of unknown origin.
#include "batch/batch_saved.h"

#include "core/bytes.h"
#include "core/sealed_file.h"
#include "engine.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {
namespace {

constexpr std::string_view magic = "SELBATCA";
constexpr std::uint64_t most_rows = 10'000'000;  // beyond what any sweep has, and little enough to be listed in memory

/// What stands before the rows.
template <class Saved>
void each_head_field(Saved& s, auto& take)
{
    take(s.device), take(s.scene), take(s.sweep), take(s.name), take(s.seed), take(s.instruments);
    take(s.layout.instruments), take(s.layout.task), take(s.layout.bands), take(s.layout.runs), take(s.layout.target);
    take(s.layout.patch), take(s.layout.limits);
    take(s.begin), take(s.end), take(s.status), take(s.ramp), take(s.totals), take(s.at), take(s.open);
}

bool is_sound(const SavedBatch& s)
{
    const auto is_time = [](double seconds) { return seconds >= 0 && seconds < 1e12; };
    const auto is_count = [](std::int64_t count) { return count >= 0 && count <= std::int64_t{1} << 53; };
    static_assert(sizeof(StageTimes) % sizeof(double) == 0);
    const BatchTotals& sums = s.totals;
    const auto* stages = reinterpret_cast<const double*>(&sums.stages);
    return s.begin <= s.end && s.end <= most_rows && s.layout.instruments.size() <= s.instruments &&
           s.status >= RunStatus::Running && s.status <= RunStatus::Stopped && is_count(sums.wire_steps) &&
           is_count(sums.world_steps) && is_count(sums.resumes) && is_time(sums.wall) &&
           std::all_of(stages, stages + sizeof(StageTimes) / sizeof(double), is_time) &&
           are_sound(s.rows, s.begin, s.end, s.instruments) && (s.status != RunStatus::Done || s.rows.size() == s.end - s.begin);
}

}  // namespace

void write_saved(const FilePlace& file, const SavedBatch& saved, const std::function<void(std::vector<std::uint8_t>&)>& put_world)
{
    std::vector<std::uint8_t> bytes;
    ByteWriter put{bytes};
    put(std::string(version()));
    each_head_field(saved, put);
    put_rows(bytes, saved.rows);
    if (saved.open) put_world(bytes);
    write_sealed(file, magic, bytes);
}

SavedBatch read_saved(const FilePlace& file, std::vector<std::uint8_t>& world)
{
    const std::vector<std::uint8_t> bytes = read_sealed(file, magic);
    ByteReader reader{bytes.data(), bytes.data() + bytes.size()};
    SavedBatch saved;
    try {
        std::string writer;
        reader(writer);
        if (writer != version())
            throw Error(ErrorKind::BadFile,
                        fmt::format("was written by version {}, this is {}; take that one", writer, version()));
        each_head_field(saved, reader);
        saved.rows = take_rows(reader.at, reader.end);
        if (!is_sound(saved)) throw Error(ErrorKind::BadFile, "is corrupt: a value is out of range");
        if (!saved.open && reader.at != reader.end) throw Error(ErrorKind::BadFile, "has data after its end");
    } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("{}: {}; run again with --overwrite", file.path().string(), error.what()));
    }
    world.assign(reader.at, reader.end);
    return saved;
}

}  // namespace seldinger
