// Named views, the tip's view, cameras that move, and what a wire is coloured by.
#include "support/approx.h"
#include "support/refusal.h"
#include "support/skip.h"
#include "view/colour.h"
#include "view/force_load.h"
#include "view/viewpoint.h"
#include "view_fixtures.h"

#include <algorithm>

namespace seldinger::test::test_viewpoint {

namespace {

struct Fixture {
    WallMesh wall = straight_tube(0.006, 0.1);
    WireFrame frame;
    Scenery scenery;
    Fixture()
    {
        frame.wires = {straight_wire({0.01, 0, 0}, {-0.05, 0, 0}, 0.0004)};
        frame.time = 1;
        scenery = {&wall, frame.wires[0].nodes, {}, 0, 2};
    }
    [[nodiscard]] Camera camera(ViewFrom from, const std::string& motion = "") const
    {
        return frame_camera(scenery, from, motion.empty() ? CameraMotion{} : parse_motion(motion), frame, 1.5);
    }
};

bool same(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-9; }

}  // namespace

TEST_SUITE("view/viewpoint")
{
    TEST_CASE("analytic: named views look along the patient's axes, whichever way the patient lies")
    {
        Fixture f;
        for (const PatientAxes& patient : {PatientAxes{}, PatientAxes{Vec3::UnitX(), -Vec3::UnitZ()}}) {
            f.scenery.patient = patient;
            const Vec3 &head = patient.head, &back = patient.back, left = patient.left();
            CHECK(same(f.camera(ViewFrom::Front).forward(), back));
            CHECK(same(f.camera(ViewFrom::Front).right(), left));  // the patient's left is on the picture's right
            CHECK(same(f.camera(ViewFrom::Back).forward(), -back));
            CHECK(same(f.camera(ViewFrom::Left).forward(), -left));
            CHECK(same(f.camera(ViewFrom::Right).forward(), left));
            CHECK(same(f.camera(ViewFrom::Top).forward(), -head));
            CHECK(same(f.camera(ViewFrom::Bottom).forward(), head));
            for (const ViewFrom from : {ViewFrom::Front, ViewFrom::Left, ViewFrom::Back})
                CHECK(f.camera(from).up.dot(head) > 0.99);
        }
    }

    TEST_CASE("property: the endoscopic view looks out of the tip along the wire, also where that is the head's direction")
    {
        Fixture f;
        Camera c = f.camera(ViewFrom::Endoscopic);
        CHECK(same(c.forward(), Vec3::UnitX()));
        CHECK((c.eye - f.frame.wires[0].nodes[0]).norm() < 0.0005);
        CHECK(c.nearest > 0);
        CHECK(c.nearest <= 0.1 * f.frame.wires[0].radius[0]);  // a tip on the wall is one radius away from it
        f.frame.wires = {straight_wire({0, 0, 0.05}, {0, 0, 0}, 0.0004)};
        c = f.camera(ViewFrom::Endoscopic);
        CHECK(same(c.forward(), Vec3::UnitZ()));
        CHECK(c.right().allFinite());
        f.frame.wires.clear();
        CHECK_THROWS_AS((void)f.camera(ViewFrom::Endoscopic), Error);
    }

    TEST_CASE("regression: the endoscopic view of a tip that lies on the wall shows wall below it, not what is behind")
    {
        Look look = bare_look();
        look.background_top = look.background_bottom = 0x00ff00;
        const auto r = renderer_or_skip(320, 240, look);
        if (!r) return;
        constexpr double radius = 0.0004, lumen = 0.003;
        Fixture f;
        f.wall = straight_tube(lumen, 0.4);
        f.frame.wires = {straight_wire({0, 0, radius - lumen}, {-0.1, 0, radius - lumen}, radius)};
        r->set_wall(f.wall);
        r->set_camera(f.camera(ViewFrom::Endoscopic));
        r->draw(f.frame);
        int green = 0;  // the floor is one radius below the eye: in the lower half of a view 90 degrees high
        for (int row = 150; row < 240; ++row)
            for (int column = 0; column < 320; ++column) {
                const Pixel p = pixel_at(*r, column, row);
                green += p.g - std::max(p.r, p.b) > 100;
            }
        CHECK(green == 0);
    }

    TEST_CASE("property: moves depend on the frame's time; half of an orbit looks from behind, keys are met and zoomed")
    {
        Fixture f;
        const Camera front = f.camera(ViewFrom::Front), orbit = f.camera(ViewFrom::Front, "orbit");  // at half of the run's time
        CHECK(same(orbit.forward(), -front.forward()));
        CHECK(same(f.camera(ViewFrom::Front, "orbit -180").forward(), f.camera(ViewFrom::Front, "0s 0 0; 1s -90 0").forward()));
        const Camera lifted = f.camera(ViewFrom::Front, "0s 0 0; 2s 0 60 3");  // half way: 30 degrees up, twice as near
        CHECK(lifted.forward().dot(front.forward()) == about(std::cos(std::numbers::pi / 6)));
        CHECK(lifted.eye.z() > front.eye.z());
        CHECK((lifted.eye - lifted.target).norm() == about(0.5 * (front.eye - front.target).norm()));
        const Camera follow = f.camera(ViewFrom::Front, "follow 40 mm");
        CHECK(same(follow.target, f.frame.wires[0].nodes[0]));
        const Viewport view{0, 0, 600, 400};
        CHECK(pixels_per_metre(follow, view, (follow.eye - follow.target).norm()) == about(400 / 0.04));
    }

    TEST_CASE("regression: a move that is none is refused in one line with examples")
    {
        for (const char* text : {"", "spin", "orbit round", "follow 0", "follow 3 km", "0s", "0 0 0", "1s 0 0; 1s 9 9",
                                 "0s 0 0 0", "0s 0 0 1 7", "0s x 0"}) {
            CAPTURE(text);
            check_refused([&] { return parse_motion(text); }, {"orbit [DEGREES]"}, ErrorKind::BadScene);
        }
    }

    TEST_CASE("property: force per length does not depend on how densely a wire is sampled for contact, and sums up to the force")
    {
        std::vector<double> peaks;
        for (const int samples : {40, 80, 320}) {
            Fixture f;
            f.frame.wires = {straight_wire({0.03, 0, 0}, {-0.03, 0, 0}, 0.0004, 241)};  // a node every 0.25 mm
            for (int k = 0; k < samples; ++k)                                           // 1 N over 20 mm, in the middle
                f.frame.contacts.push_back({{0.02 * ((k + 0.5) / samples - 0.5), 0, 0.0004}, Vec3::UnitZ(), 1.0 / samples});
            const FrameLoads loads = loads_of(f.frame);
            double sum = 0;
            for (const double load : loads.nodes) sum += load * 0.06 / 240;
            CHECK(sum == about(1.0).epsilon(0.01));  // the triangle's integral by 20 points a side
            peaks.push_back(loads.largest);
        }
        for (const double peak : peaks) CHECK(peak == about(50.0).epsilon(0.01));  // 1 N / 20 mm
        WireFrame none;
        CHECK(loads_of(none).largest == 0);
    }

    TEST_CASE("property: the scale of force per length gives its lower quarter half of the colours")
    {
        CHECK(load_share(5, 20) == about(0.5));  // low values use half of the scale
        CHECK(lightness(load_colour(0.5)) > lightness(load_colour(0.2)));
    }
}

}  // namespace seldinger::test::test_viewpoint
