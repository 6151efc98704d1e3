// The steps of a run that take longest, and why.
//
//     late_steps SCENE.toml [--least 4] [--set table.key=value]…    runs the scene; causes of all steps of so many iterations
//     … [--cut N]                                                    steps whose time is up at the trial N (World::cut_when)
//     … [--session FILE]                                             moves the hubs as this record of a live session has it
//     … [--steps N]                                                  the first N steps only
//
// Prints the distributions of Newton iterations, trials and processor time per step, of all and of the late ones (so many
// iterations and more). Causes are told by what changed most in newtons from the last trial that was taken to the next (Change).

#include "contact/capsule.h"
#include "core/error.h"
#include "core/exit_code.h"
#include "setup/key_frames.h"
#include "scene/scene.h"
#include "session/session_record.h"
#include "setup/scene_setup.h"
#include "world/world.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
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
    std::string scene, session;
    std::vector<std::string> overrides;
    int cut = 0;  // 0: never
    int least = 4;
    long steps = std::numeric_limits<long>::max();
};

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

/// From the last trial that was taken to this one [N]: forces that begin or end; the turn of the normal, times the force, where
/// the same facet is touched and where another one is; friction of contacts that begin to slip or stick; all others.
struct Change {
    double begins = 0, turns = 0, facets = 0, slips = 0;
};

class Contacts {
public:
    explicit Contacts(World& world) : contact_(dynamic_cast<const CapsuleContact*>(data_of(world).forces.contact.get())) {}
    void start() { base_.clear(), known_ = false; }

    Change look(bool take)
    {
        if (!contact_) return {};
        const Touches now = touches();
        const Change change = known_ ? from_base(now) : Change{};
        if (take || !known_) base_ = now, known_ = true;
        return change;
    }

private:
    using Touches = std::map<std::size_t, ContactState>;  // by their place in the arrays

    [[nodiscard]] Touches touches() const
    {
        Touches found;
        const std::span<const ContactState> states = contact_->at_trial();
        for (std::size_t k = 0; k < states.size(); ++k)
            if (states[k].epoch == contact_->epoch(0) && (states[k].flags & SEL_CONTACT_ACTIVE)) found.emplace(k, states[k]);
        return found;
    }

    [[nodiscard]] Change from_base(const Touches& now) const
    {
        const auto apart = [](const auto& a, const auto& b) { return Vec3(a[0] - b[0], a[1] - b[1], a[2] - b[2]).norm(); };
        Change change;
        for (const auto& [k, was] : base_)
            if (!now.count(k)) change.begins = std::max<double>(change.begins, was.normal_force);
        for (const auto& [k, is] : now) {
            const auto found = base_.find(k);
            if (found == base_.end()) {
                change.begins = std::max<double>(change.begins, is.normal_force);
                continue;
            }
            const ContactState& was = found->second;
            double& of = is.triangle != was.triangle ? change.facets : change.turns;
            of = std::max(of, std::min<double>(was.normal_force, is.normal_force) * apart(is.normal, was.normal));
            if ((is.flags ^ was.flags) & SEL_CONTACT_STUCK)
                change.slips = std::max(change.slips, apart(is.friction, was.friction));
        }
        return change;
    }

    const CapsuleContact* contact_;
    bool known_ = false;
    Touches base_;
};

// ---- steps --------------------------------------------------------------------------------------------------------------------

struct Seen {
    NewtonTrial trial;
    Change change;
};

struct Step {
    int iterations = 0, trials = 0, sub_steps = 1;
    bool cut_short = false;
    double hand = 0;  // force [N]
    double time = 0;  // of the processor [s]
    std::vector<Seen> seen;
};

class Recorder {
public:
    Recorder(World& world, int cut) : world_(world), contacts_(world)
    {
        if (cut > 0) world.cut_when([this, cut] { return ++asked_ >= cut; });
        data_of(world).solver->watch([this](const NewtonTrial& trial) {
            ++step_.trials;
            step_.seen.push_back({trial, contacts_.look(trial.end == NewtonTrial::End::Taken)});
        });
    }

    Step take(const Control& control, double dt, long number)
    {
        step_ = {};
        contacts_.start();
        asked_ = 0;
        const double start = thread_time();
        const StepReport report = step(world_, control, dt);
        step_.time = thread_time() - start;
        if (report.failed()) throw Error(ErrorKind::Stopped, fmt::format("step {} failed", number));
        step_.iterations = report.newton_iterations;
        step_.sub_steps = report.sub_steps;
        step_.cut_short = (report.flags & StepCutShort) != 0;
        step_.hand = world_.readings(0).hand_force;
        return std::move(step_);
    }

private:
    World& world_;
    Contacts contacts_;
    int asked_ = 0;
    Step step_;
};

// ---- output -------------------------------------------------------------------------------------------------------------------

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

int run(const Options& options)
{
    const Scene scene = read_scene(options.scene, options.overrides);
    World world(make_setup(scene));
    Hubs hubs(scene, options.session, options.steps);
    Recorder recorder(world, options.cut);
    std::vector<Step> all, late;
    for (long k = 1; k <= hubs.steps(); ++k) {
        all.push_back(recorder.take(hubs.control(world, k), scene.dt, k));
        if (all.back().iterations >= options.least) late.push_back(all.back());
        all.back().seen.clear();
    }
    print_steps(all);
    fmt::print("state        {}\n\n{} steps of {} iterations and more:\n", world.state_hash(), late.size(), options.least);
    if (late.empty()) return 0;
    print_causes(late);
    fmt::print("\n");
    print_steps(late);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App app("The steps of a run that take longest, and why.");
    app.add_option("scene", options.scene, "scene file")->required();
    app.add_option("--least", options.least, "iterations of a late step");
    app.add_option("--cut", options.cut, "steps whose time is up at this trial");
    app.add_option("--session", options.session, "record of a live session");
    app.add_option("--steps", options.steps, "the first so many steps only");
    app.add_option("--set", options.overrides, "table.key=value")->allow_extra_args(false);
    CLI11_PARSE(app, argc, argv);
    try {
        return run(options);
    } catch (const Error& error) {
        fmt::print(stderr, "late_steps: {}\n", error.what());
        return exit_code(error.kind());
    }
}
