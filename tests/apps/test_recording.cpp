// A program's own loop over a scene, recorded: the files are those of `seldinger run`.

#include "apps/app_fixture.h"
#include "core/error.h"
#include "record/recording.h"
#include "support/refusal.h"
#include "support/scenes.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace seldinger::test::test_recording {

namespace {

const std::string task_scene = scene_text(0.2, 0.002, "name = \"task\"\nrecord_every = 5\n") + wire_text(0.1, 1e-5, 8e-6, 41) +
                               tube_text(0.005, 0.1, 2000) + R"([feed]
point = [0.0, 0.0, -0.0035]
direction = [1.0, 0.0, -0.2]
keys = [ {t_s = 0.0, advance_m = 0.004}, {t_s = 0.2, advance_m = 0.034} ]
[task]
text = "touch it"
wall_force_n = 5.0
target = { name = "the mark", point = [0.025, 0.0, -0.005], radius_m = 0.002 }
[output]
wire_every = 10
)";

}  // namespace

TEST_SUITE("apps/recording")
{
    TEST_CASE("property: a recorded loop writes the files of a run, and follows its task")
    {
        const ScratchFolder folder;
        const fs::path file = folder.write("t.toml", task_scene), ours = folder.path / "ours", theirs = folder.path / "theirs";
        run_ok(folder, "run t.toml -o theirs --error-estimate off --quiet");
        const LoadedScene scene = load_scene(file);
        CHECK(scene.task.on);
        CHECK(scene.task.text == "touch it");
        CHECK(scene.task.target == TaskSpec::Target::Point);
        CHECK(scene.task.target_name == "the mark");
        CHECK(scene.task.point == Vec3(0.025, 0, -0.005));
        CHECK(scene.task.wall_force == 5.0);

        World world(scene.setup);
        Recording recording(scene, world, ours);
        CHECK_FALSE(recording.task().reached);
        CHECK(recording.task().distance > 0.01);
        Control control;
        control.follow(0, scene.keys[0]);
        while (world.time() < scene.duration - 0.5 * scene.dt) recording.stepped(world, step(world, control, scene.dt));
        const nlohmann::json mine = nlohmann::json::parse(recording.finish(world)),
                             run = nlohmann::json::parse(slurp(theirs / "summary.json"));

        CHECK(mine["state_hash"] == run["state_hash"]);
        CHECK(mine["task"] == run["task"]);
        CHECK(timeless_trace(ours) == timeless_trace(theirs));
        for (const char* same : {"scene.toml", "wire.csv", "wire.pvd", "wire_000100.vtp", "vessel.vtp"}) {
            CAPTURE(same);
            CHECK(slurp(ours / same) == slurp(theirs / same));
        }
        const TaskProgress progress = recording.task();
        CHECK(progress.reached);
        CHECK(progress.verdict == "passed");
        CHECK(progress.reached_at == run["task"]["reached_at_s"].get<double>());
        CHECK(progress.inserted_at == run["task"]["reached_at_m"].get<double>());
        CHECK(progress.distance == run["task"]["distance_m"].get<double>());
    }

    TEST_CASE("property: a scene that comes with the program is found by its name, as the command finds it")
    {
        const ScratchFolder folder;
        const LoadedScene swing = load_scene("swing");
        CHECK_FALSE(swing.task.on);
        World world(swing.setup);
        CHECK(world.wire_count() == 1);
        CHECK(refusal([] { (void)load_scene("swong"); }).find("swong") == 0);
        CHECK(load_scene("swing", {"scene.dt_s=0.0005"}).dt == 0.0005);
        CHECK(load_scene("training/siphon").task.on);  // a scene in a folder
        CHECK(refusal([] { (void)load_scene("../scenes/swing"); }).find("../scenes/swing") == 0);
    }

    TEST_CASE("property: what is no record of a run is refused")
    {
        const ScratchFolder folder;
        const LoadedScene scene = load_scene(folder.write("t.toml", task_scene));
        World world(scene.setup);
        const fs::path dir = folder.path / "out";
        Recording recording(scene, world, dir);
        CHECK(refusal([&] { Recording(scene, world, dir); }).find("holds a run already") != std::string::npos);
        CHECK_NOTHROW(Recording(scene, world, dir, true));
        CHECK(refusal([&] {
                  Recording(LoadedScene{scene.setup, scene.keys, scene.dt, scene.duration, {}, {}}, world, dir, true);
              }) == "Recording: got a scene that was not read; expected what load_scene() returned");

        (void)step(world, scene.dt);  // not recorded
        StepReport report = step(world, scene.dt);
        CHECK(refusal([&] { recording.stepped(world, report); }) ==
              "Recording: got a step of 0.004 s; expected 0.002 s, dt of the scene. Fix: record every step");
        report.flags |= StepNotConverged;
        CHECK(refusal([&] { recording.stepped(world, report); }).find("a step that failed (flags 2)") != std::string::npos);
    }
}

}  // namespace seldinger::test::test_recording
