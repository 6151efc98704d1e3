// Hands of instruments that share a centreline: bands of each, against finer nodes.
#include "setup/joint_readings.h"
#include "setup/key_frames.h"
#include "scene/scene.h"
#include "bands/step_twin.h"
#include "setup/scene_setup.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace seldinger::test::test_group_hands {

namespace {

/// A catheter over a wire, both fed round a bend.
Scene pair_in_a_bend(int per_length)
{
    const auto instrument = [&](const char* name, double length, double radius, double bend, const char* more) {
        return fmt::format(
            "[[instrument]]\nname = \"{}\"\nlength_m = {}\nradius_m = {}\ndensity = 3000.0\nbend_nm2 = {}\ntwist_nm2 = {}\n"
            "stretch_n = 3e3\nmu_static = 0.05\nmu_sliding = 0.05\nnodes = {}\n{}",
            name, length, radius, bend, bend, static_cast<int>(std::lround(length * per_length)) + 1, more);
    };
    return read_scene_text(
        "[scene]\nduration_s = 0.6\ndt_s = 0.004\n[vessel]\nshape = \"arc\"\nradius_m = 0.0035\nbend_radius_m = 0.03\nangle_deg "
        "= 110.0\n"
        "lead_in_m = 0.03\nlead_out_m = 0.06\ntriangles = 20000\n" +
            instrument("catheter", 0.2, 0.0008, 3e-4, "lumen_radius_m = 0.0005\n") +
            "[instrument.feed]\ninlet = \"auto\"\nkeys = [{t_s = 0, advance_m = 0.02}, {t_s = 0.6, advance_m = 0.05}]\n" +
            instrument("wire", 0.25, 0.0004, 1.5e-4, "") +
            "[instrument.feed]\nkeys = [{t_s = 0, advance_m = 0.025}, {t_s = 0.6, advance_m = 0.075}]\n[coaxial]\norder = "
            "[\"catheter\", \"wire\"]\n",
        "pair.toml");
}

struct Run {
    ErrorEstimate estimate;
    std::string hash;
};

Run run(int per_length, bool with_twin = true)
{
    const Scene scene = pair_in_a_bend(per_length);
    World world(make_setup(scene));
    const KeyFrames key_frames(scene);
    std::optional<StepTwin> twin;
    if (with_twin) twin.emplace(scene, world, 0);
    for (long k = 0; k < scene.steps(); ++k) {
        REQUIRE_FALSE(step(world, key_frames.control(), scene.step_length(k)).failed());
        if (twin) twin->stepped(world, joint_readings(world, 0), k + 1);
    }
    return {twin ? twin->finish(StepTwin::Finer::Never) : ErrorEstimate{}, world.state_hash()};
}

}  // namespace

TEST_SUITE("bands/group_hands")
{
    // Edges of 5 mm against 1.25 mm: the hands swing as the catheter's end passes from cell to cell. Bands are bounds: not fifty
    // times the difference.
    TEST_CASE("property: each hand of a catheter over a wire has a band that holds what four times as many nodes give")
    {
        const Run coarse = run(200), fine = run(800);
        CHECK(coarse.hash == run(200, false).hash);
        REQUIRE(coarse.estimate.others.size() == 1);
        CHECK(coarse.estimate.others[0].name == "wire");
        double most = 0, widest = 0;
        const auto compare = [&](const char* what, const ErrorBand& band, const ErrorBand& of_fine) {
            CAPTURE(what);
            CAPTURE(band.value);
            CAPTURE(band.nodes);
            CAPTURE(of_fine.value);
            const double off = std::abs(band.value - of_fine.value);
            CHECK(off <= band.band);
            CHECK(of_fine.nodes < 0.5 * band.nodes);
            most = std::max(most, off);
            widest = std::max(widest, band.band);
        };
        compare("catheter, end", coarse.estimate.hand, fine.estimate.hand);
        compare("catheter, largest", coarse.estimate.hand_peak, fine.estimate.hand_peak);
        compare("wire, end", coarse.estimate.others[0].end, fine.estimate.others[0].end);
        compare("wire, largest", coarse.estimate.others[0].peak, fine.estimate.others[0].peak);
        CAPTURE(most);
        CAPTURE(widest);
        CHECK(most > 2e-3);
        CHECK(widest < 50 * most);
    }
}

}  // namespace seldinger::test::test_group_hands
