// Groups a sweep's runs into worlds, steps a world and takes out the wires that are done, saves and restores it.
#include "batch/batch.h"

#include "core/error.h"
#include "record/checkpoint.h"
#include "setup/joint_readings.h"
#include "run/ready.h"
#include "run/wall_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

namespace seldinger {
std::string shared_part(Scene scene, const Scene& first)
{
    scene.name = first.name;
    scene.seed = first.seed;
    scene.record_every = first.record_every;
    scene.wire_every = first.wire_every;
    scene.contacts_every = first.contacts_every;
    static_cast<SceneInstrument&>(scene) = first;
    scene.others = first.others;
    scene.coaxial = first.coaxial;
    SceneContact& contact = scene.contact;
    const SceneContact& other = first.contact;
    contact.stiffness_from_wall = other.stiffness_from_wall;
    contact.mu_static = other.mu_static;
    contact.mu_sliding = other.mu_sliding;
    for (double ContactSpec::*member : {&ContactSpec::stiffness, &ContactSpec::exponent, &ContactSpec::restitution,
                                        &ContactSpec::rolling_alpha, &ContactSpec::rolling_sigma_b, &ContactSpec::rolling_sigma_s,
                                        &ContactSpec::rolling_hardness, &ContactSpec::layer_height, &ContactSpec::pair_distance})
        contact.*member = other.*member;
    contact.rolling = other.rolling;
    contact.samples_per_edge = other.samples_per_edge;
    return write_scene(scene, scene.source.parent_path());
}

// a wall's mesh follows the path of its run (run/wall_path.h): such a run shares no world
std::string world_kind(Scene scene, const Scene& first, std::size_t number)
{
    const bool own_wall = scene.vessel.elastic && scene.vessel.wall_edge == 0;
    return own_wall ? fmt::format("{}", number) : shared_part(std::move(scene), first);
}

Scene BatchSource::scene(std::size_t item) const
{
    const std::size_t run = item % sweep.run_count();
    std::vector<std::string> all = overrides;
    for (std::string& setting : sweep.overrides(run)) all.push_back(std::move(setting));
    try {
        Scene scene = read_scene_text(scene_text, scene_file, all);
        if (item >= sweep.run_count()) {
            scene.dt /= 2;
            scene.record_every *= 2;  // the same rows
        }
        return scene;
    } catch (const Error& error) {
        const std::string message = error.what(), name = run_name(sweep, run);
        const std::vector<std::size_t> index = sweep.indices(run);
        for (std::size_t a = 0; a < index.size(); ++a)
            for (const std::string& setting : sweep.overrides(sweep.axes[a], index[a]))
                if (message.starts_with("--set " + setting))
                    throw Error(error.kind(), fmt::format("{}:{}: vary.{}: {}{}", sweep.source.string(), sweep.axes[a].line,
                                                          sweep.axes[a].key, name, message.substr(6 + setting.size())));
        throw Error(error.kind(), fmt::format("{}: {}: {}", sweep.source.string(), name, message));
    }
}

namespace {

std::vector<std::string> names_of(const Scene& scene)
{
    std::vector<std::string> names;
    for (int k = 0; k < scene.instrument_count(); ++k)
        if (!scene.instrument(k).label.empty()) names.push_back(scene.instrument(k).label);
    return names;
}

}  // namespace

BatchLayout BatchSource::layout() const
{
    const Scene first = scene(0);
    BatchLayout layout{
        names_of(first), first.task.on && first.task.target != TaskSpec::Target::None, bands, sweep.run_count(), {}, 0, false};
    if (layout.task) layout.target = target_name(first.task);
    layout.patch = first.force_patch;
    layout.limits = first.task.wall_force > 0 || first.task.patch_force > 0 || first.task.time > 0;
    return layout;
}

BatchSource make_source(std::string scene_text, const std::filesystem::path& scene_file, std::vector<std::string> overrides,
                        const std::string& sweep_text, const std::filesystem::path& sweep_file)
{
    const Scene base = read_scene_text(scene_text, scene_file, overrides);
    return {std::move(scene_text),
            scene_file,
            std::move(overrides),
            read_sweep_text(sweep_text, sweep_file, base.seed),
            base.bands,
            base.seed};
}

std::vector<std::vector<std::size_t>> plan_worlds(const BatchSource& source, std::size_t begin, std::size_t end, bool ramp,
                                                  std::vector<std::string>* warnings)
{
    constexpr std::size_t most_warnings = 16;  // of those that tell numbers of their run there may be as many as runs
    std::vector<std::pair<std::string, std::vector<std::size_t>>> warned;
    const Scene first = source.scene(0);
    const std::vector<std::string> names = names_of(first);
    std::vector<std::vector<std::size_t>> worlds;
    std::unordered_map<std::string, std::size_t> open;   // the world that runs of this kind go to now
    std::unordered_map<std::string, std::size_t> rooms;  // how many it takes
    for (std::size_t run = begin; run < std::min(end, source.item_count()); ++run) {
        Scene scene = source.scene(run);
        if (names_of(scene) != names)
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: run {} has instruments of other names than run 0, which name the columns of "
                                    "results.csv; leave `name` out of what is varied",
                                    source.sweep.source.string(), run));
        for (const std::string& warning : scene.warnings) {
            if (!warnings || run >= source.sweep.run_count()) break;
            auto known = std::find_if(warned.begin(), warned.end(), [&](const auto& one) { return one.first == warning; });
            if (known == warned.end() && warned.size() == most_warnings) break;
            if (known == warned.end()) known = warned.insert(warned.end(), {warning, {}});
            known->second.push_back(run);
        }
        const std::string key = world_kind(std::move(scene), first, run);
        const auto [at, is_new] = open.try_emplace(key, worlds.size());
        std::size_t& room = rooms.try_emplace(key, ramp ? 1 : most_wires).first->second;
        if (!is_new && worlds[at->second].size() == room) {
            at->second = worlds.size();
            room = std::min(2 * room, most_wires);
        }
        if (at->second == worlds.size()) worlds.emplace_back();
        worlds[at->second].push_back(run);
    }
    for (const auto& [warning, runs] : warned)
        warnings->push_back(fmt::format("{}{}: {}", run_name(source.sweep, runs.front()),
                                        runs.size() > 1 ? fmt::format(" and {} more", runs.size() - 1) : "", warning));
    return worlds;
}

BatchWorld::BatchWorld(const BatchSource& source, std::span<const std::size_t> runs, LoadedVessel vessel, int device)
    : sweep_runs_(static_cast<std::int64_t>(source.sweep.run_count()))
{
    std::vector<Scene> scenes;
    for (const std::size_t run : runs) {
        scenes.push_back(source.scene(run));
        runs_.emplace_back().index = static_cast<std::int64_t>(run);
    }
    scene_ = scenes.front();
    std::vector<BoundaryLoop> openings = vessel.report.loops;
    WorldSetup setup = ready_setup(scenes, std::move(vessel), device);
    find_wall_path(scenes, setup);
    world_ = std::make_unique<World>(std::move(setup));
    loop_.emplace(*world_, scenes, static_cast<RunHooks*>(this));
    places_ = VesselPlaces(*world_, std::move(openings));
    if (scene_.task.on) score_.emplace(scene_, *world_, ScoreWatch::Patch::WhereItCounts);
}

void BatchWorld::ended(int system, RunStatus status)
{
    Run& run = runs_[static_cast<std::size_t>(system)];
    if (status == RunStatus::Done) take_loads(system), take_wall(system, Output::Wall);
    keep_files(system);
    rows_.push_back(make_row(run.index, status, *world_, system, run.tally, places_));
    world_->retire(system);
}

/// A row of the kept trace.
void BatchWorld::keep_row(int system)
{
    Run& run = runs_[static_cast<std::size_t>(system)];
    if (!scene_.keep_traces || run.index >= sweep_runs_) return;
    const int first = world_->wires_of(system).first;
    if (run.trace.empty()) run.trace = kept_header();
    run.trace += kept_row(run.tally.steps, world_->time(first), joint_readings(*world_, system), world_->rod(first).pos(0));
}

/// Keeps the files of a run that ends now.
void BatchWorld::keep_files(int system)
{
    Run& run = runs_[static_cast<std::size_t>(system)];
    if (run.index >= sweep_runs_) return;
    const bool has_row = run.tally.steps > 0 ? run.tally.steps % scene_.record_every == 0 : !run.trace.empty();
    if (!has_row) keep_row(system);
    std::vector<WireOutput> wires;
    if (scene_.keep_last_frame) {
        Output now;
        world_->read(now, Output::Shape);
        const auto [first, end] = world_->wires_of(system);
        wires.assign(now.wires.begin() + first, now.wires.begin() + end);
    }
    KeptFiles files = kept_files(run.index, scene_, run.trace, wires);
    std::move(files.begin(), files.end(), std::back_inserter(kept_));
    run.trace.clear();
}

/// Force per length and the like of a system's accepted state.
void BatchWorld::take_loads(int system)
{
    if (loads_read_at_ != world_->step_count() || loads_.wires.empty()) world_->read(loads_, Output::Contacts);
    loads_read_at_ = world_->step_count();
    const auto [first, end] = world_->wires_of(system);
    const std::span<const WireOutput> wires = std::span<const WireOutput>(loads_.wires).subspan(first, end - first);
    LoadTally& on_wall = runs_[static_cast<std::size_t>(system)].tally.on_wall;
    on_wall.take_in(joint_along(wires, &WireOutput::on_wall), world_->time(first));
}

/// Its forces only, in the steps between.
void BatchWorld::take_greatest_loads(int system)
{
    const auto [first, end] = world_->wires_of(system);
    LoadTally& on_wall = runs_[static_cast<std::size_t>(system)].tally.on_wall;
    double sum = 0;
    for (int w = first; w < end; ++w) sum += world_->readings(w).normal;
    if (!on_wall.may_rise(sum)) return;
    greatest_.resize(static_cast<std::size_t>(end - first));
    for (int w = first; w < end; ++w) world_->read_loads(w, greatest_[static_cast<std::size_t>(w - first)]);
    on_wall.take_in(joint_along(greatest_, &WireOutput::on_wall), world_->time(first));
}

/// Displacement and stress of an elastic wall: under the instruments in every step, everywhere with each row.
void BatchWorld::take_wall(int system, unsigned parts)
{
    if (!scene_.vessel.elastic) return;
    if (wall_read_at_ != world_->step_count() || (parts & ~wall_.parts)) world_->read(wall_, parts);
    wall_read_at_ = world_->step_count();
    WallReadings& now = wall_.walls[static_cast<std::size_t>(system)].readings;
    RunTally& tally = runs_[static_cast<std::size_t>(system)].tally;
    if (now.move_max > tally.wall_move.value || now.stress_max > tally.wall_stress.value) {
        const double share = gauge_.of(*world_, system).patch.nodes;
        now.move_band.nodes = share * now.move_max;
        now.stress_band.nodes = share * now.stress_max;
    }
    const double time = world_->time(world_->wires_of(system).first);
    tally.wall_move.take_in(now.move_max, now.move_at, now.move_band, time);
    tally.wall_stress.take_in(now.stress_max, now.stress_at, now.stress_band, time);
}

void BatchWorld::follow_tips(int system)
{
    const auto [first, end] = world_->wires_of(system);
    tips_.clear();
    for (int w = first; w < end; ++w) tips_.push_back(world_->rod(w).pos(0));
    watch_exits(runs_[static_cast<std::size_t>(system)].tally.exits, tips_, places_.openings, world_->setup().mesh,
                world_->time(first));
}

void BatchWorld::settled(int system, const WireReport& report)
{
    runs_[static_cast<std::size_t>(system)].tally.take_in(joint_readings(*world_, system), report.flags, report.newton_iterations,
                                                          0);
    take_loads(system);
    keep_row(system);
}

bool BatchWorld::stepped(int system, const WireReport& report, double dt)
{
    RunTally& tally = runs_[static_cast<std::size_t>(system)].tally;
    tally.steps++;
    tally.rest_steps = loop_->rest_steps(system);
    tally.take_in(joint_readings(*world_, system), report.flags, report.newton_iterations, dt);
    follow_tips(system);
    const bool has_row = tally.steps % scene_.record_every == 0;
    if (has_row) take_loads(system), keep_row(system);
    else take_greatest_loads(system);
    take_wall(system, has_row ? Output::Wall : Output::WallUnder);
    if (score_) score_->stepped(*world_, system, dt, false, false, tally.score);
    return tally.score.reached;
}

void BatchWorld::begin()
{
    loop_->begin();
    for (int k = 0; score_ && k < world_->system_count(); ++k)
        score_->begin(*world_, k, runs_[static_cast<std::size_t>(k)].tally.score);
}

std::vector<BatchRow> BatchWorld::step()
{
    rows_.clear();
    if (!loop_->begun()) begin();
    if (!finished()) {
        loop_->step();
        stages_ += loop_->report().times;
    }
    return std::move(rows_);
}

void BatchWorld::save(std::vector<std::uint8_t>& bytes) const
{
    ByteWriter put{bytes};
    put(loop_->begun());
    for (const Run& run : runs_) {
        put(run.tally);
        put(!loop_->runs(static_cast<int>(&run - runs_.data())));
        put(run.trace);
    }
    put(world_->save_state());
}

void BatchWorld::restore(const std::uint8_t*& at, const std::uint8_t* end)
{
    ByteReader take{at, end};
    bool settled = false, finished = false;
    take(settled);
    for (Run& run : runs_) {
        const int system = static_cast<int>(&run - runs_.data());
        take(run.tally), take(finished);
        if (!is_sound(run.tally, scene_.steps()))
            throw Error(ErrorKind::BadFile,
                        "got a saved state with a counter out of range; expected one that this version wrote");
        take(run.trace);
        if (finished) world_->retire(system);
        if (settled) loop_->resume(system, static_cast<long>(run.tally.steps), static_cast<long>(run.tally.rest_steps), finished);
    }
    std::vector<std::uint8_t> state;
    take(state);
    world_->restore_state(state);
    at = take.at;
}

}  // namespace seldinger
