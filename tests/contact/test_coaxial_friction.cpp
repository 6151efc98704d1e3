// Friction between instruments that share a centreline as a force term: its tangent and its effects.

#include "contact/rods/coaxial_friction.h"
#include "coaxial/merged_fixture.h"
#include "math/banded_solver.h"
#include "world/merged.h"

#include <random>

namespace seldinger::test::test_coaxial_friction {

namespace {

/// Residual of the term in the spins of both instruments, one after the other, at these angles.
std::vector<double> spins_at(CoaxialFriction& friction, RodArrays& rods, TrialState trial, std::span<const double> angles)
{
    const int n = rods.node_count(0);
    for (int w = 0; w < 2; ++w)
        for (int j = 0; j + 1 < n; ++j)
            trial.theta[static_cast<std::size_t>(rods.node_begin(w) + j)] = angles[static_cast<std::size_t>(w * n + j)];
    const std::vector<std::uint8_t> active(2, 1);
    friction.evaluate({trial, 1e-3, active});
    std::vector<double> out;
    for (int w = 0; w < 2; ++w) {
        std::vector<double> residual(static_cast<std::size_t>(RodDofs::count(n)), 0.0);
        friction.add(w, residual, nullptr, false);
        for (int j = 0; j < n; ++j) {
            if (j + 1 < n) out.push_back(residual[static_cast<std::size_t>(RodDofs::spin(j))]);
            else out.push_back(0);
            for (int c = 0; c < 3; ++c) CHECK(residual[static_cast<std::size_t>(RodDofs::position(j, c))] == 0);
        }
    }
    return out;
}

}  // namespace

TEST_SUITE("contact/coaxial friction")
{
    // Cells of 2 mm lie on two edges of 2 mm each, of 9 mm on six: beyond the band
    TEST_CASE("derivative: its tangent is that of its torques, within and beyond the band")
    {
        for (const double cell : {2e-3, 9e-3}) {
            WorldSetup setup = merged_setup({instrument_of({{0.4, 2e-4, 0}}, 0.5), instrument_of({{0.6, 2e-4, 0}}, 0.5)},
                                            {0.0307, 0.04}, 2e-3, Scheme::Newton);
            World world(setup);
            WorldData& data = data_of(world);
            RodArrays& rods = data.state.rods;
            CoaxialGroup& group = data.groups.list[0]->shared;
            CoaxialFriction friction(rods);
            friction.add(group, {0.8, 3.0, 0, 0}, cell);
            const std::vector<std::uint8_t> live(2, 1);
            group.fed = {0, 4e-6};
            friction.prepare(rods, live);
            const int n = rods.node_count(0), size = 2 * n;
            TrialState trial;
            for (auto* list : {&trial.x, &trial.y, &trial.z, &trial.theta})
                list->resize(static_cast<std::size_t>(rods.total_capacity()));
            std::mt19937 random(3);
            std::uniform_real_distribution<double> any(-0.02, 0.02);  // of r = 0.5 mm: 10 um, which is what gives
            std::vector<double> at(static_cast<std::size_t>(size));
            for (double& angle : at) angle = any(random);
            const std::vector<double> torque = spins_at(friction, rods, trial, at);

            DofMap map;
            map.lay_out(std::vector<int>{n, n});
            BandedSolver tangent(map.size());
            tangent.reset(map.size());
            for (int w = 0; w < 2; ++w) {
                std::vector<double> scratch(static_cast<std::size_t>(RodDofs::count(n)));
                BandRows rows = tangent.band.part(map.first(w), RodDofs::count(n));
                friction.add(w, scratch, &rows, false);
            }
            const std::vector<int> wires = {0, 1};
            friction.couple({map, wires}, {}, &tangent, false);

            double most = 0, sum = 0;
            for (const double t : torque) sum += t, most = std::max(most, std::abs(t));
            REQUIRE(most > 1e-7);
            CHECK(std::abs(sum) < 1e-12 * most);  // what one gains the other loses
            const double d = 1e-7;
            int compared = 0;
            for (int q = 0; q < size; ++q) {
                if (q % n == n - 1) continue;
                std::vector<double> column(static_cast<std::size_t>(map.size()), 0.0), moved = at;
                tangent.add_column(map.spin(q / n, q % n), 1, column);
                moved[static_cast<std::size_t>(q)] += d;
                const std::vector<double> more = spins_at(friction, rods, trial, moved);
                moved[static_cast<std::size_t>(q)] -= 2 * d;
                const std::vector<double> less = spins_at(friction, rods, trial, moved);
                for (int p = 0; p < size; ++p) {
                    if (p % n == n - 1) continue;
                    const double slope = (more[static_cast<std::size_t>(p)] - less[static_cast<std::size_t>(p)]) / (2 * d);
                    const double value = column[static_cast<std::size_t>(map.spin(p / n, p % n))];
                    const double stuck = 0.8 / 1e-5 * 2.5e-7 * 2e-3;  // k r^2 of a cell [N m]
                    // differences: curvature (r d/give)^2 = 2.5e-11, rounding of 1e-6 N m over 2 d
                    CHECK(std::abs(slope - value) < 1e-5 * stuck);
                    compared += value != 0;
                }
            }
            CHECK(compared > 60);
        }
    }
}

}  // namespace seldinger::test::test_coaxial_friction
