// A wire that is to start at rest and has no rest: it starts as it was placed, and the run says so.

#include "apps/app_fixture.h"

namespace seldinger::test::test_settled_start {

TEST_SUITE("apps/settled_start")
{
    TEST_CASE("regression: without an equilibrium a run starts from the placed wire, with a warning; a static one still ends")
    {
        const ScratchFolder folder;
        const std::string wire = "[wire]\nlength_m = 0.1\nradius_m = 0.0005\ndensity = 7900.0\nyoungs_pa = 1e9\nnodes = 11\n";
        folder.write("free.toml",
                     "[scene]\nduration_s = 0.02\ndt_s = 0.001\nstart = \"settled\"\n" + wire);  // nothing holds it: it falls
        run_ok(folder, "run free.toml -o settled");
        const auto settled = summary_of(folder.path / "settled");
        REQUIRE(settled.at("warnings").size() == 1);
        CHECK(has(settled.at("warnings")[0].get<std::string>(), "no equilibrium was found"));
        run_ok(folder, "run free.toml -o placed --set scene.start=placed");
        CHECK(settled.at("state_hash") ==
              summary_of(folder.path / "placed").at("state_hash"));  // what settling tried leaves no trace
        folder.write("static.toml", "[integrator]\nscheme = \"static\"\n" + wire);
        CHECK(run_app(folder, "run static.toml -o static").code == 4);
    }
}

}  // namespace seldinger::test::test_settled_start
