// The inserted length is the fed one, by steps from rest to rest whatever their length in time is.

#include "coaxial/merged_fixture.h"
#include "world/merged.h"
#include "world/world.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_merged_length {

namespace {

/// 0.2 m in steps of `by`. @return the most that the line of wire 0 has been longer or shorter than it has been fed [m]
double most_off(const WorldSetup& setup, const std::vector<double>& from, const std::vector<double>& share, double by, double dt)
{
    World world(setup);
    double most = 0;
    for (int k = 1; k * by <= 0.2; ++k) {
        Control control;
        for (int w = 0; w < world.wire_count(); ++w) control.move_to(w, from[w] + share[w] * k * by, 0);
        REQUIRE_FALSE(step(world, control, dt).failed());
        WorldData& data = data_of(world);
        const RodView line = data.rod(0);
        const double fed = data.groups.list.empty() ? data.feed(0).advance : data.groups.list[0]->feed.advance;
        most = std::max(most, std::abs(line.material_s[line.n - 1] - fed));
    }
    return most;
}

}  // namespace

TEST_SUITE("coaxial/merged length")
{
    // Hanging and curved, so that births at the hub are at an angle to it and leave a surplus of rest length. It is (kappa
    // h)^2/24 of an edge of 4 to 10 mm each, 0.2 to 8 um at 25/m, for each birth within a step, until the next step takes it
    // back.
    TEST_CASE("property: static steps leave a line as long as it is in")
    {
        const WireSpec catheter = instrument_of(0.6, 2e-4, 1.5e-4, 0.03, 15), wire = instrument_of(0.8, 1e-4, 7.7e-5, 0.02, 25);
        for (const bool adaptive : {false, true})
            for (const double dt : {1e-3, 1e-2, 1.0})
                for (const double by : {1e-3, 5e-3, 0.02}) {
                    CAPTURE(adaptive);
                    CAPTURE(dt);
                    CAPTURE(by);
                    WorldSetup pair = merged_setup({catheter, wire}, {0.05, 0.06}, 4e-3),
                               alone = merged_setup({wire}, {0.06}, 4e-3);
                    alone.coaxial.clear();
                    for (WorldSetup* setup : {&pair, &alone}) {
                        setup->gravity = {0, 0, -9.81};
                        for (WireSetup& w : setup->wires) {
                            w.wire.nodes = adaptive ? 0 : w.wire.nodes;
                            w.wire.min_edge = 1e-3;
                            w.wire.max_edge = 1e-2;
                        }
                    }
                    const double allowed = 30e-6;
                    for (const std::vector<double>& share : {std::vector{1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}})
                        CHECK(most_off(pair, {0.05, 0.06}, share, by, dt) < allowed);
                    CHECK(most_off(alone, {0.06}, {1}, by, dt) < allowed);
                }
    }
}

}  // namespace seldinger::test::test_merged_length
