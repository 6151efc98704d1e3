// seldinger chart: a wrong command line, and Ctrl-C half-way.

#include "apps/app_fixture.h"

using namespace seldinger::test;

TEST_SUITE("apps/chart") {

TEST_CASE("property: an unknown scene is exit 2 in one line, a missing file exit 3") {
    const ScratchFolder folder;
    const AppResult unknown = run_app(folder, "chart --quick --scenes experiment3");
    CHECK(unknown.code == 2);
    CHECK(unknown.error_lines() == 1);
    CHECK(unknown.err.find("did you mean \"experiment1\"?") != std::string::npos);
    CHECK(run_app(folder, "chart --scenes none.toml").code == 3);
    CHECK(run_app(folder, "chart --qick").code == 2);
    CHECK_FALSE(fs::exists(folder.path / "chart"));
}

TEST_CASE("property: Ctrl-C ends a chart with exit 130 and one line that says how to go on; what was done is kept") {
    const ScratchFolder folder;
    // hours of it: the signal comes long before the end, whatever the machine
    const std::string command = "chart --scenes heavy-swing,elastica -o D";
    const AppResult cut = run_app(folder, command, "timeout --preserve-status -s INT 3");
    CHECK(cut.code == 130);
    CHECK(cut.error_lines() == 1);
    CHECK(cut.err.find("the same command goes on") != std::string::npos);
    CHECK(fs::exists(folder.path / "D" / "runs.csv"));
    CHECK(cut.out.empty());
}

}
