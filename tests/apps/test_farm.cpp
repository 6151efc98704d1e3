// seldinger batch --part and merge, seldinger farm: any cut gives the batch's bits, finished parts are not run again, killed ones
// are; the Slurm backend against a stand-in for sbatch that runs array jobs here.
#include "background_app.h"
#include "core/file_lock.h"
#include "support/skip.h"

#include <map>
#include <memory>

namespace seldinger::test::test_farm {

namespace {

constexpr const char* sweep = R"([vary]
"wire.bend_nm2" = [4.0e-5, 5.0e-5]
"wire.density" = {min = 6000.0, max = 8000.0, n = 6}
)";

const std::vector<std::string> farm_words = {"farm", "s.toml", "--vary", "v.toml", "-o", "f", "--tasks", "3", "--quiet"};
const std::string farm = "farm s.toml --vary v.toml -o f ";

/// A scene and a sweep of 12 runs, and the batch of them in ref/.
struct FarmFolder : ScratchFolder {
    explicit FarmFolder(const std::string& scene = free_scene(), const std::string& how = "")
    {
        write("s.toml", scene);
        write("v.toml", sweep);
        const AppResult batch = run_app(*this, "batch s.toml --vary v.toml -o ref --quiet" + how);
        REQUIRE(batch.err == "");
        REQUIRE(batch.code == 0);
    }
    [[nodiscard]] nlohmann::json status(const std::string& dir) const
    {
        return nlohmann::json::parse(run_app(*this, "farm status " + dir + " --json").out);
    }
    /// Whether the program in the background has said so.
    [[nodiscard]] bool waits_for_one_task() const
    {
        return slurp(path / ".err-background").find("waiting for 1 tasks") != std::string::npos;
    }
    void check_table(const std::string& dir) const
    {
        for (const char* table :
             {"results.csv", "results.npz", "results-units.csv", "shapes.csv", "scene.toml", "sweep.toml", "vessel.vtp"}) {
            CAPTURE(table);
            CHECK(slurp(path / dir / table) == slurp(path / "ref" / table));
        }
    }
    /// Files of the parts, and when each was written.
    [[nodiscard]] std::map<std::string, fs::file_time_type> parts(const std::string& dir) const
    {
        std::map<std::string, fs::file_time_type> found;
        for (const auto& entry : fs::directory_iterator(path / dir / "parts"))
            if (entry.path().extension() == ".bin") found[entry.path().filename()] = entry.last_write_time();
        return found;
    }
};

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
    folder.write("bin/scontrol", "#!/bin/sh\ntouch \"$FAKE/again\"\n");
    folder.write("bin/srun", "#!/bin/sh\nwhile :; do case $1 in --*) shift;; *) break;; esac; done\nexec \"$@\"\n");
    for (const char* name : {"sbatch", "scontrol", "srun"}) fs::permissions(folder.path / "bin" / name, fs::perms::owner_all);
    return fmt::format("FAKE='{0}' PATH='{0}/bin':\"$PATH\"", folder.path.string());
}

}  // namespace

TEST_SUITE("apps/farm")
{
    TEST_CASE("property: whatever the cut and the number of processes, a farm leaves the batch's table")
    {
        const FarmFolder folder;
        for (const char* how : {"--tasks 1", "--tasks 5 --jobs 3", "--tasks 12", ""}) {
            CAPTURE(how);
            fs::remove_all(folder.path / "f");
            const AppResult result = run_app(folder, farm + how);
            CHECK(result.err == "");
            CHECK(result.code == 0);
            folder.check_table("f");
            const AppResult again = run_ok(folder, "farm merge f");
            CHECK(again.out.substr(again.out.find(':')) == result.out.substr(result.out.find(':')));
        }
        CHECK(folder.status("f").at("tasks") == 8);
        CHECK(summary_of(folder.path / "f").at("answer") == summary_of(folder.path / "ref").at("answer"));
    }

    TEST_CASE(
        "property: parts by batch --part, in two folders and in any order, merge to the batch: vessel, bands and kept files too")
    {
        const std::string how = " --bands --keep traces,last-frame";
        const FarmFolder folder(tube_scene(0.03), how);
        REQUIRE(fs::exists(folder.path / "ref/vessel.vtp"));
        const std::string batch = "batch s.toml --vary v.toml" + how;
        for (const char* part :
             {" --part 5/5 -o far", " --part 2/5 -o far --threads 1", " --part 4/5 -o far", " --part 1/5 -o far"})
            run_ok(folder, batch + part);
        check_refused(folder, "batch merge far", 3, "far: 1 of 5 parts are missing: 3 (runs 9-13)");
        CHECK_FALSE(fs::exists(folder.path / "far/results.csv"));
        const AppResult last = run_app(folder, batch + " --part 3/5 -o near");
        CHECK(last.out == "near: part 3/5 is done; when all are: seldinger batch merge near\n");
        run_ok(folder, "batch merge near far");
        folder.check_table("near");
        for (const auto& file : fs::directory_iterator(folder.path / "ref/runs"))
            CHECK(slurp(folder.path / "near/runs" / file.path().filename()) == slurp(file.path()));
        check_refused(folder, "batch s.toml --vary v.toml --part 1/5 -o near", 2, "of another scene, sweep, vessel");  // no bands
        run_ok(folder, "batch s.toml --vary v.toml --part 1/5 -o other --quiet");
        check_refused(folder, "batch merge near other", 2, "other: holds parts of another batch");
    }

    TEST_CASE("property: a farm runs what is missing and nothing else")
    {
        const FarmFolder folder;
        run_ok(folder, "batch s.toml --vary v.toml -o f --part 2/4");
        const auto before = folder.parts("f");
        CHECK(folder.status("f").at("missing") == "1, 3-4");
        CHECK(folder.status("f").at("runs_done") == 3);
        check_refused(folder, "farm merge f", 3, "3 of 4 parts are missing: 1, 3-4 (runs 0-2, 6-11)");
        const AppResult dry = run_app(folder, farm + "--dry-run");  // as many tasks as the folder has
        CHECK(std::count(dry.out.begin(), dry.out.end(), '\n') == 4);
        CHECK_FALSE(has(dry.out, "--part 2/4"));
        run_ok(folder, "batch s.toml --vary v.toml -o f --part 2/4");
        CHECK(folder.parts("f") == before);
        run_ok(folder, farm + "--tasks 4");
        folder.check_table("f");
        CHECK(folder.parts("f").at("2-of-4.bin") == before.at("2-of-4.bin"));
        // the printed commands do the same, in any order
        std::istringstream lines(dry.out);
        std::string line;
        fs::remove(folder.path / "f/parts/4-of-4.bin");
        while (std::getline(lines, line))
            if (line[0] != '#') CHECK(std::system((line + " >/dev/null").c_str()) == 0);
        run_ok(folder, "farm merge f");
        folder.check_table("f");
    }

    TEST_CASE("property: a part goes on from the runs that it has")
    {
        const FarmFolder folder(free_scene(0.01));
        long steps = 0, calls = 0;
        for (int code = 75; code == 75; ++calls) {
            const AppResult result = run_app(folder, "batch s.toml --vary v.toml -o f --json --part 2/3 --time-limit 1e-6");
            CAPTURE(result.err);
            REQUIRE(((code = result.code) == 75 || code == 0));
            const long now = nlohmann::json::parse(result.out).at("wire_steps").get<long>();
            REQUIRE(now > steps);
            steps = now;
        }
        CHECK(calls > 3);
        CHECK(steps == 4 * 10);  // none was taken twice
        run_ok(folder, farm + "--quiet");
        folder.check_table("f");
    }

    TEST_CASE("property: killed at any moment, the same command ends with the same bytes")
    {
        const FarmFolder folder(free_scene(2));
        const auto kill_once = [&](const std::function<bool()>& now) {
            BackgroundApp killed(folder.path, farm_words);
            if (killed.wait_until(now)) killed.send(SIGKILL);
            (void)killed.result();
        };
        kill_once([&] { return fs::exists(folder.path / "f/parts.json"); });
        for (const char* name :
             {"f/parts/1-of-3.bin.lock", "f/parts/1-of-3.bin", "f/parts/2-of-3.bin.lock", "f/parts/3-of-3.bin"})
            kill_once([&] { return fs::exists(folder.path / name); });
        const AppResult result = run_app(folder, farm + "--tasks 3 --quiet");
        CHECK(result.err == "");
        CHECK(result.code == 0);
        folder.check_table("f");
    }

    TEST_CASE("regression: a process of a farm ends with its command, even by kill -9")
    {
        const FarmFolder folder(free_scene(3));
        const fs::path lock = folder.path / "f/parts/1-of-3.bin.lock";
        std::string process;
        {
            BackgroundApp killed(folder.path, farm_words);
            REQUIRE(killed.wait_until([&] { return (process = slurp(lock)).ends_with("\n"); }));
            killed.send(SIGKILL);
            REQUIRE(killed.result().code == -SIGKILL);
        }
        process.pop_back();
        run_ok(folder, farm + "--tasks 3 --quiet");
        // "S", "R": it would have gone on; "Z": nobody has asked how it ended
        const std::string stat = slurp("/proc/" + process + "/stat");
        CHECK((stat.empty() || stat.find(") Z ") != std::string::npos));
        folder.check_table("f");
    }

    TEST_CASE("property: SIGTERM saves what runs and ends with 75; the same command goes on")
    {
        const FarmFolder folder(free_scene(3));
        BackgroundApp stopped(folder.path, farm_words);
        REQUIRE(stopped.wait_until([&] { return fs::exists(folder.path / "f/scene.toml"); }));
        stopped.send(SIGTERM);
        const AppResult result = stopped.result();
        CHECK(result.code == 75);
        CHECK(has(result.err, "run the same command again"));
        run_ok(folder, farm + "--tasks 3 --quiet");
        folder.check_table("f");
    }

    TEST_CASE("property: two processes do not run one part; a farm waits for the other, whose lock ends with it")
    {
        const FarmFolder folder;
        run_ok(folder, farm + "--tasks 3 --dry-run");
        auto held = seldinger::FileLock::if_free(folder.path / "f/parts/2-of-3.bin");
        REQUIRE(held);
        CHECK_FALSE(seldinger::FileLock::if_free(folder.path / "f/parts/2-of-3.bin"));
        check_refused(folder, "batch s.toml --vary v.toml -o f --part 2/3", 3,
                      fmt::format("2-of-3.bin: is being written by another run, process {}", getpid()));
        const std::vector<std::string> loud(farm_words.begin(), farm_words.end() - 1);
        {
            BackgroundApp asked(folder.path, loud);
            REQUIRE(asked.wait_until([&] { return folder.waits_for_one_task(); }));
            asked.send(SIGTERM);
            CHECK(asked.result().code == 75);
        }
        BackgroundApp waiting(folder.path, loud);
        REQUIRE(waiting.wait_until([&] { return folder.waits_for_one_task(); }));
        CHECK(folder.status("f").at("missing") == "2");
        held.reset();
        CHECK(waiting.result().code == 0);
        folder.check_table("f");
    }

    TEST_CASE("regression: farms that begin at once on one folder share its parts, and all end with 0")
    {
        const FarmFolder folder;
        for (int turn = 0; turn < 3; ++turn) {
            fs::remove_all(folder.path / "f");
            std::vector<std::unique_ptr<BackgroundApp>> farms;
            for (const char* own : {"a", "b", "c"}) {
                fs::create_directories(folder.path / own);
                farms.push_back(std::make_unique<BackgroundApp>(
                    folder.path / own, std::vector<std::string>{"farm", "../s.toml", "--vary", "../v.toml", "-o", "../f",
                                                                "--tasks", "6", "--quiet"}));
            }
            for (auto& one : farms) {
                const AppResult result = one->result();
                CHECK(result.err == "");
                CHECK(result.code == 0);
            }
            folder.check_table("f");
        }
    }

    TEST_CASE("property: a damaged part is never merged, and costs that part alone")
    {
        const FarmFolder folder;
        run_ok(folder, farm + "--tasks 2 --quiet");
        const fs::path part = folder.path / "f/parts/1-of-2.bin";
        fs::resize_file(part, fs::file_size(part) - 9);
        fs::remove(folder.path / "f/results.csv");
        check_refused(folder, "farm merge f", 3, "1-of-2.bin");
        CHECK_FALSE(fs::exists(folder.path / "f/results.csv"));
        CHECK(folder.status("f").at("missing") == "1");
        const auto before = folder.parts("f");
        const AppResult again = run_app(folder, farm + "--tasks 2 --quiet");
        CHECK(has(again.err, "1-of-2: begun again"));
        CHECK(again.code == 0);
        CHECK(folder.parts("f").at("2-of-2.bin") == before.at("2-of-2.bin"));
        folder.check_table("f");
    }

    TEST_CASE("property: an edit of the scene affects no part of a farm; another scene is refused")
    {
        const FarmFolder folder;
        const std::string commands = run_app(folder, farm + "--tasks 2 --dry-run").out;
        const std::string first = commands.substr(commands.find('\n') + 1);
        folder.write("s.toml", free_scene(0.02));
        CHECK(std::system(first.substr(0, first.find('\n')).c_str()) == 0);
        check_refused(folder, farm + "--tasks 2", 2, "f: holds 2 parts of another scene");
        check_refused(folder, "batch s.toml --vary v.toml -o f --part 2/2", 2, "f: holds 2 parts of another scene");
        folder.write("s.toml", free_scene());
        run_ok(folder, farm + "--tasks 2 --quiet");
        folder.check_table("f");
    }

    TEST_CASE("property: a job array of Slurm, tasks killed once; merged behind them")
    {
        const FarmFolder folder;
        const std::string slurm = with_fake_slurm(folder);
        // every third task dies the first time
        folder.write("bin/srun",
                     "#!/bin/sh\nwhile :; do case $1 in --*) shift;; *) break;; esac; done\n"
                     "[ $((SLURM_ARRAY_TASK_ID % 3)) -eq 0 ] && [ $SLURM_RESTART_COUNT -eq 0 ] && exit 137\nexec \"$@\"\n");
        const AppResult result = run_app(folder, farm + "--tasks 8 --backend slurm --submit --sbatch=--partition=cpu", slurm);
        CHECK(result.err == "");
        REQUIRE(result.code == 0);
        const std::string calls = slurp(folder.path / "calls");
        CHECK(has(calls, "--array=1-8 "));
        CHECK(has(calls, "--dependency=afterany:101 "));
        const std::string job = slurp(folder.path / "f/job.sh");
        for (const char* line : {"#SBATCH --requeue", "#SBATCH --signal=TERM@60", "#SBATCH --partition=cpu"})
            CHECK(has(job, line));
        folder.check_table("f");
        // all done: nothing is submitted any more
        const AppResult again = run_app(folder, farm + "--tasks 8 --backend slurm --submit", slurm);
        CHECK(has(again.out, "all done"));
        CHECK(slurp(folder.path / "calls") == calls);
        fs::remove(folder.path / "f/parts/3-of-8.bin");
        fs::remove(folder.path / "f/parts/7-of-8.bin");
        fs::remove(folder.path / "f/results.csv");
        run_ok(folder, farm + "--backend slurm --submit", slurm);
        CHECK(has(slurp(folder.path / "calls"), "--array=3,7 "));
        folder.check_table("f");
    }

    TEST_CASE(
        "property: a run's frames in any cut, here and by Slurm, are the bytes that render alone draws, and none is drawn twice")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.02) + "[output]\nwire_every = 2\n"}};
        run_ok(folder, "run s.toml -o run --quiet");
        const AppResult alone = run_app(folder, "render run --size 160x120 --frames 3:3");
        if (alone.code == 5 || alone.err.find("font") != std::string::npos) return seldinger::test::skip(alone.err);
        const std::string words = "farm run --frames 1:7 --tasks 3 --size 160x120";
        const std::string dry = run_app(folder, words + " -o f --dry-run").out;
        const std::string first = dry.substr(dry.find('\n') + 1);
        REQUIRE(std::system(first.substr(0, first.find('\n')).c_str()) == 0);
        check_refused(folder, "farm merge f", 3, "2 of 3 parts are missing: 2-3 (frames 3-7)");
        const auto drawn = fs::last_write_time(folder.path / "f/frame_000001.png");
        run_ok(folder, words + " -o f --quiet --jobs 2");
        CHECK(fs::last_write_time(folder.path / "f/frame_000001.png") == drawn);
        CHECK(nlohmann::json::parse(run_app(folder, "farm status f --json").out).at("frames_done") == 7);
        run_ok(folder, "farm merge f");
        CHECK(slurp(folder.path / "f/frame_000003.png") == slurp(folder.path / "run/frame_000003.png"));
        CHECK_FALSE(fs::exists(folder.path / "f/frame_000000.png"));
        CHECK_FALSE(fs::exists(folder.path / "f/frame_000008.png"));
        run_ok(folder, words + " -o g --backend slurm --submit", with_fake_slurm(folder));
        for (int k = 1; k <= 7; ++k)
            CHECK(slurp(folder.path / fmt::format("g/frame_00000{}.png", k)) ==
                  slurp(folder.path / fmt::format("f/frame_00000{}.png", k)));
        check_refused(folder, "farm run --frames 5:99 -o h", 2, "the run has 11 frames");
        check_refused(folder, "farm run --frames all -o h --video x.mp4", 2, "farm merge DIR --video");
        check_refused(folder, "farm run --frames all -o h --sise 10x10", 2, "--sise");
        check_refused(folder, "farm merge f --video f.mp4", 3, "apt-get install ffmpeg", "PATH=/nowhere");
        CHECK_FALSE(fs::exists(folder.path / "f.mp4"));
        check_refused(folder, words + "0 -o f", 2, "f: holds 3 parts of another");  // 160x1200
        folder.write("run/wire.pvd", slurp(folder.path / "run/wire.pvd") + "\n");
        CHECK(std::system(
                  (first.substr(0, first.find('\n')) + fmt::format(" 2>'{}'", (folder.path / "said").string())).c_str()) != 0);
        CHECK(has(slurp(folder.path / "said"), "has changed since the farm was made"));
    }

    TEST_CASE("regression: what cannot be done is one line")
    {
        const FarmFolder folder;
        check_refused(folder, farm + "--backend slurm --submit", 3, "no sbatch here", "PATH=/nowhere");
        CHECK_FALSE(fs::exists(folder.path / "f"));
        check_refused(folder, "farm", 2, "got no work");
        check_refused(folder, "farm s.toml -o f", 2, "--vary SWEEP.toml");
        check_refused(folder, "farm s.toml --vary v.toml", 2, "-o DIR");
        check_refused(folder, farm + "--tasks 13", 2, "only 12 runs");
        check_refused(folder, farm + "--task 13", 2, "--task");
        check_refused(folder, farm + "--submit", 2, "--backend slurm");
        check_refused(folder, "farm s.toml --vary v.toml -o ref", 2, "holds a batch");
        check_refused(folder, "farm missing.toml --vary v.toml -o f", 3, "missing.toml");
        check_refused(folder, "farm status ref", 3, "parts.json");
        check_refused(folder, "batch merge ref", 3, "parts.json");
        check_refused(folder, "farm merge nowhere", 3, "nowhere: cannot be opened as a folder");
        check_refused(folder, "batch merge", 2, "DIR");
        check_refused(folder, "batch s.toml --vary v.toml -o f --part 1/13", 2, "only 12 runs");
        for (const char* part : {"0/3", "4/3", "3", "a/b", "1/0", "-1/3"})
            check_refused(folder, std::string("batch s.toml --vary v.toml -o f --part=") + part, 2, "--part: got");
        run_ok(folder, farm + "--tasks 3 --quiet");
        check_refused(folder, farm + "--tasks 4", 2, "number of parts");
        check_refused(folder, farm + "--tasks 3 --set scene.dt_s=0.002", 2, "another folder");
        check_refused(folder, "batch s.toml --vary v.toml -o f --overwrite", 2, "holds a batch in parts");
        check_refused(folder, "farm merge f --video x.mp4", 2, "no pictures");
        folder.write("f/parts.json", "{");
        check_refused(folder, "farm status f", 3, "damaged");
    }

    TEST_CASE("regression: a farm of an earlier version is refused in one line that says what to do, and left as it is")
    {
        const FarmFolder folder;
        for (const char* name : {"f/todo", "f/running", "f/done"}) fs::create_directories(folder.path / name);
        folder.write("f/farm.json", "{\"kind\": \"sweep\", \"runs\": 12, \"tasks\": 3, \"key\": \"0123456789abcdef\"}\n");
        for (const std::string words : {farm, std::string("farm status f"), std::string("farm merge f"),
                                        std::string("batch merge f"), std::string("batch s.toml --vary v.toml -o f --part 1/3")})
            check_refused(folder, words, 2, "f: got a farm of an earlier version");
        CHECK(std::distance(fs::directory_iterator(folder.path / "f"), fs::directory_iterator()) == 4);
    }
}

}  // namespace seldinger::test::test_farm
