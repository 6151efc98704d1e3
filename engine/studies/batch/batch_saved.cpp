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

struct Writer {
    std::vector<std::uint8_t> bytes;

    template <class T>
    void operator()(const T& value)
    {
        put_bytes(bytes, &value, 1);
    }
    void operator()(const std::string& text)
    {
        (*this)(std::uint64_t{text.size()});
        put_bytes(bytes, text.data(), text.size());
    }
    void operator()(const std::vector<std::string>& texts)
    {
        (*this)(std::uint64_t{texts.size()});
        for (const std::string& text : texts) (*this)(text);
    }
};

struct Reader {
    const std::uint8_t *at, *end;

    template <class T>
    void operator()(T& value)
    {
        take_bytes(at, end, &value, 1);
    }
    void operator()(bool& flag)
    {
        std::uint8_t byte = 0;
        take_bytes(at, end, &byte, 1);
        if (byte > 1) throw Error(ErrorKind::BadFile, "is corrupt: a value is out of range");
        flag = byte == 1;
    }
    void operator()(std::string& text)
    {
        text.resize(count());
        take_bytes(at, end, text.data(), text.size());
    }
    void operator()(std::vector<std::string>& texts)
    {
        for (std::size_t left = count(); left > 0; --left) (*this)(texts.emplace_back());
    }

private:
    std::size_t count()
    {
        std::uint64_t n = 0;
        (*this)(n);
        if (n > static_cast<std::uint64_t>(end - at)) throw Error(ErrorKind::BadFile, "a list is longer than the file");
        return n;
    }
};

/// What stands before the rows.
template <class Saved>
void each_field(Saved& s, auto& take)
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
    Writer writer;
    writer(std::string(version()));
    each_field(saved, writer);
    put_rows(writer.bytes, saved.rows);
    if (saved.open) put_world(writer.bytes);
    write_sealed(file, magic, writer.bytes);
}

SavedBatch read_saved(const FilePlace& file, std::vector<std::uint8_t>& world)
{
    const std::vector<std::uint8_t> bytes = read_sealed(file, magic);
    Reader reader{bytes.data(), bytes.data() + bytes.size()};
    SavedBatch saved;
    try {
        std::string writer;
        reader(writer);
        if (writer != version())
            throw Error(ErrorKind::BadFile,
                        fmt::format("was written by version {}, this is {}; take that one", writer, version()));
        each_field(saved, reader);
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
