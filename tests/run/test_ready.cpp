// ready_setup: `check` refuses what `run` refuses before its first step, in the same words and without a device.
#include "core/error.h"
#include "engine.h"
#include "run/ready.h"
#include "run/score.h"
#include "scene/scene.h"
#include "support/refusal.h"
#include "support/scenes.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace seldinger::test::test_ready {

namespace {

const std::string wire = scene_text(0.01) + wire_text(0.3, 1e-4, 8e-5, 31);
const std::string feed =
    "[feed]\npoint = [0, 0, 0]\ndirection = [1, 0, 0]\nkeys = [{t_s = 0, advance_m = 0}, {t_s = 1, advance_m = 0.1}]\n";
const std::string tube = "[vessel]\nshape = \"tube\"\nradius_m = 0.01\nlength_m = 0.5\ntriangles = 2000\n";
const std::string plane = "[vessel]\nshape = \"plane\"\nsize_m = 1\n";

std::string hold(const std::string& at, const std::string& what = "position = true", const std::string& of = "")
{
    return fmt::format("[[hold]]\n{}at = {}\n{}\n", of.empty() ? "" : "instrument = \"" + of + "\"\n", at, what);
}

/// A wire in a catheter on one centreline, both inside by so much.
std::string merged(double catheter, double inner)
{
    const auto part = [](const char* name, const char* sizes, const char* place, double advance) {
        return fmt::format(
            "[[instrument]]\nname = \"{}\"\n{}length_m = 0.1\ndensity = 7900.0\nbend_nm2 = 1e-5\ntwist_nm2 = 1e-5\nstretch_n = "
            "1e4\n"
            "nodes = 21\n[instrument.feed]\n{}keys = [{{t_s = 0.0, advance_m = {}}}, {{t_s = 0.1, advance_m = 0.06}}]\n",
            name, sizes, place, advance);
    };
    return "[scene]\nduration_s = 0.02\ndt_s = 0.002\n" +
           part("catheter", "radius_m = 0.001\nlumen_radius_m = 0.0007\n",
                "point = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n", catheter) +
           part("wire", "radius_m = 0.0005\n", "", inner) + "[coaxial]\norder = [\"catheter\", \"wire\"]\nmodel = \"merged\"\n";
}

std::string thirteen()
{
    std::string text = wire;
    for (int k = 0; k < 13; ++k) text += hold(fmt::format("{}", 0.01 + 0.02 * k), "direction = true");
    return text;
}

std::string placed(const std::string& how) { return wire + "place = {" + how + "}\n"; }

/// A refusal, written as one `throw Error` in that file: a scene that meets it, or why none can.
struct Refusal {
    const char* file;
    std::string scene, says;
    int throws = 1;
};

const char* const saved = "of a saved state, which the checkpoint's reader has compared with the scene";
const char* const steps = "of a step's control, which C++ and Python give";
const char* const forces = "of a program's force, which C++ and Python give";

const std::vector<Refusal>& refusals()
{
    static const std::vector<Refusal> all = {
        {"files/run/score.cpp", wire + feed + tube + "[task]\ntarget = {branch = 2}\n",
         "task.target.branch: got 2; expected 1 to 1"},
        {"files/run/score.cpp", wire + feed + tube + "[task]\ntarget = {branch = \"9.9\"}\n", "task.target.branch: got \"9.9\""},
        {"files/run/score.cpp", wire + feed + tube + "[task]\ntarget = {branch = 1, beyond_m = 0.6}\n",
         "task.target.beyond_m: got 0.6 m"},
        {"physics/solve/constraints.cpp", wire + feed + hold("0.05"), "hold[0].at: 0.05 m from the tip is not on the wire"},
        {"physics/solve/constraints.cpp", thirteen(), "got 13 that hold a direction or spin"},
        {"physics/solve/constraints.cpp", wire + hold("0.1") + hold("0.102"), "both hold the position of the same node"},
        {"physics/solve/constraints.cpp", wire + hold("0.1", "position = false"), "hold.0.position: fixes nothing"},
        {"physics/solve/constraints.cpp", merged(0.01, 0.02) + hold("\"base\"", "position = true", "wire"),
         "the base is held by [feed]"},
        {"physics/solve/constraints.cpp", merged(0.01, 0.02) + hold("0.05", "position = true", "wire"),
         "0.05 m from the tip is outside"},
        {"physics/solve/constraints.cpp", merged(0.01, 0.02) + hold("\"tip\"", "position = [\"x\"]", "wire"),
         "got some of x, y and z"},
        {"physics/world/merged_holds.cpp", merged(0, 0) + hold("\"tip\"", "position = true", "wire"),
         "a wire that is outside at the start"},
        {"physics/world/merged_holds.cpp",
         merged(0.02, 0.02) + hold("\"tip\"", "position = true", "wire") + hold("\"tip\"", "position = true", "catheter"),
         "got two holds of the position of one centreline"},
        {"bodies/rod/place.cpp", placed("shape = \"centreline\"") + plane, "needs a vessel with a centreline"},
        {"bodies/rod/place.cpp", placed("shape = \"centreline\", from_m = 0.6") + tube,
         "is beyond the vessel's centreline of 0.5 m"},
        {"bodies/rod/place.cpp", placed("shape = \"points\", points = [[0, 0, 0], [0.2, 0, 0], [0.1, 0.001, 0]]"),
         "folds back on itself at point 1"},
        {"bodies/rod/place.cpp", placed("shape = \"points\", points = [[0, 0, 0], [0.15, 0, 0], [0.15, 1e-7, 0], [0, 1e-7, 0]]"),
         "folds back on itself 0.1"},
        {"bodies/rod/place.cpp", placed("shape = \"centreline\", from_m = 0.3") + tube,
         "is longer than the 0.2 m that its shape offers"},
        {"elastic/shell/wall_edge.cpp", wire + feed + tube + "wall = \"elastic\"\nwall_edge_m = 1e-6\n",
         "more than half of this machine's memory"},
        {"elastic/shell/shell_assemble.cpp",
         placed("base = [0, 0, 0.001], direction = [1, 0, 0]") + plane + "wall = \"elastic\"\npressure_pa = 1000\n",
         "vessel.pressure: got 1000 Pa"},
        {"elastic/shell/shell.cpp", wire + feed + tube + "wall = \"elastic\"\nyoungs_pa = 0\n", "vessel.youngs_pa: got 0"},
        {"physics/contact/make_contact.cpp", wire + "[contact]\ndetection = \"layer\"\nnormal = \"barrier\"\n",
         "needs material samples"},
        {"physics/contact/make_contact.cpp", wire + "[contact]\ndetection = \"layer\"\nprecision = \"float32\"\n",
         "\"float32\" is supported for"},
        {"physics/contact/make_contact.cpp", wire + "[contact]\ndetection = \"rays\"\n", "got 'rays'; expected one of"},
        {"physics/world/world_check.cpp", "", "check_setup, the first that ready_setup asks"},
        {"physics/contact/rigid_only.cpp", "", "of a program that was built without walls that deform"},
        {"elastic/surface/control_mesh.cpp", "", "a mesh that is no sheet: apps/test_bad_input"},
        {"elastic/surface/loop_topology.cpp", "", "of a control mesh, which control_mesh.cpp has made a sheet"},
        {"files/run/wall_path.cpp", "", "a signal in a trial run"},
        {"files/run/summary_lines.cpp", "", "a damaged summary of an earlier run"},
        {"physics/world/control.cpp", "", steps, 3},
        {"physics/world/world.cpp", "", forces, 5},
        {"physics/solve/given_forces.cpp", "", forces},
        {"physics/world/world_state.cpp", "", saved, 4},
        {"physics/contact/layer.cpp", "", saved},
        {"physics/contact/point_states.cpp", "", saved},
    };
    return all;
}

std::string refusal(const auto& work) { return test::refusal(work, ErrorKind::BadScene); }

/// Errors thrown in a file.
int throws_in(const std::filesystem::path& file)
{
    std::ifstream stream(file);
    int count = 0;
    for (std::string line; std::getline(stream, line);) count += line.find("throw Error(") != std::string::npos;
    return count;
}

}  // namespace

TEST_SUITE("run/ready")
{
    TEST_CASE("property: what a run refuses before its first step, check refuses in the same words")
    {
        for (const Refusal& one : refusals()) {
            if (one.scene.empty()) continue;
            CAPTURE(one.scene);
            const std::string by_run = refusal([&] {
                const Scene scene = read_scene_text(one.scene, "/tmp/case.toml");
                const World world(make_setup(scene));
                if (scene.task.on) (void)ScoreWatch(scene, world, ScoreWatch::Patch::Always);
            });
            const std::string by_check = refusal([&] { (void)ready_setup(read_scene_text(one.scene, "/tmp/case.toml")); });
            CHECK_MESSAGE(by_check.find(one.says) != std::string::npos, by_check);
            CHECK_MESSAGE(by_check.ends_with(by_run), by_run);
        }
        for (const std::string& good : {wire + hold("0.1"), wire + feed + tube, merged(0.01, 0.02)})
            CHECK(refusal([&] { (void)ready_setup(read_scene_text(good, "/tmp/case.toml")); }).empty());
    }

    TEST_CASE("property: every refusal of a run is among those above")
    {
        const std::filesystem::path engine = std::filesystem::path(SEL_SOURCE_DIR) / "engine";
        std::map<std::string, int> known;
        for (const Refusal& one : refusals()) known[one.file] += one.throws;
        for (const char* folder : {"physics", "bodies/rod", "bodies/nodes", "elastic", "files/run"})
            for (const auto& entry : std::filesystem::recursive_directory_iterator(engine / folder)) {
                if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
                const std::string name = std::filesystem::relative(entry.path(), engine).generic_string();
                CAPTURE(name);
                // another one here: does ready_setup ask for it? Then add a scene that meets it
                CHECK(throws_in(entry.path()) == (name == "files/run/ready.cpp" ? 1 : known[name]));
            }
    }
}

}  // namespace seldinger::test::test_ready
