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

    TEST_CASE("property: of several first starts one compiles each kernel, for one of PoCL's two devices")
    {
        const ScratchFolder folder;
        folder.write("t.toml", tube_scene(0.01));
        // PoCL leaves what it compiles from beside what it has compiled: one file and more for each call of its compiler
        const auto files = [&](const char* cache) {
            std::size_t kernels = 0, left = 0;
            for (const auto& at : fs::recursive_directory_iterator(folder.path / cache)) {
                if (!at.is_regular_file()) continue;
                kernels += at.path().extension() == ".so" && at.path().parent_path() != folder.path / cache &&
                           !at.path().filename().string().starts_with("temp");
                left += at.path().filename().string().find("temp") != std::string::npos;
            }
            return std::pair{kernels, left};
        };
        const std::string leave = "POCL_LEAVE_KERNEL_COMPILER_TEMP_FILES=1";
        REQUIRE(run_app(folder, "run t.toml -o one --quiet", "env POCL_CACHE_DIR=\"$PWD/alone\" " + leave).code == 0);
        if (!fs::exists(folder.path / "alone")) return;  // another OpenCL
        {
            std::list<BackgroundApp> apps;
            for (const char* out : {"A", "B", "C", "D"})
                apps.emplace_back(folder.path, std::vector<std::string>{"run", "t.toml", "-o", out, "--quiet"},
                                  std::vector<std::string>{"POCL_CACHE_DIR=" + (folder.path / "shared").string(), leave});
            for (BackgroundApp& app : apps) CHECK(app.result().code == 0);
        }
        const auto [kernels, left] = files("alone");
        CHECK(kernels == 8);  // four, for two devices
        CHECK(files("shared") == std::pair{kernels, left});
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
        for (const char* how :
             {"", "--set contact.precision=float32", "--set contact.normal=constraint", "--set contact.normal=barrier"})
            CHECK_FALSE(run_app(folder, fmt::format("run t.toml -o A --overwrite {}", how), cache).compiled);
        const AppResult alone = run_app(folder, "devices --device 0");
        CHECK(alone.code == 3);
        CHECK(alone.err.find("add --warm") != std::string::npos);
    }
}

}  // namespace test_first_start
