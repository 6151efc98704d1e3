// Steps a world, hands out copies of its state, saves and restores it.
#include "handle.h"

#include "batch/batch.h"
#include "core/bytes.h"
#include "record/checkpoint.h"
#include "setup/joint_readings.h"
#include "run/ready.h"
#include "run/wall_path.h"
#include "scene/scene_difference.h"
#include "setup/vessel_load.h"

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <numeric>
#include <type_traits>

namespace seldinger::python {

bool forked()
{
    static const pid_t started = getpid();
    return getpid() != started;
}

void check_process()
{
    if (forked())
        throw Error(ErrorKind::NoDevice,
                    "OpenCL: got a process that was forked after OpenCL had been started, without its threads; expected a fork "
                    "before the first world. "
                    "Fix: start it with multiprocessing's \"spawn\" or \"forkserver\" (AsyncVectorEnv: context=\"spawn\"), or "
                    "make the first "
                    "World after the fork.");
}

namespace {

/// What a vessel's mesh and axis depend on: its keys but those of its material, and the files' sizes and times.
std::string vessel_key(const VesselSpec& vessel)
{
    Scene scene;
    scene.vessel = vessel;
    const VesselSpec usual;
    for (double VesselSpec::*member :
         {&VesselSpec::youngs, &VesselSpec::poisson, &VesselSpec::thickness, &VesselSpec::support, &VesselSpec::support_damping,
          &VesselSpec::relaxation, &VesselSpec::pressure, &VesselSpec::wall_edge})
        scene.vessel.*member = usual.*member;
    scene.vessel.elastic = false;
    std::string key = write_scene(scene, "/");
    for (const std::filesystem::path& file : {vessel.mesh, vessel.centreline}) {
        std::error_code none;
        if (!file.empty())
            key += std::to_string(std::filesystem::file_size(file, none)) + "," +
                   std::to_string(std::filesystem::last_write_time(file, none).time_since_epoch().count()) + "\n";
    }
    return key;
}

/// The vessels of the latest worlds are kept, up to a million triangles: environments make many worlds of few vessels.
LoadedVessel loaded_vessel(const VesselSpec& vessel)
{
    constexpr std::size_t most_triangles = 1'000'000;
    static std::mutex mutex;
    static std::deque<std::pair<std::string, LoadedVessel>> kept;
    const std::string key = vessel_key(vessel);
    {
        const std::lock_guard hold(mutex);
        for (const auto& [name, known] : kept)
            if (name == key) return known;
    }
    LoadedVessel loaded = load_vessel(vessel);
    const std::lock_guard hold(mutex);
    kept.emplace_back(key, loaded);
    const auto triangles = [] {
        return std::accumulate(kept.begin(), kept.end(), std::size_t{0},
                               [](std::size_t sum, const auto& one) { return sum + one.second.mesh.triangles.size(); });
    };
    while (!kept.empty() && triangles() > most_triangles) kept.pop_front();
    return loaded;
}

}  // namespace

Handle::Handle(const std::string& text, const std::string& file, const std::vector<std::vector<std::string>>& overrides,
               int device)
{
    check_process();
    for (const std::vector<std::string>& own : overrides) scenes_.push_back(read_scene_text(text, file, own));
    const std::string shared = shared_part(scenes_.front(), scenes_.front());
    for (std::size_t k = 1; k < scenes_.size(); ++k)
        if (const std::string apart = first_difference(shared, shared_part(scenes_[k], scenes_.front())); !apart.empty())
            throw Error(ErrorKind::BadScene,
                        "copies: systems of one world share all but their instruments, feeds and coefficients of "
                        "contact, and of the first (there) and number " +
                            std::to_string(k) + " (here) " + apart + "; make worlds of their own, or use batch()");
    WorldSetup setup = ready_setup(scenes_, loaded_vessel(scenes_.front().vessel), device);
    find_wall_path(scenes_, setup);
    world_ = std::make_unique<World>(std::move(setup));
    keys_ = KeyFrames(std::span<const Scene>(scenes_));
    begin_tasks();
}

void Handle::begin_tasks()
{
    branches_ = WorldBranches(*world_);
    if (!scenes_.front().task.on) return;
    if (!watch_) watch_.emplace(scenes_.front(), *world_, ScoreWatch::Patch::WhereItCounts);
    scores_.resize(static_cast<std::size_t>(world_->system_count()));
    for (int s = 0; s < world_->system_count(); ++s) watch_->begin(*world_, s, scores_[static_cast<std::size_t>(s)]);
}

void Handle::follow_task(int system, double dt)
{
    if (watch_) watch_->stepped(*world_, system, dt, false, false, scores_[static_cast<std::size_t>(system)]);
}

void Handle::follow_tasks(double dt)
{
    for (int s = 0; s < world_->system_count(); ++s)
        if (!world_->retired(s) && !joint_report(*world_, s).failed()) follow_task(s, dt);
}

const ScoreNumbers& Handle::score(int system) const
{
    check_system(system);
    if (!watch_) throw Error(ErrorKind::BadScene, "task: the scene has no [task]; expected one with a target");
    return scores_[static_cast<std::size_t>(std::max(system, 0))];
}

const Branches& Handle::branches(int system) const
{
    check_system(system);
    return branches_.of(std::max(system, 0));
}

Branches::Place Handle::branch(int system) const
{
    check_system(system);
    return branches_.tip(world(), std::max(system, 0));
}

Handle::~Handle() { close(); }

void Handle::close()
{
    // what OpenCL and OpenGL would wait for is not in a forked child: it is left to the end of the process
    if (forked()) {
        (void)world_.release();
        new std::shared_ptr<void>(std::move(companion));
    }
    run_.reset();
    world_.reset();
    output_.reset();
    spare_.reset();
    companion.reset();
    fluoroscope.reset();
}

World& Handle::world() const
{
    if (!world_) throw Error(ErrorKind::BadScene, "the world is closed; make a new one");
    check_process();
    return *world_;
}

StepReport Handle::one_step(const std::vector<HubTarget>* targets, const std::vector<HubTarget>& start, double share, double dt,
                            const ControlForces& forces)
{
    if (!targets) return seldinger::step(*world_, keys_.control(), dt);
    control_.clear();
    for (std::size_t k = 0; k < targets->size(); ++k) {
        const HubTarget &to = (*targets)[k], &from = start[k];
        if (!to.moves) continue;
        const auto between = [share](double a, double b) { return share == 1 ? b : a + share * (b - a); };
        control_.move_to(static_cast<int>(k), between(from.advance, to.advance), between(from.turn, to.turn));
    }
    for (const HubPush& push : forces.pushes) control_.push(push.instrument, push.force, push.turn, push.spring);
    for (const PointLoad& load : forces.loads) control_.load(load.instrument, load.at, load.force, load.moment);
    return seldinger::step(*world_, control_, dt);
}

StepSummary Handle::step(const std::vector<HubTarget>* targets, long n, double dt, bool go_on,
                         const ControlForces& forces)
{
    World& at = world();
    failed_.assign(static_cast<std::size_t>(at.wire_count()), 0);
    std::vector<HubTarget> start;
    for (int w = 0; targets && n > 1 && w < at.wire_count(); ++w) {
        const WireReadings now = at.readings(w);
        const FeedSpec& feed = at.setup().wires[static_cast<std::size_t>(w)].feed;
        start.push_back({true, feed.advance + now.inserted, feed.turn + now.turned});
    }
    start.resize(std::max(start.size(), targets ? targets->size() : 0));
    forget_output();
    StepSummary all;
    while (all.steps < n) {
        const StepReport report =
            one_step(targets, start, static_cast<double>(all.steps + 1) / static_cast<double>(n), dt, forces);
        all.report.flags |= report.flags;
        all.report.newton_iterations = std::max(all.report.newton_iterations, report.newton_iterations);
        all.report.sub_steps = std::max(all.report.sub_steps, report.sub_steps);
        all.report.times += report.times;
        all.steps++;
        follow_tasks(dt);
        if (!report.failed()) continue;
        for (int w = 0; w < at.wire_count(); ++w) failed_[w] = failed_[w] || at.report(w).failed();
        if (!go_on && at.system_count() == 1) break;
    }
    return all;
}

StepReport Handle::settle()
{
    World& at = world();
    forget_output();
    const StepReport report = seldinger::settle(at);
    begin_tasks();
    return report;
}

/// The state is about to change; holders of its output keep it.
void Handle::forget_output()
{
    if (output_) spare_ = std::move(output_);
}

void Handle::begin_run(bool settles)
{
    World& at = world();
    forget_output();
    part_ = {};
    run_.emplace(at, scenes_, static_cast<RunHooks*>(this));
    if (settles) {
        part_.settling = true;
        run_->begin();
        begin_tasks();
        part_.settling = part_.failed.has_value();
        return;
    }
    for (int s = 0; s < at.system_count(); ++s) run_->resume(s, at.step_count(), 0, scene(s).integrator.scheme == Scheme::Static);
}

Handle::RunPart Handle::run(long to, long most)
{
    const World& at = world();
    if (!run_) throw Error(ErrorKind::BadScene, "run: nothing has begun");
    forget_output();
    failed_.assign(static_cast<std::size_t>(at.wire_count()), 0);
    (void)run_->run(std::min(to, at.step_count() + most));
    part_.over = part_.failed || run_->running() == 0 || at.step_count() >= to;
    return part_;
}

bool Handle::stepped(int system, const WireReport&, double dt)
{
    follow_task(system, dt);
    return watch_ && scores_[static_cast<std::size_t>(system)].reached;
}

void Handle::ended(int system, RunStatus status)
{
    if (status != RunStatus::Stopped) return;
    part_.failed = run_->report();
    const auto [first, end] = world_->wires_of(system);
    for (int w = first; w < end; ++w) failed_[static_cast<std::size_t>(w)] = world_->report(w).failed();
}

std::shared_ptr<const Output> Handle::output()
{
    const World& at = world();
    if (output_) return output_;
    if (!spare_ || spare_.use_count() > 1) spare_ = std::make_shared<Output>();
    at.read(*spare_);
    output_ = std::move(spare_);
    return output_;
}

void Handle::check_system(int system) const
{
    if (system >= world().system_count())
        throw Error(ErrorKind::BadScene, "system " + std::to_string(system) + ": there is no such system; the world has " +
                                             std::to_string(world().system_count()));
}

std::string Handle::state_hash(int system) const
{
    check_system(system);
    return system < 0 ? world().state_hash() : world().state_hash(system);
}

SavedState Handle::save(int system)
{
    const World& at = world();
    check_system(system);
    std::vector<ScoreNumbers> scores = scores_;
    if (system >= 0 && watch_) scores = {scores_[static_cast<std::size_t>(system)]};
    return {system, system < 0 ? at.save_state() : at.save_state(system), system < 0 ? output() : nullptr, std::move(scores)};
}

void Handle::restore(const SavedState& state, int into)
{
    World& at = world();
    const int system = state.system >= 0 && into >= 0 ? into : state.system;
    if (system >= at.system_count()) throw Error(ErrorKind::BadFile, "the saved state is of a system that is not there");
    if (system < 0) at.restore_state(state.bytes);
    else at.restore_state(system, state.bytes);
    std::fill(failed_.begin(), failed_.end(), 0);
    if (watch_ && system >= 0 && state.scores.size() == 1) scores_[static_cast<std::size_t>(system)] = state.scores.front();
    else if (watch_ && system < 0 && state.scores.size() == scores_.size()) scores_ = state.scores;
    if (output_) spare_ = std::move(output_);
    // a copy that only this world fills again; a damaged pickle may have brought another's
    if (state.output && state.output->wires.size() == static_cast<std::size_t>(at.wire_count()))
        output_ = std::const_pointer_cast<Output>(state.output);
}

namespace {

template <class T>
void put_list(std::vector<std::uint8_t>& bytes, const std::vector<T>& list)
{
    const std::uint64_t count = list.size();
    put_bytes(bytes, &count, 1);
    const auto* from = reinterpret_cast<const std::uint8_t*>(list.data());
    bytes.insert(bytes.end(), from, from + list.size() * sizeof(T));
}

template <class T>
void take_list(const std::uint8_t*& at, const std::uint8_t* end, std::vector<T>& list)
{
    std::uint64_t count = 0;
    take_bytes(at, end, &count, 1);
    if (count > static_cast<std::uint64_t>(end - at) / sizeof(T)) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
    list.resize(count);
    std::copy(at, at + count * sizeof(T), reinterpret_cast<std::uint8_t*>(list.data()));
    at += count * sizeof(T);
}

template <class T>
void put_raw(std::vector<std::uint8_t>& bytes, const T& value)
{
    static_assert(std::is_trivially_destructible_v<T>, "a member that owns memory is no bytes");
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}

template <class T>
void take_raw(const std::uint8_t*& at, const std::uint8_t* end, T& value)
{
    if (static_cast<std::size_t>(end - at) < sizeof value) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
    std::copy(at, at + sizeof value, reinterpret_cast<std::uint8_t*>(&value));
    at += sizeof value;
}

/// `io(member)` for everything that a wire's output has.
template <class Wire, class Raw, class List>
void visit(Wire& wire, Raw raw, List list)
{
    raw(wire.readings), raw(wire.report), raw(wire.time), raw(wire.at_rest), raw(wire.retired), raw(wire.tip);
    raw(wire.contact_area), raw(wire.contact_pressure_max), raw(wire.on_wall), raw(wire.on_instruments);
    list(wire.material_s), list(wire.radius), list(wire.curvature), list(wire.spin);
    list(wire.director), list(wire.position), list(wire.velocity), list(wire.contact_force);
}

/// Names of a sensor in a row, each closed by a 0.
std::vector<char> names_of(const SensorOutput& sensor)
{
    std::vector<char> all(sensor.name.c_str(), sensor.name.c_str() + sensor.name.size() + 1);
    for (const std::string& column : sensor.columns) all.insert(all.end(), column.c_str(), column.c_str() + column.size() + 1);
    return all;
}

void set_names(SensorOutput& sensor, const std::vector<char>& all)
{
    std::vector<std::string> names(1);
    for (const char letter : all) letter ? names.back().push_back(letter) : (void)names.emplace_back();
    names.pop_back();
    if (names.size() != sensor.values.size() + 1) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
    sensor.name = names.front();
    sensor.columns.assign(names.begin() + 1, names.end());
}

}  // namespace

std::vector<std::uint8_t> pack(const std::vector<ScoreNumbers>& scores)
{
    std::vector<std::uint8_t> bytes;
    put_list(bytes, scores);
    return bytes;
}

std::vector<ScoreNumbers> unpack_scores(const std::vector<std::uint8_t>& bytes)
{
    const std::uint8_t *at = bytes.data(), *end = at + bytes.size();
    std::vector<ScoreNumbers> scores;
    take_list(at, end, scores);
    for (const ScoreNumbers& score : scores)
        if (!is_sound(score)) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
    return scores;
}

std::vector<std::uint8_t> pack(const Output& output)
{
    std::vector<std::uint8_t> bytes;
    const auto raw = [&](const auto& value) { put_raw(bytes, value); };
    const auto list = [&](const auto& value) { put_list(bytes, value); };
    raw(output.time), raw(output.step), raw(output.parts);
    raw(static_cast<std::uint64_t>(output.wires.size()));
    for (const WireOutput& wire : output.wires) {
        visit(wire, raw, list);
        raw(static_cast<std::uint64_t>(wire.sensors.size()));
        for (const SensorOutput& sensor : wire.sensors) list(names_of(sensor)), list(sensor.values);
    }
    raw(static_cast<std::uint64_t>(output.walls.size()));
    for (const WallOutput& wall : output.walls) raw(wall.readings), list(wall.displacement), list(wall.stress);
    list(output.contacts);
    return bytes;
}

std::shared_ptr<const Output> unpack(const std::vector<std::uint8_t>& bytes)
{
    const std::uint8_t *at = bytes.data(), *end = at + bytes.size();
    auto output = std::make_shared<Output>();
    const auto raw = [&](auto& value) { take_raw(at, end, value); };
    const auto list = [&](auto& value) { take_list(at, end, value); };
    const auto resize = [&](auto& vector) {
        std::uint64_t count = 0;
        raw(count);
        if (count > bytes.size()) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
        vector.resize(count);
    };
    raw(output->time), raw(output->step), raw(output->parts);
    resize(output->wires);
    if (output->wires.empty()) throw Error(ErrorKind::BadFile, "the pickled state is damaged");
    for (WireOutput& wire : output->wires) {
        visit(wire, raw, list);
        resize(wire.sensors);
        for (SensorOutput& sensor : wire.sensors) {
            std::vector<char> names;
            list(names), list(sensor.values);
            set_names(sensor, names);
        }
    }
    resize(output->walls);
    for (WallOutput& wall : output->walls) raw(wall.readings), list(wall.displacement), list(wall.stress);
    list(output->contacts);
    return output;
}

}  // namespace seldinger::python
