// Numbers in a picture of inlets: near their places, over no arrow and over no other number.
#include "view/inlet_picture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace seldinger::test::test_inlet_picture {

namespace {

constexpr double disc = 14;  // radius of a number [pixels]

double distance(const PictureStroke& stroke, const PicturePoint& p)
{
    double least = 1e9;
    for (int k = 0; k <= 1000; ++k) {
        const double t = k / 1000.0;
        least = std::min(least, std::hypot(stroke.from.x + t * (stroke.to.x - stroke.from.x) - p.x,
                                           stroke.from.y + t * (stroke.to.y - stroke.from.y) - p.y));
    }
    return least;
}

}  // namespace

TEST_SUITE("view/inlet_picture")
{
    TEST_CASE("property: numbers lie over no arrow and over no other number, near their places, within the picture")
    {
        // an inlet's arrow ends where the branch does; two more come in beside it, and one lies in a corner
        const std::vector<PictureStroke> arrows = {
            {{200, 100}, {200, 145}}, {{215, 100}, {215, 145}}, {{5, 5}, {40, 30}}, {{170, 150}, {215, 150}}};
        const std::vector<PicturePoint> wanted = {{200, 70},  {215, 70}, {5, 5},     {150, 150}, {200, 145},
                                                  {215, 145}, {40, 30},  {215, 150}, {215, 150}};
        const std::vector<PicturePoint> placed = place_numbers(wanted, arrows, 640, 480);
        REQUIRE(placed.size() == wanted.size());
        for (std::size_t k = 0; k < placed.size(); ++k) {
            CAPTURE(k);
            for (const PictureStroke& arrow : arrows) CHECK(distance(arrow, placed[k]) >= disc);
            for (std::size_t j = 0; j < k; ++j)
                CHECK(std::hypot(placed[k].x - placed[j].x, placed[k].y - placed[j].y) >= 2 * disc - 1e-9);
            CHECK(std::hypot(placed[k].x - wanted[k].x, placed[k].y - wanted[k].y) < 100);
            CHECK(placed[k].x >= disc);
            CHECK(placed[k].y >= disc);
        }
        CHECK(placed[0].x == 200);  // what is free stays where it is wanted
        CHECK(placed[0].y == 70);
    }

    TEST_CASE("property: where there is no room, numbers are still in the picture")
    {
        const std::vector<PicturePoint> wanted(60, {30, 30});
        for (const PicturePoint& p : place_numbers(wanted, {}, 60, 60)) {
            CHECK(p.x >= disc);
            CHECK(p.x <= 60 - disc);
            CHECK(p.y >= disc);
            CHECK(p.y <= 60 - disc);
        }
    }
}

}  // namespace seldinger::test::test_inlet_picture
