// seldinger farm: any cut gives the batch's bits, finished tasks are not done again, killed ones are; the Slurm backend against a
// stand-in for sbatch that runs array jobs here.
#include "background_app.h"
#include "batch/farm.h"
#include "support/skip.h"

#include <memory>

namespace test_farm {

using namespace seldinger::test;

namespace {

constexpr const char* sweep = R"([vary]
"wire.bend_nm2" = [4.0e-5, 5.0e-5]
"wire.density" = {min = 6000.0, max = 8000.0, n = 6}
)";

/// A scene and a sweep of 12 runs, and the batch of them in ref/.
struct FarmFolder : ScratchFolder {
    explicit FarmFolder(const std::string& scene = free_scene())
    {
        write("s.toml", scene);
        write("v.toml", sweep);
        const AppResult batch = run_app(*this, "batch s.toml --vary v.toml -o ref --quiet");
        REQUIRE(batch.err == "");
        REQUIRE(batch.code == 0);
    }
    [[nodiscard]] nlohmann::json status(const std::string& dir) const
    {
        return nlohmann::json::parse(run_app(*this, "farm status " + dir + " --json").out);
    }
    /// Whether the program in the background has said so.
    [[nodiscard]] bool waits_for_one_task() const { return slurp(path / ".err-background").find("waiting for 1 tasks") != std::string::npos; }
    void check_merged(const std::string& dir) const
    {
        const AppResult merged = run_app(*this, "farm merge " + dir);
        CHECK(merged.err == "");
        CHECK(merged.code == 0);
        for (const char* table : {"results.csv", "results.npz", "scene.toml", "sweep.toml"}) {
            CAPTURE(table);
            CHECK(slurp(path / dir / table) == slurp(path / "ref" / table));
        }
    }
};

void check_refused(const ScratchFolder& folder, const std::string& words, int code, const std::string& part,
                   const std::string& prefix = "")
{
    CAPTURE(words);
    const AppResult result = run_app(folder, words, prefix);
    CHECK(result.code == code);
    CHECK(result.error_lines() == 1);
    CHECK_MESSAGE(result.err.find(part) != std::string::npos, result.err);
}

/// Replaces Slurm: each index of the array in turn, as a separate job; a task that asks to be requeued is run again.
constexpr const char* fake_sbatch = R"(#!/bin/bash
echo "$@" >> "$FAKE/calls"
array=; words=()
for word in "$@"; do case $word in --array=*) array=${word#--array=};; --*) ;; *) words+=("$word");; esac; done
job=$(($(wc -l < "$FAKE/calls") + 100))
if [ -n "$array" ]; then
    export SLURM_ARRAY_JOB_ID=$job
    for range in ${array//,/ }; do for index in $(seq ${range%-*} ${range#*-}); do
        export SLURM_ARRAY_TASK_ID=$index SLURM_RESTART_COUNT=0
        while :; do
            rm -f "$FAKE/again"
            sh "${words[@]}" >> "$FAKE/said" 2>&1
            [ -e "$FAKE/again" ] || break
            SLURM_RESTART_COUNT=$((SLURM_RESTART_COUNT + 1))
        done
    done; done
else
    sh "${words[@]}" >> "$FAKE/said" 2>&1
fi
echo $job
)";

std::string with_fake_slurm(const ScratchFolder& folder)
{
    fs::create_directories(folder.path / "bin");
    folder.write("bin/sbatch", fake_sbatch);
    folder.write("bin/scontrol",
                 "#!/bin/sh\n[ \"$1\" = show ] && { echo 'MaxArraySize            = 4'; exit; }\ntouch \"$FAKE/again\"\n");
    folder.write("bin/srun", "#!/bin/sh\nwhile :; do case $1 in --*) shift;; *) break;; esac; done\nexec \"$@\"\n");
    for (const char* name : {"sbatch", "scontrol", "srun"}) fs::permissions(folder.path / "bin" / name, fs::perms::owner_all);
    return fmt::format("FAKE='{0}' PATH='{0}/bin':\"$PATH\"", folder.path.string());
}

}  // namespace

TEST_SUITE("apps/farm")
{
    TEST_CASE("property: whatever the cut and the number of workers, the merged table has the batch's bits")
    {
        const FarmFolder folder;
        for (const char* how : {"--tasks 1", "--tasks 5 --jobs 3", "--tasks 12"}) {
            CAPTURE(how);
            fs::remove_all(folder.path / "f");
            const AppResult farm = run_app(folder, fmt::format("farm s.toml --vary v.toml -o f {}", how));
            CHECK(farm.err == "");
            CHECK(farm.code == 0);
            folder.check_merged("f");
            CHECK(folder.status("f").at("finished_again") == 0);
        }
    }

    TEST_CASE("property: a merge says which tasks and runs are missing; the next farm does only these")
    {
        const FarmFolder folder;
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 4 --dry-run").code == 0);
        REQUIRE(run_app(folder, "farm task f 1").code == 0);
        check_refused(folder, "farm merge f", 3, "3 of 4 tasks are missing: 0, 2-3 (runs 0-2, 6-11)");
        CHECK_FALSE(fs::exists(folder.path / "f/results.csv"));
        CHECK(folder.status("f").at("missing") == "0, 2-3");
        REQUIRE(run_app(folder, "farm task f 1").code == 0);  // finished: nothing happens
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 4").code == 0);
        folder.check_merged("f");
        CHECK(folder.status("f").at("begun") == 4);
        CHECK(folder.status("f").at("finished_again") == 0);
        // a result that somebody removed is made again, and only that
        fs::remove(folder.path / "f/rows/000002.rows");
        check_refused(folder, "farm merge f", 3, "1 of 4 tasks are missing: 2 (runs 6-8)");
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 4 --quiet").code == 0);
        folder.check_merged("f");
        CHECK(folder.status("f").at("begun") == 5);
    }

    TEST_CASE("property: a killed worker costs its running task, which goes on elsewhere; a living one keeps its own and is waited for")
    {
        const FarmFolder folder(free_scene(3));
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 3 --dry-run").code == 0);
        const auto killed = run_and_signal(folder.path, {"farm", "task", "f", "1"}, folder.path / "f/log/000001.csv", 1, SIGKILL);
        REQUIRE(killed.code == -SIGKILL);
        CHECK(folder.status("f").at("lost") == 1);
        auto held = seldinger::TaskClaim::take(folder.path / "f", 0, "another");
        REQUIRE(held);
        CHECK(folder.status("f").at("running") == 1);
        CHECK_FALSE(seldinger::TaskClaim::take(folder.path / "f", 0, "third"));
        BackgroundApp farm(folder.path, {"farm", "s.toml", "--vary", "v.toml", "-o", "f", "--tasks", "3"});
        REQUIRE(farm.wait_until([&] { return folder.waits_for_one_task(); }));
        CHECK(folder.status("f").at("done") == 2);
        check_refused(folder, "farm merge f", 3, "1 of 3 tasks are missing: 0 (runs 0-3)");
        held.reset();  // that worker dies
        CHECK(farm.result().code == 0);
        folder.check_merged("f");
        CHECK(folder.status("f").at("begun_again") == 1);
        CHECK(folder.status("f").at("finished_again") == 0);
    }

    TEST_CASE("regression: a signal ends a farm that waits for others")
    {
        const FarmFolder folder;
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 1 --dry-run").code == 0);
        const auto held = seldinger::TaskClaim::take(folder.path / "f", 0, "another");
        BackgroundApp farm(folder.path, {"farm", "s.toml", "--vary", "v.toml", "-o", "f", "--tasks", "1"});
        REQUIRE(farm.wait_until([&] { return folder.waits_for_one_task(); }));
        farm.send(SIGTERM);
        CHECK(farm.result().code == 75);
    }

    TEST_CASE("regression: farms that begin at once on one folder share its tasks, and all end with 0")
    {
        const FarmFolder folder;
        for (int turn = 0; turn < 3; ++turn) {
            fs::remove_all(folder.path / "f");
            std::vector<std::unique_ptr<BackgroundApp>> farms;
            for (const char* own : {"a", "b", "c"}) {
                fs::create_directories(folder.path / own);
                farms.push_back(std::make_unique<BackgroundApp>(
                    folder.path / own, std::vector<std::string>{"farm", "../s.toml", "--vary", "../v.toml", "-o", "../f", "--tasks", "6", "--quiet"}));
            }
            for (auto& farm : farms) {
                const AppResult result = farm->result();
                CAPTURE(result.err);
                CHECK(result.code == 0);
            }
            const auto status = folder.status("f");
            CHECK(status.at("done") == 6);
            CHECK(status.at("begun") == 6);
            CHECK(status.at("finished_again") == 0);
        }
        run_app(folder, "batch s.toml --vary v.toml -o ref --overwrite --quiet");
        CHECK(run_app(folder, "farm merge f").code == 0);
        CHECK(slurp(folder.path / "f/results.csv") == slurp(folder.path / "ref/results.csv"));
    }

    TEST_CASE("regression: a worker ends with its command, even by kill -9; the same command goes on")
    {
        const FarmFolder folder(free_scene(3));
        const std::vector<std::string> words = {"farm", "s.toml", "--vary", "v.toml", "-o", "f", "--tasks", "3", "--quiet"};
        std::string worker;  // host-process
        {
            BackgroundApp farm(folder.path, words);
            REQUIRE(farm.wait_until([&] { return fs::exists(folder.path / "f/tasks/000000/scene.toml"); }));
            for (const auto& entry : fs::directory_iterator(folder.path / "f/running")) worker = entry.path().filename().string();
            farm.send(SIGKILL);
            REQUIRE(farm.result().code == -SIGKILL);
        }
        REQUIRE(worker.find('-') != std::string::npos);
        CHECK(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 3 --quiet").code == 0);
        // "S", "R": it would have gone on; "Z": nobody has asked how it ended
        const std::string stat = slurp("/proc/" + worker.substr(worker.rfind('-') + 1) + "/stat");
        CHECK((stat.empty() || stat.find(") Z ") != std::string::npos));
        folder.check_merged("f");
        CHECK(folder.status("f").at("lost") == 0);
        CHECK(folder.status("f").at("finished_again") == 0);
    }

    TEST_CASE("regression: a task is done when its rows are there, whatever became of its worker")
    {
        const FarmFolder folder;
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 3 --quiet").code == 0);
        fs::rename(folder.path / "f/done/000001", folder.path / "f/running/000001@host-1");  // killed behind its last row
        CHECK(folder.status("f").at("done") == 3);
        CHECK(folder.status("f").at("lost") == 0);
        folder.check_merged("f");
        CHECK(summary_of(folder.path / "f").at("farm").at("lost") == 0);
        CHECK(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 3 --quiet").code == 0);
        CHECK(fs::exists(folder.path / "f/done/000001"));
        CHECK(folder.status("f").at("begun") == 3);
    }

    TEST_CASE("property: SIGTERM saves the task's state and ends with 75; the task goes on from there")
    {
        const FarmFolder folder(free_scene(3));
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 1 --dry-run").code == 0);
        const auto stopped =
            run_and_signal(folder.path, {"farm", "task", "f", "0"}, folder.path / "f/tasks/000000/scene.toml", 1, SIGTERM);
        REQUIRE(stopped.code == 75);
        // while the scene is still being loaded there is nothing to save: the worker is gone, and the task is taken over
        const bool too_early = stopped.err.find("before it could save") != std::string::npos;
        CHECK(fs::exists(folder.path / "f/tasks/000000/checkpoint.bin") != too_early);
        CHECK(folder.status("f").at(too_early ? "lost" : "waiting") == 1);
        REQUIRE(run_app(folder, "farm task f 0").code == 0);
        CHECK_FALSE(fs::exists(folder.path / "f/tasks/000000"));
        folder.check_merged("f");
    }

    TEST_CASE("property: a half-written result is never merged")
    {
        const FarmFolder folder;
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 2 --quiet").code == 0);
        fs::resize_file(folder.path / "f/rows/000001.rows", fs::file_size(folder.path / "f/rows/000001.rows") - 9);
        check_refused(folder, "farm merge f", 3, "000001.rows");
        CHECK_FALSE(fs::exists(folder.path / "f/results.csv"));
    }

    TEST_CASE("property: array jobs of Slurm, in arrays as long as it allows, tasks killed once; merged behind them")
    {
        const FarmFolder folder;
        const std::string slurm = with_fake_slurm(folder);
        // every third task dies the first time
        folder.write("bin/srun",
                     "#!/bin/sh\nwhile :; do case $1 in --*) shift;; *) break;; esac; done\n"
                     "[ $((SLURM_ARRAY_TASK_ID % 3)) -eq 0 ] && [ $SLURM_RESTART_COUNT -eq 0 ] && exit 137\nexec \"$@\"\n");
        const AppResult farm =
            run_app(folder, "farm s.toml --vary v.toml -o f --tasks 8 --backend slurm --submit --sbatch=--partition=cpu", slurm);
        CHECK(farm.err == "");
        REQUIRE(farm.code == 0);
        // arrays of three: MaxArraySize is one more than the largest index
        const std::string calls = slurp(folder.path / "calls");
        CHECK(calls.find("--array=0-2 ") != std::string::npos);
        CHECK(calls.find("--array=0-1 ") != std::string::npos);
        CHECK(calls.find("--dependency=afterany:101:102:103 ") != std::string::npos);
        const std::string job = slurp(folder.path / "f/job.sh");
        for (const char* line : {"#SBATCH --requeue", "#SBATCH --signal=TERM@60", "#SBATCH --partition=cpu"})
            CHECK(job.find(line) != std::string::npos);
        CHECK(slurp(folder.path / "f/results.csv") == slurp(folder.path / "ref/results.csv"));
        CHECK(folder.status("f").at("begun") == 8);
        // all done: nothing is submitted any more
        const AppResult again = run_app(folder, "farm s.toml --vary v.toml -o f --tasks 8 --backend slurm --submit", slurm);
        CHECK(again.out.find("all done") != std::string::npos);
        CHECK(slurp(folder.path / "calls") == calls);
    }

    TEST_CASE("property: a run's frames in any cut are the bytes that render alone draws, and none is drawn twice")
    {
        const ScratchFolder folder;
        folder.write("s.toml", free_scene(0.02) + "[output]\nwire_every = 2\n");
        REQUIRE(run_app(folder, "run s.toml -o run --quiet").code == 0);
        const AppResult alone = run_app(folder, "render run --size 160x120 --frames 3:3");
        if (alone.code == 5 || alone.err.find("font") != std::string::npos) return seldinger::test::skip(alone.err);
        const std::string words = "farm run --frames 1:7 --tasks 3 -o f --size 160x120";
        REQUIRE(run_app(folder, words + " --dry-run").code == 0);
        REQUIRE(run_app(folder, "farm task f 0").code == 0);
        check_refused(folder, "farm merge f", 3, "2 of 3 tasks are missing: 1-2 (frames 3-7)");
        REQUIRE(run_app(folder, words + " --quiet").code == 0);
        CHECK(run_app(folder, "farm merge f").code == 0);
        CHECK(slurp(folder.path / "f/frame_000003.png") == slurp(folder.path / "run/frame_000003.png"));
        CHECK_FALSE(fs::exists(folder.path / "f/frame_000000.png"));
        CHECK_FALSE(fs::exists(folder.path / "f/frame_000008.png"));
        check_refused(folder, "farm run --frames 5:99 -o g", 2, "the run has 11 frames");
        check_refused(folder, "farm run --frames all -o g --video x.mp4", 2, "farm merge DIR --video");
        check_refused(folder, "farm run --frames all -o g --sise 10x10", 2, "--sise");
        check_refused(folder, "farm merge f --video f.mp4", 3, "apt-get install ffmpeg", "PATH=/nowhere");
        CHECK_FALSE(fs::exists(folder.path / "f.mp4"));
    }

    TEST_CASE("regression: what cannot be done is one line")
    {
        const FarmFolder folder;
        check_refused(folder, "farm s.toml --vary v.toml -o f --backend slurm --submit", 3, "no sbatch here", "PATH=/nowhere");
        CHECK_FALSE(fs::exists(folder.path / "f"));
        check_refused(folder, "farm", 2, "got no work");
        check_refused(folder, "farm s.toml -o f", 2, "--vary SWEEP.toml");
        check_refused(folder, "farm s.toml --vary v.toml", 2, "-o DIR");
        check_refused(folder, "farm s.toml --vary v.toml -o f --tasks 13", 2, "only 12 runs");
        check_refused(folder, "farm s.toml --vary v.toml -o f --task 13", 2, "--task");
        check_refused(folder, "farm s.toml --vary v.toml -o f --submit", 2, "--backend slurm");
        check_refused(folder, "farm s.toml --vary v.toml -o ref", 2, "holds a batch");
        check_refused(folder, "farm missing.toml --vary v.toml -o f", 3, "missing.toml");
        check_refused(folder, "farm status ref", 3, "farm.json");
        check_refused(folder, "farm merge nowhere", 3, "nowhere: cannot be opened as a folder");
        REQUIRE(run_app(folder, "farm s.toml --vary v.toml -o f --tasks 3 --quiet").code == 0);
        check_refused(folder, "farm s.toml --vary v.toml -o f --tasks 4", 2, "number of tasks");
        check_refused(folder, "farm s.toml --vary v.toml -o f --tasks 3 --set scene.dt_s=0.002", 2, "another folder");
        check_refused(folder, "farm task f 3", 2, "tasks 0 to 2");
        check_refused(folder, "farm merge f --video x.mp4", 2, "no pictures");
        folder.write("f/farm.json", "{");
        check_refused(folder, "farm status f", 3, "damaged");
    }
}

}  // namespace test_farm
