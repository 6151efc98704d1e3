// Writes trace.csv, wire.csv, contacts.csv, the .vtp frames with their .pvd lists, summary.json and the checkpoint of a run.
#include "scene/recorder.h"

#include "core/error.h"
#include "scene/frames.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace seldinger {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* own_files[] = {"checkpoint.bin", "summary.json", "trace.csv",  "wire.csv",   "contacts.csv", "wire.pvd",
                                     "contacts.pvd",   "wall.pvd",     "vessel.vtp", "scene.toml", "picture.png"};
constexpr const char* own_series[] = {"wire_", "contacts_", "wall_", "frame_"};

constexpr std::string_view trace_columns =
    "step,time_s,inserted_m,turned_rad,nodes,contacts,normal_n,friction_n,sliding_n,static_n,rolling_nm,hand_force_n,hand_torque_"
    "nm,"
    "overlap_m,newton,step_ms,contact_length_m,outside_m,base_force_x_n,base_force_y_n,base_force_z_n,kinetic_j,elastic_j,"
    "gravitational_j,flags,momentum_error_n,tip_x_m,tip_y_m,tip_z_m,wall_move_max_m,wall_energy_j,wall_loss_j,wall_stress_max_"
    "pa,contact_area_m2,contact_pressure_max_pa";

/// The columns above, and those of the ledger.
std::string trace_header()
{
    std::string header(trace_columns);
    for (const EnergyEntry& entry : energy_entries({})) header.append(",").append(entry.name);
    return header + "\n";
}

/// Adds the time until its end to a sum.
class Stopwatch {
public:
    explicit Stopwatch(double& sum) : sum_(sum) {}
    ~Stopwatch() { sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

private:
    double& sum_;
    Clock::time_point start_ = Clock::now();
};

/// wire_000120.vtp, frame_000003.png, and what a killed run left of a file half written (name.PID.tmp).
bool is_own(const std::string& name)
{
    const auto digits_after = [&](std::string_view prefix) {
        return name.starts_with(prefix) && name.size() > prefix.size() && name[prefix.size()] >= '0' &&
               name[prefix.size()] <= '9';
    };
    if (std::any_of(std::begin(own_series), std::end(own_series), digits_after)) return true;
    return std::any_of(std::begin(own_files), std::end(own_files),
                       [&](std::string_view own) { return name == own || (name.starts_with(own) && name.ends_with(".tmp")); });
}

bool due(std::int64_t step, int every) { return every > 0 && step % every == 0; }

}  // namespace

void remove_old_run(const fs::path& dir)
{
    std::error_code error;
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(dir, error))
        if (is_own(entry.path().filename().string())) old.push_back(entry.path());
    for (const fs::path& path : old)
        if (!fs::remove(path, error) && error)
            throw Error(ExitCode::BadFile,
                        fmt::format("{}: cannot be removed: {}; choose another folder with -o", path.string(), error.message()));
}

bool holds_a_run(const fs::path& dir)
{
    std::error_code ignored;
    return std::any_of(std::begin(own_files), std::end(own_files),
                       [&](const char* name) { return fs::exists(dir / name, ignored); });
}

void check_run_folder(const fs::path& dir, FolderUse use, const Scene& scene)
{
    if (!holds_a_run(dir)) return;
    std::error_code ignored;
    const fs::path resolved = dir / "scene.toml";
    if (fs::equivalent(resolved, scene.source, ignored) && !fs::exists(dir / "checkpoint.bin", ignored))
        throw Error(
            ExitCode::BadScene,
            fmt::format("{}: the scene lies there itself and would be overwritten; choose another folder with -o", dir.string()));
    if (use == FolderUse::Refuse)
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: holds a run already; give --resume to go on with it, --overwrite to replace it, "
                                "or another folder with -o",
                                dir.string()));
    if (use == FolderUse::Resume && fs::exists(dir / "checkpoint.bin", ignored) && read_file(resolved) != write_scene(scene, dir))
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: differs from the scene that is to be resumed; give the same scene and --set, "
                                "or --overwrite",
                                resolved.string()));
}

Recorder::Recorder(const Scene& scene, const RepairReport& vessel, const World& world, fs::path dir)
    : scene_(scene),
      vessel_(vessel),
      mesh_(world.setup().mesh),
      dir_(std::move(dir)),
      vessel_hash_(hash_of(mesh_)),
      yields_(world.setup().vessel.elastic)
{
    const Stopwatch watch(tally_.record);
    const std::string resolved = write_scene(scene, dir_);  // first: it may be what is overwritten
    make_folder(dir_);
    remove_old_run(dir_);
    write_file(dir_ / "scene.toml", resolved);
    trace_ = AppendFile(dir_ / "trace.csv", 0);
    trace_.append(trace_header());
    has_wall_ = !mesh_.triangles.empty();
    if (has_wall_) write_file(dir_ / "vessel.vtp", wall_vtp(mesh_));
    const Output now = world.output(frame_parts());
    readings_ = now.wires[0].readings;
    if (scene_.integrator.scheme != Scheme::Static && !scene_.start_settled) {
        if (scene_.wire_every > 0) write_wire_frame(now);
        if (scene_.contacts_every > 0) write_contact_frame(now);
        write_collections();
    }
    checkpoint(world, RunStatus::Running, 0);
}

Recorder::Recorder(const Scene& scene, const RepairReport& vessel, World& world, fs::path dir, const Checkpoint& saved)
    : scene_(scene),
      vessel_(vessel),
      mesh_(world.setup().mesh),
      dir_(std::move(dir)),
      vessel_hash_(hash_of(mesh_)),
      has_wall_(!mesh_.triangles.empty()),
      yields_(world.setup().vessel.elastic),
      tally_(saved.tally),
      wire_frames_(saved.wire_frames),
      contact_frames_(saved.contact_frames)
{
    if (vessel_hash_ != saved.vessel_hash)
        throw Error(ExitCode::BadFile, fmt::format("{}: has changed since the run began; run again with --overwrite",
                                                   scene.vessel.mesh.empty() ? "the vessel" : scene.vessel.mesh.string()));
    if (world.device_name() != saved.device)
        warn(fmt::format("resumed on \"{}\" after \"{}\": the bits may differ from a run in one piece", world.device_name(),
                         saved.device));
    world.restore_state(saved.state);
    trace_ = AppendFile(dir_ / "trace.csv", saved.trace_bytes);
    readings_ = world.readings(0);
    tally_.resumes++;
}

void Recorder::take_in(const Output& now, const StepReport& report)
{
    readings_ = now.wires[0].readings;
    tally_.take_in(readings_, report.flags, report.newton_iterations);
    tally_.stages += report.times;
    tally_.row_newton = std::max<std::int64_t>(tally_.row_newton, report.newton_iterations);
    tally_.row_flags |= report.flags;
}

void Recorder::settled(const Output& now, const StepReport& report)
{
    const Stopwatch watch(tally_.record);
    take_in(now, report);
    write_row(now);
    if (scene_.wire_every > 0) write_wire_frame(now);
    if (scene_.contacts_every > 0) write_contact_frame(now);
    write_collections();
}

/// What a frame of everything takes. Where the wall is costs a search for each vertex of the mesh: only if it is written.
unsigned Recorder::frame_parts() const
{
    const unsigned parts = Output::Shape | Output::Contacts | Output::Wall;
    return yields_ && scene_.contacts_every > 0 ? parts | Output::WallShape : parts;
}

unsigned Recorder::wants() const
{
    const std::int64_t next = tally_.steps + 1;
    const unsigned contacts = yields_ ? Output::Contacts | Output::WallShape : Output::Contacts;
    return (due(next, scene_.wire_every) ? Output::Shape : Output::Numbers) |
           (has_wall_ && due(next, scene_.contacts_every) ? contacts : Output::Numbers) |
           (has_wall_ && due(next, scene_.record_every) ? Output::Contacts : Output::Numbers) |
           (yields_ && due(next, scene_.record_every) ? Output::Wall : Output::Numbers);
}

void Recorder::stepped(const Output& now, const StepReport& report, double seconds)
{
    const Stopwatch watch(tally_.record);
    tally_.steps++;
    tally_.row_steps++;
    tally_.row_time += seconds;
    take_in(now, report);
    tally_.rest_steps = now.wires[0].at_rest ? tally_.rest_steps + 1 : 0;
    if (due(tally_.steps, scene_.record_every)) write_row(now);
    if (due(tally_.steps, scene_.wire_every)) write_wire_frame(now);
    if (due(tally_.steps, scene_.contacts_every)) write_contact_frame(now);
}

std::string Recorder::csv(double value)
{
    if (std::isfinite(value)) return fmt::format("{}", value);  // the shortest text that reads back to the same bits
    tally_.non_finite++;
    return {};
}

void Recorder::write_row(const Output& now)
{
    const WireReadings& r = readings_;
    const double step_ms = tally_.row_steps > 0 ? 1e3 * tally_.row_time / static_cast<double>(tally_.row_steps) : 0;
    std::string row =
        fmt::format("{},{},{},{},{},{}", tally_.steps, csv(now.time), csv(r.inserted), csv(r.turned), r.nodes, r.contacts);
    for (const double v : {r.normal, r.friction, r.sliding, r.sticking, r.rolling, r.hand_force, r.hand_torque, r.overlap})
        row += "," + csv(v);
    row += fmt::format(",{},{:.4g}", tally_.row_newton, step_ms);
    for (const double v : {r.contact_length, r.outside, r.base_force.x(), r.base_force.y(), r.base_force.z(), r.kinetic,
                           r.elastic, r.gravitational})
        row += "," + csv(v);
    const Vec3& tip = now.wires[0].tip;
    tally_.note_wall(now.wires[0].report.flags);
    trace_.append(row +
                  fmt::format(",{},{},{},{},{}", tally_.row_flags, csv(r.momentum.error().norm()), csv(tip.x()), csv(tip.y()),
                              csv(tip.z())) +
                  wall_fields(now) + patch_fields(now.wires[0]) + energy_fields(r.energy) + "\n");
    tally_.row_newton = tally_.row_flags = tally_.row_steps = 0;
    tally_.row_time = 0;
}

std::string Recorder::wall_fields(const Output& now)
{
    const WallReadings w = now.walls.empty() ? WallReadings{} : now.walls[0].readings;
    tally_.wall_move_max = std::max(tally_.wall_move_max, w.move_max);
    tally_.wall_stress_max = std::max(tally_.wall_stress_max, w.stress_max);
    return fmt::format(",{},{},{},{}", csv(w.move_max), csv(w.energy), csv(w.loss), csv(w.stress_max));
}

std::string Recorder::energy_fields(const EnergyLedger& ledger)
{
    std::string fields;
    for (const EnergyEntry& entry : energy_entries(ledger)) fields += "," + csv(entry.value);
    return fields;
}

std::string Recorder::patch_fields(const WireOutput& wire)
{
    tally_.contact_area_max = std::max(tally_.contact_area_max, wire.contact_area);
    tally_.contact_pressure_max = std::max(tally_.contact_pressure_max, wire.contact_pressure_max);
    return fmt::format(",{},{}", csv(wire.contact_area), csv(wire.contact_pressure_max));
}

void Recorder::write_wire_frame(const Output& now)
{
    write_file(dir_ / frame_name("wire", tally_.steps), wire_vtp(now.wires[0]));
    wire_frames_.push_back({tally_.steps, now.time});
}

void Recorder::write_contact_frame(const Output& now)
{
    if (!has_wall_) return;
    write_file(dir_ / frame_name("contacts", tally_.steps), contacts_vtp(now.contacts));
    if (yields_) write_file(dir_ / frame_name("wall", tally_.steps), moved_wall_vtp(mesh_, now.walls[0]));
    contact_frames_.push_back({tally_.steps, now.time});
}

// Written with each checkpoint and at the end, not with each frame: the list of a long series would cost more than the series.
void Recorder::write_collections()
{
    const std::pair<const char*, const std::vector<FrameMark>*> series[] = {
        {"wire", &wire_frames_}, {"contacts", &contact_frames_}, {"wall", &contact_frames_}};
    for (const auto& [stem, frames] : series) {
        if (frames->empty() || (stem == std::string_view("wall") && !yields_)) continue;
        std::vector<PvdEntry> entries;
        for (const FrameMark& frame : *frames) entries.push_back({frame.time, frame_name(stem, frame.step)});
        write_file(dir_ / fmt::format("{}.pvd", stem), pvd_text(entries));
    }
}

void Recorder::write_wire_table(const WireOutput& wire)
{
    std::string table = "s_m,x_m,y_m,z_m,vx,vy,vz,spin_rad,fx_n,fy_n,fz_n\n";
    for (std::size_t i = 0; i < wire.position.size(); ++i) {
        const Vec3 &f = wire.contact_force[i], &x = wire.position[i], &v = wire.velocity[i];
        const double row[] = {wire.material_s[i], x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), wire.spin[i], f.x(), f.y(), f.z()};
        for (const double& value : row) table += csv(value) + (&value == std::end(row) - 1 ? "\n" : ",");
    }
    write_file(dir_ / "wire.csv", table);
}

void Recorder::write_contact_table(const Output& now)
{
    std::string table =
        "edge,triangle,x_m,y_m,z_m,nx,ny,nz,gap_m,normal_n,friction_n,stuck,rolling_nm,length_m,area_m2,pressure_pa\n";
    for (const ContactRow& c : now.contacts) {
        table += fmt::format("{},{}", c.a.element, c.b.element);
        for (const double v : {c.point.x(), c.point.y(), c.point.z(), c.normal.x(), c.normal.y(), c.normal.z(), c.gap,
                               c.normal_force, c.friction.norm()})
            table += "," + csv(v);
        table +=
            fmt::format(",{},{},{},{},{}\n", c.stuck ? 1 : 0, csv(c.rolling_moment), csv(c.length), csv(c.area), csv(c.pressure));
    }
    write_file(dir_ / "contacts.csv", table);
}

void Recorder::checkpoint(const World& world, RunStatus status, double wall)
{
    const Stopwatch watch(tally_.record);
    tally_.wall = wall;
    write_collections();
    trace_.sync();
    write_checkpoint(dir_ / "checkpoint.bin", {version(), world.device_name(), vessel_hash_, status, tally_, trace_.size(),
                                               wire_frames_, contact_frames_, world.save_state()});
}

std::string Recorder::finish(const World& world, RunStatus status, double wall)
{
    // what an interrupted run shows is not what it goes on from: the checkpoint comes before the extra row and frame
    const bool goes_on = status == RunStatus::TimeLimit || status == RunStatus::Interrupted;
    if (goes_on) checkpoint(world, status, wall);
    const auto start = Clock::now();
    {
        const Stopwatch watch(tally_.record);
        const bool ended = !goes_on && tally_.steps > 0;
        const Output now = world.output(frame_parts());
        if (ended && !due(tally_.steps, scene_.record_every)) write_row(now);
        if (ended && scene_.wire_every > 0 && !due(tally_.steps, scene_.wire_every)) write_wire_frame(now);
        if (ended && scene_.contacts_every > 0 && !due(tally_.steps, scene_.contacts_every)) write_contact_frame(now);
        write_collections();
        write_wire_table(now.wires[0]);
        write_contact_table(now);
    }
    tally_.wall = wall + std::chrono::duration<double>(Clock::now() - start).count();
    const std::string summary = summary_json(world, tally_, {&scene_, &vessel_, status, readings_, warnings_});
    write_file(dir_ / "summary.json", summary);
    if (status == RunStatus::Done) checkpoint(world, status, tally_.wall);
    return summary;
}

}  // namespace seldinger
