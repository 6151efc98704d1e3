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
#include <initializer_list>
#include <span>

namespace seldinger {
namespace {

constexpr std::string_view checkpoint_magic = "SELCKPT4";

template <class T>
void put_list(std::vector<std::uint8_t>& bytes, const T& list)
{
    const std::uint64_t count = list.size();
    put_bytes(bytes, &count, 1);
    put_bytes(bytes, list.data(), list.size());
}

/// @throws Error BadFile when the list claims more than is left
template <class T>
void take_list(const std::uint8_t*& at, const std::uint8_t* end, T& list)
{
    std::uint64_t count = 0;
    take_bytes(at, end, &count, 1);
    if (count > static_cast<std::uint64_t>(end - at) / sizeof(typename T::value_type))
        throw Error(ExitCode::BadFile, "a list is longer than the file");
    list.resize(count);
    take_bytes(at, end, list.data(), count);
}

void take_payload(const std::uint8_t* at, const std::uint8_t* end, Checkpoint& c)
{
    take_list(at, end, c.version);
    // what follows is laid out as this version's structures are
    if (c.version != version())
        throw Error(ExitCode::BadFile,
                    fmt::format("was written by version {}, this is {}; resume with that one, or run again with --overwrite",
                                printable(c.version), version()));
    take_list(at, end, c.device);
    take_list(at, end, c.scene);
    take_bytes(at, end, &c.vessel_hash, 1);
    take_bytes(at, end, &c.status, 1);
    take_bytes(at, end, &c.tally, 1);
    take_list(at, end, c.trace_bytes);
    take_list(at, end, c.wire_frames);
    take_list(at, end, c.contact_frames);
    take_list(at, end, c.state);
    if (at != end) throw Error(ExitCode::BadFile, "has data after its end; run again with --overwrite");
}

constexpr std::int64_t most_counted = std::int64_t{1} << 53;

bool is_time(double seconds) { return seconds >= 0 && seconds < 1e12; }

bool is_place(const double* at) { return std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]); }

bool is_sound(const LoadTally& t)
{
    const auto values = {t.per_length, t.per_length_at, t.per_length_time, t.patch_force, t.patch_at,
                         t.patch_time, t.extent,        t.window,          t.patch};
    return t.regions >= 0 && t.regions <= most_counted && t.widened <= 1 &&
           std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value) && value >= 0; });
}

bool is_sound(const EndTouch& t)
{
    return t.rows >= 0 && t.rows <= most_counted && t.wire >= 0 && is_time(t.time) && is_place(t.tip);
}

bool is_sound(const ExitTally& t)
{
    if (t.count < 0 || t.count > ExitTally::most_exits) return false;
    for (int w = 0; w < ExitTally::most_wires; ++w)
        if (t.seen[w] > 1 || !is_place(t.tip[w]) || (t.seen[w] == 0 && (t.tip[w][0] != 0 || t.tip[w][1] != 0 || t.tip[w][2] != 0)))
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

bool is_sound(const RunTally& t, std::int64_t most)
{
    const auto counts = {t.steps,   t.contacts_max, t.newton_max, t.halved_steps, t.outside_steps, t.non_finite, t.resumes,
                         t.rest_steps, t.far_steps, t.row_newton, t.row_flags,    t.row_steps,     t.unequal_steps, t.missed_steps};
    const auto values = {t.friction_max,     t.overlap_max,          t.outside_max,    t.wall_move.value, t.wall_stress.value,
                         t.contact_area_max, t.contact_pressure_max, t.hand_force_max, t.overlap_share,
                         t.normal_max,       t.sunk_force};
    const auto is_set = [](const Greatest& g) {
        return is_time(g.time) && is_time(g.band.mesh) && is_time(g.band.geometry) && is_time(g.band.nodes) && is_time(g.band.step) && is_place(g.at);
    };
    static_assert(sizeof(StageTimes) % sizeof(double) == 0);
    const std::span<const double> stages(reinterpret_cast<const double*>(&t.stages), sizeof t.stages / sizeof(double));
    return std::all_of(counts.begin(), counts.end(), [](std::int64_t n) { return n >= 0 && n <= most_counted; }) &&
           std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value) && value >= 0; }) &&
           std::all_of(stages.begin(), stages.end(), is_time) && is_time(t.wall) && is_time(t.record) && is_time(t.row_time) &&
           is_set(t.wall_move) && is_set(t.wall_stress) && is_time(t.hand_force_time) && is_time(t.overlap_time) && std::all_of(std::begin(t.overlap_at), std::end(t.overlap_at), [](double x) { return std::isfinite(x); }) &&
           is_sound(t.on_wall) && is_sound(t.on_instruments) && is_sound(t.exits) && is_sound(t.score) && t.end.is_sound() && is_sound(t.end_touch) && t.steps <= most && t.rest_steps <= t.steps && t.row_steps <= t.steps;
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
        throw Error(ExitCode::BadFile, fmt::format("{}: {}; run again with --overwrite", path.string(), why));
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
    if (c.trace_bytes.size() != static_cast<std::size_t>(tables)) refuse("belongs to a scene with other tables");
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& c)
{
    std::vector<std::uint8_t> payload;
    put_list(payload, c.version);
    put_list(payload, c.device);
    put_list(payload, c.scene);
    put_bytes(payload, &c.vessel_hash, 1);
    put_bytes(payload, &c.status, 1);
    put_bytes(payload, &c.tally, 1);
    put_list(payload, c.trace_bytes);
    put_list(payload, c.wire_frames);
    put_list(payload, c.contact_frames);
    put_list(payload, c.state);

    write_sealed(path, checkpoint_magic, payload);
}

Checkpoint read_checkpoint(const std::filesystem::path& path)
{
    const std::vector<std::uint8_t> payload = read_sealed(path, checkpoint_magic);
    Checkpoint checkpoint;
    try {
        take_payload(payload.data(), payload.data() + payload.size(), checkpoint);
    } catch (const Error& error) {
        throw Error(error.code(), fmt::format("{}: {}", path.string(), error.what()));
    }
    return checkpoint;
}

std::uint64_t hash_of(const WallMesh& mesh)
{
    std::uint64_t hash = fnv1a(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
    return fnv1a(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), hash);
}

}  // namespace seldinger
