// What a World refuses: setups that contradict themselves, and requests that cannot be met. One clear line, and nothing has
// changed.

#include "core/error.h"
#include "support/refusal.h"
#include "support/world_fixture.h"

#include <functional>
#include <limits>
#include <string>

namespace seldinger::test::test_requests {

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Two wires in a tube, the first fed.
TestSetup two_wires()
{
    TestSetup setup = in_tube(0.005, 0.2);
    setup.wires = {fed_wire(steel_wire(0.1, 21), {0.0005, 0, -0.0025}, 0.1), placed_wire(steel_wire(0.05, 11), {0.05, 0, 0})};
    return setup;
}

std::string message_of(const auto& call) { return refusal(call, ErrorKind::BadScene); }

void refused(const std::function<void(TestSetup&)>& change, const std::string& expected)
{
    TestSetup setup = two_wires();
    change(setup);
    check_refused([&] { const World world{WorldSetup(setup)}; }, {expected}, ErrorKind::BadScene);
}

}  // namespace

TEST_SUITE("step/requests")
{
    TEST_CASE("property: a setup that contradicts itself is refused by a line that names the member")
    {
        refused([](TestSetup& s) { s.wires.clear(); }, "wires: got none; expected at least one wire");
        refused([](TestSetup& s) { s.wires[1].contact.detection = Detection::Nodes; },
                "wires[1].contact.detection: got another value than wires[0]");
        refused([](TestSetup& s) { s.wires[1].contact.normal = NormalLaw::LankaraniNikravesh; },
                "wires[1].contact.normal: got another value than wires[0]");
        refused([](TestSetup& s) { s.wires[1].contact.friction = FrictionLaw::Smooth; },
                "wires[1].contact.friction: got another value than wires[0]");
        refused([](TestSetup& s) { s.wires[1].contact.precision = Precision::Float32; },
                "wires[1].contact.precision: got another value than wires[0]");
        refused([](TestSetup& s) { s.mesh.triangles.clear(); }, "mesh: got no triangles");
        refused([](TestSetup& s) { s.mesh.triangles[7][1] = 1 << 30; }, "mesh.triangles[7]: got vertex 1073741824");
        refused([](TestSetup& s) { s.mesh.vertices[3].x() = not_a_number; }, "mesh.vertices[3]: got [nan");
        refused([](TestSetup& s) { s.gravity.z() = not_a_number; }, "gravity: got [0, 0, nan]");
        refused([](TestSetup& s) { s.wires[0].wire.length = 0; },
                "wires[0].wire.length: got 0; expected a finite number greater than 0");
        refused([](TestSetup& s) { s.wires[0].wire.shaft.radius = not_a_number; }, "wires[0].wire.shaft.radius: got nan");
        refused([](TestSetup& s) { s.wires[1].wire.shaft.bend_stiffness = -1; }, "wires[1].wire.shaft.bend_stiffness: got -1");
        refused([](TestSetup& s) { s.wires[1].wire.shaft.mu_sliding = 0.9; },
                "wires[1].wire.shaft.mu_static: got 0.25; expected at least");
        refused([](TestSetup& s) { s.wires[1].wire.nodes = 1; }, "wires[1].wire.nodes: got 1");
        refused([](TestSetup& s) { s.wires[0].wire.shaft.radius = 1e-7; },
                "wires[0].wire.length: got 0.1 m; expected at most 500000 times the smallest radius, 1e-07 m");
        refused([](TestSetup& s) { s.wires[0].wire.nodes = 20000, s.wires[0].contact.samples_per_edge = 1000; },
                "wires[0].contact.samples_per_edge: got 1000 for 20000 nodes");
        refused([](TestSetup& s) { s.wires[0].feed.direction = Vec3::Zero(); }, "wires[0].feed.direction: got zero");
        refused([](TestSetup& s) { s.wires[0].feed.keys = {{0, 0.2, 0}}; }, "wires[0].feed.advance: got 0.2 m");
        refused([](TestSetup& s) { s.systems = {1}; }, "systems: got 1 instruments in all");
        refused([](TestSetup& s) { s.systems = {2, 0}; }, "systems[1]: got 0");
    }

    TEST_CASE("property: an elastic wall is a thin shell, and something holds it")
    {
        const auto elastic = [](const std::function<void(VesselSpec&)>& change) {
            return [change](TestSetup& s) {
                s.vessel.elastic = true;
                change(s.vessel);
            };
        };
        refused(elastic([](VesselSpec& v) { v.youngs = 0; }), "vessel.youngs: got 0");
        refused(elastic([](VesselSpec& v) { v.poisson = 0.5; }), "vessel.poisson: got 0.5");
        refused(elastic([](VesselSpec& v) { v.poisson = -0.1; }), "vessel.poisson: got -0.1");
        refused(elastic([](VesselSpec& v) { v.thickness = 0; }), "vessel.thickness: got 0");
        refused(elastic([](VesselSpec& v) { v.thickness = 0.006; }),
                "vessel.thickness: got 0.006 m; expected at most the lumen's radius");
        refused(elastic([](VesselSpec& v) { v.support = -1; }), "vessel.support: got -1");
        refused(elastic([](VesselSpec& v) { v.support_damping = -1; }), "vessel.support_damping: got -1");
        refused(elastic([](VesselSpec& v) { v.relaxation = not_a_number; }), "vessel.relaxation: got nan");
        refused(elastic([](VesselSpec& v) { v.pressure = not_a_number; }), "vessel.pressure: got nan");
        refused(elastic([](VesselSpec& v) { v.wall_edge = -1; }), "vessel.wall_edge: got -1");
        refused(elastic([](VesselSpec& v) { v.support = 0, v.rims_held = false; }), "vessel.support: got 0, and rims are free");
        refused([](TestSetup& s) { s.mesh = {}, s.vessel = {}, s.vessel.elastic = true; }, "mesh: got no triangles");
    }

    TEST_CASE("property: a step that cannot be taken changes nothing")
    {
        FedWorld world(two_wires());
        for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        const std::string before = world.state_hash();
        const auto refuses = [&](const Control& control, double dt, const std::string& expected) {
            check_refused([&] { return seldinger::step(world, control, dt); }, {expected}, ErrorKind::BadScene);
            CHECK(world.state_hash() == before);
        };
        const FeedKey backwards[] = {{1, 0, 0}, {1, 0.01, 0}}, lost[] = {{0, not_a_number, 0}};
        refuses({}, 0, "step: dt: got 0 s");
        refuses({}, -1e-3, "step: dt: got -0.001 s");
        refuses({}, not_a_number, "step: dt: got nan s");
        refuses({}, std::numeric_limits<double>::infinity(), "step: dt: got inf s");
        refuses(Control().move_to(0, not_a_number, 0), 1e-3, "control: instrument 0: advance: got nan m");
        refuses(Control().move_to(0, 0.2, 0), 1e-3, "advance: got 0.2 m; expected 0 to the wire's length, 0.1 m");
        refuses(Control().move_to(0, -1e-3, 0), 1e-3, "advance: got -0.001 m");
        refuses(Control().move_to(0, 0.01, not_a_number), 1e-3, "turn: got nan rad");
        refuses(Control().move_to(1, 0.01, 0), 1e-3, "control: instrument 1: got a move, but it is not fed");
        refuses(Control().move_to(2, 0.01, 0), 1e-3, "control: instrument 2: index out of range; expected below 2");
        refuses(Control().follow(0, backwards), 1e-3, "key 1: got 1 s; expected times that increase");
        refuses(Control().follow(0, lost), 1e-3, "advance: got nan m");
        CHECK(message_of([] { Control().move_to(-1, 0, 0); }).find("instrument -1") != std::string::npos);
        CHECK(message_of([] { Control().follow(0, {}); }).find("a path without keys") != std::string::npos);
        REQUIRE_FALSE(step(world, 1e-3).failed());  // and goes on
        CHECK(world.state_hash() != before);
    }

    // a turn whose energy is just a number and whose force would be none
    TEST_CASE(
        "property: a step that no number can tell of has failed, the report of that instrument says so, and readings stay "
        "numbers")
    {
        TestSetup setup = two_wires();
        setup.systems = {1, 1};
        World world{WorldSetup(setup)};
        for (int k = 0; k < 3; ++k) REQUIRE_FALSE(step(world, Control().move_to(0, 0.02 + 1e-4 * k, 0), 1e-3).failed());
        const StepReport report = step(world, Control().move_to(0, 0.0203, 1e154), 1e-3);
        CHECK(report.failed());
        CHECK(world.report(0).failed());
        CHECK_FALSE(world.report(1).failed());
        CHECK(std::isfinite(world.readings(0).hand_force));
        CHECK(std::isfinite(world.readings(0).elastic));
        CHECK(world.readings(0).turned == 0);
    }

    TEST_CASE("property: a state of another world is refused and changes nothing")
    {
        FedWorld world(two_wires());
        for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        const std::string before = world.state_hash();
        TestSetup one = two_wires();
        one.wires.pop_back();
        const std::vector<std::uint8_t> other = FedWorld(one).save_state();
        CHECK_THROWS_AS(world.restore_state(other), Error);
        CHECK(world.state_hash() == before);
        std::vector<std::uint8_t> longer = world.save_state();
        longer.push_back(0);
        CHECK_THROWS_AS(world.restore_state(longer), Error);
        CHECK(world.state_hash() == before);
    }
}

}  // namespace seldinger::test::test_requests
