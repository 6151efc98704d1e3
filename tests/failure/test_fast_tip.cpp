// F4: a fast wire at dt = 1/60 s must not tunnel.

#include "failure/watched_run.h"

#include "repair/repair.h"
#include "vessel/inside.h"

namespace seldinger::test::test_fast_tip {

namespace {

struct Shot {
    double nearest = 1;    // of the wire's axis to the wall, nodes and shaft, at the end of any step [m]
    double overlap = 0;    // deepest [m]
    bool touched = false;  // or has lost speed in a touch within a step
};

/// @param nose_first  else across the lumen
Shot shoot(NormalLaw law, double speed, bool nose_first)
{
    TestSetup setup = in_tube(0.005, 0.3, 6000);
    TestWire wire = placed_wire(steel_wire(0.1, 21), {0.08, 0, 0});
    wire.wire.place.direction = nose_first ? Vec3(1, 0, 0.02).normalized() : Vec3(1, 0, 0);
    wire.wire.place.velocity = nose_first ? speed * Vec3(0.6, 0, 0.8) : Vec3(0, 0.6 * speed, -0.8 * speed);
    wire.contact.normal = law;
    setup.wires = {wire};
    const LumenQuery lumen(setup.mesh, describe(setup.mesh).loops);
    FedWorld world(std::move(setup));
    Shot shot;
    double mass = 0;
    for (const double m : world.rod(0).mass.first(21)) mass += m;
    const double energy = 0.5 * mass * speed * speed;
    for (int k = 0; k < 40; ++k) {
        const StepReport report = step(world, 1.0 / 60);
        CHECK_FALSE(report.failed());
        CHECK_FALSE((report.flags & StepWallPenetration) != 0);
        const ConstRodView rod = world.rod(0);
        for (int j = 0; j + 1 < rod.n; ++j)
            for (int part = 0; part <= 8; ++part) {
                const LumenPlace place = lumen.locate(rod.pos(j) + part / 8.0 * (rod.pos(j + 1) - rod.pos(j)));
                if (place.opening < 0) shot.nearest = std::min(shot.nearest, place.signed_distance);
            }
        const WireReadings now = world.readings(0);
        CHECK(now.outside == 0);
        shot.touched = shot.touched || now.contacts > 0 || now.kinetic < 0.9 * energy;
        shot.overlap = std::max(shot.overlap, now.overlap);
    }
    return shot;
}

constexpr double speeds[] = {0.1, 1.0, 5.0, 20.0};  // [m/s]

}  // namespace

TEST_SUITE("failure/fast_tip")
{
    TEST_CASE("property: a wire shot at the wall at up to 20 m/s, dt = 1/60 s, is never outside")
    {
        for (const double speed : speeds)
            for (const bool nose_first : {false, true}) {
                CAPTURE(speed);
                CAPTURE(nose_first);
                const Shot shot = shoot(NormalLaw::HuntCrossley, speed, nose_first);
                // samples stay r - 0.95 depth_max = r - 0.475 r off; between two, one radius apart, the chord of a bent edge adds
                // nothing
                CHECK(shot.nearest >= 0.4445e-3 / 2);
                REQUIRE(shot.touched);
            }
    }

    TEST_CASE("property: shot as fast, a barrier does not even overlap")
    {
        for (const double speed : speeds)
            for (const bool nose_first : {false, true}) {
                CAPTURE(speed);
                CAPTURE(nose_first);
                const Shot shot = shoot(NormalLaw::Barrier, speed, nose_first);
                CHECK(shot.overlap == 0);
                // at a node between two samples the wire may bulge: an edge turned by 1 rad, r/4 of it on each side
                CHECK(shot.nearest >= 0.85 * 0.4445e-3);
                REQUIRE(shot.touched);
            }
    }

    TEST_CASE(
        "property: F4: the published method loses a wire at half a metre a second and more in the first step, the default none")
    {
        for (const double speed : {0.5, 5.0, 20.0}) {
            CAPTURE(speed);
            TestSetup setup = in_tube(0.005, 0.3, 6000);
            TestWire wire = placed_wire(steel_wire(0.1, 21), {0.08, 0, 0});
            wire.wire.place.velocity = {0, 0.6 * speed, -0.8 * speed};
            setup.wires = {wire};
            const Outcomes as_published = watch_row("F4", setup, published, 1.0 / 60, 20);
            CHECK(as_published.verdict().first_step[static_cast<int>(Outcome::Escape)] == 1);
            CHECK(as_published.contacts == 0);
            const Outcomes ours = watch_row("F4", setup, standard, 1.0 / 60, 20);
            CHECK(ours.outcome() == Outcome::Hold);
            CHECK(ours.contacts > 0);
        }
    }
}

}  // namespace seldinger::test::test_fast_tip
