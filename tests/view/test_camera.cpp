// Where points land, and that the automatic camera holds the vessel and no more.
#include "support/approx.h"
#include "view/camera.h"
#include "view_fixtures.h"

#include <algorithm>

namespace seldinger::test::test_camera {

TEST_SUITE("view/camera")
{
    TEST_CASE("analytic: a pinhole of 90 degrees maps one unit aside at one unit ahead to the edge")
    {
        Camera camera;
        camera.eye = {0, 0, 0};
        camera.target = {0, 2, 0};
        camera.up = {0, 0, 1};
        camera.fov_y = std::numbers::pi / 2;
        const Viewport view = {10, 20, 400, 200};
        const Projected top = project(camera, view, {0, 1, 1}), right = project(camera, view, {1, 1, 0});
        // exact up to rounding of tan(pi/4)
        CHECK(top.column == about(210).epsilon(1e-12));
        CHECK(top.row == about(20).epsilon(1e-12));
        CHECK(right.column == about(310).epsilon(1e-12));
        CHECK(right.row == about(120).epsilon(1e-12));
        CHECK(right.depth == about(1).epsilon(1e-12));
    }

    TEST_CASE("property: the fitted camera holds every point and touches the margin on both sides of the tighter axis")
    {
        const WallMesh mesh = straight_tube(0.004, 0.1, {0.3, -0.2, 0.7});
        const Viewport view = {0, 0, 800, 600};
        const double margin = 0.06;
        for (const Vec3& forward : {Vec3(0, 1, 0), Vec3(0.3, 0.8, -0.2), Vec3(-0.5, 0.1, 0.9)}) {
            CAPTURE(forward.x());
            const Camera camera = fit_camera(mesh.vertices, forward, {0.1, 0.2, 1}, 800.0 / 600.0, 0.35, margin);
            double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
            for (const Vec3& v : mesh.vertices) {
                const Projected p = project(camera, view, v);
                REQUIRE(p.depth > 0);
                left = std::min(left, p.column), right = std::max(right, p.column);
                top = std::min(top, p.row), bottom = std::max(bottom, p.row);
            }
            // closed form: rounding only, 1e-6 of a pixel is generous
            const double free_x = 400 * margin, free_y = 300 * margin;
            CHECK(left >= free_x - 1e-6);
            CHECK(right <= 800 - free_x + 1e-6);
            CHECK(top >= free_y - 1e-6);
            CHECK(bottom <= 600 - free_y + 1e-6);
            const bool tight_x = std::abs(left - free_x) < 1e-6 && std::abs(right - 800 + free_x) < 1e-6;
            const bool tight_y = std::abs(top - free_y) < 1e-6 && std::abs(bottom - 600 + free_y) < 1e-6;
            CHECK((tight_x || tight_y));
        }
    }

    TEST_CASE("property: an open sheet is seen from its lumen side, and a tube lies across the picture")
    {
        WallMesh sheet;  // normal +z
        sheet.vertices = {{0, 0, 0}, {0.2, 0, 0}, {0.2, 0.1, 0}, {0, 0.1, 0}};
        sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
        CHECK(automatic_camera(sheet, {}, 1.6).forward().z() < -0.99);
        for (std::array<std::int32_t, 3>& t : sheet.triangles) std::swap(t[1], t[2]);
        CHECK(automatic_camera(sheet, {}, 1.6).forward().z() > 0.99);

        // a vertical tube in a wide picture would be small: the long axis goes along the rows although gravity would be up
        WallMesh tube = straight_tube(0.01, 0.4);
        for (Vec3& v : tube.vertices) v = Vec3(v.y(), v.z(), v.x());
        const Camera camera = automatic_camera(tube, {}, 1.6);
        CHECK(std::abs(camera.right().z()) > 0.99);
        CHECK(std::abs(camera.forward().z()) < 0.01);
    }

    TEST_CASE("regression: one point, no point and a wire seen end-on give a usable camera")
    {
        const std::vector<std::vector<Vec3>> cases = {{}, {{1, 2, 3}}, {{0, 0, 0}, {0, 0.3, 0}}};
        for (const std::vector<Vec3>& points : cases) {
            for (const Camera& camera : {fit_camera(points, {0, 1, 0}, {0, 0, 1}, 1.5), automatic_camera({}, points, 1.5)}) {
                CHECK(camera.eye.allFinite());
                CHECK(camera.target.allFinite());
                CHECK(camera.right().allFinite());
                for (const Vec3& p : points) CHECK(project(camera, {0, 0, 300, 200}, p).depth > 0);
            }
        }
    }
}

}  // namespace seldinger::test::test_camera
