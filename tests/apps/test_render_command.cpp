// seldinger render on the command line: views, exports, and mistakes in them: one line each, and nothing half written.
#include "app_fixture.h"
#include "support/skip.h"

namespace seldinger::test::test_render_command {

namespace {

struct RunFolder : ScratchFolder {
    bool draws = false;
    RunFolder()
    {
        write("s.toml", free_scene(0.02) + "[output]\nwire_every = 2\n");
        run_ok(*this, "run s.toml -o run --quiet");
        const AppResult first = run_app(*this, "render run --size 64x48");
        draws = first.code == 0;
        if (!draws) skip(first.err);
    }
};

std::vector<std::string> names_in(const fs::path& dir)
{
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(dir)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

TEST_SUITE("apps/render_command")
{
    TEST_CASE("property: every view and move draws, and each frame alone as in its series")
    {
        const RunFolder folder;
        if (!folder.draws) return;
        for (const char* how :
             {"--view front", "--view side --camera orbit", "--view endoscopic", "--camera \"follow 30mm\" --background white",
              "--view top --camera \"0s 0 0; 0.02s 90 20 2\" --no-legend", "--background transparent --force-max 20mN/mm"}) {
            CAPTURE(how);
            run_ok(folder, fmt::format("render run --size 160x120 --frames 3:6 -o a.png {}", how));
            run_ok(folder, fmt::format("render run --size 160x120 --frames 5:5 -o b.png {}", how));
            CHECK(slurp(folder.path / "a_000005.png") == slurp(folder.path / "b.png"));
        }
        run_ok(folder, "render run --gltf m.glb --usd m.usda");
        CHECK(slurp(folder.path / "m.glb").substr(0, 4) == "glTF");
        CHECK(has(slurp(folder.path / "m.usda"), "20: ["));  // the last frame's time, in milliseconds
        // folders that are not there are made
        run_ok(folder, "render run --gltf a/new/folder/of/models.glb");
        CHECK(fs::exists(folder.path / "a/new/folder/of/models.glb"));
        run_ok(folder, "report run -o reports/run.html");
        CHECK(fs::exists(folder.path / "reports/run.html"));
    }

    TEST_CASE("regression: bad input is one line and leaves no file")
    {
        const RunFolder folder;
        if (!folder.draws) return;
        fs::create_directory(folder.path / "folder.dcm");
        fs::create_directory(folder.path / "folder.png");
        const std::vector<std::string> before = names_in(folder.path);
        check_refused(folder, "render run --frames 3:99", 2, "0 <= A <= B <= 10, the run has 11 frames");
        check_refused(folder, "render run --view sideways", 2, "--view");
        check_refused(folder, "render run --view endoscopic --camera orbit", 2, "leave one of the two out");
        check_refused(folder, "render run --camera spin", 2, "orbit [DEGREES]");
        check_refused(folder, "render run --view fluoro --camera orbit", 2, "not for an X-ray picture");
        check_refused(folder, "render run --force-max 20", 2, "no unit");
        check_refused(folder, "render run --fps 10", 2, "--video");
        check_refused(folder, "render run -o folder.png", 3, "got a folder");
        check_refused(folder, "render run --gltf folder.dcm", 3, "got a folder");
        check_refused(folder, "render run --gltf m.obj", 3, ".glb");
        check_refused(folder, "render run --view fluoro --size 64x64 --dicom folder.dcm", 3, "got a folder");
        check_refused(folder, "render run --frames 0:9 --size 64x48 --video f.avi", 3, ".mp4");
        check_refused(folder, "render run --frames 0:9 --size 64x48 --video f.mp4", 3, "apt-get install ffmpeg", "PATH=/nowhere");
        check_refused(folder, "render run --size 64x48", 5, "OpenGL", "__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere/none.json");
        // Mesa's loader would add six lines about its search; another maker's driver may draw all the same
        if (run_app(folder, "render run --size 64x48 -o other.png", "LIBGL_DRIVERS_PATH=/nowhere").code != 0)
            check_refused(folder, "render run --size 64x48", 5, "OpenGL", "LIBGL_DRIVERS_PATH=/nowhere");
        fs::remove(folder.path / "other.png");
        CHECK(names_in(folder.path) == before);
    }

    TEST_CASE("regression: a disk that is full in mid-film leaves no film, and one line")
    {
        const RunFolder folder;
        if (!folder.draws) return;
        if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0) return skip("no ffmpeg: apt-get install ffmpeg");
        // files of half a kilobyte at most: the film's header alone is larger
        check_refused(folder, "render run --frames 0:10 --size 320x240 --video f.mp4", 3, "from ffmpeg; expected a",
                      "ulimit -f 1;");
        CHECK_FALSE(fs::exists(folder.path / "f.mp4"));
        CHECK_FALSE(fs::exists(folder.path / "f.mp4.part"));
        run_ok(folder, "render run --frames 0:10 --size 320x240 --video f.mp4");
        CHECK(fs::file_size(folder.path / "f.mp4") > 512);
    }
}

}  // namespace seldinger::test::test_render_command
