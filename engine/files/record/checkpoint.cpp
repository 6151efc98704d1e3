// Packs a run's state, tally and file sizes into checkpoint.bin and checks every length on the way back.
#include "record/checkpoint.h"

#include "core/bytes.h"
#include "core/fnv1a.h"
#include "core/printable.h"
#include "core/sealed_file.h"
#include "scene/scene_difference.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <span>

namespace seldinger {
namespace {

constexpr std::string_view checkpoint_magic = "SELCKPT5";

/// What stands behind the version.
template <class C>
void each_field(C& c, auto& take)
{
    take(c.device), take(c.scene), take(c.vessel_hash), take(c.status), take(c.tally), take(c.trace_bytes);
    take(c.wire_frames), take(c.contact_frames), take(c.state);
}

void take_payload(ByteReader take, Checkpoint& c)
{
    take(c.version);
    // what follows is laid out as this version's structures are
    if (c.version != version())
        throw Error(ErrorKind::BadFile,
                    fmt::format("was written by version {}, this is {}; resume with that one, or run again with --overwrite",
                                printable(c.version), version()));
    each_field(c, take);
    if (take.at != take.end) throw Error(ErrorKind::BadFile, "has data after its end; run again with --overwrite");
}

constexpr std::int64_t most_counted = std::int64_t{1} << 53;

bool is_time(double seconds) { return seconds >= 0 && seconds < 1e12; }

bool is_place(const double* at) { return std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]); }

/// Whether all numbers of a struct that has nothing else are sound.
template <class Number, class T>
bool all_of(const T& numbers, bool (*is_sound)(Number))
{
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(Number) == 0 && alignof(T) == alignof(Number));
    const std::span list(reinterpret_cast<const Number*>(&numbers), sizeof(T) / sizeof(Number));
    return std::all_of(list.begin(), list.end(), is_sound);
}

bool is_count(std::int64_t n) { return n >= 0 && n <= most_counted; }

bool is_sum(double value) { return std::isfinite(value) && value >= 0; }

bool is_real(double value) { return std::isfinite(value); }

bool is_sound(const LoadTally& t)
{
    return all_of<double>(static_cast<const LoadNumbers&>(t), is_sum) && is_count(t.regions) && t.widened <= 1;
}

bool is_sound(const Greatest& g)
{
    return is_sum(g.value) && is_place(g.at) && is_time(g.time) && all_of<double>(g.band, is_sum);
}

bool is_sound(const EndTouch& t)
{
    return is_count(t.rows) && t.wire >= 0 && is_time(t.time) && is_place(t.tip);
}

bool is_sound(const ExitTally& t)
{
    if (t.count < 0 || t.count > ExitTally::most_exits) return false;
    for (int w = 0; w < ExitTally::most_wires; ++w)
        if (t.seen[w] > 1 || !is_place(t.tip[w]) ||
            (t.seen[w] == 0 && (t.tip[w][0] != 0 || t.tip[w][1] != 0 || t.tip[w][2] != 0)))
            return false;
    for (int k = 0; k < t.count; ++k) {
        const ExitTally::Exit& exit = t.exit[k];
        const bool known = exit.wire >= 0 && exit.wire < ExitTally::most_wires && exit.opening >= 0;
        if (!known || !is_time(exit.left) || !is_time(exit.back)) return false;
    }
    for (int k = t.count; k < ExitTally::most_exits; ++k)
        if (t.exit[k].wire != 0 || t.exit[k].opening != 0 || t.exit[k].left != 0 || t.exit[k].back != 0) return false;
    return true;
}

}  // namespace

bool is_sound(const ScoreNumbers& s)
{
    return all_of<double>(static_cast<const ScoreSums&>(s), is_sum) &&
           all_of<double>(static_cast<const ScoreReals&>(s), is_real) && s.direction >= -1 && s.direction <= 1 &&
           s.reached <= 1 && s.failed <= 1 && s.has_tip <= 1 && s.begun <= 1;
}

bool is_sound(const RunTally& t, std::int64_t most)
{
    return all_of<std::int64_t>(static_cast<const TallyCounts&>(t), is_count) &&
           all_of<double>(static_cast<const TallySums&>(t), is_sum) && is_sound(t.wall_move) && is_sound(t.wall_stress) &&
           is_sound(t.on_wall) && is_sound(t.on_instruments) && is_place(t.overlap_at) && is_sound(t.exits) &&
           is_sound(t.score) && t.end.is_sound() && is_sound(t.end_touch) && t.steps <= most && t.rest_steps <= t.steps &&
           t.row_steps <= t.steps;
}

namespace {

bool sound(const std::vector<FrameMark>& frames, const RunTally& tally)
{
    for (std::size_t k = 0; k < frames.size(); ++k)
        if (frames[k].step < 0 || frames[k].step > tally.steps || (k > 0 && frames[k].step <= frames[k - 1].step) ||
            !is_time(frames[k].time))
            return false;
    return true;
}

}  // namespace

void check_checkpoint(const std::filesystem::path& path, const Checkpoint& c, const Scene& of, const std::string& scene)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorKind::BadFile, fmt::format("{}: {}; run again with --overwrite", path.string(), why));
    };
    if (c.scene != scene) refuse("is of another scene, " + first_difference(c.scene, scene));
    if (c.status < RunStatus::Running || c.status > RunStatus::Stopped) refuse("has an unknown status");
    if (!is_sound(c.tally, of.steps())) refuse("is corrupt: a counter is out of range");
    for (int k = 0; k < c.tally.exits.count; ++k)
        if (c.tally.exits.exit[k].wire >= of.instrument_count()) refuse("is corrupt: an instrument index is out of range");
    if (c.tally.end_touch.wire >= of.instrument_count()) refuse("is corrupt: an instrument index is out of range");
    if (!sound(c.wire_frames, c.tally) || !sound(c.contact_frames, c.tally)) refuse("is corrupt: a frame number is out of range");
    int tables = 1;
    for (int k = 0; k < of.instrument_count(); ++k) tables += of.instrument(k).label.empty() ? 0 : 1;
    if (c.trace_bytes.size() < static_cast<std::size_t>(tables)) refuse("belongs to a scene with other tables");
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& c)
{
    std::vector<std::uint8_t> payload;
    ByteWriter put{payload};
    put(c.version);
    each_field(c, put);
    write_sealed(path, checkpoint_magic, payload);
}

Checkpoint read_checkpoint(const std::filesystem::path& path)
{
    const std::vector<std::uint8_t> payload = read_sealed(path, checkpoint_magic);
    Checkpoint checkpoint;
    try {
        take_payload({payload.data(), payload.data() + payload.size()}, checkpoint);
    } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("{}: {}", path.string(), error.what()));
    }
    return checkpoint;
}

std::uint64_t hash_of(const WallMesh& mesh)
{
    std::uint64_t hash = fnv1a(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
    return fnv1a(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), hash);
}

}  // namespace seldinger
