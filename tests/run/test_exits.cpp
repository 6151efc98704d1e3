// Tips that leave through openings: which and when; and paths that are no exit.
#include "run/exits.h"

#include "record/checkpoint.h"
#include "scene/scene.h"
#include "support/approx.h"
#include "support/world_fixture.h"
#include "vessel/inlets.h"

namespace seldinger::test::test_exits {

namespace {

/// A tube along x from 0 to 0.1 m, radius 5 mm: opening planes at both ends.
struct Tube {
    GeneratedVessel vessel;
    std::vector<BoundaryLoop> openings;
    Tube()
    {
        VesselSpec spec = test::tube(0.005, 0.1);
        spec.axis = Vec3::UnitX();
        vessel = make_tube(spec);
        openings = describe(vessel.mesh).loops;
        REQUIRE(openings.size() == 2);
    }
    [[nodiscard]] int at(double x) const { return std::abs(openings[0].centre.x() - x) < 1e-6 ? 0 : 1; }
};

std::vector<Vec3> tip_at(const Vec3& p) { return {p}; }

}  // namespace

TEST_SUITE("run/exits")
{
    TEST_CASE("analytic: a tip that comes in at one end and leaves at the other has left once, through that one")
    {
        const Tube tube;
        ExitTally tally;
        for (int k = 0; k <= 24; ++k)
            watch_exits(tally, tip_at({-0.008 + 0.005 * k, 0.001, 0}), tube.openings, tube.vessel.mesh, 0.1 * k);
        REQUIRE(tally.count == 1);
        CHECK(tally.exit[0].opening == tube.at(0.1));
        CHECK(tally.exit[0].left == test::about(2.2));  // -8 mm + 22 x 5 mm = 102 mm, 97 mm before
        CHECK(tally.exit[0].back == 0);
        CHECK(outside_through(tally, 0) == tube.at(0.1));
        CHECK(outside_through(tally, 1) == -1);
        // as people count them: the inlet at the centreline's root, x = 0, is the first, whatever the order of the mesh's loops
        CHECK(inlet_through(tube.openings, tube.vessel.centreline, tube.at(0)) == 1);
        CHECK(inlet_through(tube.openings, tube.vessel.centreline, tube.at(0.1)) == 2);
        CHECK(inlet_through(tube.openings, tube.vessel.centreline, -1) == 0);
        Scene scene;
        const auto sentences = exit_sentences(tally, tube.openings, tube.vessel.centreline, scene);
        REQUIRE(sentences.size() == 1);
        CHECK(sentences[0].find("2.2 s") != std::string::npos);
        CHECK(sentences[0].find("radius 5 mm") != std::string::npos);
        CHECK(sentences[0].find("left through inlet 2 ([0.1,") != std::string::npos);
        watch_exits(tally, tip_at({0.09, 0.001, 0}), tube.openings, tube.vessel.mesh, 3.0);
        CHECK(tally.count == 1);
        CHECK(tally.exit[0].back == 3.0);
        CHECK(outside_through(tally, 0) == -1);
        watch_exits(tally, tip_at({0.11, 0.001, 0}), tube.openings, tube.vessel.mesh, 4.0);  // out again: told again
        CHECK(tally.count == 2);
    }

    TEST_CASE("property: through the wall, or past the plane of an opening beside its rim, is no exit")
    {
        const Tube tube;
        ExitTally tally;
        const Vec3 way[] = {{0.05, 0, 0}, {0.05, 0.02, 0}, {0.12, 0.02, 0}, {0.12, 0, 0}, {0.12, 0.02, 0}, {0.05, 0.02, 0}};
        double time = 0;
        for (const Vec3& p : way) watch_exits(tally, tip_at(p), tube.openings, tube.vessel.mesh, time += 1);
        CHECK(tally.count == 0);
    }

    TEST_CASE("property: every instrument that a scene may have is watched, and each may be the one that pressed on a closed end")
    {
        const Tube tube;
        RunTally run;
        const int last = static_cast<int>(most_scene_instruments) - 1;
        std::vector<Vec3> tips(most_scene_instruments, Vec3(0.05, 0, 0));
        watch_exits(run.exits, tips, tube.openings, tube.vessel.mesh, 1);
        tips.back() = {0.11, 0, 0};
        watch_exits(run.exits, tips, tube.openings, tube.vessel.mesh, 2);
        CHECK(outside_through(run.exits, last) == tube.at(0.1));
        run.end_touch.wire = last;
        CHECK(is_sound(run, 1));
        run.end_touch.wire = -1;
        CHECK_FALSE(is_sound(run, 1));
    }

    TEST_CASE("property: more exits than are kept end no run")
    {
        const Tube tube;
        ExitTally tally;
        for (int k = 0; k < 3 * ExitTally::most_exits; ++k)
            watch_exits(tally, tip_at({k % 2 == 0 ? 0.09 : 0.11, 0, 0}), tube.openings, tube.vessel.mesh, k);
        CHECK(tally.count == ExitTally::most_exits);
    }
}

}  // namespace seldinger::test::test_exits
