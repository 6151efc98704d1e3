// rod/torn.h: what is drawn out or crushed, and what is only short and misplaced.

#include "rod/torn.h"

#include "rod/rod_fixture.h"

#include <doctest/doctest.h>

using namespace seldinger;
using namespace seldinger::testing;

TEST_SUITE("rod/torn")
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
}
