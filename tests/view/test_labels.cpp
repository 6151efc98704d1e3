// What labels say about a picture, against the geometry that the picture is drawn with.
#include "view/labels.h"
#include "support/shared_folder.h"
#include "view/view_fixtures.h"
#include "view/xray/device_paths.h"
#include "view/xray/reference_views.h"

#include <doctest/doctest.h>

#include <numbers>
#include <random>

using namespace seldinger;

namespace {

constexpr double degree = std::numbers::pi / 180;

std::array<double, 2> pixel_by(const Projection& p, const Vec3& x)
{
    std::array<double, 3> h{};
    for (std::size_t i = 0; i < 3; ++i) h[i] = p[i][0] * x.x() + p[i][1] * x.y() + p[i][2] * x.z() + p[i][3];
    return {h[0] / h[2], h[1] / h[2]};
}

/// A square detector with `side` pixels of this size at the isocentre.
CArm arm_of(int side, double pixel)
{
    CArm arm;
    arm.columns = arm.rows = side;
    arm.field = side * pixel * arm.sid / arm.sod;
    return arm;
}

WireFrame frame_of(const std::vector<WireLine>& wires)
{
    WireFrame frame;
    frame.wires = wires;
    return frame;
}

/// A wire on a circle's arc in the plane that the arm looks at square on.
WireLine bent_wire(double bend_radius, double from, double to, double radius, const Vec3& centre = Vec3::Zero())
{
    WireLine wire;
    for (int k = 0; k <= 40; ++k) {
        const double angle = from + (to - from) * k / 40;
        wire.nodes.push_back(centre + bend_radius * Vec3(std::cos(angle), 0, std::sin(angle)));
        wire.radius.push_back(radius);
    }
    return wire;
}

PictureTruth truth_of(const CArm& arm, const WireFrame& frame, bool depth = false)
{
    PictureTruth truth = locate(CArmView(arm), frame, drawn_lines(frame));
    truth.arm = arm;
    add_mask(truth, drawn_lines(frame), depth);
    return truth;
}

double distance_to_line(const std::vector<PixelPoint>& line, double column, double row)
{
    double best = 1e9;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const double ex = line[i + 1].column - line[i].column, ey = line[i + 1].row - line[i].row, square = ex * ex + ey * ey;
        const double t = square > 0 ? std::clamp(((column - line[i].column) * ex + (row - line[i].row) * ey) / square, 0.0, 1.0) : 0;
        best = std::min(best, std::hypot(column - line[i].column - t * ex, row - line[i].row - t * ey));
    }
    return best;
}

/// The mask's skeleton by thinning [Zhang and Suen 1984, doi:10.1145/357994.358023].
std::vector<std::array<int, 2>> skeleton_of(std::vector<std::uint8_t> on, int columns, int rows)
{
    for (std::uint8_t& p : on) p = p != 0;
    const auto at = [&](int c, int r) { return c >= 0 && r >= 0 && c < columns && r < rows ? on[static_cast<std::size_t>(r * columns + c)] : 0; };
    for (bool changed = true; changed;) {
        changed = false;
        for (int pass = 0; pass < 2; ++pass) {
            std::vector<std::size_t> gone;
            for (int r = 0; r < rows; ++r)
                for (int c = 0; c < columns; ++c) {
                    if (!at(c, r)) continue;
                    const int p[] = {at(c, r - 1),     at(c + 1, r - 1), at(c + 1, r),     at(c + 1, r + 1),
                                     at(c, r + 1),     at(c - 1, r + 1), at(c - 1, r),     at(c - 1, r - 1)};
                    int count = 0, rises = 0;
                    for (int k = 0; k < 8; ++k) count += p[k], rises += !p[k] && p[(k + 1) % 8];
                    const bool first = pass == 0 ? !(p[0] && p[2] && p[4]) : !(p[0] && p[2] && p[6]);
                    const bool second = pass == 0 ? !(p[2] && p[4] && p[6]) : !(p[0] && p[4] && p[6]);
                    if (count >= 2 && count <= 6 && rises == 1 && first && second) gone.push_back(static_cast<std::size_t>(r * columns + c));
                }
            for (const std::size_t k : gone) on[k] = 0;
            changed |= !gone.empty();
        }
    }
    std::vector<std::array<int, 2>> left;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c)
            if (at(c, r)) left.push_back({c, r});
    return left;
}

long count_of(const std::vector<std::uint8_t>& mask, int label) { return std::count(mask.begin(), mask.end(), label); }

}  // namespace

TEST_SUITE("view/labels")
{
    TEST_CASE("analytic: the projection gives the public reference's pixels [17_xray/carm]")
    {
        const auto shared = test::shared_folder_or_skip();
        if (!shared) return;
        int checked = 0;
        for (const auto& [arm, points] : test::reference_views(*shared)) {
            const Projection p = projection_of(CArmView(arm));
            for (const auto& point : points) {
                const auto at = pixel_by(p, Vec3(point["point"][0], point["point"][1], point["point"][2]));
                CHECK(std::abs(at[0] - point["column"].get<double>()) < 1e-6);
                CHECK(std::abs(at[1] - point["row"].get<double>()) < 1e-6);
                ++checked;
            }
        }
        REQUIRE(checked == 36);
    }

    TEST_CASE("property: the projection gives the pixels of centreline, tip and contacts to 1e-6, of any arm and of a camera")
    {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> even(-1, 1);
        double worst = 0;
        for (int k = 0; k < 50; ++k) {
            CArm arm = arm_of(512, 3e-4);
            arm.primary = 180 * degree * even(random), arm.secondary = 90 * degree * even(random);
            arm.isocentre = Vec3(even(random), even(random), even(random));
            WireFrame frame = frame_of({bent_wire(0.05, even(random), 2 + even(random), 4e-4, arm.isocentre)});
            frame.contacts.push_back({frame.wires[0].nodes[3], Vec3::UnitX(), 0.1});
            Camera camera;
            camera.eye = arm.isocentre + Vec3(0.4 * even(random), -0.6, 0.3 * even(random)), camera.target = arm.isocentre;
            for (const CArmView& view : {CArmView(arm), pinhole_view(camera, {0, 0, 640, 480})}) {
                const PictureTruth truth = locate(view, frame, drawn_lines(frame));
                const Projection p = projection_of(view);
                const InstrumentTruth& wire = truth.instruments[0];
                REQUIRE(wire.contacts.size() == 1);
                const auto check = [&](const Vec3& x, const PixelPoint& px) {
                    const auto at = pixel_by(p, x);
                    worst = std::max({worst, std::abs(at[0] - px.column), std::abs(at[1] - px.row)});
                };
                for (std::size_t i = 0; i < wire.centreline.size(); ++i) check(wire.centreline[i], wire.pixels[i]);
                check(wire.contacts[0].position, wire.contacts[0].pixel);
            }
        }
        MESSAGE("worst: " << worst << " pixels");
        CHECK(worst < 1e-6);
    }

    TEST_CASE("property: an ordinary camera's pixels are those that it draws at, its centres being integers")
    {
        const Camera camera = test::side_camera(0.5);
        const Viewport viewport{0, 0, 640, 480};
        const CArmView view = pinhole_view(camera, viewport);
        for (const Vec3& p : {Vec3(0.01, 0.02, 0.03), Vec3(-0.04, -0.01, 0.02)}) {
            const Projected drawn = project(camera, viewport, p);
            const CArmPoint at = project(view, p);
            CHECK(at.column == doctest::Approx(drawn.column - 0.5).epsilon(1e-9));
            CHECK(at.row == doctest::Approx(drawn.row - 0.5).epsilon(1e-9));
            CHECK(at.depth == doctest::Approx(drawn.depth).epsilon(1e-12));
        }
    }

    TEST_CASE("analytic: a mask has the area of length x width within 3 %, and its skeleton lies within half a pixel of the centreline")
    {
        double worst_area = 0, farthest = 0, sum = 0;
        int count = 0;
        for (const double pixels : {1.6, 2.3, 3.7, 6.0}) {
            double area = 0, covered = 0;  // of twelve views: each decides some 300 pixels of its edges, by whole pixels
            for (int k = 0; k < 12; ++k) {
                CArm arm = arm_of(200, 3e-4);
                arm.primary = (k - 6) * 9 * degree, arm.secondary = (k % 5 - 2) * 11 * degree;
                const double radius = 0.5 * pixels * 3e-4;
                const PictureTruth truth = truth_of(arm, frame_of({bent_wire(0.018, 0.3 + 0.1 * k, 2.6 + 0.1 * k, radius)}));
                const InstrumentTruth& wire = truth.instruments[0];
                covered += static_cast<double>(count_of(truth.mask, 1));
                for (std::size_t i = 0; i + 1 < wire.pixels.size(); ++i) {
                    REQUIRE(wire.pixels[i].in_field);
                    const double length = std::hypot(wire.pixels[i + 1].column - wire.pixels[i].column, wire.pixels[i + 1].row - wire.pixels[i].row);
                    area += length * 2 * radius * project(truth.view, wire.centreline[i]).magnification / truth.view.pixel;
                }
                // a skeleton ends with spurs of the flat end's corners: the last width at each end is left out
                for (const auto& [column, row] : skeleton_of(truth.mask, 200, 200)) {
                    const double from_ends = std::min(std::hypot(column - wire.pixels.front().column, row - wire.pixels.front().row),
                                                      std::hypot(column - wire.pixels.back().column, row - wire.pixels.back().row));
                    if (from_ends <= pixels + 1) continue;
                    const double distance = distance_to_line(wire.pixels, column, row);
                    farthest = std::max(farthest, distance), sum += distance, ++count;
                }
            }
            MESSAGE(pixels << " pixels wide: " << covered / area);
            worst_area = std::max(worst_area, std::abs(covered / area - 1));
        }
        MESSAGE("area: " << 100 * worst_area << " %, skeleton: " << sum / count << " pixels in the mean, " << farthest << " at most");
        CHECK(worst_area < 0.03);
        REQUIRE(count > 5000);
        CHECK(sum / count < 0.5);
        // thinning leaves whole pixels: of a strip of even width one of the two in the middle, half a pixel off, and half a pixel's
        // diagonal more where the strip's edges are stepped
        CHECK(farthest < 0.5 + 0.5 * std::numbers::sqrt2);
    }

    TEST_CASE("property: the middle of the mask's cross-section lies within half a pixel of the centreline")
    {
        double worst = 0;
        int sections = 0;
        for (int k = 0; k < 8; ++k) {
            const double angle = (50 + 10 * k) * degree;  // from the rows: 50 to 120 degrees, so that rows cut the wire across
            const Vec3 along(std::cos(angle), 0, std::sin(angle));
            const PictureTruth truth = truth_of(arm_of(160, 3e-4), frame_of({test::straight_wire(-0.018 * along, 0.018 * along, 4.5e-4)}));
            const std::vector<PixelPoint>& line = truth.instruments[0].pixels;
            for (int row = 0; row < 160; ++row) {
                if (row < std::min(line.front().row, line.back().row) + 6 || row > std::max(line.front().row, line.back().row) - 6) continue;
                int first = 160, last = -1;
                for (int c = 0; c < 160; ++c)
                    if (truth.mask[static_cast<std::size_t>(row * 160 + c)]) first = std::min(first, c), last = std::max(last, c);
                REQUIRE(last >= first);
                worst = std::max(worst, distance_to_line(line, 0.5 * (first + last), row));
                ++sections;
            }
        }
        REQUIRE(sections > 400);
        MESSAGE("worst: " << worst << " pixels");
        CHECK(worst < 0.5);
    }

    TEST_CASE("property: a ray of every mask pixel passes the rod, and pixels that it does not touch are not in the mask")
    {
        const CArm arm = arm_of(128, 3e-4);
        const WireFrame frame = frame_of({bent_wire(0.012, 0, 5, 3e-4)});
        const PictureTruth truth = truth_of(arm, frame);
        Device device;
        const auto lines = drawn_lines(frame);
        for (const TubeStation& s : lines[0]) device.push_back({s.position, s.radius});
        std::vector<float> length(128 * 128);
        for (const DevicePath& p : trace_devices(CArmView(arm), {device})) length[static_cast<std::size_t>(p.pixel)] += p.length;
        long inside = 0;
        for (std::size_t k = 0; k < length.size(); ++k) {
            if (truth.mask[k]) ++inside;
            CHECK_FALSE((truth.mask[k] && !(length[k] > 0)));
            // all of a pixel's rays pass the middle of the wire: more than 0.9 of its thickness on the mean
            CHECK_FALSE((!truth.mask[k] && length[k] > 0.9 * 2 * 3e-4));
        }
        REQUIRE(inside > 300);
    }

    TEST_CASE("analytic: half of a pixel's area decides")
    {
        // a strip along the rows that covers row 10 wholly and row 11 by a fraction
        for (const double fraction : {0.4, 0.6}) {
            CArm arm = arm_of(21, 1e-3);
            const double top = 0.5e-3, bottom = -(0.5 + fraction) * 1e-3;  // up, from the middle row's centre [m]
            const Vec3 middle(0, 0, 0.5 * (top + bottom));
            const PictureTruth truth = truth_of(arm, frame_of({test::straight_wire(middle - Vec3(0.02, 0, 0), middle + Vec3(0.02, 0, 0), 0.5 * (top - bottom))}));
            CHECK(truth.mask[10 * 21 + 10] == 1);
            CHECK(truth.mask[9 * 21 + 10] == 0);
            CHECK(truth.mask[11 * 21 + 10] == (fraction > 0.5 ? 1 : 0));
        }
    }

    TEST_CASE("property: of three instruments in each other the inner one wins, whatever the order in the scene")
    {
        const WireLine sheath = test::straight_wire(Vec3(0, 0, 0), Vec3(0.02, 0, 0), 1.5e-3), catheter = test::straight_wire(Vec3(-0.01, 0, 0), Vec3(0.02, 0, 0), 1e-3),
                       wire = test::straight_wire(Vec3(-0.02, 0, 0), Vec3(0.02, 0, 0), 4e-4);
        const PictureTruth truth = truth_of(arm_of(161, 3e-4), frame_of({sheath, catheter, wire}));
        const PictureTruth turned = truth_of(arm_of(161, 3e-4), frame_of({wire, catheter, sheath}));
        for (std::size_t k = 0; k < truth.mask.size(); ++k) REQUIRE((truth.mask[k] == 0 ? 0 : 4 - truth.mask[k]) == turned.mask[k]);
        const auto at = [&](double x, double z) {  // [m]
            return truth.mask[static_cast<std::size_t>(std::lround(80 - z / 3e-4) * 161 + std::lround(80 + x / 3e-4))];
        };
        CHECK(at(0.01, 0) == 3);
        CHECK(at(0.01, 0.7e-3) == 2);
        CHECK(at(0.01, 1.3e-3) == 1);
        CHECK(at(-0.005, 0.7e-3) == 2);
        CHECK(at(-0.015, 0) == 3);
        CHECK(at(-0.015, 0.7e-3) == 0);
    }

    TEST_CASE("analytic: depth is that of the near surface along the line of sight")
    {
        const WireFrame frame = frame_of({test::straight_wire(Vec3(-0.02, 0.01, 0), Vec3(0.02, 0.01, 0), 2e-3)});
        const Camera camera = test::side_camera(0.5);
        PictureTruth truth = locate(pinhole_view(camera, {0, 0, 201, 201}), frame, drawn_lines(frame));
        add_mask(truth, drawn_lines(frame), true);
        CHECK(truth.mask[100 * 201 + 100] == 1);
        CHECK(truth.depth[100 * 201 + 100] == doctest::Approx(0.51 - 2e-3).epsilon(1e-4));  // of a pixel's rays the nearest
        CHECK(truth.depth[0] == 0);
    }

    TEST_CASE("property: what lies outside of the field is said, and warned of with the tip")
    {
        const CArm arm = arm_of(101, 3e-4);  // 30 mm at the isocentre
        const WireFrame frame = frame_of({test::straight_wire(Vec3(0, 0, 0), Vec3(0.03, 0, 0), 3e-4), test::straight_wire(Vec3(0.03, 0, 0), Vec3(0, 0, 0), 3e-4)});
        const PictureTruth truth = truth_of(arm, frame);
        CHECK(truth.instruments[0].pixels.front().in_field);
        CHECK_FALSE(truth.instruments[0].pixels.back().in_field);
        CHECK(truth.instruments[0].cut_off == doctest::Approx(0.5).epsilon(0.05));
        LabelWarnings warnings;
        warnings.take_in(truth);
        const std::vector<std::string> lines = warnings.lines(true);
        REQUIRE(lines.size() == 2);
        CHECK(lines[0].find("tip is outside in 0") != std::string::npos);
        CHECK(lines[1].find("tip is outside in 1") != std::string::npos);
        LabelWarnings thin;
        thin.take_in(truth_of(arm, frame_of({test::straight_wire(Vec3(-0.005, 0, 0), Vec3(0.005, 0, 0), 1e-4)})));
        REQUIRE(thin.lines(true).size() == 1);
        CHECK(thin.lines(true)[0].find("0.67 pixels wide") != std::string::npos);
        CHECK(thin.lines(false).empty());
    }

    TEST_CASE("property: a contact between instruments pushes on both alike, one on the wall on its own instrument")
    {
        WireFrame frame = frame_of({test::straight_wire(Vec3(0, 0, 0), Vec3(0.01, 0, 0), 1e-3), test::straight_wire(Vec3(0, 0, 0), Vec3(0.01, 0, 0), 3e-4)});
        ContactMark wall{Vec3(0.002, 0, 0.001), Vec3::UnitZ(), 0.25};
        wall.instrument = 1, wall.friction = Vec3(0.1, 0, 0);
        ContactMark both = wall;
        both.instrument = 0, both.other = 1, both.force = 0.5;
        frame.contacts = {wall, both};
        const PictureTruth truth = locate(CArmView(arm_of(64, 3e-4)), frame, drawn_lines(frame));
        REQUIRE(truth.instruments[0].contacts.size() == 1);
        REQUIRE(truth.instruments[1].contacts.size() == 2);
        CHECK((truth.instruments[1].contacts[0].force - Vec3(0.1, 0, 0.25)).norm() < 1e-15);
        CHECK((truth.instruments[0].contacts[0].force - Vec3(0.1, 0, 0.5)).norm() < 1e-15);
        CHECK((truth.instruments[1].contacts[1].force + Vec3(0.1, 0, 0.5)).norm() < 1e-15);
    }
}
