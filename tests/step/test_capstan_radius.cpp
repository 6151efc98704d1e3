// Capstan of a thick wire in a tight bend: friction's moment about the axis of bending changes the exponent by r/R.

#include "support/world_fixture.h"

namespace seldinger::test::test_capstan_radius {

namespace {

/// Elastic rod of radius r drawn over a drum, its axis at R; T tension, P = p R, shares rho = r/R and friction mu:
///     T' = mu (1 - rho) P, rho mu P' = T - P over the angle. The moment B/R is constant. The shear is rho mu P from force and
///     shear of the tail at the slack end to a point force Q at the taut one, where the moment jumps by r mu Q.
struct Drum {
    double bend, axis, rho, mu, back, wrap;

    [[nodiscard]] double pull() const
    {
        const double t1 = std::acos(1 - bend / (2 * axis * axis * back));
        const double root = std::sqrt(1 + 4 * mu * mu * rho * (1 - rho)), scale = 2 * rho * mu;
        const double slow = (root - 1) / scale, fast = (-root - 1) / scale;
        // T = A e^(slow phi) + C e^(fast phi)
        const double tension = back * std::cos(t1), slope = (1 - rho) / rho * back * std::sin(t1);
        const double amount = (slope - fast * tension) / (slow - fast), decaying = tension - amount;
        double t2 = t1, force = 0;
        for (int round = 0; round < 100; ++round) {
            const double angle = wrap - t1 - t2, a = amount * std::exp(slow * angle), c = decaying * std::exp(fast * angle);
            const double end = a + c, shear = rho / (1 - rho) * (slow * a + fast * c);
            double low = 0, high = end;
            for (int i = 0; i < 100; ++i) {
                const double point = (low + high) / 2;
                force = std::hypot(end + mu * point, point - shear);
                t2 = std::atan2(point - shear, end + mu * point);
                const double left = bend / axis - rho * axis * mu * point - 2 * std::sqrt(bend * force) * std::sin(t2 / 2);
                (left > 0 ? low : high) = point;
            }
        }
        return force;
    }
};

}  // namespace

TEST_SUITE("step/capstan_radius")
{
    // without the moment the pull is e^(mu wrap rho) = 1.021 times this
    TEST_CASE("analytic: a 0.035 inch wire round R = 10 mm")
    {
        Drum drum{1e-7, 0.01, 0.04445, 0.3, 0.3, 0};
        const double radius = drum.rho * drum.axis;
        TestSetup setup;
        setup.gravity = Vec3::Zero();
        VesselSpec spec{.shape = VesselShape::Arc, .radius = 0.002};
        spec.bend_radius = drum.axis + spec.radius - radius;
        spec.angle = std::numbers::pi / 2;
        spec.lead_in = spec.lead_out = 0.02;
        spec.normal = Vec3::UnitY();
        spec.triangles = 30000;
        add_vessel(setup, make_arc(spec), spec);
        WireSpec wire = steel_wire(0.038, 77);
        wire.shaft.bend_stiffness = wire.shaft.twist_stiffness = drum.bend;
        wire.shaft.mu_static = wire.shaft.mu_sliding = drum.mu;
        wire.place.shape = PlaceShape::Centreline;
        wire.place.from = 0.005;
        TestWire placed;
        placed.wire = wire;
        placed.contact.samples_per_edge = 2;
        placed.holds = {{.position = true, .velocity = {-0.01, 0, 0}}};
        placed.loads = {{.at = {WirePoint::Kind::Tip}, .force = {0, drum.back, 0}, .ramp = 0.05}};
        setup.wires = {placed};
        FedWorld world(std::move(setup));
        Vec3 pull = Vec3::Zero();
        for (int k = 1; k <= 300; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            if (k > 200) pull += world.readings(0).base_force / 100;
        }
        drum.wrap = std::acos(-pull.y() / pull.norm());
        const double of_exponent = std::log(pull.norm() / drum.pull()) / (drum.mu * drum.wrap);
        MESSAGE("pull " << pull.norm() << " N over " << drum.wrap << " rad: " << 100 * of_exponent << " % of the exponent off");
        CHECK(std::abs(of_exponent) <= 0.01);
    }
}

}  // namespace seldinger::test::test_capstan_radius
