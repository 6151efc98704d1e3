// What `seldinger init` says of the way that it proposes.
#include "setup/first_scene.h"
#include "support/approx.h"

namespace seldinger::test::test_first_scene {

namespace {

/// 100 mm along x, a lumen of 5 mm radius; of another radius in its middle.
WayThrough straight_way(double middle)
{
    Centreline line;
    for (int i = 0; i <= 100; ++i) {
        line.points.emplace_back(1e-3 * i, 0.002, 0);
        line.radius.push_back(i == 50 ? middle : 5e-3);
        line.parent.push_back(i - 1);
    }
    Inlet inlet;
    inlet.point = line.points.front(), inlet.direction = Vec3::UnitX(), inlet.radius = 5e-3;
    return way_through(line, inlet);
}

}  // namespace

TEST_CASE("A stenosis is told with its radius")
{
    const WayThrough way = straight_way(3e-4);
    CHECK(way.narrowest == 3e-4);
    CHECK(way.narrowest_at == test::about(0.05));
    CHECK(choose_wire(way, "").why.find("the narrowest lumen on the longest way has a radius of 0.3 mm") != std::string::npos);
}

TEST_CASE("A place where two parts of a mesh only touch is told with where it is, not as a lumen")
{
    const std::string why = choose_wire(straight_way(1.3e-7), "").why;
    CHECK(why.find("as good as closed 50 mm from its beginning, at [50.00, 2.00, 0.00] mm") != std::string::npos);
    CHECK(why.find("it gets 50 mm far") != std::string::npos);
}

}  // namespace seldinger::test::test_first_scene
