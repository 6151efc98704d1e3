// The force scale: its order must survive on paper.
#include "math/vec3.h"
#include "support/approx.h"
#include "view/colour.h"
#include "view/legend.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger::test::test_colour {

TEST_SUITE("view/colour")
{
    TEST_CASE("analytic: black, white and mid grey of sRGB")
    {
        CHECK(rgb_from_hex(0x000000).g == 0);
        CHECK(rgb_from_hex(0xffffff).r == test::about(1).epsilon(1e-6));
        CHECK(rgb_from_hex(0x808080).b == test::about(0.21586).epsilon(1e-4));     // ((128/255 + 0.055) / 1.055)^2.4
        CHECK(lightness(rgb_from_hex(0xffffff)) == test::about(1).epsilon(1e-4));  // Oklab's white is 1 by definition
        for (std::uint32_t hex : {0x0b69c7u, 0x123456u, 0xfedcbau}) {
            const auto bytes = srgb_bytes(rgb_from_hex(hex));
            CHECK(((std::uint32_t{bytes[0]} << 16) | (std::uint32_t{bytes[1]} << 8) | bytes[2]) == hex);
        }
    }

    TEST_CASE("property: force colours are in gamut and their lightness rises linearly with force")
    {
        for (int i = 0; i <= 100; ++i) {
            CAPTURE(i);
            const Rgb c = force_colour(0.01 * i);
            for (float v : {c.r, c.g, c.b}) {
                CHECK(v >= 0);
                CHECK(v <= 1);
            }
            // Oklab there and back in float: the published matrices invert each other to 1e-6, cubes and roots triple it
            CHECK(lightness(c) == test::about(0.36 + 0.56 * 0.01 * i).epsilon(1e-4));
        }
    }

    TEST_CASE("property: wall colours are in gamut, fall linearly in lightness, and equal steps are about equally far apart")
    {
        // Oklab of linear light, as `lightness`: how far two colours are apart
        const auto oklab = [](const Rgb& c) {
            const float l = std::cbrt(0.4122214708f * c.r + 0.5363325363f * c.g + 0.0514459929f * c.b);
            const float m = std::cbrt(0.2119034982f * c.r + 0.6806995451f * c.g + 0.1073969566f * c.b);
            const float s = std::cbrt(0.0883024619f * c.r + 0.2817188376f * c.g + 0.6299787005f * c.b);
            return Vec3(0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s,
                        1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
                        0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s);
        };
        double least = 1, most = 0;
        for (int i = 0; i <= 50; ++i) {
            CAPTURE(i);
            const Rgb c = wall_colour(0.02 * i);
            for (float v : {c.r, c.g, c.b}) {
                CHECK(v >= 0);
                CHECK(v <= 1);
            }
            CHECK(lightness(c) == test::about(0.94 - 0.58 * 0.02 * i).epsilon(1e-4));  // as above
            if (i == 0) continue;
            const double step = (oklab(c) - oklab(wall_colour(0.02 * (i - 1)))).norm();
            least = std::min(least, step), most = std::max(most, step);
        }
        CHECK(most < 1.15 * least);  // "to a seventh"
        CHECK(lightness(wall_colour(3)) == lightness(wall_colour(1)));
        CHECK(lightness(wall_colour(std::numeric_limits<double>::quiet_NaN())) == lightness(wall_colour(0)));
    }

    TEST_CASE("regression: a force off the scale or not finite has a colour")
    {
        CHECK(lightness(force_colour(7)) == lightness(force_colour(1)));
        CHECK(lightness(force_colour(-1)) == lightness(force_colour(0)));
        CHECK(lightness(force_colour(std::numeric_limits<double>::quiet_NaN())) == lightness(force_colour(0)));
    }

    TEST_CASE("analytic: round numbers above a value")
    {
        CHECK(round_up_125(0.03) == test::about(0.05).epsilon(1e-12));
        CHECK(round_up_125(0.05) == test::about(0.05).epsilon(1e-12));
        CHECK(round_up_125(7) == test::about(10).epsilon(1e-12));
        CHECK(round_force_up(0.111) == test::about(0.12).epsilon(1e-12));
        CHECK(round_force_up(8.1e-4) == test::about(1e-3).epsilon(1e-12));
    }
}

}  // namespace seldinger::test::test_colour
