// Static equilibria with closed forms: elastica, heavy cantilever, torsion, column.
#include "newton/system_problem.h"
#include "solve/wire_fixture.h"

#include <Eigen/Dense>

namespace seldinger::test::test_equilibrium {

namespace {

struct Elastica {
    double alpha, dx, dy;  // alpha = P L^2/B; tip's shortening and deflection over L
};

// Bisshopp & Drucker, Quart. Appl. Math. 3 (1945) 272: elliptic integrals, inextensible
constexpr Elastica elastica[] = {
    {0.5, 0.015918962470837496, 0.1621435756583696},
    {1, 0.0564332, 0.3017208},
    {2, 0.1606417, 0.4934575},
    {5, 0.3876284, 0.7137915},
    {10, 0.5549956, 0.8106090},
};

/// Tip of a clamped wire of 0.1 m under a dead load across it, relative to its length: (shortening, deflection).
std::pair<double, double> elastica_tip(int edges, double alpha, SolveReport* report = nullptr)
{
    Rig rig(nitinol(0.1), edges + 1);
    const double force = alpha * rig.wire.shaft.bend_stiffness / 0.01;
    rig.hold({clamp_base()}, {tip_load({0, 0, -force})});
    rig.integrate_with({});
    REQUIRE(rig.settle());
    if (report) *report = rig.reports[0];
    return {1 - rig.tip().x() / 0.1, -rig.tip().z() / 0.1};
}

// Heavy cantilever: Gamma = rho A g L^3/B, sag over span H/W (collocation, 1e-11)
struct Heavy {
    double gamma, sag;
};
constexpr Heavy heavy[] = {
    {0.1, 0.0124996}, {1, 0.12456176644123432}, {10, 1.0668023204338655}, {100, 5.8881046}, {1000, 21.3354405}};

/// R at `trial`, and dR/dq as the solver has it.
struct Linearised {
    Eigen::VectorXd residual;
    Eigen::MatrixXd tangent;

    Linearised(SystemProblem& problem, const std::vector<double>& trial)
    {
        const int size = problem.size();
        std::copy(trial.begin(), trial.end(), problem.trial.begin());
        REQUIRE(problem.update());
        REQUIRE(problem.evaluate_residual({}));
        problem.assemble_tangent(HessianMode::Exact, false, {});
        residual = Eigen::Map<const Eigen::VectorXd>(problem.residual.data(), size);
        tangent = Eigen::MatrixXd::Zero(size, size);
        for (int i = 0; i < size; ++i)
            for (int j = std::max(0, i - BandRows::half_bandwidth); j <= std::min(size - 1, i + BandRows::half_bandwidth); ++j)
                tangent(i, j) = problem.linear.band.at(i, j);
    }
};

}  // namespace

TEST_SUITE("newton/equilibrium")
{
    // what a moment adds to residual and tangent, so that nothing else of either is compared
    TEST_CASE("derivative: the tangent of a dead moment is that of its residual, spins included, and not symmetric")
    {
        Rig rig(nitinol(0.1), 6, 1, [](double s) { return Vec3(0.1 * std::sin(9 * s), 0.06 * s, 0.1 * s * s); });
        LoadSpec moment{.at = {WirePoint::Kind::Distance, 0.05}, .moment = {3e-4, -2e-4, 5e-4}};
        const int nodes[] = {6};
        SystemProblem with(0, nodes, {}), without(0, nodes, {});
        SystemProblem::Workspace workspace(6);
        for (SystemProblem* problem : {&with, &without}) (void)problem->work_in(workspace, false);
        rig.hold({clamp_base()}, {moment});
        const std::vector<WireConstraints> loaded = rig.constraints;
        std::vector<WireConstraints> bare = loaded;
        bare[0].loads.clear();
        with.begin(rig.rods, loaded, rig.active, {{}, Vec3::Zero(), Motion::Static, 0});
        without.begin(rig.rods, bare, rig.active, {{}, Vec3::Zero(), Motion::Static, 0});
        const auto added = [&](const std::vector<double>& trial) {
            return std::pair(Linearised(with, trial), Linearised(without, trial));
        };
        const auto [a, b] = added(with.start);
        const Eigen::MatrixXd tangent = a.tangent - b.tangent;
        CHECK((tangent - tangent.transpose()).norm() > 0.1 * tangent.norm());
        const int size = with.size(), edge = loaded[0].loads[0].edge;
        REQUIRE(tangent.row(RodDofs::spin(edge)).norm() > 0);
        for (int q = 0; q < size - 1; ++q) {
            const double step = RodDofs::is_spin(q) ? 1e-4 : 1e-6;
            Eigen::VectorXd numeric = Eigen::VectorXd::Zero(size);
            for (const double sign : {1.0, -1.0}) {
                std::vector<double> trial = with.start;
                trial[q] += sign * step;
                const auto [c, d] = added(trial);
                numeric += sign / (2 * step) * (c.residual - d.residual);
            }
            CAPTURE(q);
            // truncation (step/edge)^2 of m/l^2, and rounding of the elastic forces that cancel, 1e-16 EA (2e-2)/step
            CHECK((numeric - tangent.col(q)).norm() < 1e-6 * tangent.norm());
        }
    }

    // What a step feeds is gone from the base edge once the wire has moved on by it, as a step's first guess has. The tangent
    // there is that of the residual: taken at the tension that the feed makes before anything moves, -EA fed/l, it lacks EA
    // fed/l^2 against turning.
    TEST_CASE("derivative: the first tangent after a feed is that of a wire which has moved on")
    {
        const double fed = 2e-5;
        Rig rig(nitinol(0.1), 6);
        rig.hold({clamp_base()}, {});
        const RodView rod = rig.rods.view(0);
        const int hub = rod.n - 1;
        const Vec3 inwards = (rod.pos(hub - 1) - rod.pos(hub)).normalized();
        const double lacking = rod.stretch_stiffness[hub - 1] * fed / (rod.rest_length[hub - 1] * rod.rest_length[hub - 1]);
        rod.rest_length[hub - 1] += fed;
        rig.constraints[0].base_grown = fed;
        const int nodes[] = {6};
        SystemProblem problem(0, nodes, {});
        SystemProblem::Workspace workspace(6);
        (void)problem.work_in(workspace, false);
        problem.begin(rig.rods, rig.constraints, rig.active, {{}, Vec3::Zero(), Motion::Static, 0});
        std::vector<double> moved = problem.start;
        for (int i = 0; i < hub; ++i)
            for (int c = 0; c < 3; ++c) moved[RodDofs::position(i, c)] += fed * inwards[c];
        const Eigen::MatrixXd tangent = Linearised(problem, moved).tangent;
        for (int c = 1; c < 3; ++c) {  // across the wire
            const int q = RodDofs::position(hub - 1, c);
            Eigen::VectorXd numeric = Eigen::VectorXd::Zero(problem.size());
            for (const double sign : {1.0, -1.0}) {
                std::vector<double> trial = moved;
                trial[q] += sign * 1e-7;
                numeric += sign / 2e-7 * Linearised(problem, trial).residual;
            }
            // truncation EA/(2 l) (1e-7/l)^2 of a stretched edge, and rounding 1e-16 EA/1e-7
            CHECK(std::abs(numeric[q] - tangent(q, q)) < 1e-3 * lacking);
        }
    }

    // by a quarter turn at a time: no potential goes with a dead moment, and its tangent is as large as an edge is of the arc, m
    // l/B = 0.16
    TEST_CASE("analytic: dead moments roll a wire into a ring and further")
    {
        Rig rig(nitinol(0.1), 61);
        LoadSpec moment{.at = {WirePoint::Kind::Tip}, .moment = {0, -rig.wire.shaft.bend_stiffness * 3 * pi / 0.1, 0}, .ramp = 1};
        rig.hold({clamp_base()}, {moment});
        rig.integrate_with({});
        int evaluations = 0;
        for (int k = 1; k <= 6; ++k) {
            rig.fill(k / 6.0);
            rig.solver->equilibrium(rig.constraints, {}, rig.active, rig.reports);
            REQUIRE(rig.reports[0].converged);
            evaluations += rig.reports[0].evaluations;
        }
        MESSAGE(evaluations << " evaluations for six parts of one and a half turns");
        // the moment turns the last edge: every node and the clamp's half cell have it, the wire is an arc of 59.5 edges
        const double radius = 0.1 / (3 * pi);
        CHECK(std::abs(rig.tip().x() - 0) < 0.02 * radius);
        CHECK(rig.tip().z() == about(2 * radius).epsilon(0.01));
        for (int i = 1; i < 60; ++i) CHECK(rig.solver->frames(0).kb[i].norm() > 0.15);
    }

    // 100 edges: the half-edge clamp leaves 7e-6 to 1e-4 of L; stretching at EA/P > 1e5 less than that
    TEST_CASE("analytic: elastica under a dead tip load, from straight in one solve")
    {
        for (const Elastica& c : elastica) {
            CAPTURE(c.alpha);
            SolveReport report;
            const auto [dx, dy] = elastica_tip(100, c.alpha, &report);
            CHECK(dx == about(c.dx).epsilon(0.001));
            CHECK(dy == about(c.dy).epsilon(0.001));
            CHECK(report.residual <= report.tolerance);
            MESSAGE("alpha " << c.alpha << ": " << report.iterations << " iterations, " << report.evaluations << " evaluations");
        }
    }

    TEST_CASE("analytic: the error of the elastica falls with the square of the edge length")
    {
        const double coarse = elastica_tip(20, 2).second - 0.4934575, fine = elastica_tip(40, 2).second - 0.4934575;
        CHECK(std::log2(std::abs(coarse / fine)) == about(2).epsilon(0.1));
    }

    TEST_CASE("analytic: heavy cantilever up to Gamma = 1000")
    {
        for (const Heavy& c : heavy) {
            CAPTURE(c.gamma);
            WireSpec spec = nitinol(1);
            const double weight = spec.shaft.density * pi * std::pow(spec.shaft.radius, 2) * 9.81;  // [N/m]
            spec.length = std::cbrt(c.gamma * spec.shaft.bend_stiffness / weight);
            Rig rig(spec, 101);
            rig.hold({clamp_base()});
            rig.integrate_with({}, {0, 0, -9.81});
            REQUIRE(rig.settle());
            const double sag = -rig.tip().z() / rig.tip().x();
            // second order: 1e-4 at Gamma = 1, 6e-3 where the wire turns down within three edges of the clamp
            CHECK(sag == about(c.sag).epsilon(c.gamma > 100 ? 0.02 : 0.002));
            // the hold carries the weight
            double mass = 0;
            for (int i = 0; i < rig.rod().n; ++i) mass += rig.rod().mass[i];
            CHECK(rig.solver->reaction(0, RodDofs::position(100, 2)) == about(9.81 * mass).epsilon(1e-5));
            MESSAGE("Gamma " << c.gamma << ": " << rig.reports[0].iterations << " iterations, sag error " << sag / c.sag - 1);
        }
    }

    TEST_CASE("analytic: torque of a straight wire turned at its base with the tip's spin held is C Phi / L")
    {
        for (const double angle : {0.5, pi / 2, 2 * pi}) {
            CAPTURE(angle);
            WireSpec spec = nitinol(0.3);
            Rig rig(spec, 31);
            HoldSpec base = clamp_base(), tip = clamp_base();
            tip.at.kind = WirePoint::Kind::Tip;
            base.turn = {{0, 0}, {1, angle}};
            rig.hold({base, tip});
            rig.integrate_with({});
            REQUIRE(rig.settle());
            const double torque = -clamp_torque(rig.rod(), rig.constraints[0].clamps, rig.solver->frames(0), 0);
            CHECK(torque == about(spec.shaft.twist_stiffness * angle / 0.3).epsilon(1e-9));
        }
    }

    TEST_CASE("analytic: residuals are compared with the weight, or with B/L^2 where that is more")
    {
        for (const double g : {0.0, 9.81}) {
            const WireSpec spec = nitinol(0.4);
            Rig rig(spec, 21);
            rig.hold({clamp_base()});
            rig.integrate_with({}, {0, 0, -g});
            REQUIRE(rig.settle());
            double mass = 0;
            for (int i = 0; i < rig.rod().n; ++i) mass += rig.rod().mass[i];
            const double bending = spec.shaft.bend_stiffness / 0.16;
            if (g > 0) REQUIRE(mass * g > bending);
            CHECK(rig.reports[0].force_scale == about(g > 0 ? mass * g : bending).epsilon(1e-9));
            CHECK(rig.reports[0].residual <= rig.reports[0].tolerance);
            CHECK(rig.reports[0].tolerance >= IntegratorSpec{}.tolerance * rig.reports[0].force_scale);
        }
    }

    // free tip: P_cr = pi^2 B / (4 L^2); 50 edges: second-order error below 1e-3
    TEST_CASE("analytic: a pushed column stays straight below Euler's load and buckles above")
    {
        const WireSpec spec = nitinol(0.2);
        const double critical = pi * pi * spec.shaft.bend_stiffness / (4 * 0.04);
        double deflection[3];
        for (int k : {0, 1, 2}) {
            Rig rig(spec, 51);
            if (k == 2) {  // from a straight state beyond the load's: the search passes unstable ones before it ends at one
                const double shorter = 1 - 2 * critical / spec.shaft.stretch_stiffness;
                for (double& x : rig.rods.view(0).x) x *= shorter;
            }
            rig.hold({clamp_base()}, {tip_load({-(k == 0 ? 0.97 : 1.03) * critical, 0, 0})});
            rig.integrate_with({});
            REQUIRE(rig.settle());
            deflection[k] = std::hypot(rig.tip().y(), rig.tip().z()) / 0.2;
        }
        // perfectly straight: above the load it is an equilibrium still, but not a stable one. w/L = 0.32 (Timoshenko & Gere,
        // table 2-4, at 1.035)
        CHECK(deflection[0] < 1e-9);
        CHECK(deflection[1] > 0.25);
        CHECK(deflection[2] == about(deflection[1]).epsilon(1e-6));
    }

    TEST_CASE("property: a free wire with nothing to hold it rests where it is; with a load it says that it cannot")
    {
        Rig rig(nitinol(0.1), 21, 1, arc_towards_z(0.05));
        rig.integrate_with({});
        CHECK(rig.settle());  // straightens, momentum-free
        // Straight now, it is an equilibrium in every place: none of its six free motions may be taken for a way downhill.
        const Vec3 rest = rig.tip();
        CHECK(rig.settle());
        CHECK((rig.tip() - rest).norm() < 1e-9 * 0.1);
        double lowest = 1e9, highest = -1e9;
        for (int j = 1; j < 20; ++j) {
            lowest = std::min(lowest, rig.solver->frames(0).kb[j].norm());
            highest = std::max(highest, rig.solver->frames(0).kb[j].norm());
        }
        CHECK(highest < 1e-6);
        const Vec3 before = rig.tip();
        rig.hold({}, {tip_load({0, 0, 1})});
        CHECK_FALSE(rig.settle());
        CHECK(rig.tip() == before);
    }

    // a heavy wire held at the base pointing up falls over to one side and hangs: past two folds of energy
    TEST_CASE("property: prolapse: a wire that stands upright and is too long finds the shape that hangs down")
    {
        WireSpec spec = nitinol(1.0);
        Rig rig(spec, 101, 1, [](double s) { return Vec3(1e-4 * s, 0, s); });
        rig.hold({clamp_base()});
        rig.integrate_with({}, {0, 0, -9.81});
        REQUIRE(rig.settle());
        CHECK(rig.tip().z() < 0);
        MESSAGE("prolapse: " << rig.reports[0].iterations << " iterations");
    }
}

}  // namespace seldinger::test::test_equilibrium
