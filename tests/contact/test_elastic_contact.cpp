// A wire and an elastic wall, solved together: known solutions, limits, conservation, bits.

#include "core/parallel.h"
#include "coupling/elastic_contact.h"
#include "shell/elastic_wall.h"
#include "stages/step_stages.h"
#include "support/approx.h"
#include "support/fed_world.h"
#include "support/world_fixture.h"
#include "world/world.h"

#include <cmath>
#include <numbers>

namespace seldinger::test::test_elastic_contact {

namespace {

constexpr double radius = 4.445e-4, plate_side = 0.08;

/// A wire along x on a plate in z = 0, of weight `per_length` [N/m].
TestSetup wire_on_plate(double per_length, double bend, double wall_edge, int triangles)
{
    TestSetup setup;
    setup.integrator.scheme = Scheme::Static;
    setup.vessel.shape = VesselShape::Plane;
    setup.vessel.size = plate_side;
    setup.vessel.triangles = triangles;
    setup.vessel.thickness = 0.0015;
    setup.vessel.elastic = true;
    setup.vessel.wall_edge = wall_edge;
    TestWire wire;
    wire.wire.length = plate_side;
    wire.wire.shaft.radius = radius;
    wire.wire.shaft.density = per_length / (9.81 * std::numbers::pi * radius * radius);
    wire.wire.shaft.bend_stiffness = wire.wire.shaft.twist_stiffness = bend;
    wire.wire.shaft.stretch_stiffness = 1e4;
    wire.wire.nodes = 81;
    wire.wire.place.shape = PlaceShape::Straight;
    wire.wire.place.base = Vec3(plate_side / 2, 0, radius);
    wire.wire.place.direction = Vec3(-1, 0, 0);
    wire.contact.detection = Detection::Swept;
    wire.contact.friction = FrictionLaw::None;
    setup.wires.push_back(wire);
    WorldSetup made = setup;
    load_vessel(made);
    setup.mesh = made.mesh;
    return setup;
}

/// Height of the wire's middle at rest.
double settled_middle(const TestSetup& setup)
{
    World world{WorldSetup(setup)};
    REQUIRE(!settle(world).failed());
    const ConstRodView rod = world.rod(0);
    return rod.z[rod.n / 2];
}

double rigid_middle(TestSetup setup)
{
    setup.vessel.elastic = false;
    return settled_middle(setup);
}

/// A wire held at its base that is lowered onto the plate with its tip first, at 20 mm/s.
TestSetup lowered_wire()
{
    TestSetup setup = wire_on_plate(0.05, 5e-4, 0.005, 800);
    setup.integrator = {};
    setup.vessel.youngs = 0.2e6;
    TestWire& wire = setup.wires[0];
    wire.wire.length = 0.03;
    wire.wire.nodes = 16;
    wire.wire.place.direction = Vec3(0, std::cos(0.3), -std::sin(0.3));
    wire.wire.place.base = Vec3(0.002, -0.01, radius + 1e-4 + 0.03 * std::sin(0.3));
    wire.contact.friction = FrictionLaw::StickSlip;
    HoldSpec hold{
        .at = {WirePoint::Kind::Base}, .position = true, .direction = true, .spin = true, .velocity = Vec3(0, 0, -0.02)};
    wire.holds.push_back(hold);
    return setup;
}

}  // namespace

// Hetenyi: w0 = q / (8 D beta^3), beta^4 = k_s / 4 D. The tolerance is that of the control mesh (edges of 1/3 and 2/3 of the
// decay length of 6.1 mm). A floppy wire (its own decay length on this bed is 4 mm) keeps the load even.
TEST_CASE("a line load sinks into a plate as Hetenyi has it, whatever the two meshes")
{
    const double q = 1.0, d = 1e6 * std::pow(0.0015, 3) / (12 * (1 - 0.45 * 0.45)), beta = std::pow(1e6 / (4 * d), 0.25);
    const double expected = q / (8 * d * std::pow(beta, 3));
    for (const double edge : {0.002, 0.004})
        for (const int triangles : {800, 6000}) {
            CAPTURE(edge);
            CAPTURE(triangles);
            const TestSetup setup = wire_on_plate(q, 2e-6, edge, triangles);
            CHECK(rigid_middle(setup) - settled_middle(setup) == about(expected).epsilon(0.02));
        }
}

// What a stiff shell gives way falls as 1/E (its supports hold it at the rims); the wire's height differs from the rigid run's by
// that.
TEST_CASE("a wall that gets stiffer tends to the rigid one, with the order of its compliance")
{
    TestSetup setup = wire_on_plate(0.2, 2e-5, 0.005, 800);
    setup.vessel.support = 1e3;  // a thousandth of what the stiffest plate but one takes to bend over its whole side
    double last = 0;
    for (const double factor : {1e2, 1e3, 1e4}) {
        setup.vessel.youngs = factor * 1e6;
        // the law through the thickness is of the wall's E too: the rigid run has the same one
        const double off = rigid_middle(setup) - settled_middle(setup);
        if (last > 0) CHECK(last / off == about(10).epsilon(0.1));
        last = off;
    }
    CHECK(last > 0);
}

TEST_CASE("a wire that touches nothing moves as it does beside a rigid wall, to the last bit")
{
    TestSetup setup = lowered_wire();
    setup.wires[0].wire.place.base.z() = 0.02;
    setup.wires[0].holds[0].velocity = Vec3(0.01, 0, 0);
    World elastic{WorldSetup(setup)};
    setup.vessel.elastic = false;
    World rigid{WorldSetup(setup)};
    for (int k = 0; k < 50; ++k) {
        REQUIRE(!step(elastic, 1e-3).failed());
        REQUIRE(!step(rigid, 1e-3).failed());
    }
    for (int i = 0; i < rigid.rod(0).n; ++i) CHECK(elastic.rod(0).pos(i) == rigid.rod(0).pos(i));
}

TEST_CASE("the same bits from a saved state, on one thread and on two, alone and beside others")
{
    const TestSetup setup = lowered_wire();
    World whole{WorldSetup(setup)};
    std::vector<std::uint8_t> saved;
    for (int k = 0; k < 60; ++k) {
        if (k == 30) saved = whole.save_state();
        REQUIRE(!step(whole, 1e-3).failed());
    }
    REQUIRE(whole.wall_readings().move_max > 3e-4);  // a fifth of the thickness: its displacements are large
    World resumed{WorldSetup(setup)};
    resumed.restore_state(saved);
    for (int k = 30; k < 60; ++k) REQUIRE(!step(resumed, 1e-3).failed());
    CHECK(resumed.state_hash() == whole.state_hash());

    TestSetup three = setup;
    three.wires.push_back(setup.wires[0]);
    three.wires.back().holds[0].velocity = Vec3(0.01, 0, -0.015);
    three.wires.push_back(setup.wires[0]);
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        World world{WorldSetup(three)};
        for (int k = 0; k < 60; ++k) REQUIRE(!step(world, 1e-3).failed());
        CHECK(world.state_hash(0) == whole.state_hash(0));
        CHECK(world.state_hash(2) == whole.state_hash(0));
        CHECK(world.state_hash(1) != whole.state_hash(0));
    }
    set_thread_count(0);
}

// A live session reads contacts after every step, its replay now and then: the state may not know of it.
TEST_CASE("what is read leaves no trace in the state")
{
    World world{WorldSetup(lowered_wire())};
    for (int k = 0; k < 60; ++k) REQUIRE(!step(world, 1e-3).failed());
    REQUIRE(world.wall_readings().move_max > 1e-5);
    const std::vector<std::uint8_t> state = world.save_state();
    REQUIRE(!world.output(Output::Everything).contacts.empty());
    CHECK(world.save_state() == state);
}

// Line load q on a plate on its bed [Hetenyi46, sec. 30]: M = q lambda/4 across the wire, nu M along it. Elements see the corner
// of M rounded off over their size; what that takes is added (wall/wall_resolution.h). The end effect of the plate, of e^-6, is
// left out.
TEST_CASE("analytic: the largest stress under a line load is that of a plate on its bed, on edges of 0.25 to 0.9 decay lengths")
{
    constexpr double q = 0.5, t = 0.0015, nu = 0.45;
    const double d = 1e6 * t * t * t / (12 * (1 - nu * nu)), decay = std::pow(4 * d / 1e6, 0.25);
    const double exact = std::sqrt(1 - nu + nu * nu) * 6 / (t * t) * q * decay / 4;
    for (const double share : {0.25, 0.5, 0.9}) {
        CAPTURE(share);
        World world{WorldSetup(wire_on_plate(q, 2e-6, share * decay, 3000))};
        REQUIRE(!settle(world).failed());
        const WallReadings now = world.wall_readings();
        CHECK(now.stress_max == about(exact).epsilon(0.04));
        CHECK(std::abs(now.stress_max - exact) < now.stress_band.sum());
        const WallReadings bare =
            read_wall(ElasticWall(*data_of(world).forces.wall), data_of(world).forces.wall_contact->displacement(0), 0);
        if (share > 0.3) CHECK(bare.stress_max < 0.93 * exact);
    }
}

// A point load on a plate on its bed, the thick plate's stress at its surface by the equivalent radius 0.325 t [Westergaard 1926;
// Timoshenko & Woinowsky-Krieger, sec. 57]: 6/t^2 F (1 + nu)/(4 pi) (1/2 - 0.5772 + ln(2 l/(0.325 t))), l^4 = D/k_s. The tip is
// all that touches.
TEST_CASE("analytic: the largest stress under a wire's tip is that of a point load on a thick plate, whatever the nodes")
{
    constexpr double t = 0.0015, nu = 0.45, youngs = 0.2e6;
    const double d = youngs * t * t * t / (12 * (1 - nu * nu)), length = std::pow(d / 1e6, 0.25);
    const double per_load = 6 / (t * t) * (1 + nu) / (4 * std::numbers::pi) * (0.5 - 0.5772 + std::log(2 * length / (0.325 * t)));
    for (const int nodes : {16, 61, 241}) {
        CAPTURE(nodes);
        TestSetup setup = lowered_wire();
        setup.integrator.scheme = Scheme::Static;
        setup.vessel.wall_edge = 0.002;
        TestWire& wire = setup.wires[0];
        wire.wire.nodes = nodes;
        wire.holds[0].velocity = Vec3::Zero();
        wire.loads.push_back({.at = {WirePoint::Kind::Tip}, .force = Vec3(0, 0, -0.01)});
        World world{WorldSetup(setup)};
        REQUIRE(!settle(world).failed());
        const WallReadings now = world.wall_readings();
        const double exact = per_load * world.readings(0).normal;
        REQUIRE(exact > 0);
        CHECK(now.stress_max == about(exact).epsilon(0.1));
        CHECK(std::abs(now.stress_max - exact) < now.stress_band.sum());
    }
}

// Whatever the recorder reads in between rows is under the wires: it must not miss what is largest there.
TEST_CASE("the readings under the wires are the largest of the wall")
{
    World world{WorldSetup(lowered_wire())};
    Output now;
    int compared = 0;
    for (int k = 0; k < 60; ++k) {
        REQUIRE(!step(world, 1e-3).failed());
        world.read(now, Output::WallUnder);
        const WallReadings under = now.walls[0].readings, all = world.wall_readings();
        if (all.move_max < 1e-5) continue;
        ++compared;
        CHECK(under.move_max <= all.move_max * (1 + 1e-9));
        CHECK(under.move_max > 0.95 * all.move_max);
        CHECK(under.stress_max == all.stress_max);
        CHECK(under.energy == 0);
    }
    CHECK(compared > 10);
}

// Under the load the surface is read where the load is, all of it at control vertices, which are 5 mm apart in a dent of 6.
TEST_CASE("property: the scene's load moves the wall from the first step on, with and without a wire in the vessel, and is read")
{
    TestSetup placed = lowered_wire();
    placed.vessel.loads = {{0, Vec3(0.01, 0.01, 0), Vec3(0, 0, -0.02)}};
    placed.wires[0].wire.place.base.z() = 0.02;
    placed.wires[0].holds[0].velocity = Vec3::Zero();
    TestSetup fed = placed;
    fed.wires[0].holds.clear();
    fed.wires[0].feed.on = true;  // and none of it is inside
    fed.wires[0].feed.point = Vec3(0, 0, 0.02);
    World beside{WorldSetup(placed)}, alone{WorldSetup(fed)};
    Output now;
    for (int k = 0; k < 40; ++k) {
        REQUIRE(!step(beside, 1e-3).failed());
        REQUIRE(!step(alone, 1e-3).failed());
        const WallReadings all = beside.wall_readings();
        CHECK(all.move_max > 0);
        CHECK(alone.wall_readings().move_max == all.move_max);
        for (World* world : {&beside, &alone}) {
            world->read(now, Output::WallUnder);
            CHECK(now.walls[0].readings.move_max == about(all.move_max).epsilon(0.2));
        }
    }
}

// Two wires of one system side by side, nearer than the plate's decay length: each lies in the dent of the other. In the middle
// both sink by w(0) + w(3 mm) of the line load, w(y) = w0 exp(-b y) (cos b y + sin b y).
TEST_CASE("wires of one system push the same wall")
{
    TestSetup setup = wire_on_plate(0.5, 2e-6, 0.003, 800);
    const double alone = rigid_middle(setup) - settled_middle(setup), apart = 0.003;
    TestWire second = setup.wires[0];
    second.wire.place.base.y() = apart;
    setup.wires.push_back(second);
    setup.systems = {2};
    const double together = rigid_middle(setup) - settled_middle(setup);
    const double d = 1e6 * std::pow(0.0015, 3) / (12 * (1 - 0.45 * 0.45)), beta = std::pow(1e6 / (4 * d), 0.25);
    const double share = std::exp(-beta * apart) * (std::cos(beta * apart) + std::sin(beta * apart));
    CHECK(together / alone == about(1 + share).epsilon(0.02));
}

// What the wall has been given by contact is stored in it or lost to its damping; damping never gives.
TEST_CASE("the wall stores or loses what contact gives it, and gives none of its own")
{
    World world{WorldSetup(lowered_wire())};
    double loss = 0;
    for (int k = 0; k < 80; ++k) {
        REQUIRE(!step(world, 1e-3).failed());
        const WallReadings now = world.wall_readings();
        CHECK(now.energy >= 0);
        CHECK(now.loss >= loss - 1e-12);
        loss = now.loss;
    }
    CHECK(world.wall_readings().energy > 0);
    CHECK(loss > 0);
    CHECK(world.readings(0).energy_made < 1e-7);
}

TEST_CASE("every detection and every law presses on an elastic wall")
{
    // (`layer` misses a tip that comes down on a plane, whatever the wall is)
    for (const Detection detection : {Detection::Swept, Detection::Nodes})
        for (const NormalLaw law : {NormalLaw::HuntCrossley, NormalLaw::LankaraniNikravesh, NormalLaw::Augmented,
                                    NormalLaw::Constraint, NormalLaw::Impulse, NormalLaw::Barrier}) {
            if (detection == Detection::Nodes && law != NormalLaw::HuntCrossley) continue;
            if (law == NormalLaw::Barrier && detection != Detection::Swept) continue;
            CAPTURE(static_cast<int>(detection));
            CAPTURE(static_cast<int>(law));
            TestSetup setup = lowered_wire();
            setup.wires[0].contact.detection = detection;
            setup.wires[0].contact.normal = law;
            if (law == NormalLaw::Barrier) setup.wires[0].wire.place.base.z() += 5e-4;
            World world{WorldSetup(setup)};
            for (int k = 0; k < 60; ++k) REQUIRE(!step(world, 1e-3).failed());
            CHECK(world.readings(0).contacts > 0);
            CHECK(world.wall_readings().move_max > 1e-5);
            // momentum of the wire closes with the forces that it is said to feel
            CHECK(world.readings(0).momentum.error().norm() < 1e-6);
        }
}

namespace {

/// Slope of the wall's height where it has moved to, by the plane through the vertices within `reach` of a place.
Vec3 slope_near(const World& world, const Vec3& place, double reach)
{
    const Output now = world.output(Output::WallShape);
    Mat3 normal = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (std::size_t i = 0; i < now.walls[0].displacement.size(); ++i) {
        const Vec3 from = world.setup().mesh.vertices[i] - place;
        if (from.norm() > reach) continue;
        const Vec3 row(from.x(), from.y(), 1);
        normal += outer(row, row);
        right += now.walls[0].displacement[i].z() * row;
    }
    return normal.inverse() * right;
}

}  // namespace

// A weight presses a dent beside a wire that lies across its side on both ends, without friction. What the wire feels is normal
// to the wall where that has gone: f_x/f_z = -dz/dx (D11a); with the unmoved wall's normal it would be 0. Second order of the
// slope is 0.1 % here. The plane through the wall within 2 mm of a dent that decays over 6 mm misses (2/6)^2/8 = 1.4 % of its
// slope. The wire's own furrow, 0.4 mm wide, misses as much again of its slope: 15 % is four times both.
TEST_CASE("a wire on the side of a dent is pushed along the normal of the moved wall")
{
    TestSetup setup = wire_on_plate(0.5, 5e-4, 0.003, 12000);
    TestWire& wire = setup.wires[0];
    wire.wire.length = 0.02;
    wire.wire.nodes = 21;
    wire.wire.place.direction = Vec3(0, 1, 0);
    wire.wire.place.base = Vec3(0.006, -0.01, radius);
    HoldSpec hold{.at = {WirePoint::Kind::Base}, .position = true, .direction = true, .spin = true};
    hold.move = {{0.0, 0.0, 0.0, 0.0}, {0.1, 0.0, 0.0, -2.5e-4}};  // follows the dent
    wire.holds.push_back(hold);
    setup.integrator = {};
    setup.integrator.damping_mass = 100;
    setup.vessel.loads.push_back({0, Vec3::Zero(), Vec3(0, 0, -0.1)});
    World world{WorldSetup(setup)};
    for (int k = 0; k < 100; ++k) REQUIRE(!step(world, 4e-3).failed());
    const std::vector<Vec3> forces = world.nodal_contact_force(0);
    int pushed = 0;
    for (int i = 0; i < world.rod(0).n; ++i) {
        const Vec3 x = world.rod(0).pos(i), force = forces[static_cast<std::size_t>(i)];
        if (force.z() < 2e-3) continue;
        CAPTURE(i);
        ++pushed;
        const Vec3 slope = slope_near(world, Vec3(x.x(), x.y(), 0), 0.002);
        CHECK(slope.x() > 0.01);
        for (int c = 0; c < 2; ++c) CHECK(std::abs(force[c] / force.z() + slope[c]) < 0.15 * std::hypot(slope.x(), slope.y()));
    }
    CHECK(pushed >= 3);
}

namespace {

/// Two wires in a tube that is pressed together from outside by more than it bears at rest; the second one is in the introducer.
TestSetup in_a_tube_that_buckles(double relaxation)
{
    TestSetup setup;
    VesselSpec vessel = tube(0.008, 0.1, 2000);
    vessel.elastic = true;
    vessel.youngs = 0.4e6;
    vessel.thickness = 8e-4;
    vessel.pressure = -2000;
    vessel.support = vessel.support_damping = 0;
    vessel.relaxation = relaxation;
    add_tube(setup, vessel);
    setup.wires = {fed_wire(steel_wire(0.1, 21), Vec3::Zero(), 0.1), fed_wire(steel_wire(0.1, 21), Vec3::Zero(), 1e-4)};
    return setup;
}

}  // namespace

TEST_CASE("property: a wall that buckles in every step ends its own system, as it was before the step; the other one goes on")
{
    FedWorld world(in_a_tube_that_buckles(0));
    int k = 0;
    Vec3 tip;
    StepReport report;
    for (; k < 40 && !report.failed(); ++k) {
        tip = world.rod(0).pos(0);
        report = step(world, 1e-3);
    }
    REQUIRE(report.failed());
    CHECK(k > 20);  // in the introducer, until half an edge is in, there is no wall
    CHECK(world.report(0).flags == (StepHalved | StepNotConverged | StepWallBuckles));
    CHECK(world.report(1).flags == StepOk);
    CHECK((world.rod(0).pos(0) - tip).norm() < 1e-4);  // of one step, which parts in the introducer may have taken
    world.retire(0);
    const double reached = world.readings(1).inserted;
    for (int more = 0; more < 5; ++more) CHECK_FALSE(step(world, 1e-3).failed());
    CHECK(world.readings(1).inserted == about(reached + 5e-7).epsilon(1e-9));
}

TEST_CASE("property: a wall that buckles in long steps alone is taken through shorter ones")
{
    FedWorld world(in_a_tube_that_buckles(1e-3));
    unsigned flags = 0;
    int sub_steps = 0;
    for (int k = 0; k < 40; ++k) {
        const StepReport report = step(world, 1e-3);
        REQUIRE_FALSE(report.failed());
        flags |= report.flags, sub_steps = std::max(sub_steps, report.sub_steps);
    }
    CHECK((flags & StepHalved) != 0);
    CHECK(sub_steps > 1);
    CHECK(world.readings(0).inserted == about(4e-3).epsilon(1e-9));
}

// Above the wall, which stands: a node that goes 1.5 times as far as the limit has 1/1.5 of its path open, wherever the others
// are.
TEST_CASE("analytic: the path of a trial is open as far as the node that goes farthest may go")
{
    TestSetup setup = wire_on_plate(0, 1e-3, 0.008, 800);
    setup.integrator.scheme = Scheme::Newton;
    setup.wires[0].wire.shaft.density = 7900;
    setup.wires[0].wire.place.base.z() = 3 * radius;
    World world{WorldSetup(setup)};
    WorldData& data = data_of(world);
    StepReport report;
    take_control(data, {}, 1e-3);
    begin_step(data);
    data.work.pending.begin(1e-3, data.systems.running(), feed_parts(data, 1e-3, report));
    const SubStep* sub = data.work.pending.next();
    REQUIRE(sub);
    begin_sub_step(data, *sub);
    feed_hubs(data, *sub);
    hold_and_load(data, *sub);
    find_contacts(data);
    auto& wall = dynamic_cast<ElasticContact&>(*data.forces.wall_contact);
    const double limit = wall.traits().most_move[0];
    REQUIRE(limit == about(0.45 * radius).epsilon(1e-6));
    const ConstRodView rod = world.rod(0);
    const std::vector<std::uint8_t> live = {1};
    for (const double moved : {0.9, 1.5, 4.0}) {
        CAPTURE(moved);
        TrialState trial;
        for (auto* array : {&trial.x, &trial.y, &trial.z, &trial.theta}) array->resize(data.state.rods.total_capacity());
        for (int i = 0; i < rod.n; ++i)
            trial.x[i] = rod.x[i], trial.y[i] = rod.y[i] + (i == 40 ? moved * limit : 0), trial.z[i] = rod.z[i];
        wall.evaluate({trial, 1e-3, live});
        const TermAnswer answer = wall.answer(0, Ask::Trial);
        CHECK(answer.open == about(std::min(1.0, 1 / moved)).epsilon(1e-6));
        CHECK(answer.admissible == (moved < 1));
    }
}

}  // namespace seldinger::test::test_elastic_contact
