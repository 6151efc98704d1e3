// Wires confined by a wall, against solutions computed apart from the engine: elastica shooting with its two exact invariants,
// energy of the buckled rod. Cases: contact forces in a circular bend, force to push and pull a wire round it, buckling in a
// tube.
//
// In a bend N ~ B / (R sqrt(12 c R)). Overlap adds to the clearance c, so the wall is 1,000 times stiffer than an artery (2.5
// um of overlap in 2 mm). Forces are summed over contacts less than 4 mm apart on the same side.

#include "support/world_fixture.h"

#include <algorithm>
#include <numeric>

namespace seldinger::test::test_confined {

namespace {

constexpr double bend_radius = 0.05, stiffness = 5.5e-5, wire_radius = 0.4445e-3;

/// A straight wire laid along the centreline of a bend, base `from` metres from the vessel's start.
TestSetup in_bend(double clearance, double lead_in, double degrees, double length, double from, int nodes)
{
    TestSetup setup;
    setup.gravity = Vec3::Zero();
    setup.integrator.scheme = Scheme::Static;
    VesselSpec spec{.shape = VesselShape::Arc,
                    .radius = clearance + wire_radius,
                    .bend_radius = bend_radius,
                    .angle = degrees * std::numbers::pi / 180,
                    .lead_in = lead_in,
                    .lead_out = 0.002,
                    .normal = Vec3::UnitY(),
                    .triangles = 60000,
                    .youngs = 1e9};
    add_vessel(setup, make_arc(spec), spec);
    WireSpec wire = steel_wire(length, nodes);
    wire.shaft.bend_stiffness = stiffness;
    wire.shaft.twist_stiffness = 4.2e-5;
    wire.place.shape = PlaceShape::Centreline;
    wire.place.from = from;
    setup.wires = {placed_wire(wire, Vec3::Zero())};
    setup.wires[0].wire.place = wire.place;
    ContactSpec& contact = setup.wires[0].contact;
    contact.friction = FrictionLaw::None;
    contact.samples_per_edge = 4;
    return setup;
}

HoldSpec clamped_base()
{
    HoldSpec hold;
    hold.position = hold.direction = hold.spin = true;
    return hold;
}

struct Cluster {
    bool outer = false;       // wall that pushes towards the centre of the bend
    double at = 0;            // mean distance from the tip, weighted with force [m]
    double force = 0;         // [N]
    double from = 0, to = 0;  // [m]
};

/// Contact forces side by side along the wire, from the tip. `centre`: of the bend.
std::vector<Cluster> clusters(const World& world, const Vec3& centre)
{
    std::vector<Cluster> list;
    const ConstRodView rod = world.rod(0);
    for (const ContactRow& row : world.contacts()) {
        const double s = (rod.material_s[row.a.element] + rod.material_s[row.a.element + 1]) / 2;
        const bool outer = row.normal.dot(centre - row.point) > 0;
        if (list.empty() || list.back().outer != outer || s - list.back().to > 0.004) list.push_back({outer, 0, 0, s, s});
        Cluster& last = list.back();
        last.at = (last.at * last.force + s * row.normal_force) / (last.force + row.normal_force);
        last.force += row.normal_force;
        last.to = s;
    }
    return list;
}

std::vector<Cluster> settled_clusters(FedWorld& world, double lead_in)
{
    REQUIRE_FALSE(settle(world).failed());
    return clusters(world, {lead_in, bend_radius, 0});
}

/// A tube along x of `around` facets, each as long as the tube allows for: 10 mm.
WallMesh long_faceted_tube(double radius, double length, int around)
{
    WallMesh mesh;
    const int rings = static_cast<int>(std::lround(length / 0.01)) + 1;
    for (int i = 0; i < rings; ++i)
        for (int k = 0; k < around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around;
            mesh.vertices.emplace_back(length * i / (rings - 1), radius * std::sin(angle), -radius * std::cos(angle));
        }
    for (int i = 0; i + 1 < rings; ++i)
        for (int k = 0; k < around; ++k) {
            const int a = i * around + k, b = i * around + (k + 1) % around, c = a + around, d = b + around;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    return mesh;
}

}  // namespace

TEST_SUITE("contact/confined")
{
    // reference 11, free_arc: c = 2 mm; the wire touches the outer wall with both ends and the inner one between
    TEST_CASE("analytic: forces on a free wire wholly inside a bend")
    {
        struct Case {
            double length, tip, inner;
        };
        for (const Case& at :
             {Case{0.045, 0.0172914, 0.0311883}, Case{0.06, 0.0344192, 0.0567235}, Case{0.07, 0.0361073, 0.0549409}}) {
            CAPTURE(at.length);
            TestSetup setup = in_bend(0.002, 0.002, 180, at.length, 0.05, 121);
            setup.wires[0].contact.samples_per_edge = 8;  // what is left of the base beyond its last quadrature point: 23 um
            FedWorld world(std::move(setup));
            const std::vector<Cluster> found = settled_clusters(world, 0.002);
            REQUIRE(found.size() == 3);
            CHECK(found[0].outer);
            CHECK_FALSE(found[1].outer);
            CHECK(found[2].outer);
            CHECK(found[0].force == about(at.tip).epsilon(0.05));
            CHECK(found[1].force == about(at.inner).epsilon(0.05));
            CHECK(found[2].force == about(at.tip).epsilon(0.05));
        }
    }

    TEST_CASE("analytic: a longer free wire touches the inner wall twice")
    {
        TestSetup setup = in_bend(0.002, 0.002, 300, 0.11, 0.08, 121);
        // turning round the centre costs nothing: a spring holds the middle where the reference has it, 48.09 mm from the centre
        LinkSpec middle;
        middle.at = {WirePoint::Kind::Distance, 0.055};
        const double angle = (0.08 - 0.002 + 0.055) / bend_radius, radius = 0.0480925;
        middle.anchor = {0.002 + radius * std::sin(angle), bend_radius - radius * std::cos(angle), 0};
        middle.stiffness = 1;
        setup.wires[0].links = {middle};
        FedWorld world(std::move(setup));
        const std::vector<Cluster> found = settled_clusters(world, 0.002);
        REQUIRE(found.size() == 4);
        for (const int end : {0, 3}) CHECK(found[end].force == about(0.0358363).epsilon(0.05));
        for (const int inner : {1, 2}) CHECK(found[inner].force == about(0.0173037).epsilon(0.05));
        CHECK(found[1].at == about(0.0330695).epsilon(0.05));
    }

    // reference 11, end_layer: the tip's pair, then line contact with B/(R + c)^3 per metre; push B / (2 (R + c)^2)
    TEST_CASE("analytic: a long wire pushed into a long bend from a straight tube")
    {
        FedWorld world([] {
            TestSetup setup = in_bend(0.002, 0.12, 300, 0.34, 0.02, 341);
            setup.wires[0].holds = {clamped_base()};
            return setup;
        }());
        const std::vector<Cluster> found = settled_clusters(world, 0.12);
        REQUIRE(found.size() >= 3);
        CHECK(found[0].outer);
        CHECK(found[0].force == about(0.0294218).epsilon(0.05));
        CHECK_FALSE(found[1].outer);
        CHECK(found[1].force == about(0.00655613).epsilon(0.05));
        CHECK(found[1].at == about(0.0261635).epsilon(0.05));
        CHECK(found[2].outer);
        CHECK(found[2].from == about(0.1002299).epsilon(0.05));
        CHECK(world.readings(0).base_force.x() == about(0.0101701).epsilon(0.05));
        double line = 0;  // on the wire from 0.11 to 0.15 m from its tip, away from both ends of the line contact
        for (const ContactRow& row : world.contacts()) {
            const double s = world.rod(0).material_s[row.a.element];
            if (s > 0.1095 && s < 0.1495) line += row.normal_force;
        }
        CHECK(line / 0.04 == about(0.391158).epsilon(0.05));
    }

    // reference 11, insertion: clamped on the axis 50 mm before the bend, c = 1.5 mm
    TEST_CASE("analytic: push that a bend needs without friction")
    {
        struct Case {
            double angle, push, normal;
        };
        for (const Case& at : {Case{0.8, 0.0110162, 0.077471}, Case{1.2, 0.0126799, 0.0817338}, Case{1.6, 0.0127893, 0.073037}}) {
            CAPTURE(at.angle);
            TestSetup setup = in_bend(0.0015, 0.051, 150, 0.05 + at.angle * bend_radius, 0.001, 151);
            setup.wires[0].holds = {clamped_base()};
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            CHECK(world.readings(0).base_force.x() == about(at.push).epsilon(0.05));
            CHECK(world.readings(0).normal == about(at.normal).epsilon(0.05));
        }
    }

    // the same with friction mobilised: 5 mm of sliding up to the place of the reference
    TEST_CASE("analytic: push and pull that a bend needs with friction")
    {
        struct Case {
            double sense, force;
        };
        for (const Case& at : {Case{1, 0.0207854}, Case{-1, 0.00370153}}) {
            CAPTURE(at.sense);
            const double travel = 0.005, speed = 0.02;
            TestSetup setup = in_bend(0.0015, 0.062, 150, 0.05 + 1.2 * bend_radius, 0.012 - at.sense * travel, 111);
            setup.integrator.scheme = Scheme::Newton;
            setup.wires[0].holds = {clamped_base()};
            setup.wires[0].holds[0].velocity = {at.sense * speed, 0, 0};
            setup.wires[0].contact.friction = FrictionLaw::StickSlip;
            setup.wires[0].wire.shaft.mu_static = setup.wires[0].wire.shaft.mu_sliding = 0.1;
            FedWorld world(std::move(setup));
            for (int k = 0; k < 250; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
            CHECK(world.readings(0).base_force.x() == about(at.force).epsilon(0.05));
        }
    }

    // Reference 08, tube_buckling_tip: EI = 1e-6, w = 6.3 mN/m, clearance 1.3 mm, pinned at 0.3 m: five half waves at 4.509 mN.
    // The wire is pushed together below that and bent into five half waves by five small side forces. To the angle a/r of a mode
    //   EI k^4 + w/r - F k^2 = (2/L) sum |q| / a,
    // so the stiffness falls linearly with F, and is none at the buckling load. A turn of 8 degrees is many facets of 1.8, yet
    // small.
    TEST_CASE("analytic: sinusoidal buckling of a wire on the floor of a tube of 200 facets")
    {
        constexpr double length = 0.3, clearance = 0.0013, weight = 0.0063, bend = 1e-6, soft = 20;
        constexpr int waves = 5, nodes = 101;
        const double k = waves * std::numbers::pi / length, amplitude = 0.14 * clearance, critical = 0.004509221735779009;
        std::vector<double> forces, stiffnesses;
        for (const double share : {0.2, 0.5, 0.8}) {
            CAPTURE(share);
            TestSetup setup;
            setup.integrator.scheme = Scheme::Static;
            VesselSpec spec = tube(clearance + wire_radius, 0.32);
            setup.vessel = spec;
            setup.mesh = long_faceted_tube(spec.radius, spec.length, 200);
            setup.centreline = make_tube(tube(spec.radius, spec.length, 1000)).centreline;
            WireSpec wire = steel_wire(length, nodes);
            wire.shaft.bend_stiffness = bend;
            wire.shaft.twist_stiffness = bend;
            wire.shaft.stretch_stiffness = soft;
            wire.shaft.density = weight / (9.81 * std::numbers::pi * wire_radius * wire_radius);
            TestWire placed = placed_wire(wire, {0.01, 0, -clearance - 4e-7});
            placed.contact.friction = FrictionLaw::None;
            HoldSpec base, tip;
            base.position = tip.position = true;
            tip.at.kind = WirePoint::Kind::Tip;
            // what the side forces' waves take up, k^2 a^2 / 4 of the length, need not be pushed
            const double pushed = length * (share * critical / soft + k * k * amplitude * amplitude / 4);
            base.move = {{0, 0, 0, 0}, {1, pushed, 0, 0}};
            placed.holds = {base, tip};
            const double wanted = bend * std::pow(k, 4) + weight / clearance - share * critical * k * k;
            for (int i = 0; i < waves; ++i) {
                placed.loads.push_back({.at = {WirePoint::Kind::Distance, (i + 0.5) * length / waves},
                                        .force = {0, (i % 2 ? -1 : 1) * wanted * amplitude * length / (2 * waves), 0}});
            }
            setup.wires = {placed};
            FedWorld world(std::move(setup));
            REQUIRE_FALSE(settle(world).failed());
            const ConstRodView rod = world.rod(0);
            double mode = 0, side = 0;
            for (int i = 0; i < nodes; ++i)
                mode += 2.0 / (nodes - 1) * std::sin(k * rod.material_s[i]) * std::asin(rod.y[i] / clearance) * clearance;
            for (const LoadSpec& load : placed.loads) side += std::abs(load.force.y());
            CHECK(mode > 0.5 * amplitude);
            forces.push_back(world.readings(0).base_force.x());
            stiffnesses.push_back(2 / length * side / mode);
            MESSAGE("pushed with " << forces.back() << " N: " << mode / clearance << " rad, " << stiffnesses.back()
                                   << " N/m^2, theory " << bend * std::pow(k, 4) + weight / clearance - forces.back() * k * k);
        }
        const double slope = (stiffnesses[2] - stiffnesses[0]) / (forces[2] - forces[0]);
        const double found = forces[0] - stiffnesses[0] / slope;
        MESSAGE("buckles at " << found << " N");
        CHECK(slope == about(-k * k).epsilon(0.05));
        CHECK(found == about(critical).epsilon(0.05));
        CHECK(forces[1] - stiffnesses[1] / slope == about(found).epsilon(0.02));  // on one line
    }
}

}  // namespace seldinger::test::test_confined
