// The C-arm against the reference's views and against what its words say.
#include "core/error.h"
#include "support/approx.h"
#include "support/shared_folder.h"
#include "xray/c_arm.h"
#include "xray/reference_views.h"

namespace seldinger::test::test_c_arm {

TEST_SUITE("xray/c_arm")
{
    TEST_CASE("analytic: points of the public reference [17_xray/carm]")
    {
        const auto shared = test::shared_folder_or_skip();
        if (!shared) return;
        int checked = 0;
        for (const auto& [arm, points] : test::reference_views(*shared))
            for (const auto& p : points) {
                const CArmPoint at = project(CArmView(arm), Vec3(p["point"][0], p["point"][1], p["point"][2]));
                CHECK(std::abs(at.column - p["column"].get<double>()) < 1e-9);  // allowed: 0.05
                CHECK(std::abs(at.row - p["row"].get<double>()) < 1e-9);
                CHECK(at.magnification == test::about(p["magnification"].get<double>()).epsilon(1e-12));
                ++checked;
            }
        REQUIRE(checked == 36);
    }

    TEST_CASE("analytic: LAO 90 puts the detector at the patient's left, CRA 90 at the head; the head is up from the front")
    {
        CArm arm;
        arm.head = Vec3::UnitX(), arm.back = -Vec3::UnitZ();  // lies on the back along x
        const Vec3 left = arm.back.cross(arm.head);
        CHECK((CArmView(arm).direction - Vec3::UnitZ()).norm() < 1e-15);
        CHECK((CArmView(arm).up - Vec3::UnitX()).norm() < 1e-15);
        set_angles(arm, "LAO 90");
        CHECK((CArmView(arm).direction - left).norm() < 1e-15);
        set_angles(arm, "cra 90");
        CHECK((CArmView(arm).direction - arm.head).norm() < 1e-15);
    }

    TEST_CASE("property: angles are read as they are written")
    {
        CArm arm;
        set_angles(arm, "RAO 20 CAU 10.5");
        CHECK(angle_words(arm) == "RAO 20, CAU 10.5");
        set_angles(arm, "-20, -10.5");
        CHECK(angle_words(arm) == "RAO 20, CAU 10.5");
        for (const char* bad : {"", "LAO", "LAO 30 RAO 20", "LAO 200", "CRA 91", "up 30", "LAO -30", "30", "LAO x"})
            CHECK_THROWS_AS(set_angles(arm, bad), Error);
    }
}

}  // namespace seldinger::test::test_c_arm
