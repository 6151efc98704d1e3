// What a first start says while OpenCL's kernels are compiled.

#include "apps/app_fixture.h"
#include "apps/background_app.h"

#include <list>

namespace test_first_start {

using namespace seldinger::test;

TEST_SUITE("apps/first_start")
{
    TEST_CASE("property: kernels that are compiled are announced, those in the cache and --quiet are not")
    {
        const ScratchFolder folder;
        folder.write("t.toml", tube_scene());
        const std::string cold = "env POCL_CACHE_DIR=\"$PWD/kernels\"";
        const AppResult first = run_app(folder, "run t.toml -o A", cold);
        CAPTURE(first.err);
        REQUIRE(first.code == 0);
        if (!fs::exists(folder.path / "kernels")) return;  // another OpenCL, which says where nothing of it goes
        CHECK(first.compiled);
        CHECK_FALSE(run_app(folder, "run t.toml -o B", cold).compiled);
        // a program that is missing among others is announced as well, when it has been compiled
        const auto without_one = [&](const char* more) {
            for (const auto& at : fs::recursive_directory_iterator(folder.path / "kernels"))
                if (at.path().filename() == "program.bc") {
                    fs::remove_all(at.path().parent_path());
                    return run_app(folder, fmt::format("run t.toml -o C --overwrite {}", more), cold).compiled;
                }
            FAIL("no program in the cache");
            return false;
        };
        CHECK(without_one(""));
        CHECK_FALSE(without_one("--quiet"));
    }

    TEST_CASE("property: several first starts at once end well, with the kernels that one has alone, and leave no lock")
    {
        const ScratchFolder folder;
        folder.write("t.toml", tube_scene(0.01));
        const fs::path cache = folder.path / "kernels";
        {
            std::list<BackgroundApp> apps;
            for (const char* out : {"A", "B", "C", "D"})
                apps.emplace_back(folder.path, std::vector<std::string>{"run", "t.toml", "-o", out, "--quiet"},
                                  std::vector<std::string>{"POCL_CACHE_DIR=" + cache.string()});
            for (BackgroundApp& app : apps) CHECK(app.result().code == 0);
        }
        if (!fs::exists(cache)) return;  // another OpenCL
        int kernels = 0;
        for (const auto& at : fs::recursive_directory_iterator(cache)) {
            kernels += at.path().extension() == ".so";
            CHECK(at.path().extension() != ".lock");
        }
        CHECK(kernels == 8);  // four, for two devices
    }

    TEST_CASE("property: after devices --warm no run compiles a kernel; a second time there is nothing to do")
    {
        const ScratchFolder folder;
        folder.write("t.toml", tube_scene(0.01));
        const std::string cache = "env POCL_CACHE_DIR=\"$PWD/kernels\"";
        const AppResult warmed = run_app(folder, "devices --warm", cache);
        CHECK(warmed.code == 0);
        if (!fs::exists(folder.path / "kernels")) return;  // another OpenCL
        CHECK(warmed.out.find(" kernels compiled, 0 were there; kept in ") != std::string::npos);
        CHECK(run_app(folder, "devices --warm", cache).out.find("0 kernels compiled, ") == 0);
        for (const char* how : {"", "--set contact.precision=float32", "--set contact.normal=constraint", "--set contact.normal=barrier"})
            CHECK_FALSE(run_app(folder, fmt::format("run t.toml -o A --overwrite {}", how), cache).compiled);
        const AppResult alone = run_app(folder, "devices --device 0");
        CHECK(alone.code == 2);  // the command line is wrong
        CHECK(alone.err.find("add --warm") != std::string::npos);
    }
}

}  // namespace test_first_start
