// F11, F16 and bad input: the wire at the limits of its input. Clear errors or right answers, never NaN.

#include "core/error.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace seldinger::test::test_rod_edges {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double length = 0.1, bend = 5.5e-5, twist = 4.2e-5;  // [m], [N m^2]

/// A wire along x, its base clamped at the origin, without weight.
const std::string clamped = scene_text(1, 1e-3, "gravity = [0, 0, 0]\n") + wire_text(length, bend, twist, 41, 2e-4, 6450, 7000) +
                            "place = { shape = \"straight\", direction = [1, 0, 0], normal = [0, 0, 1] }\n" + held_base;

World world_of(const std::string& text, const std::vector<std::string>& sets = {})
{
    return World(make_setup(read_scene_text(text, "edge.toml", sets)));
}

void check_refusal(const std::string& text, const std::vector<std::string>& sets, const std::vector<std::string>& says)
{
    check_refused([&] { return world_of(text, sets); }, says, ErrorKind::BadScene);
}

bool finite(const ConstRodView& rod)
{
    for (int i = 0; i < rod.n; ++i)
        if (!std::isfinite(rod.pos(i).sum() + rod.vel(i).sum() + rod.theta[std::min(i, rod.n - 2)])) return false;
    return true;
}

/// The worst wire of the run: sub-steps of any step.
int worst_sub_steps(World& world, int steps, double dt)
{
    int worst = 0;
    for (int k = 0; k < steps; ++k) {
        const StepReport report = step(world, dt);
        REQUIRE_FALSE(report.failed());
        worst = std::max(worst, report.sub_steps);
    }
    REQUIRE(finite(world.rod(0)));
    return worst;
}

}  // namespace

TEST_SUITE("failure/rod_edges")
{
    TEST_CASE("property: a wire of two nodes is refused in a scene, with the number that would do")
    {
        check_refusal(clamped, {"wire.nodes=2"}, {"wire.nodes", "3"});
        check_refusal(clamped, {"wire.nodes=0"}, {"wire.nodes", "3"});
    }

    // One edge on its clamp's half cell: it turns by P L (L/2)/B. The engine itself goes down to two nodes, as a fed wire does.
    TEST_CASE("analytic: a wire of two nodes is a rigid edge on half a cell of wire")
    {
        WorldSetup setup = make_setup(read_scene_text(clamped, "edge.toml"));
        setup.gravity = Vec3::Zero();
        setup.wires[0].wire.nodes = 2;
        setup.wires[0].loads = {{.at = {WirePoint::Kind::Tip}, .force = {0, 0, -1e-6}}};
        setup.integrator.scheme = Scheme::Static;
        setup.integrator.tolerance = 1e-9;
        World world(std::move(setup));
        REQUIRE_FALSE(settle(world).failed());
        // (P L^2/B)^2 = 3e-8 is what the large turn changes
        CHECK(world.rod(0).pos(0).z() == about(-1e-6 * std::pow(length, 3) / (2 * bend)).epsilon(1e-6));
    }

    TEST_CASE("property: an edge of no length is refused where the wire is placed")
    {
        check_refusal(clamped, {"wire.place={shape=\"points\", points=[[0,0,0],[0.05,0,0],[0.05,0,0],[0.1,0,0]]}"},
                      {"wire.place", "no point twice"});
    }

    // u = P (a^3/b_soft + (L^3 - a^3)/b)/3 for a soft tip of length a
    TEST_CASE("analytic: stiffness of 1000:1 between neighbours: deflection at rest, and steps of a millisecond")
    {
        const double a = 0.03, load = 1e-7;
        const std::vector<std::string> soft = {
            fmt::format("wire.section=[{{from_tip_m=[0, {}], bend_nm2={}, twist_nm2={}}}]", a, bend / 1000, twist / 1000),
            "load.0.at=tip", fmt::format("load.0.force_n=[0, 0, {}]", load)};
        std::vector<std::string> at_rest = soft;
        at_rest.insert(at_rest.end(), {"integrator.scheme=static", "integrator.tolerance=1e-9"});
        World world = world_of(clamped, at_rest);
        REQUIRE_FALSE(settle(world).failed());
        const double expected = load * (std::pow(a, 3) * 1000 + std::pow(length, 3) - std::pow(a, 3)) / (3 * bend);
        // the boundary is at a node: trapezoidal rule over a, error h^2/(2 a^2) = 0.0035 with 12 edges in it; (w/a)^2 = 3e-5
        CHECK(world.rod(0).pos(0).z() == about(expected).epsilon(0.005));

        World swinging = world_of(clamped, soft);
        CHECK(worst_sub_steps(swinging, 200, 1e-3) == 1);
        // let go it swings up to twice where it hangs, damped by backward Euler
        CHECK(swinging.rod(0).pos(0).z() > 0);
        CHECK(swinging.rod(0).pos(0).z() < 2 * expected);
    }

    // Elastica, P L^2/B = 1 [Bisshopp45]; 40 edges leave 7e-5
    TEST_CASE("analytic: EA of 1e8 B/L^2: the elastica all the same, and steps of a millisecond")
    {
        const double load = bend / (length * length);
        const std::vector<std::string> stiff = {fmt::format("wire.stretch_n={}", 1e8 * bend / (length * length)), "load.0.at=tip",
                                                fmt::format("load.0.force_n=[0, 0, {}]", -load)};
        std::vector<std::string> at_rest = stiff;
        at_rest.push_back("integrator.scheme=static");
        World world = world_of(clamped, at_rest);
        REQUIRE_FALSE(settle(world).failed());
        CHECK(world.rod(0).pos(0).z() == about(-0.30172077 * length).epsilon(3e-4));
        CHECK(world.rod(0).pos(0).x() == about((1 - 0.05643324) * length).epsilon(3e-4));

        World swinging = world_of(clamped, stiff);
        CHECK(worst_sub_steps(swinging, 200, 1e-3) == 1);
        double inside = 0;
        const ConstRodView rod = swinging.rod(0);
        for (int j = 0; j < rod.n - 1; ++j) inside += (rod.pos(j + 1) - rod.pos(j)).norm();
        CHECK(inside == about(length).epsilon(1e-6));
    }

    // Torque C angle/L of a straight wire, both ends held, far below Greenhill's torque of its bending stiffness
    TEST_CASE("analytic: spin of five turns an edge is not aliased, at rest and in one step")
    {
        const double angle = 2 * pi * 5 * 40;
        const std::string both = clamped + "[[hold]]\nat = \"tip\"\nposition = true\ndirection = true\nspin = true\n";
        const std::vector<std::string> turned = {fmt::format("hold.0.turn=[[0, 0], [0.001, {}]]", angle), "wire.twist_nm2=1e-7"};
        const double torque = 1e-7 * angle / length;
        REQUIRE(torque < 0.5 * 8.9868 * bend / length);
        for (const bool at_rest : {true, false}) {
            CAPTURE(at_rest);
            std::vector<std::string> sets = turned;
            if (at_rest) sets.push_back("integrator.scheme=static");
            World world = world_of(both, sets);
            if (at_rest) REQUIRE_FALSE(settle(world).failed());
            else (void)worst_sub_steps(world, 100, 1e-3);  // 200 turns in the first step, then the spin comes to rest
            CHECK(std::abs(world.readings(0).hand_torque) == about(torque).epsilon(1e-5));
            const ConstRodView rod = world.rod(0);
            for (int j = 0; j < rod.n - 1; ++j) CHECK(std::abs(rod.theta[j]) == about(angle * (j + 0.5) / 40).epsilon(1e-4));
        }
    }

    TEST_CASE("property: a wire folded back on itself is refused, one that is nearly so opens")
    {
        const std::string folded = "wire.place={shape=\"points\", points=[[0,0,0],[0.05,0,0],[-0.001,0,0]]}";
        check_refusal(clamped, {folded}, {"wire.place.points", "folds back on itself at point 1", "round it off"});
        // 165 degrees, at a node: no frame is lost, and it swings open without a failed step
        const std::string nearly = "wire.place={shape=\"points\", points=[[0,0,0],[0.05,0,0],[0.001607,0.012967,0]]}";
        World world = world_of(clamped, {nearly});
        (void)worst_sub_steps(world, 300, 1e-3);
        CHECK(world.rod(0).pos(0).x() > 0);
    }

    TEST_CASE("property: holds that contradict each other are refused")
    {
        check_refusal(clamped + "[[hold]]\nat = 0.1\nposition = true\n", {},
                      {"hold[0] and hold[1] both hold the position of the same node"});
        check_refusal(clamped + "[[hold]]\nat = \"base\"\nspin = true\nturn = [[0, 0], [1, 1]]\n", {},
                      {"hold[0] and hold[1] both hold the spin"});
        check_refusal(clamped, {"hold.0.velocity_m_s=[0.1, 0, 0]", "integrator.scheme=static"},
                      {"hold.0.velocity_m_s", "has no end"});
    }

    // Both ends held and drawn apart: the wire takes the strain that is asked for
    TEST_CASE("analytic: holds farther apart than the wire is long stretch it")
    {
        World world = world_of(clamped + "[[hold]]\nat = \"tip\"\nposition = true\nmove = [[0, 0, 0, 0], [1, 0.001, 0, 0]]\n",
                               {"integrator.scheme=static"});
        REQUIRE_FALSE(settle(world).failed());
        CHECK(world.readings(0).base_force.x() == about(-7000 * 0.01).epsilon(1e-6));
    }

    TEST_CASE("property: a load, a link or a hold on a point that is not there is refused, with what is there")
    {
        check_refusal(clamped + "[[load]]\nat = 0.3\nforce_n = [0, 0, 1]\n", {}, {"load.0.at", "0.1 m"});
        check_refusal(clamped + "[[load]]\nat = -0.01\nforce_n = [0, 0, 1]\n", {}, {"load.0.at"});
        check_refusal(clamped + "[[load]]\nat = \"middle\"\nforce_n = [0, 0, 1]\n", {}, {"load.0.at", "\"base\", \"tip\""});
        check_refusal(clamped + "[[link]]\nat = 0.3\nanchor = [0, 0, 0]\nstiffness_n_m = 1\n", {}, {"link.0.at", "0.1 m"});
        check_refusal(clamped + "[[hold]]\nat = 0.3\nposition = true\n", {}, {"hold.1.at", "0.1 m"});
    }
}

}  // namespace seldinger::test::test_rod_edges
