// How wide the lumen is at a place of its wall, from inscribed spheres of a tapering axis and of one that branches.
#include "wall/wall_model.h"

#include "support/approx.h"

namespace seldinger::test::test_width_of_lumen {

TEST_SUITE("wall/wall_model")
{
    TEST_CASE("analytic: beside a tapering axis it is the radius of the sphere there, on its wall and inside")
    {
        Centreline axis;
        for (int i = 0; i < 9; ++i) {
            axis.points.push_back({0.02 * i, 0, 0});
            axis.radius.push_back(0.008 - 0.0005 * i);
            axis.parent.push_back(i - 1);
        }
        const VesselSpec spec;
        const WallMesh mesh;
        const WallModel wall(spec, mesh, axis);
        CHECK(wall.typical_lumen_radius == about(0.006).epsilon(1e-12));  // of the fifth of nine
        for (std::size_t i = 0; i < axis.points.size(); ++i)
            for (const double share : {1.0, 0.9, 0.5}) {
                CAPTURE(i);
                CAPTURE(share);
                // spheres stand 2.5 radii and more apart: no other one is near
                CHECK(lumen_radius_at(wall, axis.points[i] + share * axis.radius[i] * Vec3(0, 0.6, 0.8)) == axis.radius[i]);
            }
    }

    TEST_CASE("property: a place that spheres of a vessel and of its branch all but touch is as wide as the wider one")
    {
        Centreline axis;
        axis.points = {{0, 0, 0}, {0, 0.0105, 0}};
        axis.radius = {0.008, 0.002};
        axis.parent = {-1, 0};
        const VesselSpec spec;
        const WallMesh mesh;
        const WallModel wall(spec, mesh, axis);
        CHECK(lumen_radius_at(wall, {0, 0.0084, 0}) ==
              0.008);  // inside the small one, 0.4 mm, a twentieth of its radius, off the other
        CHECK(lumen_radius_at(wall, {0, 0.0100, 0}) == 0.002);  // 2 mm off
        CHECK(lumen_radius_at(wall, {0, -0.008, 0}) == 0.008);
    }

    TEST_CASE("property: without an axis there is no limit, and a plane is as wide as it is long")
    {
        const Centreline none;
        const WallMesh mesh;
        VesselSpec spec;
        CHECK(std::isinf(lumen_radius_at(WallModel(spec, mesh, none), {0, 0, 0})));
        spec.shape = VesselShape::Plane;
        spec.size = 0.08;
        CHECK(lumen_radius_at(WallModel(spec, mesh, none), {1, 2, 3}) == 0.04);
    }
}

}  // namespace seldinger::test::test_width_of_lumen
