// Sticking friction: the cone locks itself whatever the load, and the anchor outlives a change of triangle and of nodes.

#include "contact/one_quadrature_point.h"
#include "contact/wall_law.h"
#include "support/world_fixture.h"

#include <algorithm>
#include <set>

namespace seldinger::test::test_stick {

namespace {

constexpr double radius = 0.4445e-3;

QuadratureModel millimetre_of_steel() { return line_model(steel_wire(1, 2).shaft, {}, VesselSpec{}, INFINITY, 1e-3); }

}  // namespace

TEST_SUITE("contact/stick")
{
    // tan phi = |F_T| / F_N <= mu_static: the load's size has no say
    TEST_CASE("analytic: the cone locks itself: inside mu_static no load makes the wire slip, outside every load does")
    {
        for (double depth = 1e-9; depth < 0.4 * radius; depth *= 4) {
            CAPTURE(depth);
            OneQuadraturePoint s(millimetre_of_steel());
            s.par.inv_dt = 0;
            add_floor(s.soup);
            s.start = v3(0, 0, radius - depth);
            s.accept({0, 0, radius - depth, s.theta0});
            ContactState now[2];
            const double fn = s.at({0, 0, radius - depth, s.theta0}, now).force[2];
            const double to_yield = s.model.mu_static * fn / (s.model.friction_stiffness * s.model.weight);
            for (const double part : {0.0, 0.5, 0.999, 1.001, 2.0}) {
                CAPTURE(part);
                const ContactForce f = s.at({0.6 * part * to_yield, 0.8 * part * to_yield, radius - depth, s.theta0}, now);
                const double ft = std::hypot(f.force[0], f.force[1]);
                CHECK(((now[0].flags & SEL_CONTACT_STUCK) != 0) == (part < 1));
                CHECK(std::abs(ft - std::min(part, 1.0) * s.model.mu_static * fn) <=
                      1e-6 * fn);  // 5e-20 m of rounding in 1e-9 of depth, and margin
            }
        }
    }

    TEST_CASE("property: a stuck sample that crosses from triangle to triangle keeps its anchor")
    {
        OneQuadraturePoint s(millimetre_of_steel());
        s.soup.add_patch(v3(-0.01, -0.01, 0), v3(0.02, 0, 0), v3(0, 0.02, 0), 7);
        const double z = radius - 2e-6, kt = s.model.friction_stiffness * s.model.weight;
        const double fn = 1e-3 * s.model.stiffness * std::pow(2e-6, 1.5);
        const double to_yield = 0.2 * fn / kt;
        // over the diagonal of the middle square, within the elastic slip
        s.start = v3(0, 0, z);
        s.accept({0, 0, z, s.theta0});
        std::set<std::uint32_t> triangles;
        for (int k = 0; k <= 200; ++k) {
            const double u = 0.9 * to_yield * std::sin(0.1 * k);
            ContactState now[2];
            const ContactForce f = s.at({u, -0.3 * u, z, s.theta0}, now);
            REQUIRE((now[0].flags & SEL_CONTACT_STUCK) != 0);
            triangles.insert(now[0].triangle);
            // the spring from where contact began, no matter which triangle is under it; 1e-12 m of rounding in 1e-7
            CHECK(std::abs(f.force[0] + kt * u) <= 1e-5 * kt * to_yield);
            CHECK(std::abs(f.force[1] - 0.3 * kt * u) <= 1e-5 * kt * to_yield);
            s.accept({u, -0.3 * u, z, s.theta0});
        }
        CHECK(triangles.size() >= 2);
    }

    TEST_CASE("property: while a wire is refined and coarsened, what sticks does not move")
    {
        const double angle = std::atan(0.5 * 0.25), dt = 2e-3;
        TestSetup setup;
        setup.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
        setup.start_settled = true;
        add_plane(setup, 0.6, 5000);
        TestWire wire = placed_wire(steel_wire(0.3, 0), {-0.15, 0, radius - 4.6e-7});
        wire.wire.min_edge = 1e-3;
        wire.wire.max_edge = 1e-2;
        LinkSpec lift;  // the tip lifted by millimetres and laid down again, by a spring that hardly pulls sideways
        lift.at.kind = WirePoint::Kind::Tip;
        lift.anchor = {0.15, 0, radius};
        lift.stiffness = 0.5;
        lift.move = {{0.1, 0, 0, 0}, {0.5, 0, 0, 8e-3}, {0.9, 0, 0, 0}};
        wire.links = {lift};
        setup.wires = {wire};
        FedWorld world(std::move(setup));
        REQUIRE_FALSE(settle(world).failed());
        const Vec3 base = world.rod(0).pos(world.rod(0).n - 1);
        int changes = 0, nodes = world.rod(0).n, fewest_stuck = 1 << 20;
        for (int k = 0; k < 600; ++k) {
            REQUIRE_FALSE(step(world, dt).failed());
            changes += world.rod(0).n != nodes;
            nodes = world.rod(0).n;
            int stuck = 0;
            for (const ContactRow& row : world.contacts())
                if (row.stuck && row.point.x() < 0) ++stuck;  // the half away from the tip
            fewest_stuck = std::min(fewest_stuck, stuck);
        }
        MESSAGE(changes << " steps with a change of nodes, base moved by "
                        << 1e9 * (world.rod(0).pos(world.rod(0).n - 1) - base).norm() << " nm");
        REQUIRE(changes > 6);
        CHECK(fewest_stuck > 0.9 * 0.15 / radius);
        // elastic slip under half the cone: 0.125 w / k_t = 80 nm, here and gone again
        CHECK((world.rod(0).pos(world.rod(0).n - 1) - base).norm() <= 1e-6);
    }
}

}  // namespace seldinger::test::test_stick
