// Several wires solved together: wires without coupling move as they would alone, and couplings are solved exactly.
#include "math/banded_solver.h"
#include "newton/system_problem.h"
#include "solve/wire_fixture.h"

#include <array>

namespace seldinger::test::test_systems {

namespace {

/// A spring of no length between node a of wire 0 and node b of wire 1: E = k |x_a - x_b|^2/2. With `mean`, its force is that at
/// the mean of the step's start and end, which does the work -(E+ - E-): what an energy-momentum step takes.
class Spring : public ForceTerm {
public:
    Spring(RodArrays& rods, int a, int b, double stiffness, bool mean = false)
        : rods_(rods), node_{a, b}, stiffness_(stiffness), mean_(mean)
    {
        traits_.follows_spins = traits_.may_jump = false;
    }
    void begin_step(RodArrays& rods, Settling) override { start_ = rods.view(0).pos(node_[0]) - rods.view(1).pos(node_[1]); }
    void evaluate(const TermTrial& trial) override
    {
        const auto at = [&](int wire) {
            const int i = rods_.node_begin(wire) + node_[wire];
            return Vec3(trial.at.x[i], trial.at.y[i], trial.at.z[i]);
        };
        apart_ = at(0) - at(1);
    }
    void add(int wire, std::span<double>, BandRows* tangent, bool) const override
    {
        for (int c = 0; c < RodDofs::coordinates && tangent; ++c) {
            const int at = RodDofs::position(node_[wire], c);
            tangent->add(at, at, slope());
        }
    }
    void couple(const SystemUnknowns& system, std::span<double> residual, BandedSolver* tangent,
                bool /*symmetric*/) const override
    {
        const int wire_a = system.rod_of(0), wire_b = system.rod_of(1);
        if (wire_a < 0 || wire_b < 0) return;
        for (int c = 0; c < RodDofs::coordinates; ++c) {
            const int a = system.map.position(wire_a, node_[0], c), b = system.map.position(wire_b, node_[1], c);
            residual[a] -= force()[c];
            residual[b] += force()[c];
            if (!tangent) continue;
            tangent->far.add(a, b, -slope()), tangent->far.add(b, a, -slope());
        }
    }

    [[nodiscard]] double slope() const { return (mean_ ? 0.5 : 1.0) * stiffness_; }
    [[nodiscard]] Vec3 force() const { return -stiffness_ * (mean_ ? Vec3(0.5 * (start_ + apart_)) : apart_); }  // on wire 0
    [[nodiscard]] double energy() const { return 0.5 * stiffness_ * apart_.squaredNorm(); }

private:
    RodArrays& rods_;
    int node_[2];
    double stiffness_;
    bool mean_;
    Vec3 start_ = Vec3::Zero(), apart_ = Vec3::Zero();
};

constexpr int together[] = {2};

/// Two equal wires side by side, 1 mm apart in y.
void set_apart(Rig& rig)
{
    place_nodes(rig.rod(1), rig.wire, [](double s) { return Vec3(s, 1e-3, 0); });
}

}  // namespace

TEST_SUITE("solve/systems")
{
    // Either way every wire's residual ends below its own tolerance T, but a system's iterations are its worst wire's: the other
    // one may be solved further than alone. Two solutions of a step with residuals below T differ by M^-1 h^2 2T at most on a
    // node, and by 2 T h/m in velocity. The latter add up: n^2 T h^2/m after n steps. Bending holds against that, it does not
    // add.
    TEST_CASE("property: two wires that nothing couples move in one system as they do apart")
    {
        const auto swing = [](Rig& rig, std::span<const int> partition) {
            set_apart(rig);
            for (int i = 0; i < 21; ++i) rig.rod(1).set_vel(i, {0, 0, 0.2 * (20 - i) / 20.0});
            rig.hold({clamp_base()});
            rig.integrate_with({}, {0, 0, -9.81}, partition);
        };
        Rig apart(nitinol(0.1), 21, 2), joined(nitinol(0.1), 21, 2);
        swing(apart, {});
        swing(joined, together);
        const int steps = 50;
        const double h = 1e-3;
        double farthest = 0, moved = 0;
        for (int k = 1; k <= steps; ++k) {
            REQUIRE(apart.step(h));
            REQUIRE(joined.step(h));
            REQUIRE(joined.reports[1].converged);
            for (int w = 0; w < 2; ++w) {
                CHECK(joined.reports[w].residual <= joined.reports[w].tolerance);
                for (int i = 0; i < 21; ++i) {
                    farthest = std::max(farthest, (apart.rod(w).pos(i) - joined.rod(w).pos(i)).norm());
                    moved = std::max(moved, std::abs(joined.rod(w).z[i]));
                }
            }
        }
        REQUIRE(moved > 3e-3);
        const double mass = apart.rod(0).mass[0];  // of an end, the lightest
        CHECK(farthest < steps * steps * joined.reports[0].tolerance * h * h / mass);
    }

    TEST_CASE("property: a wire that takes no part leaves the other one of its system as it is alone, bit for bit")
    {
        Rig alone(nitinol(0.1), 21), joined(nitinol(0.1), 21, 2);
        for (Rig* rig : {&alone, &joined}) {
            rig->hold({clamp_base()});
            rig->integrate_with({}, {0, 0, -9.81}, rig == &joined ? std::span<const int>(together) : std::span<const int>());
        }
        joined.active = {0, 1};
        std::vector<Vec3> placed;
        for (int i = 0; i < 21; ++i) placed.push_back(joined.rod(0).pos(i));
        for (int k = 0; k < 20; ++k) {
            REQUIRE(alone.step(1e-3));
            joined.step(1e-3);
            REQUIRE(joined.reports[1].converged);
        }
        REQUIRE(alone.tip().z() < -1e-4);
        for (int i = 0; i < 21; ++i) {
            CHECK(joined.rod(1).pos(i) == alone.rod().pos(i));
            CHECK(joined.rod(0).pos(i) == placed[i]);
        }
    }

    // The force in the spring, as a dead load on either wire alone, bends it to the same shape: an equilibrium found without
    // the coupling. Small deflections: F = k gap/(1 + 2 k/k_beam), k_beam = 3 B/L^3, to (gap/L)^2 and the clamp's and nodes'
    // (1/n)^2.
    TEST_CASE("analytic: two cantilevers with a spring between their tips meet where beam theory says")
    {
        const int n = 41;
        Rig pair(nitinol(0.1), n, 2);
        set_apart(pair);
        pair.hold({clamp_base()});
        pair.integrate_with({}, Vec3::Zero(), together);
        const double beam = 3 * pair.wire.shaft.bend_stiffness / std::pow(0.1, 3);
        for (const double ratio : {0.5, 1e4}) {  // soft, and one that all but ties the tips together
            CAPTURE(ratio);
            Spring spring(pair.rods, 0, 0, ratio * beam);
            REQUIRE(pair.settle(spring));
            REQUIRE(pair.reports[1].converged);
            CHECK(pair.reports[0].iterations <= 8);
            const double force = spring.force().norm(), gap = 1e-3;
            CHECK(force == about(ratio * beam * gap / (1 + 2 * ratio)).epsilon(1e-3));
            for (int w = 0; w < 2; ++w) {
                Rig one(nitinol(0.1), n);
                if (w == 1) place_nodes(one.rod(), one.wire, [](double s) { return Vec3(s, 1e-3, 0); });
                one.hold({clamp_base()}, {tip_load(w == 0 ? spring.force() : Vec3(-spring.force()))});
                one.integrate_with({});
                REQUIRE(one.settle());
                // both to their tolerances over the beam's stiffness, a force on each node
                const double allowed = n * (one.reports[0].tolerance + pair.reports[w].tolerance) / beam;
                for (int i = 0; i < n; ++i) CHECK((one.rod().pos(i) - pair.rod(w).pos(i)).norm() < allowed);
            }
        }
    }

    // Momentum: the residual on the free nodes, n tolerances a step. Energy: elastic, kinetic and the spring's change by the
    // work of those residuals, and by rounding.
    TEST_CASE("property: two free wires on a spring keep their momentum and energy")
    {
        const int n = 21;
        Rig rig(nitinol(0.1), n, 2);
        set_apart(rig);
        for (int i = 0; i < n; ++i) rig.rod(1).set_vel(i, {0, 0.1, 0.3 * i / n});
        IntegratorSpec spec;
        spec.conserve = true;
        rig.integrate_with(spec, Vec3::Zero(), together);
        Spring spring(rig.rods, 10, 10, 20, true);  // 20 mN at 1 mm
        const auto momentum_of_both = [&] {
            Vec3 sum = Vec3::Zero();
            for (int w = 0; w < 2; ++w)
                for (int i = 0; i < n; ++i) sum += rig.rod(w).mass[i] * rig.rod(w).vel(i);
            return sum;
        };
        const auto energy = [&] {
            double sum = spring.energy();
            for (int w = 0; w < 2; ++w) sum += rig.solver->elastic_energy(w) + rig.solver->kinetic_energy(w);
            return sum;
        };
        const double h = 1e-3;
        const Vec3 momentum_before = momentum_of_both();
        double expected = 0, most_force = 0, allowed_momentum = 0;
        for (int k = 0; k < 200; ++k) {
            spring.begin_step(rig.rods, Settling::Off);
            REQUIRE(rig.step(h, spring));
            CHECK(rig.reports[0].iterations <= 6);
            most_force = std::max(most_force, spring.force().norm());
            allowed_momentum += 2 * n * std::sqrt(3.0) * h * rig.reports[0].tolerance;
            if (k == 0) expected = energy();
            else expected += rig.solver->residual_work(0) + rig.solver->residual_work(1);
            CHECK(std::abs(energy() - expected) < 1e-9 * expected);
        }
        REQUIRE(most_force > 100 * rig.reports[0].tolerance);
        CHECK((momentum_of_both() - momentum_before).norm() < allowed_momentum);
        REQUIRE(allowed_momentum < 1e-2 * momentum_before.norm());
    }
}

}  // namespace seldinger::test::test_systems
