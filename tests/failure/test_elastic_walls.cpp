// The rows of the other files beside an elastic wall of 0.1 and 1 MPa, and wires fed at 0.1 to 100 cm/s. They stay inside the
// lumen of the moved wall, and no step is without a solution. A few of them for every run of the tests; all of them, which
// bench/wall_hard.py makes a table of, on demand.

#include "failure/hard_vessels.h"
#include "failure/watched_run.h"
#include "support/approx.h"

#include <fmt/format.h>

#include <cstdlib>

namespace seldinger::test::test_elastic_walls {

namespace {

constexpr double radius = 0.4445e-3, pi = std::numbers::pi;

struct Row {
    const char* name;
    TestSetup setup;
    double dt;  // [s]
    int steps;
    bool thrown = false;    // its force alternates because its base does
    bool spun = false;      // Spun: its work is the turning hand's
    double base_speed = 0;  // of a hold along the wire that moves for as long as the run [m/s]: its work is the hand's
};

HoldSpec clamped_base()
{
    HoldSpec base;
    base.position = base.direction = base.spin = true;
    return base;
}

TestSetup fed_in(WallMesh mesh, double length, int nodes, const Vec3& point, const Vec3& direction, double speed, double turn = 0)
{
    TestSetup setup;
    use_mesh(setup, std::move(mesh));
    setup.wires = {fed_wire(steel_wire(length, nodes), point, speed, turn)};
    setup.wires[0].feed.direction = direction.normalized();
    return setup;
}

TestSetup shot(double speed)
{
    TestSetup setup = in_tube(0.005, 0.2, 4000);
    TestWire wire = placed_wire(steel_wire(0.1, 21), {0.05, 0, 0});
    wire.wire.place.velocity = {0, 0.6 * speed, -0.8 * speed};
    setup.wires = {wire};
    return setup;
}

TestSetup tight_bend()
{
    TestSetup setup = in_bend(0.002, 0.012);
    TestWire wire = fed_wire(steel_wire(0.1, 11), {0.0005, 0, 0}, 0.05);
    wire.wire.shaft.bend_stiffness = 1e-6;
    wire.wire.shaft.twist_stiffness = 7e-7;
    setup.wires = {wire};
    return setup;
}

TestSetup pushed_helix()
{
    TestSetup setup = in_tube(0.003, 0.16, 8000);
    TestWire wire = placed_wire(steel_wire(0.14, 57), {0.005, 0, -0.003 + radius});
    wire.wire.shaft.stretch_stiffness = 500;
    HoldSpec base = clamped_base(), tip;
    base.velocity = {0.02, 0, 0};
    tip.at.kind = WirePoint::Kind::Tip;
    tip.position = true;
    wire.holds = {base, tip};
    setup.wires = {wire};
    return setup;
}

TestSetup soft_tip()
{
    TestSetup setup = fed_into_bend(0.05, 0.12, 49);
    WireSpec& wire = setup.wires[0].wire;
    wire.shaft.bend_stiffness = 2e-4;
    wire.shaft.twist_stiffness = 1.6e-4;
    wire.shaft.stretch_stiffness = 2e4;
    WireSectionRange tip{0, 0.03, wire.shaft};
    tip.section.bend_stiffness = 2e-7;
    tip.section.twist_stiffness = 1.6e-7;
    wire.sections = {tip};
    return setup;
}

TestSetup narrow_neck()
{
    TestSetup setup = fed_in(stenosis(0.003, 0.0003, 0.03, 0.012, 0.08), 0.08, 41, {0.001, 0, -0.001}, {1, 0, 0}, 0.05);
    setup.wires[0].feed.keys = {{0, 0, 0}, {0.56, 0.028, 0}, {1, 0.0324, 0}};
    return setup;
}

TestSetup folded()
{
    TestSetup setup = in_tube(0.02, 0.2, 4000);
    TestWire wire = placed_wire(steel_wire(0.08, 33), Vec3::Zero());
    wire.wire.place.shape = PlaceShape::Points;
    const double c = std::cos(12 * pi / 180), s = std::sin(12 * pi / 180), corner = 0.05 + 0.04 + 1e-9;
    wire.wire.place.points = {{0.05, 0, 0}, {corner, 0, 0}, {corner - 0.041 * c, 0, 0.041 * s}};
    setup.wires = {wire};
    return setup;
}

TestSetup thrown_base(double dt)
{
    TestSetup setup = in_tube(0.004, 0.16, 6000);
    TestWire wire = placed_wire(steel_wire(0.12, 49), {0.01, 0, 0});
    HoldSpec base = clamped_base();
    for (int k = 0; k <= 200; ++k) base.move.push_back({k * dt, 0, 0, k % 2 ? 1e-3 : -1e-3});
    wire.holds = {base};
    setup.wires = {wire};
    return setup;
}

/// Laid down without speed, as deep as nothing: contact begins at no speed.
TestSetup laid_down()
{
    TestSetup setup = in_tube(0.003, 0.1, 6000);
    setup.wires = {placed_wire(steel_wire(0.06, 25), {0.02, 0, -0.003 + radius + 1e-7})};
    return setup;
}

/// The bend and the wire that is fed into it, `away` from the origin along each axis.
TestSetup bend_away(double away)
{
    TestSetup setup = fed_into_bend(0.1);
    const Vec3 shift(away, -away, away);
    for (Vec3& v : setup.mesh.vertices) v += shift;
    for (Vec3& v : setup.centreline.points) v += shift;
    setup.wires[0].feed.point += shift;
    return setup;
}

/// 60 mm into the bend, at most 0.17 mm in a step.
Row fed_at(double speed, const char* name)
{
    const double dt = std::min(0.05, 1.0 / 6000 / speed);
    TestSetup setup = fed_into_bend(speed);
    setup.wires[0].feed.keys = {{0, 0, 0}, {0.06 / speed, 0.06, 0}};
    return {name, setup, dt, static_cast<int>(std::lround(0.06 / speed / dt))};
}

std::vector<Row> all_rows()
{
    std::vector<Row> rows;
    rows.push_back({"F2 bend, 2 cm/s", fed_into_bend(0.02), 1.0 / 60, 240});
    rows.push_back({"F3 bend, 10 cm/s", fed_into_bend(0.1), 2e-3, 400});
    rows.push_back({"F4 shot at 0.5 m/s", shot(0.5), 1.0 / 60, 20});
    rows.push_back({"F4 shot at 5 m/s", shot(5), 1.0 / 60, 20});
    rows.push_back({"F4 shot at 20 m/s", shot(20), 1.0 / 60, 20});
    rows.push_back({"F5 panels of 10 cm",
                    fed_in(box_channel(0.1, -0.004, 0.004, -0.004, 0.004, 1), 0.08, 33, {0.002, 0, 0}, {1, 0.1, -0.2}, 0.1), 2e-3,
                    350});
    rows.push_back({"F5 bend tighter than the nodes", tight_bend(), 2e-3, 500});
    rows.push_back({"F7 laid down", laid_down(), 1e-3, 500});
    rows.push_back({"F8 ten minutes on a slope", on_a_slope(0.2, 2000, 0, std::atan(0.1)), 0.25, 2400});
    rows.push_back({"F10 helix", pushed_helix(), 1e-3, 500, false, false, 0.02});
    rows.push_back({"F11 soft tip", soft_tip(), 1e-3, 1600});
    rows.push_back({"F12 narrow neck", narrow_neck(), 1e-3, 1000});
    rows.push_back({"F14 bend, 1 m away", bend_away(1), 2e-3, 400});
    rows.push_back({"F14 bend, 10 m away", bend_away(10), 2e-3, 400});
    const PushPull push_pull;
    rows.push_back({"F15 push, pull", push_pull.setup, PushPull::dt, push_pull.before + 3 * push_pull.cycle});
    rows.push_back({"F16 spin", Spun().setup, Spun::dt, 150, false, true});
    rows.push_back({"F16 fold", folded(), 1e-3, 300});
    rows.push_back({"F17 thrown base, 1 ms", thrown_base(1e-3), 1e-3, 200, true});
    rows.push_back({"F17 thrown base, 16.7 ms", thrown_base(1.0 / 60), 1.0 / 60, 200, true});
    rows.push_back(fed_at(0.001, "fed at 0.1 cm/s"));
    rows.push_back(fed_at(0.01, "fed at 1 cm/s"));
    rows.push_back(fed_at(0.1, "fed at 10 cm/s"));
    rows.push_back(fed_at(1.0, "fed at 100 cm/s"));
    return rows;
}

/// Work of a hold that moves: by the trapezoid; of one that is thrown by the engine's ledger, sub-step by sub-step, since the
/// ends of steps do not show it where one was halved.
void count_work(WatchedRun& run, const Row& row)
{
    if (row.thrown)
        run.work = [before = 0.0](FedWorld& world) mutable {
            if (world.step_count() == 1)  // the ledger begins at its end
                return 0.5 * world.readings(0).base_force.z() * world.rod(0).z[world.rod(0).n - 1];
            const double now = world.readings(0).energy.outside, work = now - before;
            before = now;
            return work;
        };
    else if (row.spun) count_turning(run, Spun::turn / 60, 60);
    else if (row.base_speed > 0)
        run.work = [force = 0.0, step = row.base_speed * row.dt](FedWorld& world) mutable {
            const double now = world.readings(0).hand_force, work = 0.5 * (force + now) * step;
            force = now;
            return work;
        };
}

/// Runs it, prints a line of the table, and returns what came of it.
Outcomes go(const Row& row, double youngs)
{
    TestSetup setup = row.setup;
    make_elastic(setup, youngs);
    WatchedRun run(setup, standard, row.dt);
    count_work(run, row);
    run.run(row.steps);
    const Outcomes o = run.outcomes();
    const FailureReadings& r = o.verdict().readings;
    MESSAGE(fmt::format("row;{};{:g};{:g};{};{};{};{};{};{:.4g};{:.4g};{:.4g};{:.4g};{:.4g};{:.2f};{};{}", row.name, youngs,
                        row.dt, row.steps, name(o.outcome()), r.steps, o.halved, r.sub_steps, 1e3 * o.nearest, 1e6 * r.overlap,
                        1e3 * o.wall_move, 1e3 * r.hand_force, o.normal, r.mean_iterations, r.newton_iterations, o.far));
    CAPTURE(row.name);
    CAPTURE(youngs);
    CHECK(r.outside == 0);
    CHECK(o.nearest > 0);
    CHECK(o.outcome() <= (row.thrown ? Outcome::Jitter : Outcome::Hold));  // a base that alternates makes a force that does
    CHECK(o.contacts > 0);
    return o;
}

}  // namespace

TEST_SUITE("failure/elastic_walls")
{
    TEST_CASE("property: the hard rows hold beside an elastic wall, as soft as 0.1 MPa")
    {
        for (const Row& row : all_rows()) {
            const std::string name = row.name;
            const bool quick = name.starts_with("F2") || name.starts_with("F4 shot at 5") ||
                               name.starts_with("F17 thrown base, 16.7") || name == "fed at 100 cm/s" || name == "fed at 1 cm/s";
            if (quick) (void)go(row, 0.1e6);
        }
    }

    // The neck is pushed along by more than its radius, which the model does not carry (docs/failures.md). The engine's own
    // reading against the distance to the moved wall's mesh.
    TEST_CASE("property: F12: a wire that leaves a neck through its soft wall is flagged")
    {
        TestSetup setup = narrow_neck();
        setup.wires[0].feed.keys = {{0, 0.026, 0}, {0.4, 0.0305, 0}};
        make_elastic(setup, 0.1e6);
        WatchedRun run(setup, standard, 1e-3);
        bool flagged = false, inside_before = true;
        run.run(400, [&](FedWorld& world) {
            const double nearest = run.outcomes().nearest;  // looked up every few steps
            flagged = flagged || world.readings(0).outside > 0;
            inside_before = inside_before && (flagged || nearest > 0);
            return nearest > 0;
        });
        CHECK(flagged);
        CHECK(inside_before);
        CHECK(run.outcomes().nearest < 0);
        CHECK(run.outcomes().outcome() == Outcome::Escape);
    }

    // Newton's first way to the equilibrium leads nowhere here; the next ones begin at the start again, wire and wall. The feet
    // that are found bear the weight: plane and wire turn by the dent's slope at most, 20 um over 5 mm.
    TEST_CASE("property: a wire settles on a tilted plane of 0.1 MPa, however many nodes it has")
    {
        constexpr double tilt = 0.1;
        for (const int nodes : {6, 11, 21}) {
            CAPTURE(nodes);
            TestSetup setup = on_a_slope(0.2, 2000, 0, std::atan(tilt));
            setup.wires[0].wire.nodes = nodes;
            make_elastic(setup, 0.1e6);
            FedWorld world(setup);
            REQUIRE_FALSE(settle(world).failed());
            const WireSpec& wire = setup.wires[0].wire;
            const double weight = wire.shaft.density * pi * radius * radius * wire.length * setup.gravity.norm();
            const WireReadings now = world.readings(0);
            CHECK(now.normal == about(weight * std::cos(std::atan(tilt))).epsilon(0.01));
            CHECK(now.friction == about(weight * std::sin(std::atan(tilt))).epsilon(0.1));
            CHECK(now.outside == 0);
        }
    }

    // minutes; bench/wall_hard.py asks for it
    TEST_CASE("table: every row beside walls of 0.1 and 1 MPa" * doctest::skip())
    {
        const char* asked = std::getenv("SELDINGER_ROWS");  // what names begin with; absent: all
        for (const Row& row : all_rows())
            for (const double youngs : {0.1e6, 1e6})
                if (!asked || std::string(row.name).starts_with(asked)) (void)go(row, youngs);
    }
}

}  // namespace seldinger::test::test_elastic_walls
