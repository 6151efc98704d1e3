// Spin angles left out of steps that do not need them: the same results, and never where they do.
#include "solve/wire_fixture.h"

namespace seldinger::test::test_spins {

namespace {

constexpr double tolerance = 1e-9;

struct Comparison {
    double difference = 0;  // farthest that a node ever was from its place with spins kept [m]
    double twist = 0;       // largest difference of a node's twist [rad]
    double share = 0;       // of steps without spins
};

struct Scenario {
    std::vector<HoldSpec> holds;
    std::vector<LoadSpec> loads;
    Vec3 gravity = {0, 0, -9.81};
    IntegratorSpec integrator;
    double h = 1e-3;
    int steps = 100;
};

/// The same motion with spins kept and left out where they may be.
Comparison compare(const WireSpec& spec, const Scenario& motion)
{
    Rig kept(spec, 41), left(spec, 41);
    for (Rig* rig : {&kept, &left}) {
        IntegratorSpec integrator = motion.integrator;
        integrator.tolerance = tolerance;
        integrator.spins = rig == &kept ? Spins::Kept : Spins::Auto;
        rig->hold(motion.holds, motion.loads);
        rig->integrate_with(integrator, motion.gravity);
        rig->solver->initialise_acceleration(rig->constraints, {}, rig->active);
    }
    Comparison result;
    for (int k = 0; k < motion.steps; ++k) {
        REQUIRE(kept.step(motion.h));
        REQUIRE(left.step(motion.h));
        for (int i = 0; i < 41; ++i)
            result.difference = std::max(result.difference, (kept.rod().pos(i) - left.rod().pos(i)).norm());
        for (int i = 1; i < 40; ++i)
            result.twist = std::max(result.twist, std::abs(kept.solver->frames(0).twist[i] - left.solver->frames(0).twist[i]));
    }
    CHECK(kept.solver->spin_record(0).without == 0);
    REQUIRE(left.solver->spin_record(0).steps == motion.steps);
    result.share = left.solver->spin_record(0).without / static_cast<double>(motion.steps);
    MESSAGE("farthest " << result.difference << " m, twist " << result.twist << " rad, without spins in " << 100 * result.share
                        << " % of the steps");
    return result;
}

/// What a residual at the tolerance, force_scale = max(weight, loads, B/L^2) times 1e-9, moves the end of a clamped wire by: F
/// L^3/(3 B). It is left anew in each step, in either run, and moves that are not damped add up.
double allowed(const WireSpec& spec, const Scenario& motion)
{
    double force = spec.shaft.bend_stiffness / (spec.length * spec.length);
    force =
        std::max(force, spec.length * spec.shaft.density * pi * spec.shaft.radius * spec.shaft.radius * motion.gravity.norm());
    for (const LoadSpec& load : motion.loads) force = std::max(force, load.force.norm());
    return 2 * motion.steps * tolerance * force * std::pow(spec.length, 3) / (3 * spec.shaft.bend_stiffness);
}

}  // namespace

TEST_SUITE("solve/spins")
{
    TEST_CASE("property: a wire that moves in a plane is solved without spins, by every integrator, with the same result")
    {
        const WireSpec spec = nitinol(0.2);
        Scenario motion;
        motion.holds = {clamp_base()};
        motion.loads = {tip_load({0.002, 0, 0.001})};
        for (const char* name : {"backward Euler", "trapezoid", "energy-momentum", "linearised"}) {
            CAPTURE(name);
            motion.integrator = {};
            motion.integrator.newmark = name[0] == 't';
            motion.integrator.conserve = name[0] == 'e';
            if (name[0] == 'l') motion.integrator.scheme = Scheme::Linearised;
            const Comparison c = compare(spec, motion);
            CHECK(c.share == 1);
            CHECK(c.twist == 0);
            CHECK(c.difference < allowed(spec, motion));
        }
    }

    // moved round a circle in half a second: the frames' holonomy must not become twist
    TEST_CASE("property: in space frames follow the wire, to the solver's tolerance or with the spins solved for")
    {
        const WireSpec spec = nitinol(0.2);
        Scenario motion;
        HoldSpec base = clamp_base();
        for (int k = 0; k <= 16; ++k)
            base.move.push_back({k / 32.0, 0, 0.01 * std::sin(pi * k / 8), 0.01 * (1 - std::cos(pi * k / 8))});
        motion.holds = {base};
        motion.steps = 500;
        const Comparison c = compare(spec, motion);
        CHECK(c.difference < allowed(spec, motion));
        // J theta''/l is 1e-10 N m/m at most here, over C: what the tolerance leaves, and the spins' own inertia where it is
        // below that
        CHECK(c.twist < 1e-6);
    }

    TEST_CASE("property: spins are never left out where they are needed")
    {
        Scenario motion;
        motion.holds = {clamp_base()};
        SUBCASE("natural curvature")
        {
            WireSpec spec = nitinol(0.2);
            WireSection tip = spec.shaft;
            tip.rest_curvature = {20, 0};
            spec.sections.push_back({0, 0.02, tip});
            CHECK(compare(spec, motion).share == 0);
        }
        SUBCASE("a moment")
        {
            motion.loads = {tip_load({})};
            motion.loads[0].moment = {1e-6, 0, 0};
            CHECK(compare(nitinol(0.2), motion).share == 0);
        }
        SUBCASE("turned at the base, bent aside")
        {
            motion.holds[0].turn = {{0, 0}, {1, 5}};
            motion.loads = {tip_load({0, 0.001, 0})};
            const Comparison c = compare(nitinol(0.2), motion);
            CHECK(c.share == 0);
            CHECK(c.difference == 0);
        }
    }

    TEST_CASE("property: turning that begins late is noticed, and its end too")
    {
        Scenario motion;
        motion.holds = {clamp_base()};
        motion.holds[0].turn = {{0.03, 0}, {0.05, 0.5}};
        motion.steps = 100;
        const WireSpec spec = nitinol(0.2);
        const Comparison c = compare(spec, motion);
        CHECK(c.share >= 0.30);
        CHECK(c.share < 0.80);
        CHECK(c.difference < allowed(spec, motion));
    }
}

}  // namespace seldinger::test::test_spins
