// One Newton step per step (D5) at its best: friction is Coulomb's, and nothing shakes a wire in free air.

#include "support/world_fixture.h"

#include <algorithm>

namespace seldinger::test::test_linearised {

namespace {

constexpr double speed = 0.02, length = 0.2, mu = 0.1;  // SI

/// A wire that lies on a plane and is drawn along it by its base, from the first step on at `speed`.
FedWorld dragged(Scheme scheme, FrictionLaw law)
{
    TestSetup setup;
    add_plane(setup, 0.5, 20000);
    WireSpec spec = steel_wire(length, 41);
    spec.shaft.mu_static = 1.2 * mu;
    spec.shaft.mu_sliding = mu;
    // base as deep in the wall as the rest of the wire, so that it carries no more than its share
    TestWire wire = placed_wire(spec, {-length / 2, 0, spec.shaft.radius - 0.4e-6});
    wire.wire.place.velocity = Vec3(-speed, 0, 0);
    wire.holds = {{.position = true, .spin = true, .velocity = Vec3(-speed, 0, 0)}};
    wire.contact.friction = law;
    setup.wires = {wire};
    setup.integrator.scheme = scheme;
    return FedWorld(std::move(setup));
}

}  // namespace

TEST_SUITE("step/linearised")
{
    // The hand draws with mu_sliding times the force on the wall, less what `smooth` leaves out at this speed: v/(v + 1 mm/s).
    // One part in a thousand: the rest of the laying down after 0.2 s, and the stretch of the wire, which slides a little
    // slower.
    TEST_CASE("analytic: a wire dragged along a plane feels its friction, whatever the law and the step")
    {
        for (const FrictionLaw law : {FrictionLaw::StickSlip, FrictionLaw::Smooth, FrictionLaw::Sign})
            for (const double dt : {1e-3, 5e-3, 1.0 / 60}) {
                CAPTURE(static_cast<int>(law));
                CAPTURE(dt);
                FedWorld world = dragged(Scheme::Linearised, law);
                const int steps = static_cast<int>(std::lround(0.4 / dt));
                double least = 1, most = 0, normal = 0;
                for (int k = 1; k <= steps; ++k) {
                    REQUIRE_FALSE(step(world, dt).failed());
                    if (2 * k < steps) continue;
                    const WireReadings now = world.readings(0);
                    least = std::min(least, -now.hand_force);
                    most = std::max(most, -now.hand_force);
                    normal = now.normal;
                }
                const double share = law == FrictionLaw::Smooth ? speed / (speed + 1e-3) : 1.0;
                MESSAGE("drawn with " << least << " to " << most << " N");
                CHECK(normal == about(7900 * std::numbers::pi * 0.4445e-3 * 0.4445e-3 * 9.81 * length).epsilon(0.01));
                CHECK(least == about(share * mu * normal).epsilon(1e-3));
                CHECK(most == about(share * mu * normal).epsilon(1e-3));
            }
    }

    // The tip is 50 times as soft as the shaft, and the base edge is split just behind the boundary. The push of the fed
    // length, EA v h/l = 67 N in an edge of 3 mm, once made the tangent too soft by a factor of 2.6. The wire then shook itself
    // up to a kilonewton. Allowed: the linear equations leave out how far the tangent turns within the step, of the order of EA
    // phi^3/2 per edge, phi = h v/(10 l) at the most: 1.5 mN.
    TEST_CASE("property: fed through free air across a jump of stiffness, the hand feels what converged steps say")
    {
        const auto make = [](Scheme scheme) {
            TestSetup setup;
            WireSpec spec = steel_wire(0.6, 101);
            spec.shaft.bend_stiffness = 5e-4;
            spec.shaft.twist_stiffness = 3.8e-4;
            WireSectionRange tip{0, 0.03, spec.shaft};
            tip.section.bend_stiffness = 1e-5;
            tip.section.twist_stiffness = 8e-6;
            spec.sections = {tip};
            setup.wires = {fed_wire(spec, Vec3::Zero(), speed)};
            setup.integrator.scheme = scheme;
            return FedWorld(std::move(setup));
        };
        FedWorld one = make(Scheme::Linearised), converged = make(Scheme::Newton);
        double apart = 0, tip = 0;
        for (int k = 0; k < 3000; ++k) {
            REQUIRE_FALSE(step(one, 1e-3).failed());
            REQUIRE_FALSE(step(converged, 1e-3).failed());
            apart = std::max(apart, std::abs(one.readings(0).hand_force - converged.readings(0).hand_force));
            tip = std::max(tip, (one.rod(0).pos(0) - converged.rod(0).pos(0)).norm());
        }
        MESSAGE("hand force up to " << apart << " N apart, tip " << tip << " m");
        CHECK(apart <= 1.5e-3);
    }
}

}  // namespace seldinger::test::test_linearised
