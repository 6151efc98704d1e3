// Points at even arc lengths along polylines.
#include "record/wire_shapes.h"
#include "support/approx.h"

#include <vector>

namespace seldinger::test::test_wire_shapes {

TEST_SUITE("record/wire_shapes")
{
    TEST_CASE("analytic: a corner of edges of 1 and 3 in five points; one point, and points that coincide")
    {
        const std::vector<Vec3> corner = {{0, 0, 0}, {1, 0, 0}, {1, 3, 0}};
        std::vector<double> points;
        put_stations(corner, 5, points);
        const std::vector<double> expected = {0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 2, 0, 1, 3, 0};
        REQUIRE(points.size() == expected.size());
        for (std::size_t i = 0; i < points.size(); ++i) CHECK(points[i] == test::about(expected[i]).epsilon(1e-15));
        for (const std::vector<Vec3>& line : {std::vector<Vec3>{{1, 2, 3}}, std::vector<Vec3>{{1, 2, 3}, {1, 2, 3}}}) {
            points.clear();
            put_stations(line, 3, points);
            CHECK(points == std::vector<double>{1, 2, 3, 1, 2, 3, 1, 2, 3});
        }
    }
}

}  // namespace seldinger::test::test_wire_shapes
