// What a first start says while OpenCL's kernels are compiled.

#include "apps/app_fixture.h"
#include "apps/background_app.h"

#include <list>

namespace seldinger::test::test_first_start {

TEST_SUITE("apps/first_start")
{
    TEST_CASE("property: kernels that are compiled are announced, those in the cache and --quiet are not")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        const std::string cold = "env POCL_CACHE_DIR=\"$PWD/kernels\"";
        const AppResult first = run_ok(folder, "run t.toml -o A", cold);
        if (!fs::exists(folder.path / "kernels")) return;  // another OpenCL, which says where nothing of it goes
        CHECK(first.compiled);
        CHECK_FALSE(run_app(folder, "run t.toml -o B", cold).compiled);
        CHECK_FALSE(run_app(folder, "run t.toml -o B --overwrite --threads 1", cold).compiled);  // on one of PoCL's two devices
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

    TEST_CASE("property: several first starts at once end well, compile each kernel once, and leave no lock")
    {
        const ScratchFolder folder;
        const fs::path cache = folder.path / "kernels";
        int compiled = 0;
        {
            std::list<BackgroundApp> apps;
            for (const char* name : {"A", "B", "C", "D"}) {
                fs::create_directory(folder.path / name);
                folder.write(fmt::format("{}/t.toml", name), tube_scene(0.01));
                apps.emplace_back(folder.path / name, std::vector<std::string>{"run", "t.toml", "-o", "out", "--quiet"},
                                  std::vector<std::string>{"POCL_CACHE_DIR=" + cache.string(), "POCL_DEBUG=llvm"});
            }
            for (BackgroundApp& app : apps) {
                const AppResult result = app.result();
                CHECK(result.code == 0);
                constexpr std::string_view words = "Temporary kernel.so file";  // PoCL's, for each that it compiles
                for (std::size_t at = 0; (at = result.err.find(words, at)) != std::string::npos; ++at) ++compiled;
            }
        }
        if (!fs::exists(cache)) return;  // another OpenCL
        CHECK(compiled == 4);
        int kernels = 0, programs = 0;
        for (const auto& at : fs::recursive_directory_iterator(cache)) {
            kernels += at.path().extension() == ".so";
            programs += at.path().extension() == ".program";
            CHECK(at.path().extension() != ".lock");
        }
        CHECK(kernels == 8);   // four, for two devices
        CHECK(programs == 1);  // of both
    }

    TEST_CASE("regression: a program's code that was cut is made again, and the run is the same")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.01)}};
        const std::string cache = "env POCL_CACHE_DIR=\"$PWD/kernels\"";
        run_ok(folder, "run t.toml -o A", cache);
        fs::path code;
        for (const auto& at : fs::recursive_directory_iterator(folder.path / "kernels"))
            if (at.path().extension() == ".program") code = at.path();
        if (code.empty()) return;  // another OpenCL
        const auto size = fs::file_size(code);
        fs::resize_file(code, size / 2);
        run_ok(folder, "run t.toml -o B", cache);
        CHECK(fs::file_size(code) > size / 2);
        CHECK_FALSE(run_app(folder, "run t.toml -o C", cache).compiled);
        CHECK(summary_of(folder.path / "B").at("state_hash") == summary_of(folder.path / "A").at("state_hash"));
    }

    TEST_CASE("property: after devices --warm no run compiles a kernel; a second time there is nothing to do")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.01)}};
        const std::string cache = "env POCL_CACHE_DIR=\"$PWD/kernels\"";
        const AppResult warmed = run_ok(folder, "devices --warm", cache);
        if (!fs::exists(folder.path / "kernels")) return;  // another OpenCL
        CHECK(has(warmed.out, " kernels compiled, 0 were there; kept in "));
        CHECK(run_app(folder, "devices --warm", cache).out.find("0 kernels compiled, ") == 0);
        for (const char* how : {"", "--set contact.precision=float32", "--set contact.normal=constraint",
                                "--set contact.normal=barrier", "--set contact.detection=layer"})
            CHECK_FALSE(run_app(folder, fmt::format("run t.toml -o A --overwrite {}", how), cache).compiled);
        const AppResult alone = run_app(folder, "devices --device 0");
        CHECK(alone.code == 2);  // the command line is wrong
        CHECK(has(alone.err, "add --warm"));
    }
}

}  // namespace seldinger::test::test_first_start
