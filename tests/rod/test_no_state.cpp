// rod/no_state.h: states drawn out or crushed, states only short and misplaced, and what a residual throws.

#include "rod/no_state.h"

#include "rod/rod_fixture.h"

#include <cmath>

namespace seldinger::test::test_no_state {

TEST_SUITE("rod/no_state")
{
    TEST_CASE("property: half of an edge's length is too much either way, of one that is long enough to tell")
    {
        OneWire wire(4);
        const RodView& rod = wire.rod;
        const auto torn = [&](double last, double rest) {
            for (int j = 0; j < 4; ++j) rod.radius[j] = 4e-4;
            for (int j = 0; j < 3; ++j) rod.rest_length[j] = 1e-3;
            rod.rest_length[2] = rest;
            wire.place({{0, 0, 0}, {1e-3, 0, 0}, {2e-3, 0, 0}, {2e-3, last, 0}});
            return is_torn(wire.arrays.view(0));
        };
        CHECK_FALSE(torn(1e-3, 1e-3));
        CHECK_FALSE(torn(1.45e-3, 1e-3));
        CHECK_FALSE(torn(0.55e-3, 1e-3));
        CHECK(torn(1.55e-3, 1e-3));
        CHECK(torn(0.45e-3, 1e-3));
        CHECK_FALSE(torn(3e-6, 1e-9));  // a base edge that has just begun, its node 3 um off: below 0.01 r
        CHECK(torn(3e-4, 1e-9));
    }

    TEST_CASE("analytic: a force that moves a free node by its radius within the step is too much")
    {
        OneWire wire(4);
        const RodView& rod = wire.rod;
        for (int i = 0; i < 4; ++i) rod.mass[i] = (i == 0 || i == 3) ? 1e-5 : 3e-5;  // 2e-5 kg in the mean
        rod.radius[0] = 4e-4;
        const double h = 1e-5, most = 4e-4 * 2e-5 / (h * h);  // 80 N
        CHECK_FALSE(is_thrown(wire.arrays.view(0), 0.999 * most, h));
        CHECK(is_thrown(wire.arrays.view(0), 1.001 * most, h));
        CHECK(is_thrown(wire.arrays.view(0), std::nan(""), h));
    }
}

}  // namespace seldinger::test::test_no_state
