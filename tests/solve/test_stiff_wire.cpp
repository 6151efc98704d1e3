// A wire of real stiffness (60 GPa, radius 0.2 mm) at steps of 1, 5 and 16.7 ms with the default settings: every step converges,
// and nothing drifts. Longer runs: bench/long_runs.py.
#include "solve/wire_fixture.h"

namespace seldinger::test::test_stiff_wire {

namespace {

constexpr int nodes = 61;
const Vec3 gravity = {0, 0, -9.81};

WireSpec stiff_wire()
{
    WireSpec spec = nitinol(0.2);
    const double r = 0.0002, youngs = 60e9;
    spec.shaft.radius = r;
    spec.shaft.bend_stiffness = youngs * pi * r * r * r * r / 4;
    spec.shaft.twist_stiffness = spec.shaft.bend_stiffness / 1.33;
    spec.shaft.stretch_stiffness = youngs * pi * r * r;
    return spec;
}

double total_energy(Rig& rig)
{
    return rig.solver->elastic_energy(0) + rig.solver->kinetic_energy(0) + rig.solver->potential_energy(0);
}

}  // namespace

TEST_SUITE("solve/stiff_wire")
{
    TEST_CASE("property: from its equilibrium, with a shaped tip and a turned base, the wire stays where it is")
    {
        for (const double h : {1e-3, 5e-3, 1.0 / 60}) {
            CAPTURE(h);
            WireSpec spec = stiff_wire();
            WireSection tip = spec.shaft;
            tip.rest_curvature = {150, 0};
            spec.sections.push_back({0, 0.01, tip});
            Rig rig(spec, nodes);
            HoldSpec base = clamp_base();
            base.turn = {{0, 0}, {0.001, 1}};
            rig.hold({base});
            rig.integrate_with({}, gravity);
            REQUIRE(rig.settle());
            rig.time = 1;  // the base has been turned
            const Vec3 start = rig.tip();
            double moved = 0;
            for (int k = 0; k < 300; ++k) {
                REQUIRE(rig.step(h));
                moved = std::max(moved, (rig.tip() - start).norm());
            }
            // what the residual allowed at each node does at the tip of a cantilever
            const double allowed = nodes * rig.reports[0].tolerance * std::pow(spec.length, 3) / (3 * spec.shaft.bend_stiffness);
            CHECK(moved <= allowed);
            CHECK(allowed < 1e-5);
        }
    }

    // Backward Euler only loses energy. A step's residual is at most the tolerance of the weight W at each node. It does work
    // of that times the node's move, which is less than the sag: n 1e-6 of W sag.
    TEST_CASE("property: let go level it swings, converges at every step and gains no energy")
    {
        for (const bool conserve : {false, true})
            for (const double h : {1e-3, 5e-3, 1.0 / 60}) {
                CAPTURE(conserve);
                CAPTURE(h);
                const WireSpec spec = stiff_wire();
                Rig rig(spec, nodes);
                rig.hold({clamp_base()});
                IntegratorSpec integrator;
                integrator.conserve = conserve;
                if (conserve) integrator.tolerance = 1e-9;
                rig.integrate_with(integrator, gravity);
                double before = 0, lowest = 0, gained = 0, off = 0, mass = 0;
                for (int i = 0; i < nodes; ++i) mass += rig.rod().mass[i];
                int iterations = 0;
                const int steps = 300;
                for (int k = 0; k < steps; ++k) {
                    REQUIRE(rig.step(h));
                    iterations += rig.reports[0].iterations;
                    const double energy = total_energy(rig);
                    if (k == 0) before = energy;
                    gained = std::max(gained, energy - before);
                    if (!conserve) before = energy;
                    off = std::max(off, std::abs(energy - before));
                    lowest = std::min(lowest, rig.tip().z());
                }
                const double scale = mass * 9.81 * -lowest, a_step = nodes * integrator.tolerance;
                REQUIRE(-lowest > 0.01);  // it did swing
                CHECK(gained <= a_step * (conserve ? steps : 1) * scale);
                if (conserve) CHECK(off <= a_step * steps * scale);
                CHECK(iterations <= 3 * steps);
            }
    }
}

}  // namespace seldinger::test::test_stiff_wire
