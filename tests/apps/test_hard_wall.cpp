// A wire that sinks into a rigid wall: said with its number where the scene does not give the wall's stiffness.

#include "apps/app_fixture.h"

namespace test_hard_wall {

using namespace seldinger::test;

namespace {

/// A stiff 0.035 inch wire that is pushed round a bend of 40 mm in a lumen of 5 mm. @param wall  further keys of [vessel]
std::string bend_scene(const std::string& wall)
{
    return "[scene]\nduration_s = 1.0\ndt_s = 0.001\ngravity = [0.0, 0.0, 0.0]\n[wire]\nlength_m = 0.2\nradius_m = 0.0004445\ndensity = 7900.0\n"
           "bend_nm2 = 5.0e-4\ntwist_nm2 = 3.8e-4\nstretch_n = 1.0e4\nnodes = 81\n[vessel]\nshape = \"arc\"\nradius_m = 0.005\n"
           "bend_radius_m = 0.04\nangle_deg = 90.0\nlead_in_m = 0.03\nlead_out_m = 0.05\n" +
           wall + "[feed]\ninlet = 1\nkeys = [ {t_s = 0.0, advance_m = 0.0}, {t_s = 1.0, advance_m = 0.09} ]\n";
}

}  // namespace

TEST_SUITE("apps/hard_wall")
{
    TEST_CASE("property: the soft default is said with the share of the radius; who gives the wall's stiffness has asked for it")
    {
        const ScratchFolder folder;
        folder.write("soft.toml", bend_scene(""));
        folder.write("given.toml", bend_scene("youngs_pa = 1e6\n"));
        folder.write("hard.toml", bend_scene("youngs_pa = 1e9\n"));
        const auto run = [&](const std::string& name) {
            const AppResult result = run_app(folder, "run " + name + ".toml -o " + name + " --json --error-estimate off");
            REQUIRE(result.code == 0);
            return nlohmann::json::parse(result.out);
        };
        const auto soft = run("soft"), given = run("given"), hard = run("hard");
        CHECK(soft["overlap_share_max"].get<double>() > 0.2);
        CHECK(soft["overlap_share_max"] == given["overlap_share_max"]);
        CHECK(soft["warnings"].dump().find("sinks into the rigid wall") != std::string::npos);
        CHECK(given["warnings"].dump().find("sinks") == std::string::npos);
        // depth goes with the stiffness to the power -2/3: a hundredth, of which this wire keeps more where it bears on less length
        CHECK(hard["overlap_share_max"].get<double>() < 0.1 * soft["overlap_share_max"].get<double>());
    }
}

}  // namespace test_hard_wall
