// The virtual coupling (D14): rest, following, energies, and a sampled hand against Colgate's condition.

#include "session/coupling.h"
#include "support/approx.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace seldinger::test::test_coupling {

namespace {

constexpr double dt = 1e-3, no_end = 1e9;

/// A wire's end as a mass on a spring and a damper, stepped by backward Euler with its end where it is asked to be.
struct SpringWire {
    double stiffness, damping, mass;
    double x = 0, v = 0, force = 0;
    [[nodiscard]] HubLoad load() const { return {force, stiffness + damping / dt + mass / (dt * dt), mass}; }
    void move_to(double to)
    {
        const double before = v;
        v = (to - x) / dt;
        x = to;
        force = std::max(stiffness * x, 0.0) + damping * v + mass * (v - before) / dt;
    }
};

/// A hand that holds a device: mass and damping, driven; the force of the last answer is held for a period and `late` periods
/// old.
struct Hand {
    double mass, damping;
    int late;
    double x = 0, v = 0;
    std::vector<double> waiting = {};
    double move(double drive, double felt)
    {
        waiting.push_back(felt);
        const double now =
            waiting.size() > static_cast<std::size_t>(late) ? waiting[waiting.size() - 1 - static_cast<std::size_t>(late)] : 0;
        const int parts = 50;  // of a period, while the force is held
        const double h = dt / parts;
        for (int k = 0; k < parts; ++k) {
            v = (v + h / mass * (drive - now)) / (1 + h * damping / mass);
            x += h * v;
        }
        return x;
    }
};

/// How far the hand swings in the last of `seconds` against a wall of 20 kN/m, pushed with half a newton.
double swing(const CouplingSpec& spec, Hand hand, double seconds = 4)
{
    Coupling coupling(spec, dt);
    SpringWire wire{2e4, 0, 1e-3};
    double low = no_end, high = -no_end, felt = 0;
    for (int k = 0; k < static_cast<int>(seconds / dt); ++k) {
        const double x = hand.move(0.5, felt);
        if (!(std::abs(x) < 1)) return no_end;
        wire.move_to(coupling.next(x, wire.load(), -no_end, no_end));
        coupling.stepped(wire.force);
        felt = coupling.force();
        if (k > (seconds - 1) / dt) low = std::min(low, x), high = std::max(high, x);
    }
    return high - low;
}

}  // namespace

TEST_SUITE("session/coupling")
{
    TEST_CASE("analytic: at rest the hand feels what the wire answers, at the stretch F/k")
    {
        Coupling coupling(advance_coupling, dt);
        SpringWire wire{300, 0, 1e-3};
        for (int k = 0; k < 5000; ++k) {
            wire.move_to(coupling.next(0.01, wire.load(), -no_end, no_end));
            coupling.stepped(wire.force);
        }
        const double k = advance_coupling.stiffness, together = k * 300 / (k + 300);
        CHECK(coupling.force() == test::about(together * 0.01).epsilon(1e-9));
        CHECK(coupling.force() == test::about(wire.force).epsilon(1e-9));
        CHECK(coupling.stretch() == test::about(coupling.force() / k).epsilon(1e-9));
    }

    TEST_CASE("analytic: a free wire that is drawn along steadily is not felt, but for its own friction")
    {
        Coupling coupling(advance_coupling, dt);
        SpringWire wire{0, 3, 2e-3};  // 3 N s/m at 2 cm/s: 60 mN
        for (int k = 0; k < 3000; ++k) {
            wire.move_to(coupling.next(0.02 * dt * k, wire.load(), -no_end, no_end));
            coupling.stepped(wire.force);
        }
        CHECK(wire.force == test::about(0.06).epsilon(1e-6));
        // what the damper takes is thought to grow with every step: force is what the wire will answer plus that share
        CHECK(coupling.force() == test::about(0.06 + 3 * 0.02).epsilon(1e-6));
    }

    TEST_CASE("derivative: the force grows with the hand as force_per_advance says")
    {
        const HubLoad load{0.2, 4000, 1e-3};
        Coupling here(advance_coupling, dt), there(advance_coupling, dt);
        for (Coupling* c : {&here, &there}) {
            (void)c->next(1e-3, load, -no_end, no_end);
            c->stepped(0.2);
        }
        // at the same speed: the hand is farther on from before the step
        const double d = 1e-6, damper = advance_coupling.damping / dt;
        (void)here.next(1.5e-3, load, -no_end, no_end);
        (void)there.next(1.5e-3 + d, load, -no_end, no_end);
        const double whole = advance_coupling.stiffness + damper + load.stiffness;
        const double by_speed = damper * load.stiffness / whole;  // of the move within the step, which is not the position's
        CHECK((there.force() - here.force()) / d == test::about(here.force_per_advance() + by_speed).epsilon(1e-6));
    }

    TEST_CASE("property: what the hand brings in is never less than what is stored and done, for any motion against any wire")
    {
        std::mt19937 draw(3);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (const double stiffness : {0.0, 100.0, 1e4, 1e6}) {
            CAPTURE(stiffness);
            Coupling coupling(advance_coupling, dt);
            SpringWire wire{stiffness, 0.5, 1.5e-3};
            double hand = 0, speed = 0, largest = 0;
            for (int k = 0; k < 200000; ++k) {
                speed = 0.99 * speed + 0.02 * uniform(draw);
                hand = std::clamp(hand + dt * speed, -0.05, 0.05);
                wire.move_to(coupling.next(hand, wire.load(), -no_end, no_end));
                coupling.stepped(wire.force);
                largest = std::max(largest, coupling.energy());
            }
            // rounding: 2e5 terms of some mJ, and the one-sided spring is met with the stiffness of the other side for a step
            CHECK(coupling.lowest_energy() >= -1e-3 * largest);
            CHECK(coupling.energy() > 0);
        }
    }

    TEST_CASE("analytic: the defaults are stable in a hand of 3 N s/m up to Colgate's line, and far beyond it nothing is")
    {
        // a force that is held for T and comes n periods late is k (1/2 + n) T of negative damping
        const double human = 3, mass = 0.15;
        // half a newton goes 25 um into the wall: a stable coupling lies still there, another bounces off
        CHECK(swing(advance_coupling, {mass, human, 0}) < 1e-9);
        CHECK(swing(advance_coupling, {mass, human, 2}) < 1e-9);
        CouplingSpec stiff = advance_coupling;
        stiff.stiffness = 20 * human / (0.5 * dt);
        CHECK(swing(stiff, {mass, human, 0}) > 5e-5);
        CHECK(swing(advance_coupling, {mass, human, 25}) > 5e-5);
    }

    TEST_CASE("property: hub stays within its way and below its speed, and a placed one begins at rest")
    {
        Coupling coupling(advance_coupling, dt);
        double before = 0;
        for (int k = 0; k < 1000; ++k) {
            const double at = coupling.next(0.2, {}, -0.01, 0.03);
            CHECK(at <= 0.03);
            CHECK(at - before <= advance_coupling.speed_limit * dt * (1 + 1e-12));
            before = at;
            coupling.stepped(0);
        }
        CHECK(before == 0.03);
        CHECK(coupling.force_per_advance() == advance_coupling.stiffness);
        const double energy = coupling.energy();
        coupling.place(0);
        CHECK(coupling.force() == 0);
        CHECK(coupling.position() == 0);
        CHECK(coupling.energy() == test::about(energy));
    }
}

}  // namespace seldinger::test::test_coupling
