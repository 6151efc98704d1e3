// [[force]] of a scene: a plugin acts as a force of a program does, its state and record belong to the run, and one that is wrong
// is refused in one line.

#include "core/error.h"
#include "core/file_io.h"
#include "core/fnv1a.h"
#include "models/run_model.h"
#include "record/recorder.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "world/world.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

namespace seldinger::test::test_force_plugin {

namespace {

const std::string cantilever =
    "[scene]\nduration_s = 0.01\ndt_s = 0.001\n[wire]\nlength_m = 0.1\nradius_m = 0.0002\ndensity = 6450.0\nbend_nm2 = 5e-5\n"
    "twist_nm2 = 4e-5\nstretch_n = 7000.0\nnodes = 11\n[[hold]]\nat = \"base\"\nposition = true\n";

std::string scene_with(const std::string& plugin, const std::string& keys)
{
    return cantilever + fmt::format("[[force]]\nplugin = \"{}.so\"\n{}\n", plugin, keys);
}

Scene read(const std::string& text) { return read_scene_text(text, std::filesystem::temp_directory_path() / "plugin.toml"); }

/// Takes a scene to its eighth step.
void go(const std::string& plugin, const std::string& keys)
{
    World world(make_setup(read(scene_with(plugin, keys))));
    for (int k = 0; k < 8; ++k)
        if (step(world, 1e-3).failed()) throw Error(ErrorKind::Stopped, "a step failed");
}

void refused(const std::string& plugin, const std::string& keys, const std::string& part)
{
    check_refused([&] { go(plugin, keys); }, {part});
}

/// Folders that are looked in, for the life of this.
struct Plugins {
    explicit Plugins(const std::string& folders) { REQUIRE(setenv("SELDINGER_PLUGINS", folders.c_str(), 1) == 0); }
    ~Plugins() { unsetenv("SELDINGER_PLUGINS"); }
    Plugins(const Plugins&) = delete;
    Plugins& operator=(const Plugins&) = delete;
};

}  // namespace

TEST_SUITE("setup/force_plugin")
{
    TEST_CASE("property: what a plugin does wrong is one line that names it")
    {
        refused("force_plugin", "", "plugin force_plugin.so: got no such file in the folders of SELDINGER_PLUGINS (wh");
        const TemporaryFolder folder;
        write_file(folder.path() / "text.so", "no library");
        const Plugins plugins(":/no/such/folder:" + folder.path().string() + ":" SEL_PLUGINS);
        const char* pull = "pull_n = [0.0, 0.0, 0.001]";
        const auto fails = [&](const char* how, const char* part) {
            refused("force_plugin", fmt::format("{}\nfails = \"{}\"", pull, how), part);
        };
        CHECK_NOTHROW(go("force_plugin", pull));
        refused("no_such", pull, "plugin no_such.so: got no such file in the folders of SELDINGER_PLUGINS (:/no/such");
        refused("../plugins/force_plugin", pull, "got a path; expected a file's name");
        refused("text", pull, "text.so: got no library that can be opened");
        refused("force_plugin_none", pull, "force_plugin_none.so: got a library without a force; expected a plugin. Fix: ");
        refused("force_plugin_old", pull, "got a plugin for \"force 0, C++ ABI 1\"; expected \"force 1, C++ ABI ");
        refused("force_plugin", "", "force_plugin.so: pull_n: is missing; expected numbers");
        refused("force_plugin", "pull_n = \"up\"", "pull_n: got a value of another kind; expected numbers");
        refused("force_plugin", "pull_n = [1.0, 2.0]", "pull_n: got other numbers; expected three numbers [x, y, z]");
        refused("force_plugin", "pull_n = true", "force.0.pull_n: got true; expected a number");
        refused("force_plugin", "pull_n = [0.0, nan, 0.0]", "force.0.pull_n: got nan; expected a number");
        refused("force_plugin", fmt::format("{}\npush_n = 1.0", pull), "push_n: unknown key; the plugin does not ask for");
        refused("force_plugin", fmt::format("{}\n\"pull n\" = 1.0", pull), "force.0: expected keys of letters, digits");
        refused("force_plugin", fmt::format("{}\nat_m = 0.2", pull), "pull\": instrument 0: places: got 0.2 m");
        refused("force_plugin", fmt::format("{}\ninstrument = \"sheath\"", pull), "force.0.instrument: ");
        fails("when made", "force_plugin.so: pull_n: got a bad day; expected a good one");
        fails("with a number", "force_plugin.so: got something thrown that is no std::exception");
        fails("in a step", "force_plugin.so: forces: got enough");
        fails("in a step with a number", "force_plugin.so: forces: got something thrown");
        fails("without numbers", "force \"pull\": got a force that is not finite");
    }

    TEST_CASE("property: what plugins are compiled against has not changed without a new version")
    {
        std::string declared;
        std::istringstream lines(read_file(std::filesystem::path(SEL_SOURCE_DIR) / "engine/include/seldinger/solve/force.h"));
        for (std::string line; std::getline(lines, line);)
            for (const char c : line.substr(0, line.find("//")))
                if (c != ' ') declared += c;
        CHECK_MESSAGE(fmt::format("{:016x}", fnv1a(declared.data(), declared.size())) == "763bf326280c416c",
                      "force.h has changed: count SELDINGER_FORCE_VERSION up, and put this hash here");
    }

    TEST_CASE("property: a plugin's force has the bits of the same force of a program, in twins, too, and comes back from a file")
    {
        const Plugins plugins(SEL_PLUGINS);
        class Pull final : public Force {
        public:
            Pull() { state = {0, 1}; }
            void forces(const ForcePoints& at, std::span<PointForce> out) const override
            {
                out[0].force = at.state[1] * Vec3(0, 0, 0.001);
            }
            void accept(const ForcePoints& at, std::span<double> next) const override
            {
                next[0] = at.time > 0.0025 ? at.time : 0;
                next[1] = 1 - 10 * at.position[0].norm();
            }
        };
        const Scene scene = read(scene_with("force_plugin", "pull_n = [0.0, 0.0, 0.001]\nname = \"upwards\""));
        World plugin(make_setup(scene)), own(make_setup(read(cantilever)));
        own.add_force(0, std::make_shared<Pull>());
        World twin = plugin.twin(), twin_of_own = own.twin();
        for (World* world : {&plugin, &own, &twin, &twin_of_own})
            for (int k = 0; k < 5; ++k) REQUIRE(!step(*world, 1e-3).failed());
        CHECK(plugin.state_hash() != World(make_setup(scene)).state_hash());
        for (World* world : {&own, &twin, &twin_of_own}) CHECK(world->state_hash() == plugin.state_hash());
        const std::string written = write_scene(scene, std::filesystem::temp_directory_path());
        CHECK(write_scene(read(written), std::filesystem::temp_directory_path()) == written);
        CHECK(has(written, "pull_n = [0.0, 0.0, 0.001]"));
        CHECK(has(written, "name = \"upwards\""));
    }

    // A study's own audit knows loads alone: what a force puts in would be energy from nothing.
    TEST_CASE("property: a study does not take the work of a plugin's force for energy made from nothing")
    {
        const Plugins plugins(SEL_PLUGINS);
        const StudyScene study = load_study_scene(read(scene_with("force_plugin", "pull_n = [0.0, 0.0, 0.5]\nat_m = 0.05")));
        const ModelRun run = run_model(study, model_of(study.scene), {});
        CHECK(run.complete);
        CHECK(!run.verdict.had(Outcome::BlowUp));
    }

    TEST_CASE("property: a record has a row for each step in which its first number changes, and goes on after a checkpoint")
    {
        const Plugins plugins(SEL_PLUGINS);
        const TemporaryFolder folder;
        const Scene scene = read(scene_with("force_plugin", "pull_n = [0.0, 0.0, 0.001]\nname = \"upwards\""));
        const RepairReport none;
        World world(make_setup(scene));
        const auto take = [&](Recorder& recorder, World& of, int steps) {
            for (int k = 0; k < steps; ++k) {
                const StepReport report = step(of, scene.dt);
                REQUIRE_FALSE(report.failed());
                recorder.stepped(of.output(), report, 0.001);
            }
        };
        {
            Recorder recorder(scene, none, world, folder.path());
            take(recorder, world, 4);
            recorder.checkpoint(world, RunStatus::Interrupted, 0.1);
            take(recorder, world, 2);
        }
        const std::string whole = read_file(folder.path() / "sensor_upwards.csv");
        CHECK(std::ranges::count(whole, '\n') == 1 + 4);  // at 3, 4, 5 and 6 ms
        CHECK(whole.starts_with("time_s,part\n0.003,"));
        World resumed(make_setup(scene));
        Recorder recorder(scene, none, resumed, folder.path(), read_checkpoint(folder.path() / "checkpoint.bin"));
        CHECK(std::ranges::count(read_file(folder.path() / "sensor_upwards.csv"), '\n') == 1 + 2);
        take(recorder, resumed, 2);
        recorder.checkpoint(resumed, RunStatus::Interrupted, 0.1);
        CHECK(read_file(folder.path() / "sensor_upwards.csv") == whole);
        CHECK(resumed.output().wires[0].sensors[0].values == world.output().wires[0].sensors[0].values);
        const std::string once = scene_with("force_plugin", "pull_n = [0.0, 0.0, 0.001]\nname = \"../a b\"");
        const Scene two = read(once + once.substr(once.find("[[force]]")));
        World of_two(make_setup(two));
        Recorder both(two, none, of_two, folder.path());
        for (const char* file : {"sensor____a_b.csv", "sensor____a_b_2.csv"})
            CHECK(read_file(folder.path() / file) == "time_s,part\n");
    }
}

}  // namespace seldinger::test::test_force_plugin
