// Energy-momentum steps: what they keep, at which order they converge, and where the trapezoid does not hold.
#include "solve/wire_fixture.h"

using namespace seldinger;
using namespace seldinger::testing;

namespace {

/// Tight, so that what is seen is the scheme: each step's residual does work of the residual times the move.
IntegratorSpec conserving(double tolerance = 1e-11)
{
    IntegratorSpec spec;
    spec.conserve = true;
    spec.tolerance = tolerance;
    return spec;
}

double total_energy(Rig& rig)
{
    return rig.solver->elastic_energy(0) + rig.solver->kinetic_energy(0) + rig.solver->potential_energy(0);
}

/// Deflected by a tip load to `amplitude` and let go.
void pluck(Rig& rig, double amplitude)
{
    const double load = 3 * rig.wire.shaft.bend_stiffness * amplitude / std::pow(rig.wire.length, 3);
    rig.hold({clamp_base()}, {tip_load({0, 0, load})});
    rig.integrate_with({});
    REQUIRE(rig.settle());
    rig.hold({clamp_base()});
    for (WireConstraints& c : rig.constraints) c.loads.clear();
}

}  // namespace

TEST_SUITE("solve/conserving") {

TEST_CASE("property: a clamped wire let go from a fifth of its length keeps its energy at any step") {
    for (const double h : {1e-4, 1e-3, 5e-3}) {
        CAPTURE(h);
        Rig rig(nitinol(0.1), 41);
        pluck(rig, 0.02);
        const WireHolds kept = rig.holds[0];
        rig.integrate_with(conserving());
        double start = 0, largest = 0;
        int evaluations = 0;
        const int steps = 300;
        for (int k = 0; k < steps; ++k) {
            REQUIRE(rig.step(h));
            evaluations += rig.reports[0].evaluations;
            const double now = total_energy(rig);
            if (k == 0) start = now;
            largest = std::max(largest, std::abs(now / start - 1));
        }
        MESSAGE("h " << h << " s: energy within " << largest << ", " << evaluations / double(steps) << " evaluations a step");
        CHECK(largest < 1e-8);
    }
}
}
