// What a first start says while OpenCL's kernels are compiled.

#include "apps/app_fixture.h"

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
}

}  // namespace test_first_start
