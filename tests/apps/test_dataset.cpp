// seldinger dataset: the same bytes whatever the cut and after a kill, splits by vessel, COCO, runs that end early, and refusals.
#include "background_app.h"

#include <map>
#include <set>

namespace seldinger::test::test_dataset {

using nlohmann::json;

namespace {

constexpr const char* command =
    "dataset s.toml --vary v.toml --views w.toml --frames 3 --size 160x120 --field 0.15 --format coco --licence CC0 -o ";

/// Three tubes, two frictions of which pictures show nothing, two views.
struct DatasetFolder : ScratchFolder {
    DatasetFolder()
    {
        std::string scene = tube_scene(0.03);
        write("s.toml", scene.insert(scene.find("duration_s"), "seed = 3\n"));
        write("v.toml",
              "[vary]\n\"vessel.radius_m\" = [0.005, 0.006, 0.007]\n\"wire.mu_sliding\" = {min = 0.05, max = 0.2, n = 2}\n");
        write("w.toml", "[vary]\n\"carm.lao_deg\" = [0.0, 40.0]\n");
    }
    [[nodiscard]] AppResult make(const std::string& dir, const std::string& more = "") const
    {
        return run_app(*this, command + dir + " " + more);
    }
    [[nodiscard]] std::vector<std::string> list(const std::string& file) const
    {
        std::vector<std::string> lines;
        std::stringstream stream(slurp(path / file));
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        return lines;
    }
    /// All of a data set but how it was divided.
    [[nodiscard]] std::map<std::string, std::string> contents(const std::string& dir) const
    {
        std::map<std::string, std::string> all = contents_of(path / dir);
        std::erase_if(all, [](const auto& file) {
            return file.first == "parts.json" || file.first.ends_with(".lock") || file.first.ends_with(".tmp");
        });
        return all;
    }
};

}  // namespace

TEST_SUITE("apps/dataset")
{
    TEST_CASE("property: a data set has the same bytes whatever the cut, and after a kill")
    {
        const DatasetFolder folder;
        const AppResult made = folder.make("one", "--tasks 1");
        REQUIRE_MESSAGE(made.code == 0, made.err);
        CHECK(made.out.find("36 pictures of 6 runs; train, val, test: 12, 12, 12 pictures of 1, 1, 1 vessels") !=
              std::string::npos);
        const auto all = folder.contents("one");
        REQUIRE(all.count("images/run_000005_v2_000003.png") == 1);
        REQUIRE(all.count("labels/run_000005_v2_000003_mask.png") == 1);
        REQUIRE(folder.make("cut", "--tasks 4 --jobs 2 --quiet").code == 0);
        CHECK(folder.contents("cut") == all);

        BackgroundApp killed(folder.path, {"dataset",   "s.toml", "--vary",  "v.toml",  "--views", "w.toml",   "--frames",
                                           "3",         "--size", "160x120", "--field", "0.15",    "--format", "coco",
                                           "--licence", "CC0",    "-o",      "again",   "--tasks", "6",        "--quiet"});
        CHECK(killed.wait_until([&] { return fs::exists(folder.path / "again/runs/run_000001.json"); }));
        killed.send(SIGKILL);
        (void)killed.result();
        const auto kept = fs::last_write_time(folder.path / "again/runs/run_000000.json");
        CHECK(run_app(folder, "farm status again --json").code == 0);
        REQUIRE(folder.make("again", "--quiet").code == 0);
        CHECK(fs::last_write_time(folder.path / "again/runs/run_000000.json") == kept);
        CHECK(folder.contents("again") == all);
    }

    TEST_CASE("property: no vessel is in two splits, runs have noise of their own, and every list names what is there")
    {
        const DatasetFolder folder;
        REQUIRE(folder.make("d", "--quiet").code == 0);
        std::map<std::string, std::string> split_of;  // of a picture
        for (const char* split : {"train", "val", "test"}) {
            std::set<std::string> annotated;
            const json coco = json::parse(slurp(folder.path / fmt::format("d/coco_{}.json", split)));
            for (const json& image : coco["images"]) annotated.insert(image["file_name"].get<std::string>());
            const std::vector<std::string> names = folder.list(fmt::format("d/{}.txt", split));
            CHECK(annotated == std::set<std::string>(names.begin(), names.end()));
            CHECK(coco["annotations"].size() == names.size());  // one wire, in every picture
            for (const std::string& name : names) {
                CHECK(fs::exists(folder.path / "d/images" / name));
                CHECK(split_of.emplace(name, split).second);
            }
        }
        CHECK(split_of.size() == 36);
        const std::string card = slurp(folder.path / "d/card.md");
        std::map<std::string, std::string> split_of_vessel;  // by its radius
        for (int run = 0; run < 6; ++run) {
            const json of = json::parse(slurp(folder.path / fmt::format("d/runs/run_{:06}.json", run)));
            const std::string drawn = of["values"][1].get<std::string>();  // by the scene's seed
            CHECK(has(card, drawn.substr(drawn.find('=') + 1)));
            CHECK(of["pictures"].size() == 6);
            for (const json& name : of["pictures"]) {
                const std::string split = split_of.at(name.get<std::string>());
                CHECK(split_of_vessel.emplace(of["values"][0].get<std::string>(), split).first->second == split);
            }
        }
        CHECK(split_of_vessel.size() == 3);
        // runs 0 and 1 differ by a friction that acts nowhere before the wire touches: the wire is the same, the noise is not
        CHECK(slurp(folder.path / "d/images/run_000000_v1_000001.png") !=
              slurp(folder.path / "d/images/run_000001_v1_000001.png"));
        CHECK(slurp(folder.path / "d/labels/run_000000_v1_000001_mask.png") ==
              slurp(folder.path / "d/labels/run_000001_v1_000001_mask.png"));
        for (const char* part : {"Licence: CC0", "| `vessel.radius_m` | 0.005, 0.006, 0.007 |", "2 drawn |", "| test | 1 | 12 |"})
            CHECK_MESSAGE(card.find(part) != std::string::npos, part);
    }

    TEST_CASE("property: a run that ends early has no pictures, is counted, and ends the command with 4")
    {
        const DatasetFolder folder;
        // explicit integration far above the axial wave's limit ends at once, below it does not
        folder.write("v.toml", "[vary]\n\"wire.stretch_n\" = [0.5, 7.0e12]\n");
        folder.write("s.toml", free_scene(0.01));
        const AppResult made = folder.make("d",
                                           "--set integrator.scheme=explicit --set scene.dt_s=1e-5 --set wire.bend_nm2=1e-9 "
                                           "--set wire.twist_nm2=1e-9");
        CHECK(made.code == 4);
        CHECK(made.out.find("6 pictures of 2 runs") != std::string::npos);
        CHECK(json::parse(slurp(folder.path / "d/dataset.json"))["stopped"] == 1);
        CHECK(folder.list("d/train.txt").size() == 6);  // one vessel: nothing is held back
        CHECK(folder.list("d/test.txt").empty());
    }

    TEST_CASE("property: a preview is one sheet and nothing else, and what cannot be made is refused in one line")
    {
        const DatasetFolder folder;
        const AppResult sheet =
            run_app(folder, "dataset s.toml --vary v.toml --frames 3 --size 160x120 --field 0.15 --preview sheet.png");
        CHECK_MESSAGE(sheet.code == 0, sheet.err);
        CHECK(fs::exists(folder.path / "sheet.png"));
        CHECK_FALSE(fs::exists(folder.path / "sheet.png.run"));
        // what is wrong with all pictures is said once
        const std::string err = run_app(folder, "dataset s.toml --vary v.toml --frames 1 --size 32x24 -o n").err;
        CHECK_MESSAGE(has(err, "pixel"), err);
        CHECK(err.find("pixel") == err.rfind("pixel"));
        REQUIRE(folder.make("d", "--quiet").code == 0);
        for (const auto& [words, part] : std::initializer_list<std::pair<const char*, const char*>>{
                 {"dataset s.toml --frames 3 -o e", "expected SCENE.toml and --vary SWEEP.toml"},
                 {"dataset s.toml --vary v.toml --frames 0 -o e", "--frames: got \"0\""},
                 {"dataset s.toml --vary v.toml --frames 3:9 -o e", "--frames: got \"3:9\""},
                 {"dataset s.toml --vary v.toml --frames 31 -o e", "run 0 has only 30 steps"},
                 {"dataset s.toml --vary v.toml --frames 3", "with -o DIR"},
                 {"dataset s.toml --vary v.toml --frames 3 -o e --video a.mp4", "--video"},
                 {"dataset s.toml --vary v.toml --frames 3 -o e --nothing", "--nothing"},
                 {"dataset s.toml --vary v.toml --frames 3 -o e --views none.toml", "none.toml"},
                 {"dataset s.toml --vary v.toml --frames 3 -o e --format minari", "folder"},
                 {"dataset s.toml --vary v.toml --frames 2 -o d", "of another scene, sweep"}}) {
            check_refused(folder, words, part == std::string("none.toml") ? 3 : 2, part);
            CHECK_FALSE(fs::exists(folder.path / "e"));
        }
    }
}

}  // namespace seldinger::test::test_dataset
