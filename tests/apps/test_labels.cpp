// seldinger render --labels, --preview and labels --coco: files, views, farms, and refusals.
#include "app_fixture.h"
#include "io/coco_write.h"
#include "io/png_write.h"
#include "support/approx.h"
#include "support/skip.h"

#include <cstring>
#include <map>

namespace seldinger::test::test_labels {

using nlohmann::json;

namespace {

/// A run of a catheter and a wire in a tube, 11 frames.
struct LabelRun : ScratchFolder {
    LabelRun()
    {
        write("s.toml", two_instruments("merged") + "[output]\nwire_every = 2\ncontacts_every = 2\n");
        run_ok(*this, "run s.toml -o run --quiet --set scene.duration_s=0.04");
    }
    [[nodiscard]] json read(const std::string& name) const { return json::parse(slurp(path / name)); }
};

/// Only pictures and labels of a farm's folder; a process that is killed as it writes leaves a file NAME.PID.tmp.
std::map<std::string, std::string> pictures_of(const fs::path& dir)
{
    std::map<std::string, std::string> all = contents_of(dir);
    std::erase_if(all, [](const auto& file) {
        return file.first.ends_with(".tmp") || (!file.first.starts_with("frame_") && !file.first.starts_with("truth/"));
    });
    return all;
}

/// Worst distance of a projected point from the pixel that the file says.
double projection_error(const json& labels)
{
    const json& p = labels["camera"]["projection"];
    double worst = 0;
    const auto check = [&](const json& m, const json& px) {
        double h[3];
        for (std::size_t i = 0; i < 3; ++i)
            h[i] = p[i][0].get<double>() * m[0].get<double>() + p[i][1].get<double>() * m[1].get<double>() +
                   p[i][2].get<double>() * m[2].get<double>() + p[i][3].get<double>();
        for (std::size_t k = 0; k < 2; ++k) worst = std::max(worst, std::abs(h[k] / h[2] - px[k].get<double>()));
    };
    for (const json& instrument : labels["instruments"]) {
        check(instrument["tip_m"], instrument["tip_px"]);
        for (std::size_t i = 0; i < instrument["centreline_m"].size(); ++i)
            check(instrument["centreline_m"][i], instrument["centreline_px"][i]);
        for (const json& c : instrument["contacts"]) check(c["position_m"], c["position_px"]);
    }
    return worst;
}

std::vector<std::uint32_t> runs_of_text(const std::string& text)
{
    std::vector<std::uint32_t> runs;
    for (std::size_t at = 0; at < text.size();) {
        std::int64_t x = 0;
        int shift = 0;
        bool more = true;
        while (more) {
            const int c = text[at++] - 48;
            x |= static_cast<std::int64_t>(c & 0x1f) << shift;
            shift += 5;
            more = c & 0x20;
            if (!more && (c & 0x10)) x |= -(std::int64_t{1} << shift);
        }
        if (runs.size() > 2) x += runs[runs.size() - 2];
        runs.push_back(static_cast<std::uint32_t>(x));
    }
    return runs;
}

}  // namespace

TEST_SUITE("apps/labels")
{
    TEST_CASE(
        "property: a picture's labels hold what the contract names, project to a millionth of a pixel, and repeat to the byte")
    {
        const LabelRun folder;
        const std::string words = "render run --view fluoro --size 96x80 --field 0.2 --frames 3:5 --labels truth --label-vessel ";
        run_ok(folder, words + "-o a.png");
        CHECK(fs::exists(folder.path / "a_000003.png"));
        const json labels = folder.read("truth/a_000004.json");
        CHECK(labels["image"] == json::parse(R"({"file":"a_000004.png","width":96,"height":80,"pixel_m":)" +
                                             labels["image"]["pixel_m"].dump() + "}"));
        CHECK(labels["image"]["pixel_m"].get<double>() == about(0.2 / 96));
        CHECK(labels["step"] == 8);
        CHECK(labels["time_s"].get<double>() == about(0.016));
        for (const char* key : {"source_m", "right", "up", "towards_detector", "sid_m", "sod_m", "primary_deg", "secondary_deg"})
            CHECK_MESSAGE(labels["camera"].contains(key), key);
        REQUIRE(labels["instruments"].size() == 2);
        CHECK(labels["instruments"][0]["name"] == "catheter");
        CHECK(labels["instruments"][1]["name"] == "wire");
        for (const json& instrument : labels["instruments"]) {
            CHECK(instrument["centreline_m"].size() == instrument["in_field"].size());
            CHECK(instrument["centreline_m"][0] == instrument["tip_m"]);
            CHECK(instrument["hand_force_n"].is_number());
            CHECK(instrument["contacts"].is_array());
        }
        CHECK(labels["instruments"][0]["radius_m"] == 0.001);
        CHECK(projection_error(labels) < 1e-6);
        const seldinger::LabelImage mask = seldinger::read_label_png(folder.path / "truth/a_000004_mask.png");
        CHECK(mask.width == 96);
        CHECK(std::count(mask.labels.begin(), mask.labels.end(), 2) > 0);
        const std::string lumen = slurp(folder.path / "truth/a_000004_lumen.png");
        CHECK(static_cast<int>(lumen[24]) == 16);  // bits
        const auto before = contents_of(folder.path / "truth");
        run_ok(folder, words + "-o a.png");
        CHECK(contents_of(folder.path / "truth") == before);
        // a picture without its labels is made again; one that has them stays
        fs::remove(folder.path / "truth/a_000004.json");
        fs::remove(folder.path / "a_000003.png");
        run_ok(folder, words + "-o a.png --resume");
        CHECK(contents_of(folder.path / "truth") == before);
        CHECK(fs::exists(folder.path / "a_000003.png"));
    }

    TEST_CASE(
        "property: labels do not change the picture; each of several views is the picture that it is alone but for its noise")
    {
        const LabelRun folder;
        const std::string words = "render run --view fluoro --size 64x64 --frames 4:4 --no-noise ";
        run_ok(folder, words + "-o made/here/plain.png --c-arm \"LAO 30\"");
        run_ok(folder, words + "-o two.png --c-arm \"LAO 30\" --c-arm \"RAO 60, CRA 10\" --labels truth");
        CHECK(slurp(folder.path / "two_v1.png") == slurp(folder.path / "made/here/plain.png"));
        CHECK(slurp(folder.path / "two_v2.png") != slurp(folder.path / "made/here/plain.png"));
        CHECK(folder.read("truth/two_v1.json")["camera"]["primary_deg"].get<double>() == about(30));
        CHECK(folder.read("truth/two_v2.json")["camera"]["primary_deg"].get<double>() == about(-60));
        CHECK(folder.read("truth/two_v2.json")["instruments"][1]["tip_m"] ==
              folder.read("truth/two_v1.json")["instruments"][1]["tip_m"]);
        CHECK(projection_error(folder.read("truth/two_v2.json")) < 1e-6);
        const std::string noisy = "render run --view fluoro --size 64x64 --frames 4:4 -o n.png --c-arm 0,0 --c-arm 0,0";
        run_ok(folder, noisy);
        CHECK(slurp(folder.path / "n_v1.png") != slurp(folder.path / "n_v2.png"));  // the same view, noise of its own
    }

    TEST_CASE("property: views from a sweep after the run")
    {
        const LabelRun folder;
        folder.write("views.toml",
                     "[vary]\n\"carm.lao_deg\" = [-20.0, 40.0]\n\"carm.cra_deg\" = {min = -10.0, max = 10.0, n = 2}\n");
        run_ok(folder, "render run --view fluoro --size 48x48 --frames 5:5 --labels truth --views views.toml");
        std::vector<double> primary, secondary;
        for (int k = 1; k <= 4; ++k) {
            const json camera = folder.read(fmt::format("truth/fluoro_v{}_000005.json", k))["camera"];
            primary.push_back(camera["primary_deg"]), secondary.push_back(camera["secondary_deg"]);
            CHECK(std::abs(secondary.back()) <= 10);
        }
        CHECK(primary[0] == about(-20));
        CHECK(primary[3] == about(40));
        CHECK(secondary[0] != secondary[1]);
        CHECK(secondary[0] == secondary[2]);  // each point of the grid sees the same draws
        folder.write("wrong.toml", "[vary]\n\"wire.radius_m\" = [1e-3]\n");
        check_refused(folder, "render run --view fluoro --views wrong.toml", 2, "is not of the picture");
        check_refused(folder, "render run --view fluoro --views none.toml", 3, "none.toml");
        check_refused(folder, "render run --view fluoro --views views.toml --c-arm \"LAO 3\"", 2, "give one of the two");
    }

    TEST_CASE("property: a field that cuts instruments off, or a mask with gaps, is a warning and no error")
    {
        const LabelRun folder;
        const AppResult drawn = run_ok(folder, "render run --view fluoro --size 64x64 --field 0.02 -o a.png");
        CHECK_MESSAGE(drawn.err.find("warning: the field cuts off wire") != std::string::npos, drawn.err);
        const AppResult coarse = run_app(folder, "render run --view fluoro --size 64x64 --field 0.5 -o a.png --labels truth");
        CHECK_MESSAGE(coarse.err.find("may have gaps") != std::string::npos, coarse.err);
        // where they are read first, and where a farm's labels come together
        const AppResult sheet = run_app(folder, "render run --view fluoro --size 64x64 --field 0.02 --preview sheet.png");
        CHECK_MESSAGE(sheet.err.find("warning: the field cuts off wire") != std::string::npos, sheet.err);
        run_ok(folder, "render run --view fluoro --size 64x64 --field 0.02 --frames 4:6 -o b.png --labels cut --quiet");
        const AppResult coco = run_ok(folder, "labels cut --coco coco.json");
        CHECK_MESSAGE(coco.err.find("warning: the field cuts off wire: in 3 of 3 pictures") != std::string::npos, coco.err);
        CHECK(run_app(folder, "labels cut --coco coco.json --quiet").err.empty());
        CHECK(run_app(folder, "render run --view fluoro --size 64x64 --field 0.02 -o a.png --quiet").err.empty());
    }

    TEST_CASE("property: ordinary views have labels too, with depth; the picture is then without a legend")
    {
        const LabelRun folder;
        const AppResult drawn = run_app(folder, "render run --view front --size 400x300 -o a.png --labels truth --label-vessel");
        if (drawn.code == 5) return skip(drawn.err);
        REQUIRE_MESSAGE(drawn.code == 0, drawn.err);
        const json labels = folder.read("truth/a.json");
        CHECK(projection_error(labels) < 1e-6);
        CHECK(labels["camera"]["fov_y_deg"].is_number());
        CHECK_FALSE(labels["camera"].contains("sid_m"));
        const seldinger::LabelImage mask = seldinger::read_label_png(folder.path / "truth/a_mask.png");
        const std::string depth = slurp(folder.path / "truth/a_depth.npy");
        REQUIRE(depth.size() == 128 + 4u * 400 * 300);
        std::size_t covered = 0;
        for (std::size_t k = 0; k < mask.labels.size(); ++k) {
            float z = 0;
            std::memcpy(&z, depth.data() + 128 + 4 * k, 4);
            CHECK((z > 0) == (mask.labels[k] != 0));
            covered += mask.labels[k] != 0;
        }
        CHECK(covered > 200);
        run_ok(folder, "render run --view front --size 400x300 -o b.png --no-legend");
        CHECK(slurp(folder.path / "a.png") == slurp(folder.path / "b.png"));
        // depths that somebody removed are made again
        fs::remove(folder.path / "truth/a_depth.npy");
        run_ok(folder, "render run --view front --size 400x300 -o a.png --labels truth --resume");
        CHECK(slurp(folder.path / "truth/a_depth.npy") == depth);
        CHECK_FALSE(has(drawn.err, "cuts off"));
        const AppResult close =
            run_ok(folder, "render run --view front --size 400x300 -o c.png --labels near --camera \"0s 0 0 8\"");
        CHECK_MESSAGE(close.err.find("Fix: another --view or --camera") != std::string::npos, close.err);
        check_refused(folder, "render run --view endoscopic --labels truth", 2, "out of an instrument");
    }

    TEST_CASE("property: a preview is one sheet and nothing else, of any view")
    {
        const LabelRun folder;
        run_ok(folder, "render run --view fluoro --size 200x100 --frames 0:10 --c-arm 0,0 --c-arm 90,0 --preview sheet.png");
        CHECK_FALSE(fs::exists(folder.path / "truth"));
        CHECK_FALSE(fs::exists(folder.path / "run/fluoro_v1_000000.png"));
        const std::string png = slurp(folder.path / "sheet.png");
        const auto side = [&](std::size_t at) {
            return (static_cast<unsigned char>(png[at + 2]) << 8) + static_cast<unsigned char>(png[at + 3]);
        };
        CHECK(side(16) == 4 * 404 + 4);  // 16 of 22 pictures in four columns
        CHECK(side(20) == 4 * (200 + 22 + 4) + 4);
        check_refused(folder, "render run --view fluoro --preview s.png --video f.mp4", 2, "only the sheet");
        check_refused(folder, "render run --view fluoro --preview s.png --labels truth", 2, "only the sheet");
        check_refused(folder, "render run --view fluoro --preview run", 3, "got a folder");
        check_refused(folder, "render run --view fluoro --label-vessel", 2, "--labels");
        check_refused(folder, "render run --gltf m.glb --labels truth", 2, "once for each");
        check_refused(folder, "render run --view fluoro --labels sheet.png", 3, "got a file");
    }

    TEST_CASE("property: a farm's frames carry their labels, the same bytes in any cut, and after a kill")
    {
        const LabelRun folder;
        const std::string words =
            " --view fluoro --size 64x64 --frames 2:9 --c-arm \"LAO 30\" --c-arm \"RAO 30\" --label-vessel --labels truth";
        run_ok(folder, "farm run -o one --tasks 1 --quiet" + words);
        const auto one = pictures_of(folder.path / "one");
        CHECK(one.size() == 8 * 2 * 4);  // two pictures of each frame, each with three files of labels
        run_ok(folder, "farm run -o many --tasks 5 --jobs 2 --quiet" + words);
        CHECK(pictures_of(folder.path / "many") == one);
        run_ok(folder, "farm merge many");
        // as render alone
        run_ok(folder, "render run" + words + " -o frame.png");
        CHECK(slurp(folder.path / "frame_v2_000005.png") == one.at("frame_v2_000005.png"));
        CHECK(slurp(folder.path / "truth/frame_v2_000005.json") == one.at("truth/frame_v2_000005.json"));
        // killed after a few pictures, and gone on with
        const pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            if (!std::freopen("/dev/null", "w", stderr)) _exit(126);
            if (chdir(folder.path.c_str()) != 0) _exit(126);
            execl("/bin/sh", "sh", "-c", ("exec \"$0\" farm run -o killed --tasks 2 --quiet" + words).c_str(), app_path(),
                  nullptr);
            _exit(127);
        }
        while (waitpid(child, nullptr, WNOHANG) != child) {
            if (!fs::exists(folder.path / "killed/frame_v1_000003.png")) continue;
            kill(child, SIGKILL);
            waitpid(child, nullptr, 0);
            break;
        }
        run_ok(folder, "farm run -o killed --tasks 2 --quiet" + words);
        CHECK(pictures_of(folder.path / "killed") == one);
        // labels that somebody removed are made again
        fs::remove(folder.path / "killed/truth/frame_v1_000004_mask.png");
        run_ok(folder, "farm run -o killed --tasks 2 --quiet" + words);
        CHECK(pictures_of(folder.path / "killed") == one);
        check_refused(folder, "farm run --frames all -o g --preview s.png", 2, "leave it out");
        const std::string front = " --view front --size 80x60 --frames 2:6 --labels truth";
        if (run_app(folder, "render run -o front.png" + std::string(" --view front --size 80x60")).code == 5) return;
        run_ok(folder, "farm run -o front1 --tasks 1 --quiet" + front);
        run_ok(folder, "farm run -o front3 --tasks 3 --jobs 2 --quiet" + front);
        CHECK(pictures_of(folder.path / "front1").size() == 5 * 4);
        CHECK(pictures_of(folder.path / "front1") == pictures_of(folder.path / "front3"));
    }

    TEST_CASE("property: COCO annotations hold the masks, their boxes, tips and bases")
    {
        const LabelRun folder;
        REQUIRE(run_app(folder, "render run --view fluoro --size 96x80 --field 0.2 --frames 4:6 --labels truth -o a.png").code ==
                0);
        run_ok(folder, "labels truth --coco truth/coco.json");
        const std::string first = slurp(folder.path / "truth/coco.json");
        run_ok(folder, "labels truth --coco truth/coco.json --quiet");  // which is no label itself
        CHECK(slurp(folder.path / "truth/coco.json") == first);
        const json coco = json::parse(first);
        CHECK(coco["images"].size() == 3);
        REQUIRE(coco["annotations"].size() == 6);
        CHECK(coco["categories"][1]["name"] == "wire");
        for (const json& a : coco["annotations"]) {
            const json& image = coco["images"][a["image_id"].get<std::size_t>() - 1];
            const std::string stem = fs::path(image["file_name"].get<std::string>()).stem();
            const seldinger::LabelImage mask = seldinger::read_label_png(folder.path / "truth" / (stem + "_mask.png"));
            const auto runs = runs_of_text(a["segmentation"]["counts"]);
            std::vector<char> painted(mask.labels.size());
            std::size_t at = 0;
            bool inside = false;
            for (const std::uint32_t run : runs) {
                for (std::uint32_t k = 0; k < run; ++k, ++at) painted.at(at % 80 * 96 + at / 80) = inside;
                inside = !inside;
            }
            REQUIRE(at == painted.size());
            int low[2] = {96, 80}, high[2] = {-1, -1}, area = 0;
            for (int r = 0; r < 80; ++r)
                for (int c = 0; c < 96; ++c) {
                    const std::size_t k = static_cast<std::size_t>(r * 96 + c);
                    REQUIRE(static_cast<bool>(painted[k]) == (mask.labels[k] == a["category_id"].get<int>()));
                    if (!painted[k]) continue;
                    ++area, low[0] = std::min(low[0], c), high[0] = std::max(high[0], c), low[1] = std::min(low[1], r),
                            high[1] = std::max(high[1], r);
                }
            CHECK(a["area"] == area);
            CHECK(a["bbox"] == json({low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1}));
            const json labels = folder.read("truth/" + stem + ".json");
            const json& instrument = labels["instruments"][a["category_id"].get<std::size_t>() - 1];
            CHECK(a["keypoints"][0] == instrument["tip_px"][0]);
            CHECK(a["keypoints"][2] == 2);
            CHECK(a["keypoints"][3] == instrument["centreline_px"].back()[0]);
        }
        if (std::system("python3 -c 'import pycocotools' 2>/dev/null") != 0) return skip("no pycocotools: ./dev deps test");
        folder.write("open.py", R"(import json, sys
from pycocotools.coco import COCO
coco = COCO(sys.argv[1])
assert len(coco.imgs) == 3 and [c["name"] for c in coco.loadCats(coco.getCatIds())] == ["catheter", "wire"]
for a in coco.anns.values():
    mask = coco.annToMask(a)
    assert mask.shape == (80, 96) and mask.sum() == a["area"], a["id"]
    rows, columns = mask.nonzero()
    assert a["bbox"] == [columns.min(), rows.min(), columns.max() - columns.min() + 1, rows.max() - rows.min() + 1]
)");
        CHECK(std::system(fmt::format("cd '{}' && python3 open.py truth/coco.json >/dev/null", folder.path.string()).c_str()) ==
              0);
    }

    TEST_CASE("regression: labels that are damaged or not there are one line")
    {
        const ScratchFolder folder;
        check_refused(folder, "labels nowhere --coco c.json", 3, "no such folder");
        fs::create_directory(folder.path / "d");
        check_refused(folder, "labels d --coco c.json", 3, "no labels in it");
        folder.write("d/a.json", "{}");
        folder.write("d/a_mask.png", "no picture");
        check_refused(folder, "labels d --coco c.json", 3, "a_mask.png");
        CHECK_FALSE(fs::exists(folder.path / "c.json"));
    }
}

}  // namespace seldinger::test::test_labels
