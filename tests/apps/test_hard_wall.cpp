// How far a wire sinks into a rigid wall whose stiffness the scene does not give, and when that is said.

#include "apps/app_fixture.h"

#include <fmt/format.h>

#include <cmath>

namespace seldinger::test::test_hard_wall {

namespace {

/// A stiff 0.035 inch wire that is pushed round a bend of 40 mm. @param wall  further keys of [vessel]   @param stiffer  factor
/// on its stiffness
std::string bend_scene(const std::string& wall, double stiffer = 1, double angle = 90, double lumen = 0.005)
{
    return fmt::format(
        "[scene]\nduration_s = 1.0\ndt_s = 0.001\ngravity = [0.0, 0.0, 0.0]\n[wire]\nlength_m = 0.2\nradius_m = "
        "0.0004445\ndensity = 7900.0\n"
        "bend_nm2 = {}\ntwist_nm2 = 3.8e-4\nstretch_n = 1.0e4\nnodes = 81\n[vessel]\nshape = \"arc\"\nradius_m = {}\n"
        "bend_radius_m = 0.04\nangle_deg = {}\nlead_in_m = 0.03\nlead_out_m = 0.05\n{}[feed]\ninlet = 1\n"
        "keys = [ {{t_s = 0.0, advance_m = 0.0}}, {{t_s = 1.0, advance_m = 0.09}} ]\n",
        5.0e-4 * stiffer, lumen, angle, wall);
}

}  // namespace

TEST_SUITE("apps/hard_wall")
{
    // The depth under a given load goes with the stiffness to the power -2/3: from 1 MPa to 1 GPa a hundredth, of which the wire
    // keeps more where it bears on less length. What that does to forces depends on how far the wall deflects the wire: dN/N =
    // o/d.
    //     bend of 90 degrees in a lumen of 5 mm        d = 10 mm: an overlap of a tenth of the radius is half a per cent
    //     bend of 10 degrees in a lumen of 0.55 mm     d = 0.05 mm: the same overlap is a fifth
    // Each is held against a wall that is a hundred times as hard.
    TEST_CASE(
        "property: the default is hard; where its softness is felt in the forces, and only there, it is said; who gives the "
        "stiffness has asked for it")
    {
        const ScratchFolder folder;
        folder.write("plain.toml", bend_scene(""));
        folder.write("stiffer.toml", bend_scene("", 30));
        folder.write("stiffer-hard.toml", bend_scene("youngs_pa = 1e11\n", 30));
        folder.write("narrow.toml", bend_scene("", 100, 10, 0.00055));
        folder.write("narrow-hard.toml", bend_scene("youngs_pa = 1e11\n", 100, 10, 0.00055));
        folder.write("soft.toml", bend_scene("youngs_pa = 1e6\n"));
        folder.write("hard.toml", bend_scene("youngs_pa = 1e9\n"));
        const auto run = [&](const std::string& name) {
            const AppResult result = run_ok(folder, "run " + name + ".toml -o " + name + " --json --error-estimate off");
            return nlohmann::json::parse(result.out);
        };
        const auto share = [](const nlohmann::json& summary) { return summary["overlap_share_max"].get<double>(); };
        const auto says = [](const nlohmann::json& summary) {
            return summary["warnings"].dump().find("sinks into the rigid wall") != std::string::npos;
        };
        const auto lost = [](const nlohmann::json& soft, const nlohmann::json& hard) {
            return 1 - soft["hand_force_max_n"].get<double>() / hard["hand_force_max_n"].get<double>();
        };
        const auto plain = run("plain"), stiffer = run("stiffer"), narrow = run("narrow"), soft = run("soft"), hard = run("hard");
        CHECK(plain["state_hash"] == hard["state_hash"]);
        CHECK(share(plain) < 0.025);
        CHECK(share(soft) > 0.2);
        CHECK(share(plain) < 0.1 * share(soft));
        CHECK(share(stiffer) > 0.05);
        CHECK(std::abs(lost(stiffer, run("stiffer-hard"))) < 0.03);
        CHECK(share(narrow) > 0.05);
        CHECK(lost(narrow, run("narrow-hard")) > 0.1);
        CHECK(says(narrow));
        for (const auto& quiet : {plain, stiffer, soft, hard}) CHECK_FALSE(says(quiet));
    }
}

}  // namespace seldinger::test::test_hard_wall
