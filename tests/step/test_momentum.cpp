// engine/physics/newton/momentum.h: what a wire's readings say of its forces adds up to the change of its momentum, step by step.

#include "failure/hard_vessels.h"
#include "support/world_fixture.h"

#include <algorithm>
#include <limits>

namespace seldinger::test::test_momentum {

namespace {

// Momentum by the test's own sum, so that the engine's rate of change is not believed but checked.
Vec3 momentum_of(const World& world)
{
    const ConstRodView rod = world.rod(0);
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i] * rod.vel(i);
    return sum;
}

// Free nodes keep a residual of at most force_residual per axis; positions are rounded to half an ulp of their distance from the
// origin, which the stiffest edge turns into force on both its nodes.
double allowed_error(const World& world)
{
    const ConstRodView rod = world.rod(0);
    double stiffest = 0, reach = 0;
    for (int j = 0; j + 1 < rod.n; ++j) stiffest = std::max(stiffest, rod.stretch_stiffness[j] / rod.rest_length[j]);
    for (int i = 0; i < rod.n; ++i) reach = std::max(reach, rod.pos(i).norm());
    const double rounding = 8 * std::numeric_limits<double>::epsilon() * stiffest * reach;
    return std::sqrt(3.0) * (rod.n + 1) * (world.readings(0).force_residual + rounding);
}

Vec3 normal_of(const WallMesh& mesh, std::size_t triangle)
{
    const auto& t = mesh.triangles[triangle];
    return (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).normalized();
}

// Of each triangle, the least cosine of an angle between its normal and that of one with a vertex in common.
std::vector<double> least_cosines(const WallMesh& mesh)
{
    std::vector<std::vector<std::size_t>> beside(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const auto vertex : mesh.triangles[t]) beside[vertex].push_back(t);
    std::vector<double> least(mesh.triangles.size(), 1.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const auto vertex : mesh.triangles[t])
            for (const std::size_t other : beside[vertex])
                least[t] = std::min(least[t], normal_of(mesh, t).dot(normal_of(mesh, other)));
    return least;
}

struct Closed {
    int checked = 0, halved = 0, touching = 0;
    double worst = 0;    // error over what is allowed
    double largest = 0;  // of the balance's terms [N]
    // worst difference of the contact list's sum from the balance's contact force, beyond what creases explain [N]
    double listed = 0;
    double change = 0;  // worst difference between the balance's rate and the test's own, backward Euler [N]
};

Closed run_closed(TestSetup setup, int steps, double dt = 1e-3)
{
    const bool newmark = setup.integrator.newmark;
    FedWorld world(std::move(setup));
    const std::vector<double> cosines = least_cosines(world.setup().mesh);
    Closed closed;
    for (int k = 0; k < steps; ++k) {
        const Vec3 before = momentum_of(world);
        const double allowed_before = allowed_error(world);  // a base edge that was short has gone by the end of the step
        const bool was_inside = !data_of(world).feed(0).on || data_of(world).feed(0).inside;
        const StepReport report = step(world, dt);
        REQUIRE_FALSE(report.failed());
        const WireReadings now = world.readings(0);
        const MomentumBalance& b = now.momentum;
        // A row has the sum of the forces of all facets of a crease, in the direction of their resultant. All of them are within
        // the angle a of the nearest facet's normal, so the resultant is at least cos a of the sum.
        Vec3 listed = Vec3::Zero();
        double creases = 0;
        for (const ContactRow& row : world.contacts()) {
            listed += row.normal_force * row.normal + row.friction;
            creases += row.normal_force * (1 - cosines[static_cast<std::size_t>(row.b.element)]);
        }
        closed.listed = std::max(closed.listed, (listed - b.contact).norm() - creases);
        closed.worst = std::max(closed.worst, b.error().norm() / std::max(allowed_before, allowed_error(world)));
        for (const Vec3& term : {b.held, b.weight, b.contact, b.loads, b.fed, b.rate})
            closed.largest = std::max(closed.largest, term.norm());
        closed.touching += now.contacts > 0;
        closed.halved += report.sub_steps > 1;
        if (!newmark && was_inside && report.sub_steps == 1)
            closed.change = std::max(closed.change, ((momentum_of(world) - before) / dt - b.rate).norm());
        ++closed.checked;
    }
    MESSAGE(closed.checked << " steps, " << closed.touching << " in contact, " << closed.halved << " halved: error at most "
                           << closed.worst << " of what the residual allows, terms up to " << closed.largest << " N");
    return closed;
}

void check_closed(const Closed& closed)
{
    CHECK(closed.worst <= 1);
    CHECK(closed.listed <= 1e-12 * (1 + closed.largest));  // the same numbers, summed in another order
    CHECK(closed.change <= 1e-11 * (1 + closed.largest));  // masses of 1e-4 kg times velocities, over 1 ms
}

TestSetup fed_in_bend(const WireSpec& spec)
{
    TestSetup setup = in_bend(0.003, 0.03);
    setup.wires = {fed_wire(spec, {0.0005, 0, -0.0024}, 0.1, 3.0)};
    setup.wires[0].contact.rolling = true;
    return setup;
}

HoldSpec hold_at(WirePoint::Kind kind, double from_tip = 0) { return {.at = {kind, from_tip}, .position = true}; }

// Base clamped and moved, middle held, tip tied to a moving spring; a force, a moment; on a floor; damped.
TestSetup held_on_floor()
{
    TestSetup setup;
    add_plane(setup, 0.4, 2000);
    setup.gravity = {0.5, -1, -9.6};
    setup.integrator.damping_mass = 2;
    setup.integrator.damping_stiffness = 1e-4;
    TestWire wire = placed_wire(steel_wire(0.1, 21), {-0.05, 0, 0.0005});
    HoldSpec base = hold_at(WirePoint::Kind::Base);
    base.direction = base.spin = true;
    base.velocity = {0.02, 0.01, 0};
    base.turn = {{0, 0}, {0.2, 1.0}};
    wire.holds = {base, hold_at(WirePoint::Kind::Distance, 0.07)};
    LoadSpec load{
        .at = {WirePoint::Kind::Distance, 0.033}, .force = {1e-3, 2e-3, -1e-3}, .moment = {1e-5, 2e-5, -3e-5}, .ramp = 0.05};
    wire.loads = {load};
    LinkSpec link{
        .at = {WirePoint::Kind::Tip, 0}, .anchor = {0.05, 0, 0.001}, .stiffness = 5, .move = {{0, 0, 0, 0}, {0.2, 0, 0.01, 0}}};
    wire.links = {link};
    setup.wires = {wire};
    return setup;
}

}  // namespace

TEST_SUITE("step/momentum")
{
    TEST_CASE("property: the balance closes for a wire that is fed and turned into a bend, nodes coming and going")
    {
        for (const int nodes : {25, 0}) {
            CAPTURE(nodes);
            const Closed closed = run_closed(fed_in_bend(steel_wire(0.12, nodes)), 700);
            check_closed(closed);
            CHECK(closed.touching > 300);
        }
    }

    // The wall takes over what contact exerts through every birth and merge of nodes, as force and as work. The solver leaves
    // 1e-6 B/L^2 on a node and that times an edge as a moment, which work over the moves and turns of a step, and a millionth of
    // the largest force on the wall, over the overlaps.
    TEST_CASE("property: beside an elastic wall it closes too, and so do the energies of wire and wall, nodes coming and going")
    {
        constexpr double dt = 1e-3;
        TestSetup setup = fed_in_bend(steel_wire(0.12, 0));
        const double bend = setup.wires[0].wire.shaft.bend_stiffness;
        make_elastic(setup, 1e6);
        setup.wires[0].feed.keys = {{0, 0, 0}, {0.6, 0.06, 0}, {1.1, 0.01, 0}};
        FedWorld world(std::move(setup));
        int born = 0, merged = 0, touching = 0;
        double worst = 0, wall_allowed = 0, allowed = 0, wall_open = 0, open = 0;
        Output now;
        for (int k = 0; k < 1000; ++k) {
            const double allowed_before = allowed_error(world);
            const int nodes = world.rod(0).n;
            REQUIRE_FALSE(step(world, dt).failed());
            const WireReadings wire = world.readings(0);
            born += world.rod(0).n > nodes;
            merged += world.rod(0).n < nodes;
            touching += wire.contacts > 0;
            worst = std::max(worst, wire.momentum.error().norm() / std::max(allowed_before, allowed_error(world)));
            world.read(now, Output::Wall);
            const WallReadings& wall = now.walls.front().readings;
            wall_allowed += 1e-6 * wire.normal * wire.contacts * wire.overlap;
            const ConstRodView rod = world.rod(0);
            const double inside = rod.material_s[rod.n - 1],
                         force = std::max(wire.force_residual, 1e-6 * bend / (inside * inside));
            for (int i = 0; i < rod.n; ++i) allowed += force * std::sqrt(3.0) * rod.vel(i).norm() * dt;
            for (int j = 0; j + 1 < rod.n; ++j) allowed += force * inside / (rod.n - 1) * std::abs(rod.spin_rate[j]) * dt;
            wall_open = std::max(wall_open, std::abs(wire.energy.wall - wall.energy - wall.loss) / (wall_allowed + 1e-18));
            open = std::max(open, std::abs(wire.energy.open()) / (allowed + wall_allowed + 1e-18));
            CHECK(wall.loss >= 0);
        }
        CHECK(born > 10);
        CHECK(merged > 10);
        CHECK(touching > 500);
        CHECK(worst <= 1);
        CHECK(wall_open <= 1);
        CHECK(open <= 1);
    }

    TEST_CASE("property: it closes for a wire that is pulled back out")
    {
        TestSetup setup = fed_in_bend(steel_wire(0.12, 25));
        setup.wires[0].feed.keys = {{0, 0, 0}, {0.4, 0.06, 0}, {0.8, 0.01, 0}};
        check_closed(run_closed(std::move(setup), 800));
    }

    TEST_CASE("property: it closes with holds, loads, links, damping and a floor, whatever the time stepping")
    {
        enum class Stepping { BackwardEuler, Trapezoid, EnergyMomentum };
        for (const Stepping stepping : {Stepping::BackwardEuler, Stepping::Trapezoid, Stepping::EnergyMomentum}) {
            CAPTURE(static_cast<int>(stepping));
            TestSetup setup = held_on_floor();
            setup.integrator.newmark = stepping == Stepping::Trapezoid;
            setup.integrator.conserve = stepping == Stepping::EnergyMomentum;
            const Closed closed = run_closed(std::move(setup), 200);
            check_closed(closed);
            CHECK(closed.touching > 100);
        }
    }

    TEST_CASE("property: it closes through the impact of a free wire, steps halved")
    {
        TestSetup setup = in_tube(0.005, 0.3, 6000);
        setup.wires = {placed_wire(steel_wire(0.1, 21), {0.08, 0, 0})};
        setup.wires[0].wire.place.velocity = {0, 0.6, -0.8};
        const Closed closed = run_closed(std::move(setup), 30, 1.0 / 60);
        check_closed(closed);
        CHECK(closed.halved > 0);
    }

    TEST_CASE("property: it closes at rest, where nothing moves")
    {
        TestSetup setup = held_on_floor();
        setup.integrator.scheme = Scheme::Static;
        setup.wires[0].holds[0].velocity.setZero();
        FedWorld world(std::move(setup));
        REQUIRE_FALSE(settle(world).failed());
        const WireReadings now = world.readings(0);
        CHECK(now.momentum.rate.isZero());
        const double mass = 7900 * std::numbers::pi * 0.4445e-3 * 0.4445e-3 * 0.1;
        CHECK((now.momentum.weight - mass * Vec3(0.5, -1, -9.6)).norm() <= 1e-12);
        CHECK(now.contacts > 0);
        CHECK(now.momentum.error().norm() <= allowed_error(world));
    }

    // Fed material brings its own momentum, so a straight wire gliding into nothing pulls and pushes at nothing, whenever a
    // node comes.
    TEST_CASE("analytic: a steady feed brings rho A v^2, and the hand needs no force for it")
    {
        const double speed = 1;
        for (const int nodes : {41, 0}) {
            CAPTURE(nodes);
            TestSetup setup;
            setup.gravity = Vec3::Zero();
            setup.wires = {fed_wire(steel_wire(0.2, nodes), Vec3::Zero(), speed)};
            FedWorld world(std::move(setup));
            const double flow = 7900 * std::numbers::pi * 0.4445e-3 * 0.4445e-3 * speed * speed;
            double held = 0, fed = 0, hand = 0;
            int inside = 0;
            for (int k = 0; k < 1500; ++k) {
                REQUIRE_FALSE(step(world, 1e-4).failed());
                // the step that leaves the guide starts with the rigid piece of half an edge, whatever of it was inside
                if (!data_of(world).feed(0).inside || ++inside == 1) continue;
                const WireReadings now = world.readings(0);
                held = std::max(held, now.momentum.held.norm());
                hand = std::max(hand, std::abs(now.hand_force));
                fed = std::max(fed, (now.momentum.fed - Vec3(flow, 0, 0)).norm());
            }
            REQUIRE(inside > 1000);
            CHECK(fed <= 1e-6 * flow);
            // the solver's tolerance is 1e-6 of B/L^2 with the length that is inside: 1.6 uN for the first 2.5 mm
            CHECK(held <= 1e-5);
            CHECK(hand <= 1e-5);
        }
    }
}

}  // namespace seldinger::test::test_momentum
