// A fed wire whose first length lies along the vessel's centreline at the start.

#include "core/error.h"
#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace seldinger::test::test_feed_start {

namespace {

constexpr double lumen = 0.004, bend = 0.02, wire = 0.00045;

/// An arc of 180 degrees, entered at its root or at its other end.
Scene scene_of(double advance, const std::string& feed, const std::string& scene = "")
{
    static const TemporaryFolder folder;
    const std::string text = fmt::format(
        "[scene]\nduration_s = 0.2\ndt_s = 0.001\n{}\n[vessel]\nshape = \"arc\"\nradius_m = {}\nbend_radius_m = {}\n"
        "angle_deg = 180.0\ntriangles = 8000\n[wire]\nradius_m = {}\ndensity = 6450.0\nyoungs_pa = 1e9\nlength_m = 0.2\n"
        "nodes = 101\n[feed]\n{}\nkeys = [{{t_s = 0.0, advance_m = {}}}, {{t_s = 1.0, advance_m = {}}}]\n",
        scene, lumen, bend, wire, feed, advance, advance + 0.01);
    return read_scene_text(text, folder.path() / "s.toml", {});
}

/// Distance of a point from the arc's axis [m].
double off_axis(const Vec3& p) { return std::hypot(std::hypot(p.x(), p.z() - bend) - bend, p.y()); }

}  // namespace

TEST_SUITE("step/feed_start")
{
    TEST_CASE("property: 5 cm that lie along a bend start on its axis, from either end, and settle onto its wall")
    {
        for (const char* inlet : {"inlet = 1", "inlet = 2"}) {
            CAPTURE(inlet);
            const Scene scene = scene_of(0.05, std::string(inlet) + "\nstart = \"centreline\"");
            CHECK(scene.start_settled);
            World world(make_setup(scene));
            const ConstRodView rod = world.rod(0);
            // Edges of 2 mm that are chords of the axis' own polyline: sagittas of 2^2/(8 x 20) = 0.025 mm and those of its
            // pieces
            double farthest = 0;
            for (int i = 0; i < rod.n; ++i) farthest = std::max(farthest, off_axis(rod.pos(i)));
            CHECK(farthest < 0.3e-3);
            const double angle = 0.05 / bend;  // of the tip, from the inlet
            const Vec3 tip = rod.pos(0);
            CHECK(std::abs(std::hypot(tip.x(), tip.z() - bend) - bend) < 0.3e-3);
            const double from_root = std::atan2(tip.x(), bend - tip.z()),
                         expected = inlet[8] == '1' ? angle : std::numbers::pi - angle;
            CHECK(std::abs(from_root - expected) < 0.03);  // chords for arcs: 5 cm less 0.02 %; the piece at the inlet
            REQUIRE_FALSE(settle(world).failed());
            CHECK(world.readings(0).contacts > 0);
            CHECK(world.readings(0).outside == 0);
            for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            CHECK(world.readings(0).kinetic < 1e-3 * world.readings(0).elastic);  // at rest it was
        }
    }

    TEST_CASE("property: straight through the wall is refused with that way out; who asks for no settling has none")
    {
        check_refused([] { return make_setup(scene_of(0.05, "inlet = 1")); }, {"feed.start = \"centreline\""});
        CHECK_FALSE(scene_of(0.05, "inlet = 1\nstart = \"centreline\"", "start = \"placed\"").start_settled);
        CHECK_FALSE(scene_of(0.01, "inlet = 1").start_settled);
    }
}

}  // namespace seldinger::test::test_feed_start
