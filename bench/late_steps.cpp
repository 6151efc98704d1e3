// The steps of a run that take longest, and why.
//
//     late_steps SCENE.toml [--worst 200] [--keep FILE] [--set table.key=value]…      runs the scene
//     late_steps SCENE.toml --replay FILE [--repeat 1] [--set table.key=value]…       takes the kept steps again
//     … [--trials FILE]                                                                a row for each trial of the kept steps
//     … [--least N]                                                                    causes and trials of all steps of N iterations and more
//     … [--cut N]                                                                      steps whose time is up at the trial N (World::cut_when)
//     … [--session FILE]                                                               moves the hubs as this record of a live session has it
//     … [--steps N]                                                                    the first N steps only
//
// A run prints the distributions of Newton iterations, trials and processor time per step, and keeps the steps of most iterations
// with the state before each. A replay takes the same steps by another program or another law (--set contact.friction=none): what
// falls away with a law is its share. Causes are told by what changed most in newtons from the last trial that was taken to the
// next (see Change).

#include "contact/capsule.h"
#include "core/error.h"
#include "core/exit_code.h"
#include "core/file_io.h"
#include "run/key_frames.h"
#include "scene/scene.h"
#include "session/session_record.h"
#include "setup/scene_setup.h"
#include "world/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <map>
#include <optional>
#include <string>

namespace {

using namespace seldinger;

double thread_time()
{
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Options {
    std::string scene, keep, replay, trials, session;
    std::vector<std::string> overrides;
    std::size_t worst = 200;
    int repeat = 1;
    int cut = 0;    // 0: never
    int least = 0;  // 0: the kept steps
    long steps = std::numeric_limits<long>::max();
};

Options read_options(int argc, char** argv)
{
    Options options;
    for (int k = 1; k < argc; ++k) {
        const std::string word = argv[k];
        const auto value = [&]() -> std::string {
            return k + 1 < argc ? argv[++k] : throw Error(ErrorKind::BadScene, word + ": a value is missing");
        };
        if (word == "--worst") options.worst = static_cast<std::size_t>(std::atol(value().c_str()));
        else if (word == "--keep") options.keep = value();
        else if (word == "--replay") options.replay = value();
        else if (word == "--trials") options.trials = value();
        else if (word == "--session") options.session = value();
        else if (word == "--repeat") options.repeat = std::max(1, std::atoi(value().c_str()));
        else if (word == "--cut") options.cut = std::max(0, std::atoi(value().c_str()));
        else if (word == "--least") options.least = std::max(0, std::atoi(value().c_str()));
        else if (word == "--steps") options.steps = std::max(1L, std::atol(value().c_str()));
        else if (word == "--set") options.overrides.push_back(value());
        else if (options.scene.empty() && word[0] != '-') options.scene = word;
        else throw Error(ErrorKind::BadScene, word + ": unknown. The head of bench/late_steps.cpp says what there is");
    }
    if (options.scene.empty()) throw Error(ErrorKind::BadScene, "give a scene file");
    return options;
}

/// Where the hubs go: by the scene's key frames, or as a session's record has it.
class Hubs {
public:
    Hubs(const Scene& scene, const std::string& record, long most) : keys_(scene), steps_(std::min(most, scene.steps()))
    {
        if (record.empty()) return;
        record_ = read_record(record);
        steps_ = std::min(most, record_->steps());
        for (const RecordEntry& entry : record_->entries)
            if (entry.kind == RecordEntry::Kind::Reset || entry.kind == RecordEntry::Kind::CutShort)
                throw Error(ErrorKind::BadFile, record + ": holds resets or steps cut short; expected neither");
    }

    [[nodiscard]] long steps() const { return steps_; }

    /// @param step  from 1 on
    const Control& control(const World& world, long step)
    {
        if (!record_) return keys_.control();
        const std::vector<double>& hubs = record_->entries[static_cast<std::size_t>(step - 1)].hubs;
        for (int w = 0; w < world.wire_count(); ++w)
            if (world.setup().wires[static_cast<std::size_t>(w)].feed.on)
                at_.move_to(w, hubs[2 * static_cast<std::size_t>(w)], hubs[2 * static_cast<std::size_t>(w) + 1]);
        return at_;
    }

private:
    KeyFrames keys_;
    std::optional<SessionRecord> record_;
    Control at_;
    long steps_;
};

// ---- what contact does from one trial to another ------------------------------------------------------------------------------

struct Touch {
    std::size_t record;
    Vec3 normal, friction;
    double force;
    std::uint32_t triangle;
    bool stuck;
};

/// From the last trial that was taken to this one [N]: forces that begin or end; the turn of the normal, times the force, where
/// the same facet is touched and where another one is; friction of contacts that begin to slip or stick; all others.
struct Change {
    double begins = 0, turns = 0, facets = 0, slips = 0;
    int began = 0, other_facets = 0, slipped = 0, touches = 0;
};

class Contacts {
public:
    explicit Contacts(World& world) : contact_(dynamic_cast<const CapsuleContact*>(data_of(world).forces.contact.get())) {}
    void start() { base_.clear(), known_ = false; }

    Change look(bool take)
    {
        Change change;
        if (!contact_) return change;
        read();
        change.touches = static_cast<int>(now_.size());
        if (known_) compare(change);
        if (take || !known_) base_ = now_, known_ = true;
        return change;
    }

private:
    void read()
    {
        const std::span<const ContactState> states = contact_->at_trial();
        now_.clear();
        for (std::size_t k = 0; k < states.size(); ++k) {
            const ContactState& s = states[k];
            if (s.epoch != contact_->epoch(0) || !(s.flags & SEL_CONTACT_ACTIVE)) continue;
            now_.push_back({k,
                            {s.normal[0], s.normal[1], s.normal[2]},
                            {s.friction[0], s.friction[1], s.friction[2]},
                            s.normal_force,
                            s.triangle,
                            (s.flags & SEL_CONTACT_STUCK) != 0});
        }
    }

    void compare(Change& change) const
    {
        std::size_t b = 0;
        const auto begins = [&](const Touch& t) { change.begins = std::max(change.begins, t.force), ++change.began; };
        for (const Touch& now : now_) {
            while (b < base_.size() && base_[b].record < now.record) begins(base_[b++]);
            if (b == base_.size() || base_[b].record != now.record) {
                begins(now);
                continue;
            }
            const Touch& was = base_[b++];
            const double turn = std::min(was.force, now.force) * (now.normal - was.normal).norm();
            double& of = now.triangle != was.triangle ? change.facets : change.turns;
            of = std::max(of, turn);
            change.other_facets += now.triangle != was.triangle;
            if (now.stuck == was.stuck) continue;
            ++change.slipped;
            change.slips = std::max(change.slips, (now.friction - was.friction).norm());
        }
        while (b < base_.size()) begins(base_[b++]);
    }

    const CapsuleContact* contact_;
    bool known_ = false;
    std::vector<Touch> base_, now_;
};

// ---- steps ------------------------------------------------------------------------------------------------------------------------

struct Seen {
    NewtonTrial trial;
    Change change;
};

struct Step {
    long number = 0;
    int iterations = 0, trials = 0, sub_steps = 1, nodes = 0;
    bool cut_short = false;
    double hand = 0;  // force [N]
    double time = 0;  // of the processor [s]
    std::vector<std::uint8_t> before;
    std::vector<Seen> seen;
};

class Recorder {
public:
    Recorder(World& world, bool look, int cut) : world_(world), contacts_(world), look_(look)
    {
        if (cut > 0) world.cut_when([this, cut] { return ++asked_ >= cut; });
        data_of(world).solver->watch([this](const NewtonTrial& trial) {
            ++step_.trials;
            if (look_) step_.seen.push_back({trial, contacts_.look(trial.end == NewtonTrial::End::Taken)});
        });
    }

    Step take(const Control& control, double dt, long number)
    {
        step_ = {};
        step_.number = number;
        contacts_.start();
        asked_ = 0;
        const double start = thread_time();
        const StepReport report = step(world_, control, dt);
        step_.time = thread_time() - start;
        if (report.failed()) throw Error(ErrorKind::Stopped, fmt::format("step {} failed", number));
        step_.iterations = report.newton_iterations;
        step_.sub_steps = report.sub_steps;
        step_.nodes = world_.rod(0).n;
        step_.cut_short = (report.flags & StepCutShort) != 0;
        step_.hand = world_.readings(0).hand_force;
        return std::move(step_);
    }

private:
    World& world_;
    Contacts contacts_;
    bool look_;
    int asked_ = 0;
    Step step_;
};

// ---- output -----------------------------------------------------------------------------------------------------------------------

void print_row(const char* what, std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const auto at = [&](double p) {
        return values[std::min(values.size() - 1, static_cast<std::size_t>(p * static_cast<double>(values.size())))];
    };
    double sum = 0;
    for (const double v : values) sum += v;
    fmt::print("{:12} mean {:8.4g}  p50 {:7.4g}  p90 {:7.4g}  p99 {:7.4g}  p99.9 {:7.4g}  most {:7.4g}\n", what,
               sum / static_cast<double>(values.size()), at(0.5), at(0.9), at(0.99), at(0.999), values.back());
}

void print_steps(const std::vector<Step>& steps)
{
    const auto row = [&](const char* what, auto value) {
        std::vector<double> values;
        for (const Step& step : steps) values.push_back(value(step));
        print_row(what, std::move(values));
    };
    row("iterations", [](const Step& s) { return s.iterations; });
    row("trials", [](const Step& s) { return s.trials; });
    row("hand [N]", [](const Step& s) { return s.hand; });
    row("time [ms]", [](const Step& s) { return 1e3 * s.time; });
    fmt::print("cut short    {}\n", std::count_if(steps.begin(), steps.end(), [](const Step& s) { return s.cut_short; }));
    fmt::print("halved       {}\n", std::count_if(steps.begin(), steps.end(), [](const Step& s) { return s.sub_steps > 1; }));
}

const char* name_of(NewtonTrial::End end)
{
    using enum NewtonTrial::End;
    switch (end) {
        case Taken:
            return "taken";
        case Refused:
            return "refused";
        case TooLong:
            return "too long";
        case Solved:
            return "solved";
        case Settled:
            return "settled";
        case GivenUp:
            return "given up";
    }
    return "";
}

/// Of a trial after the first direction: what changed most in newtons, where that is more than the tolerance leaves.
std::string cause(const Seen& s)
{
    if (s.trial.end == NewtonTrial::End::Refused) return "refused by contact";
    if (s.trial.residual < 10) return "within ten tolerances";
    const Change& c = s.change;
    const std::array<std::pair<double, const char*>, 4> of{{{c.begins, "contact begins or ends"},
                                                            {c.facets, "another facet"},
                                                            {c.turns, "the normal turns"},
                                                            {c.slips, "stick and slip"}}};
    const auto most = std::max_element(of.begin(), of.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (most->first < 3e-7) return s.trial.projected ? "Hessian not positive" : "the wire's own shape";
    return most->second;
}

void print_causes(const std::vector<Step>& steps)
{
    std::map<std::string, int> trials, led;
    int all = 0, late = 0;
    for (const Step& step : steps) {
        std::map<std::string, int> here;
        for (const Seen& s : step.seen) {
            if (s.trial.iteration < 2 || s.trial.end == NewtonTrial::End::Solved) continue;
            ++trials[cause(s)], ++here[cause(s)], ++all;
        }
        if (here.empty()) continue;
        const auto most =
            std::max_element(here.begin(), here.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
        ++led[most->first], ++late;
    }
    fmt::print("\n{:28} {:>10} {:>10}\n", "cause", "trials [%]", "steps [%]");
    for (const auto& [name, count] : trials)
        fmt::print("{:28} {:10.1f} {:10.1f}\n", name, 100.0 * count / all, 100.0 * led[name] / late);
}

void write_trials(const std::string& file, const std::vector<Step>& steps)
{
    std::string text =
        "step,end,iteration,alpha,move_um,residual,contraction,projected,touches,began,begins_mn,turns_mn,facets,facets_mn,"
        "slipped,slips_mn\n";
    for (const Step& step : steps)
        for (const auto& [t, c] : step.seen)
            text += fmt::format("{},{},{},{:.3g},{:.4g},{:.4g},{:.3g},{},{},{},{:.3g},{:.3g},{},{:.3g},{},{:.3g}\n", step.number,
                                name_of(t.end), t.iteration, t.alpha, 1e6 * t.move, t.residual, t.contraction,
                                t.projected ? 1 : 0, c.touches, c.began, 1e3 * c.begins, 1e3 * c.turns, c.other_facets,
                                1e3 * c.facets, c.slipped, 1e3 * c.slips);
    write_file(file, text);
}

// ---- kept steps -------------------------------------------------------------------------------------------------------------------

void write_kept(const std::string& file, const std::vector<Step>& steps)
{
    std::string bytes;
    const auto put = [&](std::int64_t number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof(number)); };
    for (const Step& step : steps) {
        put(step.number);
        put(static_cast<std::int64_t>(step.before.size()));
        bytes.append(reinterpret_cast<const char*>(step.before.data()), step.before.size());
    }
    write_file(file, bytes);
}

std::vector<Step> read_kept(const std::string& file)
{
    const std::string bytes = read_file(file);
    std::vector<Step> steps;
    for (std::size_t at = 0; at + 16 <= bytes.size();) {
        std::int64_t head[2];
        std::memcpy(head, bytes.data() + at, sizeof(head));
        at += sizeof(head);
        if (head[1] < 0 || static_cast<std::size_t>(head[1]) > bytes.size() - at)
            throw Error(ErrorKind::BadFile, file + ": cut off");
        Step step;
        step.number = head[0];
        step.before.assign(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                           bytes.begin() + static_cast<std::ptrdiff_t>(at) + head[1]);
        at += static_cast<std::size_t>(head[1]);
        steps.push_back(std::move(step));
    }
    return steps;
}

void take_again(World& world, const Scene& scene, Hubs& hubs, std::vector<Step>& steps, bool look, int repeat, int cut)
{
    Recorder recorder(world, look, cut);
    for (Step& kept : steps) {
        std::vector<double> times;
        for (int k = 0; k < repeat; ++k) {
            world.restore_state(kept.before);
            Step taken = recorder.take(hubs.control(world, kept.number), scene.dt, kept.number);
            times.push_back(taken.time);
            taken.before = std::move(kept.before);
            kept = std::move(taken);
        }
        std::sort(times.begin(), times.end());
        kept.time = times[times.size() / 2];
    }
}

std::vector<Step> run_scene(World& world, const Scene& scene, Hubs& hubs, std::vector<Step>& kept, const Options& options)
{
    const std::size_t worst = options.worst;
    Recorder recorder(world, options.least > 0, options.cut);
    std::vector<Step> steps;
    int least = 2;  // iterations of a step that is kept
    const auto thin_out = [&] {
        std::stable_sort(kept.begin(), kept.end(), [](const Step& a, const Step& b) { return a.iterations > b.iterations; });
        if (kept.size() <= worst) return;
        kept.resize(worst);
        least = kept.back().iterations;
    };
    for (long k = 1; k <= hubs.steps(); ++k) {
        std::vector<std::uint8_t> before = world.save_state();
        steps.push_back(recorder.take(hubs.control(world, k), scene.dt, k));
        if (steps.back().iterations <= least) continue;
        kept.push_back(steps.back());
        kept.back().before = std::move(before);
        if (kept.size() > 2 * worst) thin_out();
    }
    thin_out();
    std::sort(kept.begin(), kept.end(), [](const Step& a, const Step& b) { return a.number < b.number; });
    return steps;
}

int run(const Options& options)
{
    const Scene scene = read_scene(options.scene, options.overrides);
    World world(make_setup(scene));
    Hubs hubs(scene, options.session, options.steps);
    std::vector<Step> kept;
    if (options.replay.empty()) {
        std::vector<Step> all = run_scene(world, scene, hubs, kept, options);
        print_steps(all);
        if (options.least > 0) {
            std::erase_if(all, [&](const Step& s) { return s.iterations < options.least; });
            fmt::print("\n{} steps of {} iterations and more:\n", all.size(), options.least);
            print_causes(all);
            if (!options.trials.empty()) write_trials(options.trials, all);
        }
        if (!options.keep.empty()) write_kept(options.keep, kept);
        fmt::print("state        {}\n\nthe {} of most iterations, taken again:\n", world.state_hash(), kept.size());
    } else {
        kept = read_kept(options.replay);
    }
    if (kept.empty()) return 0;
    take_again(world, scene, hubs, kept, true, 1, options.cut);
    print_causes(kept);
    if (!options.trials.empty() && options.least == 0) write_trials(options.trials, kept);
    fmt::print("\n");
    take_again(world, scene, hubs, kept, false, options.repeat, options.cut);
    print_steps(kept);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        return run(read_options(argc, argv));
    } catch (const seldinger::Error& error) {
        fmt::print(stderr, "late_steps: {}\n", error.what());
        return exit_code(error.kind());
    }
}
