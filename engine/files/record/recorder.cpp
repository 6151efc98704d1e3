// The files of a running run: frames with their .pvd lists, summary.json, the checkpoint. Rows and tables:
// recorder_tables.cpp.
#include "record/recorder.h"

#include "core/clock.h"
#include "core/error.h"
#include "record/wire_shapes.h"
#include "run/frames.h"
#include "setup/joint_readings.h"
#include "scene/scene_difference.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

constexpr const char* own_files[] = {"checkpoint.bin", "summary.json", "trace.csv",    "wire.csv",  "contacts.csv",
                                     "wire.pvd",       "wire.npz",     "contacts.pvd", "wall.pvd",  "vessel.vtp",
                                     "scene.toml",     "picture.png",  "score.json",   "score.html"};
constexpr const char* own_series[] = {"wire_", "contacts_", "wall_", "frame_"};

/// Adds the time until its end to a sum.
class Stopwatch {
public:
    explicit Stopwatch(double& sum) : sum_(sum) {}
    ~Stopwatch() { sum_ += seconds_since(start_); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

private:
    double& sum_;
    Clock::time_point start_ = Clock::now();
};

/// wire_000120.vtp, frame_000003.png, and what a killed run left of a file half written (name.PID.tmp).
/// @param instruments  names of [[instrument]] that the folder's run has
bool is_own(const std::string& name, const std::vector<std::string>& instruments)
{
    const auto digits_after = [&](const std::string& prefix) {
        return name.starts_with(prefix) && name.size() > prefix.size() && name[prefix.size()] >= '0' &&
               name[prefix.size()] <= '9';
    };
    const auto is_file = [&](const std::string& own) { return name == own || (name.starts_with(own) && name.ends_with(".tmp")); };
    if (std::any_of(std::begin(own_series), std::end(own_series), digits_after)) return true;
    if (std::any_of(std::begin(own_files), std::end(own_files), is_file)) return true;
    if (name.starts_with("sensor_") && name.ends_with(".csv")) return true;
    return std::any_of(instruments.begin(), instruments.end(), [&](const std::string& of) {
        return is_file("trace_" + of + ".csv") || is_file(of + ".csv") || is_file(of + ".pvd") || digits_after(of + "_");
    });
}

/// Instruments that a folder's run has: those of trace_NAME.csv.
std::vector<std::string> instruments_in(const std::vector<std::string>& files)
{
    std::vector<std::string> names;
    constexpr std::string_view before = "trace_", after = ".csv";
    for (const std::string& name : files)
        if (name.starts_with(before) && name.ends_with(after) && name.size() > before.size() + after.size())
            names.push_back(name.substr(before.size(), name.size() - before.size() - after.size()));
    return names;
}

bool due(std::int64_t step, int every) { return every > 0 && step % every == 0; }

ClosedEnds closed_ends_of(const World& world, const RepairReport& vessel)
{
    std::vector<Vec3> inlets;
    for (const WireSetup& wire : world.setup().wires)
        if (wire.feed.on) inlets.push_back(wire.feed.point);
    return {vessel.loops, world.setup().mesh, world.setup().centreline, inlets};
}

}  // namespace

void remove_old_run(const Folder& dir)
{
    const std::vector<std::string> files = dir.names(), instruments = instruments_in(files);
    for (const std::string& name : files)
        if (const int error = is_own(name, instruments) ? dir.remove(name) : 0; error != 0)
            throw Error(ErrorKind::BadFile, fmt::format("{}: cannot be removed: {}; choose another folder with -o",
                                                       (dir.path() / name).string(), std::strerror(error)));
}

bool holds_a_run(const Folder& dir)
{
    return std::any_of(std::begin(own_files), std::end(own_files), [&](const char* name) { return dir.has(name); });
}

void check_run_folder(const fs::path& dir, FolderUse use, const Scene& scene)
{
    if (!holds_a_run(dir)) return;
    std::error_code ignored;
    const fs::path resolved = dir / "scene.toml";
    if (fs::equivalent(resolved, scene.source, ignored) && !fs::exists(dir / "checkpoint.bin", ignored))
        throw Error(
            ErrorKind::BadScene,
            fmt::format("{}: the scene lies there itself and would be overwritten; choose another folder with -o", dir.string()));
    if (use == FolderUse::Refuse)
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: holds a run already; give --resume to continue it, --overwrite to replace it, "
                                "or another folder with -o",
                                dir.string()));
    if (use != FolderUse::Resume || !fs::exists(dir / "checkpoint.bin", ignored)) return;
    const std::string difference = first_difference(read_file(resolved), write_scene(scene, dir));
    if (!difference.empty())
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: differs from the scene that is to be resumed: {}; give the same scene and --set, "
                                "or --overwrite",
                                resolved.string(), difference));
}

Recorder::Recorder(const Scene& scene, const RepairReport& vessel, const World& world, fs::path dir)
    : scene_(scene),
      vessel_(vessel),
      mesh_(world.setup().mesh),
      dir_(std::move(dir)),
      vessel_hash_(hash_of(mesh_)),
      elastic_(world.setup().vessel.elastic)
{
    const Stopwatch watch(tally_.record);
    resolved_ = write_scene(scene, dir_);  // first: it may be what is overwritten
    make_folder(dir_);
    remove_old_run(dir_);
    write_file(dir_ / "scene.toml", resolved_);
    begin_traces(world, {});
    has_wall_ = !mesh_.triangles.empty();
    closed_ends_ = closed_ends_of(world, vessel_);
    if (has_wall_) write_file(dir_ / "vessel.vtp", wall_vtp(mesh_));
    const Output now = world.output(frame_parts());
    readings_ = joint_readings(now.wires);
    if (scene_.integrator.scheme != Scheme::Static && !scene_.start_settled) placed(now);
    checkpoint(world, RunStatus::Running, 0);
}

Recorder::Recorder(const Scene& scene, const RepairReport& vessel, World& world, fs::path dir, const Checkpoint& saved)
    : scene_(scene),
      vessel_(vessel),
      mesh_(world.setup().mesh),
      dir_(std::move(dir)),
      vessel_hash_(hash_of(mesh_)),
      has_wall_(!mesh_.triangles.empty()),
      closed_ends_(closed_ends_of(world, vessel_)),
      elastic_(world.setup().vessel.elastic),
      tally_(saved.tally),
      wire_frames_(saved.wire_frames),
      contact_frames_(saved.contact_frames)
{
    if (vessel_hash_ != saved.vessel_hash)
        throw Error(ErrorKind::BadFile, fmt::format("{}: has changed since the run began; run again with --overwrite",
                                                   scene.vessel.mesh.empty() ? "the vessel" : scene.vessel.mesh.string()));
    for (int k = 0; k < tally_.exits.count; ++k)
        if (tally_.exits.exit[k].opening >= static_cast<int>(vessel_.loops.size()))
            throw Error(ErrorKind::BadFile, fmt::format("{}: is corrupt: an opening is out of range; run again with --overwrite",
                                                       (dir_ / "checkpoint.bin").string()));
    if (world.device_name() != saved.device)
        warn(fmt::format("resumed on \"{}\" after \"{}\": the bits may differ from a run in one piece", world.device_name(),
                         saved.device));
    try {
        world.restore_state(saved.state);
    } catch (const Error& error) {
        throw Error(error.kind(),
                    fmt::format("{}: {}; run again with --overwrite", (dir_ / "checkpoint.bin").string(), error.what()));
    }
    resolved_ = saved.scene;
    begin_traces(world, saved.trace_bytes);
    forget_lost_frames();
    readings_ = joint_readings(world, 0);
    tally_.resumes++;
}

/// Frames that were deleted since are not listed again.
void Recorder::forget_lost_frames()
{
    const auto is_lost = [&](const std::string& series) {
        return [this, series](const FrameMark& frame) {
            std::error_code ignored;
            return !fs::exists(dir_ / frame_name(series, frame.step), ignored);
        };
    };
    for (int k = 0; k < scene_.instrument_count(); ++k) std::erase_if(wire_frames_, is_lost(series_of(scene_, k)));
    std::erase_if(contact_frames_, is_lost("contacts"));
    if (elastic_) std::erase_if(contact_frames_, is_lost("wall"));
}

void Recorder::take_in(const Output& now, const StepReport& report, double dt)
{
    readings_ = joint_readings(now.wires);
    if (readings_.overlap_share > tally_.overlap_share) {
        tally_.overlap_share = readings_.overlap_share;
        tally_.overlap_time = now.time;
        for (int k = 0; k < 3; ++k) tally_.overlap_at[k] = readings_.overlap_at[k];
    }
    if (std::abs(readings_.hand_force) > tally_.hand_force_max) tally_.hand_force_time = now.time;
    tips_.clear();
    for (const WireOutput& wire : now.wires) tips_.push_back(wire.tip);
    watch_exits(tally_.exits, tips_, vessel_.loops, mesh_, now.time);
    tally_.take_in(readings_, report.flags, report.newton_iterations, dt);
    tally_.stages += report.times;
    tally_.row_newton = std::max<std::int64_t>(tally_.row_newton, report.newton_iterations);
    tally_.row_flags |= report.flags;
}

/// The greatest loads and moves of the readings, and flags that only reading shows.
void Recorder::take_greatest(const Output& now)
{
    unsigned seen = 0;
    for (const WireOutput& wire : now.wires) seen |= wire.report.flags;
    tally_.note_read(seen);
    if (now.parts & (Output::Contacts | Output::Loads)) {
        tally_.on_wall.take_in(joint_along(now.wires, &WireOutput::on_wall), now.time);
        tally_.on_instruments.take_in(joint_along(now.wires, &WireOutput::on_instruments), now.time);
    }
    if (now.parts & Output::Contacts) closed_ends_.watch(tally_.end_touch, now);
    if (now.walls.empty() || !(now.parts & (Output::Wall | Output::WallShape | Output::WallUnder))) return;
    const WallReadings& wall = now.walls[0].readings;
    // displacement and stress are in proportion to the load
    WallBand move = wall.move_band, stress = wall.stress_band;
    move.nodes = move_nodes_ * wall.move_max;
    stress.nodes = stress_nodes_ * wall.stress_max;
    tally_.wall_move.take_in(wall.move_max, wall.move_at, move, now.time);
    tally_.wall_stress.take_in(wall.stress_max, wall.stress_at, stress, now.time);
}

void Recorder::gauge(const World& world, const Output& now)
{
    if (now.walls.empty()) return;
    const WallReadings& wall = now.walls[0].readings;
    // by steps of a fixed scale, so that a resumed run takes them where a whole one does
    const auto outgrows = [](double largest, double before) {
        constexpr double a_per_cent = 100;
        return largest > before && std::floor(a_per_cent * std::log(largest)) > std::floor(a_per_cent * std::log(before));
    };
    const auto known = [](const Greatest& so_far) { return so_far.value > 0 ? so_far.band.nodes / so_far.value : 0.0; };
    if (outgrows(wall.move_max, tally_.wall_move.value) || outgrows(wall.stress_max, tally_.wall_stress.value))
        move_nodes_ = stress_nodes_ = GridErrorGauge().of(world).patch.nodes;
    else move_nodes_ = known(tally_.wall_move), stress_nodes_ = known(tally_.wall_stress);
}

void Recorder::passed(const Output& now)
{
    const Stopwatch watch(tally_.record);
    take_in(now, {}, 0);
    take_greatest(now);
    if (due(++passed_, scene_.record_every)) write_row(now);
}

void Recorder::settled(const Output& now, const StepReport& report)
{
    const Stopwatch watch(tally_.record);
    take_in(now, report, 0);
    take_greatest(now);
    write_row(now);
    placed(now);
}

void Recorder::placed(const Output& now)
{
    if (scene_.wire_every > 0) write_wire_frame(now);
    if (scene_.contacts_every > 0) write_contact_frame(now);
    write_collections();
}

/// What a frame of everything takes. Where the wall is costs a search for each vertex of the mesh: only if it is written.
unsigned Recorder::frame_parts() const
{
    const unsigned parts = Output::Shape | Output::Contacts | Output::Wall;
    return elastic_ && scene_.contacts_every > 0 ? parts | Output::WallShape : parts;
}

/// In most steps the total load is below the largest reading so far, and the load along the wires is not computed.
bool Recorder::may_bear_most(const World& world) const
{
    for (int w = 0; w < world.wire_count(); ++w) {
        const WireReadings r = world.readings(w);
        if (tally_.on_wall.may_rise(r.normal - r.normal_between) || tally_.on_instruments.may_rise(r.normal_between)) return true;
    }
    return false;
}

unsigned Recorder::wants(const World& world) const
{
    const std::int64_t next = tally_.steps + 1;
    const unsigned contacts = elastic_ ? Output::Contacts | Output::WallShape : Output::Contacts;
    return (due(next, scene_.wire_every) ? Output::Shape : Output::Numbers) |
           (has_wall_ && due(next, scene_.contacts_every) ? contacts : Output::Numbers) |
           (due(next, scene_.record_every) ? Output::Contacts : Output::Numbers) |
           (may_bear_most(world) ? Output::Loads : Output::Numbers) |
           (!elastic_ ? Output::Numbers : due(next, scene_.record_every) ? Output::Wall : Output::WallUnder);
}

void Recorder::stepped(const Output& now, const StepReport& report, double seconds, long rest_steps)
{
    const Stopwatch watch(tally_.record);
    tally_.steps++;
    tally_.row_steps++;
    tally_.row_time += seconds;
    take_in(now, report, scene_.step_length(static_cast<long>(tally_.steps - 1)));
    take_greatest(now);
    tally_.rest_steps = rest_steps;
    write_samples(now);
    if (due(tally_.steps, scene_.record_every)) write_row(now);
    if (due(tally_.steps, scene_.wire_every)) write_wire_frame(now);
    if (due(tally_.steps, scene_.contacts_every)) write_contact_frame(now);
}

void Recorder::write_wire_frame(const Output& now)
{
    for (int k = 0; k < scene_.instrument_count(); ++k)
        write_file(dir_ / frame_name(series_of(scene_, k), tally_.steps), wire_vtp(now.wires[static_cast<std::size_t>(k)]));
    wire_frames_.push_back({tally_.steps, now.time});
}

void Recorder::write_contact_frame(const Output& now)
{
    if (!has_wall_) return;
    write_file(dir_ / frame_name("contacts", tally_.steps), contacts_vtp(now.contacts));
    if (elastic_) write_file(dir_ / frame_name("wall", tally_.steps), moved_wall_vtp(mesh_, now.walls[0]));
    contact_frames_.push_back({tally_.steps, now.time});
}

// Written with each checkpoint and at the end, not with each frame: the list of a long series would cost more than the series.
void Recorder::write_collections()
{
    const auto write = [&](const std::string& stem, const std::vector<FrameMark>& frames, const std::vector<std::string>& parts) {
        if (frames.empty()) return;
        std::vector<PvdEntry> entries;
        for (const FrameMark& frame : frames)
            for (std::size_t k = 0; k < parts.size(); ++k)
                entries.push_back(
                    {frame.time, frame_name(parts[k], frame.step), static_cast<int>(k), parts.size() > 1 ? parts[k] : ""});
        write_file(dir_ / fmt::format("{}.pvd", stem), pvd_text(entries));
    };
    std::vector<std::string> instruments;
    for (int k = 0; k < scene_.instrument_count(); ++k) instruments.push_back(series_of(scene_, k));
    write("wire", wire_frames_, instruments);
    if (!scene_.label.empty())
        for (const std::string& one : instruments)
            if (one != "wire") write(one, wire_frames_, {one});
    write("contacts", contact_frames_, {"contacts"});
    if (elastic_) write("wall", contact_frames_, {"wall"});
}

/// The frames as arrays. They are files that somebody may have changed: then there is a warning, and the run ends as it does.
void Recorder::write_shapes()
{
    if (wire_frames_.empty()) return;
    std::vector<std::string> series, names;
    for (int k = 0; k < scene_.instrument_count(); ++k)
        series.push_back(series_of(scene_, k)), names.push_back(scene_.instrument(k).label);
    std::string shapes;
    try {
        shapes = wire_npz(dir_, wire_frames_, series, names);
    } catch (const Error& error) {
        warn(fmt::format("wire.npz was not written: {}", error.what()));
        return;
    }
    write_file(dir_ / "wire.npz", shapes);
}

void Recorder::checkpoint(const World& world, RunStatus status, double wall)
{
    const Stopwatch watch(tally_.record);
    tally_.wall = wall;
    write_collections();
    std::vector<std::uint64_t> sizes;
    for (AppendFile& trace : traces_) {
        trace.sync();
        sizes.push_back(trace.size());
    }
    write_checkpoint(dir_ / "checkpoint.bin", {version(), world.device_name(), resolved_, vessel_hash_, status, tally_,
                                               std::move(sizes), wire_frames_, contact_frames_, world.save_state()});
}

std::string Recorder::finish(const World& world, RunStatus status, double wall)
{
    // an interrupted run does not resume from the row that it shows: the checkpoint comes before the extra row and frame
    const bool goes_on = status == RunStatus::TimeLimit || status == RunStatus::Interrupted;
    if (goes_on) checkpoint(world, status, wall);
    const auto start = Clock::now();
    {
        const Stopwatch watch(tally_.record);
        const bool ended = !goes_on && tally_.steps > 0;
        const Output now = world.output(frame_parts());
        if (tally_.steps > 0) take_greatest(now);
        if (ended && !due(tally_.steps, scene_.record_every)) write_row(now);
        if (ended && scene_.wire_every > 0 && !due(tally_.steps, scene_.wire_every)) write_wire_frame(now);
        if (ended && scene_.contacts_every > 0 && !due(tally_.steps, scene_.contacts_every)) write_contact_frame(now);
        write_collections();
        write_shapes();
        for (int k = 0; k < scene_.instrument_count(); ++k)
            write_wire_table(now.wires[static_cast<std::size_t>(k)], series_of(scene_, k));
        write_contact_table(now);
    }
    tally_.wall = wall + seconds_since(start);
    const WorldBranches branches(world);
    const SummaryNotes notes{&scene_, &vessel_, status, readings_, warnings_, branches.of(0), branches.tip(world, 0), estimate_};
    const std::string summary = summary_json(world, tally_, notes);
    write_file(dir_ / "summary.json", summary);
    if (status == RunStatus::Done) checkpoint(world, status, tally_.wall);
    return summary;
}

}  // namespace seldinger
