// Time integration: frequencies and orders, momentum, damping, holds that move, and what a step costs.
#include "solve/wire_fixture.h"

namespace seldinger::test::test_dynamics {

namespace {

IntegratorSpec trapezoid()
{
    IntegratorSpec spec;
    spec.newmark = true;
    return spec;
}

/// First mode of a clamped wire of 0.1 m, its tip's amplitude [m]; s from the base.
Curve first_mode(double amplitude)
{
    const double b = 18.751040687119611, ratio = 0.7340955137589128;  // beta_1, (cosh bL + cos bL)/(sinh bL + sin bL)
    return [=](double s) {
        return Vec3(s, 0, 0.5 * amplitude * (std::cosh(b * s) - std::cos(b * s) - ratio * (std::sinh(b * s) - std::sin(b * s))));
    };
}

struct Oscillation {
    double period, energy_ratio;  // [s]; energy at the end over that at the start, per period
};

// 25 edges: the half-edge clamp and lumped masses lower the frequency by this ratio (eigenvalues of the discrete beam)
constexpr double omega = 103.08842908953729 * 0.9986486072397088;

/// Lets the clamped wire swing for `periods` and measures between the first and the last upward crossing.
Oscillation swing(const IntegratorSpec& spec, double h, int periods)
{
    Rig rig(nitinol(0.1), 26, 1, first_mode(1e-5));
    rig.hold({clamp_base()});
    rig.integrate_with(spec);
    rig.solver->initialise_acceleration(rig.constraints, {}, rig.active);
    std::vector<double> crossings;
    double first_energy = 0, last_energy = 0;
    double before = rig.tip().z();
    while (static_cast<int>(crossings.size()) <= periods) {
        REQUIRE(rig.step(h));
        const double z = rig.tip().z();
        if (before < 0 && z >= 0) {
            crossings.push_back(rig.time - h * z / (z - before));
            last_energy = rig.solver->elastic_energy(0) + rig.solver->kinetic_energy(0);
            if (crossings.size() == 1) first_energy = last_energy;
        }
        before = z;
        REQUIRE(rig.time < 1);
    }
    return {(crossings.back() - crossings.front()) / periods, std::pow(last_energy / first_energy, 1.0 / periods)};
}

Vec3 momentum_of(const RodView& rod)
{
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i] * rod.vel(i);
    return sum;
}

double mass_of(const RodView& rod)
{
    double sum = 0;
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i];
    return sum;
}

}  // namespace

TEST_SUITE("solve/dynamics")
{
    // one mode, trapezoid: period grows by w h/(2 atan(w h/2)) and energy stays
    TEST_CASE("analytic: the trapezoid's period error is (w h)^2/12, second order, and its energy stays")
    {
        double error[2];
        for (int k : {0, 1}) {
            const double h = 2 * pi / omega / (k == 0 ? 30 : 60);
            const Oscillation o = swing(trapezoid(), h, 3);
            const double expected = 2 * pi / omega * omega * h / (2 * std::atan(omega * h / 2));
            // higher modes are excited at 1e-3 by the difference of discrete and continuous shape
            CHECK(o.period == about(expected).epsilon(2e-4));
            CHECK(o.energy_ratio == about(1).epsilon(1e-3));
            error[k] = o.period - 2 * pi / omega;
        }
        CHECK(std::log2(error[0] / error[1]) == about(2).epsilon(0.15));
    }

    // one mode: 1/(1 + w^2 h^2) per step in energy: the damping per period is first order in h
    TEST_CASE("analytic: backward Euler damps by 1/(1 + w^2 h^2) a step, first order")
    {
        double lost[2];
        for (int k : {0, 1}) {
            const double h = 2 * pi / omega / (k == 0 ? 100 : 200);
            const Oscillation o = swing({}, h, 2);
            const double expected = std::pow(1 / (1 + std::pow(omega * h, 2)), o.period / h);
            CHECK(o.energy_ratio == about(expected).epsilon(5e-3));
            lost[k] = -std::log(o.energy_ratio);
        }
        CHECK(std::log2(lost[0] / lost[1]) == about(1).epsilon(0.05));
    }

    TEST_CASE("property: a free wire falls as a stone does, without bending")
    {
        for (const bool newmark : {false, true}) {
            CAPTURE(newmark);
            Rig rig(nitinol(0.1), 21);
            IntegratorSpec spec;
            spec.newmark = newmark;
            rig.integrate_with(spec, {0, 0, -9.81});
            rig.solver->initialise_acceleration(rig.constraints, {}, rig.active);
            const int steps = 50;
            const double h = 2e-3, mass = mass_of(rig.rod());
            for (int k = 0; k < steps; ++k) REQUIRE(rig.step(h));
            const Vec3 p = momentum_of(rig.rod());
            // residual below 1e-6 of the weight at each step
            CHECK(p.z() == about(-mass * 9.81 * steps * h).epsilon(1e-6));
            CHECK(std::abs(p.x()) < 1e-6 * std::abs(p.z()));
            CHECK(rig.rod().z[0] == about(rig.rod().z[20]).epsilon(1e-9));
            // backward Euler falls n (n + 1)/2 h^2 g, the trapezoid exactly t^2/2 g
            const double fall = 9.81 * h * h * (newmark ? steps * steps : steps * (steps + 1)) / 2;
            CHECK(-rig.rod().z[0] == about(fall).epsilon(1e-6));
        }
    }

    TEST_CASE("property: a bent free wire that springs open keeps momentum and angular momentum at rest")
    {
        Rig rig(nitinol(0.1), 31, 1, arc_towards_z(0.04));
        rig.integrate_with({});
        double largest = 0;
        for (int k = 0; k < 40; ++k) {
            REQUIRE(rig.step(1e-4));
            for (int i = 0; i < 31; ++i) largest = std::max(largest, rig.rod().vel(i).norm());
        }
        CHECK(largest > 0.1);
        // each step leaves at most its tolerance as an impulse
        CHECK(momentum_of(rig.rod()).norm() < 40 * 1e-4 * 31 * rig.reports[0].tolerance);
    }

    TEST_CASE("property: the hold's impulse is the wire's change of momentum")
    {
        Rig rig(nitinol(0.1), 21);
        HoldSpec hold = clamp_base();
        hold.velocity = {0.02, 0, 0.05};
        rig.hold({hold});
        rig.integrate_with({}, {0, 0, -9.81});
        const double h = 1e-3, mass = mass_of(rig.rod());
        Vec3 before = momentum_of(rig.rod());
        for (int k = 0; k < 20; ++k) {
            REQUIRE(rig.step(h));
            const Vec3 after = momentum_of(rig.rod());
            const Vec3 reaction = {rig.solver->reaction(0, 80), rig.solver->reaction(0, 81), rig.solver->reaction(0, 82)};
            const Vec3 force = (after - before) / h - mass * Vec3(0, 0, -9.81);
            CHECK((reaction - force).norm() < 21 * rig.reports[0].tolerance + 1e-9 * force.norm());
            before = after;
        }
        // prescribed positions are met exactly, and their velocity follows
        CHECK(rig.rod().z[20] == 0.05 * rig.time);
        CHECK(rig.rod().vz[20] == about(0.05).epsilon(1e-9));
    }

    TEST_CASE("analytic: mass damping slows a free wire by 1/(1 + c h) a step")
    {
        Rig rig(nitinol(0.1), 11);
        for (int i = 0; i < 11; ++i) rig.rod().set_vel(i, {0, 0.3, 0});
        IntegratorSpec spec;
        spec.damping_mass = 50;
        rig.integrate_with(spec);
        for (int k = 0; k < 10; ++k) REQUIRE(rig.step(1e-3));
        // the tolerance, 1e-6 B/L^2, is 5.5e-9 N; over a node's mass and 10 ms, 1e-5 m/s
        CHECK(rig.rod().vy[5] == about(0.3 / std::pow(1.05, 10)).epsilon(1e-4));
    }

    // a mode with stiffness damping c_k has the damping ratio w c_k/2: energy falls by exp(-w^2 c_k T) a period
    TEST_CASE("analytic: stiffness damping of the first mode")
    {
        IntegratorSpec spec = trapezoid();
        spec.damping_stiffness = 2e-4;
        const Oscillation o = swing(spec, 2 * pi / omega / 60, 2);
        CHECK(-std::log(o.energy_ratio) == about(omega * omega * spec.damping_stiffness * o.period).epsilon(0.01));
    }

    TEST_CASE("property: a wire of two nodes is a bar: it falls, spins and keeps its length")
    {
        Rig rig(nitinol(0.01), 2);
        rig.rod().set_vel(0, {0, 0.1, 0});
        rig.rod().set_vel(1, {0, -0.1, 0});
        rig.rod().spin_rate[0] = 3;
        rig.integrate_with({}, {0, 0, -9.81});
        for (int k = 0; k < 20; ++k) REQUIRE(rig.step(1e-3));
        CHECK((rig.tip() - rig.rod().pos(1)).norm() == about(0.01).epsilon(1e-4));
        CHECK(rig.rod().spin_rate[0] == about(3).epsilon(1e-3));
        CHECK(rig.rod().vz[0] == about(-9.81 * 0.02).epsilon(1e-6));
        CHECK(rig.rod().vy[0] * rig.rod().vx[0] != 0);  // it has turned
    }

    TEST_CASE("property: the linearised scheme takes one step and agrees with Newton to second order in the step")
    {
        double difference[2];
        for (int k : {0, 1}) {
            const double h = k == 0 ? 4e-4 : 2e-4;
            Vec3 tips[2];
            for (int linearised : {0, 1}) {
                Rig rig(nitinol(0.1), 21, 1, arc_towards_z(2.0));
                rig.hold({clamp_base()});
                IntegratorSpec spec;
                spec.scheme = linearised ? Scheme::Linearised : Scheme::Newton;
                rig.integrate_with(spec);
                REQUIRE(rig.step(h));
                if (linearised) CHECK(rig.reports[0].evaluations == 2);
                tips[linearised] = rig.tip();
            }
            difference[k] = (tips[0] - tips[1]).norm();
        }
        CHECK(difference[0] < 1e-6);
        CHECK(difference[0] / difference[1] > 3.5);
    }

    // a soft wire, so that the explicit limit (axial wave over an edge, 2 ms here) can be met
    TEST_CASE("property: symplectic Euler follows Newton at a small step, and fails by its report above its limit")
    {
        WireSpec soft = nitinol(0.1);
        soft.shaft.stretch_stiffness = 0.05;
        soft.shaft.twist_stiffness = 1e-9;
        soft.shaft.bend_stiffness = 1e-7;
        const auto run = [&](Scheme scheme, double h, int steps, bool& good) {
            Rig rig(soft, 11);
            rig.hold({clamp_base()});
            IntegratorSpec spec;
            spec.scheme = scheme;
            rig.integrate_with(spec, {0, 0, -1});
            good = true;
            for (int k = 0; k < steps && good; ++k) good = rig.step(h);
            return rig.tip();
        };
        bool good = false;
        const Vec3 newton = run(Scheme::Newton, 1e-5, 1000, good);
        REQUIRE(good);
        const Vec3 symplectic = run(Scheme::Explicit, 1e-5, 1000, good);
        REQUIRE(good);
        CHECK((newton - symplectic).norm() < 0.01 * std::abs(newton.z()));
        (void)run(Scheme::Explicit, 0.02, 2000, good);
        CHECK_FALSE(good);
    }

    // the cost of a step is its evaluations: contact is searched at each
    TEST_CASE("property: steps of a millisecond take about two evaluations, however stiff the wire is axially")
    {
        for (const double stretch : {6966.0, 2e5}) {
            CAPTURE(stretch);
            WireSpec spec = nitinol(0.3);
            spec.shaft.stretch_stiffness = stretch;
            Rig rig(spec, 101, 1, arc_towards_z(0.5));
            HoldSpec base = clamp_base();
            base.velocity = {0.05, 0, 0};
            base.turn = {{0, 0}, {1, 6}};
            rig.hold({base});
            rig.integrate_with({}, {0, 0, -9.81});
            int evaluations = 0, worst = 0;
            const int steps = 200;
            for (int k = 0; k < steps; ++k) {
                REQUIRE(rig.step(1e-3));
                if (k < 20) continue;  // the release itself
                evaluations += rig.reports[0].evaluations;
                worst = std::max(worst, rig.reports[0].evaluations);
            }
            const double mean = evaluations / (steps - 20.0);
            MESSAGE("EA " << stretch << " N: " << mean << " evaluations a step, at most " << worst);
            CHECK(mean < 3.2);
            CHECK(worst <= 6);
        }
    }

    TEST_CASE("property: a step is the same bits alone and among others")
    {
        const auto prepare = [](Rig& rig, int w, double amplitude) {
            place_nodes(rig.rods.view(w), rig.wire, first_mode(amplitude));
        };
        Rig alone(nitinol(0.1), 26), three(nitinol(0.1), 26, 3);
        prepare(alone, 0, 0.02);
        for (int w : {0, 1, 2}) prepare(three, w, w == 1 ? 0.02 : 0.0007 * (w + 1));
        for (Rig* rig : {&alone, &three}) {
            rig->hold({clamp_base()});
            rig->integrate_with({}, {0, 0, -9.81});
            for (int k = 0; k < 30; ++k) REQUIRE(rig->step(1e-3));
        }
        for (int i = 0; i < 26; ++i) {
            CHECK(alone.rod().pos(i) == three.rod(1).pos(i));
            CHECK(alone.rod().vel(i) == three.rod(1).vel(i));
        }
        CHECK(alone.rod().pos(0) != three.rod(0).pos(0));
    }

    TEST_CASE("property: inactive wires are left alone")
    {
        Rig rig(nitinol(0.1), 11, 2);
        rig.integrate_with({}, {0, 0, -9.81});
        rig.active[1] = 0;
        REQUIRE(rig.step(1e-3));
        CHECK(rig.rod(0).z[3] < 0);
        CHECK(rig.rod(1).z[3] == 0);
        CHECK(rig.solver->trial().z[rig.rods.node_begin(1) + 3] == 0);
    }

    TEST_CASE("property: a step that cannot be made says so and leaves every byte of the wire alone")
    {
        const auto bytes = [](Rig& rig) {
            std::vector<double> all;
            for (const auto& array : rig.rods.arrays(0)) all.insert(all.end(), array.begin(), array.end());
            return all;
        };
        for (const char* what : {"not a number", "infinite load", "zero edge", "impossible hold"}) {
            CAPTURE(what);
            Rig rig(nitinol(0.1), 11);
            rig.hold({clamp_base()}, {tip_load({0, 0, 0.001})});
            rig.integrate_with({});
            REQUIRE(rig.step(1e-3));
            if (what[0] == 'n') rig.rod().vx[4] = NAN;
            if (what[1] == 'n') rig.hold({clamp_base()}, {tip_load({INFINITY, 0, 0})});
            if (what[0] == 'z') rig.rod().set_pos(5, rig.rod().pos(4));
            const auto before = bytes(rig);
            if (what[1] == 'm') {
                rig.constraints[0].prescribed[0].second = NAN;
                rig.solver->step(1e-3, rig.constraints, {}, rig.active, rig.reports);
                CHECK_FALSE(rig.reports[0].converged);
            } else {
                CHECK_FALSE(rig.step(1e-3));
            }
            const auto after = bytes(rig);
            REQUIRE(before.size() == after.size());
            CHECK(std::memcmp(before.data(), after.data(), before.size() * sizeof(double)) == 0);
        }
    }
}

}  // namespace seldinger::test::test_dynamics
