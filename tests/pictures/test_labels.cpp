// What labels say about a picture, against the geometry that the picture is drawn with.
#include "pictures/label_sheet.h"
#include "pictures/labels.h"
#include "support/approx.h"
#include "support/shared_folder.h"
#include "view/view_fixtures.h"
#include "xray/device_paths.h"
#include "xray/mesh_paths.h"
#include "xray/reference_views.h"

#include <map>
#include <numbers>
#include <random>
#include <set>

namespace seldinger::test::test_labels {

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

/// Where a line is nearest to a place: how near, its direction there, and the radius that it bends with, all in pixels.
struct Foot {
    double distance = 1e9, ex = 0, ey = 0, bend = 1e9;
};

Foot nearest_on(const std::vector<PixelPoint>& line, double column, double row)
{
    Foot best;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const double ex = line[i + 1].column - line[i].column, ey = line[i + 1].row - line[i].row, length = std::hypot(ex, ey);
        if (length == 0) continue;
        const double x = column - line[i].column, y = row - line[i].row,
                     t = std::clamp((x * ex + y * ey) / (length * length), 0.0, 1.0);
        const double distance = std::hypot(x - t * ex, y - t * ey);
        if (distance >= best.distance) continue;
        best = {distance, ex / length, ey / length, 1e9};
        if (i + 2 == line.size()) continue;
        const double fx = line[i + 2].column - line[i + 1].column, fy = line[i + 2].row - line[i + 1].row;
        const double turn = std::abs(std::atan2(ex * fy - ey * fx, ex * fx + ey * fy));
        if (turn > 0) best.bend = 0.5 * (length + std::hypot(fx, fy)) / turn;
    }
    return best;
}

/// Middles of the mask's runs of pixels, along rows and along columns.
struct RunMiddle {
    double column, row;
    bool by_rows;
};

std::vector<RunMiddle> run_middles(const std::vector<std::uint8_t>& mask, int columns, int rows)
{
    std::vector<RunMiddle> all;
    for (const bool by_rows : {true, false})
        for (int line = 0; line < (by_rows ? rows : columns); ++line) {
            const int count = by_rows ? columns : rows;
            const auto on = [&](int k) {
                return k < count && mask[static_cast<std::size_t>(by_rows ? line * columns + k : k * columns + line)] != 0;
            };
            for (int k = 0; k < count; ++k) {
                if (!on(k)) continue;
                const int first = k;
                while (on(k + 1)) ++k;
                const double middle = 0.5 * (first + k);
                all.push_back(by_rows ? RunMiddle{middle, static_cast<double>(line), true}
                                      : RunMiddle{static_cast<double>(line), middle, false});
            }
        }
    return all;
}

/// The mask's skeleton by thinning [Zhang and Suen 1984, doi:10.1145/357994.358023].
std::vector<std::array<int, 2>> skeleton_of(std::vector<std::uint8_t> on, int columns, int rows)
{
    for (std::uint8_t& p : on) p = p != 0;
    const auto at = [&](int c, int r) {
        return c >= 0 && r >= 0 && c < columns && r < rows ? on[static_cast<std::size_t>(r * columns + c)] : 0;
    };
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
                    if (count >= 2 && count <= 6 && rises == 1 && first && second)
                        gone.push_back(static_cast<std::size_t>(r * columns + c));
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

constexpr int bent_side = 200;

/// View k of 12 of a bent wire of this width, from all sides.
PictureTruth bent_view(int k, double pixels)
{
    CArm arm = arm_of(bent_side, 3e-4);
    arm.primary = (k - 6) * 9 * degree, arm.secondary = (k % 5 - 2) * 11 * degree;
    return truth_of(arm, frame_of({bent_wire(0.018, 0.3 + 0.1 * k, 2.6 + 0.1 * k, 0.5 * pixels * 3e-4)}));
}

long count_of(const std::vector<std::uint8_t>& mask, int label) { return std::count(mask.begin(), mask.end(), label); }

}  // namespace

TEST_SUITE("pictures/labels")
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
            CHECK(at.column == test::about(drawn.column - 0.5).epsilon(1e-9));
            CHECK(at.row == test::about(drawn.row - 0.5).epsilon(1e-9));
            CHECK(at.depth == test::about(drawn.depth).epsilon(1e-12));
        }
    }

    TEST_CASE("analytic: a mask has the area of length x width within 3 %")
    {
        double worst = 0;
        for (const double pixels : {1.6, 2.3, 3.7, 6.0}) {
            double area = 0, covered = 0;  // of twelve views: each decides some 300 pixels of its edges, by whole pixels
            for (int k = 0; k < 12; ++k) {
                const PictureTruth truth = bent_view(k, pixels);
                const InstrumentTruth& wire = truth.instruments[0];
                covered += static_cast<double>(count_of(truth.mask, 1));
                for (std::size_t i = 0; i + 1 < wire.pixels.size(); ++i) {
                    REQUIRE(wire.pixels[i].in_field);
                    const double length = std::hypot(wire.pixels[i + 1].column - wire.pixels[i].column,
                                                     wire.pixels[i + 1].row - wire.pixels[i].row);
                    area += length * 2 * wire.radius * project(truth.view, wire.centreline[i]).magnification / truth.view.pixel;
                }
            }
            MESSAGE(pixels << " pixels wide: " << covered / area);
            worst = std::max(worst, std::abs(covered / area - 1));
        }
        CHECK(worst < 0.03);
    }

    TEST_CASE(
        "analytic: the middles of the mask across the wire lie within half a pixel of the centreline, thinned whole pixels "
        "within one")
    {
        // An edge falls between two pixels' centres. Each end of a run of pixels across the wire is off by at most half a
        // pixel, and so is their middle, along the run. At right angles to the wire, times the sine between both. A bent wire's
        // run has its middle w^2/8R tan^2 off. Thinning keeps whole pixels, of a run of even length one beside the middle: half
        // a pixel more.
        double worst = 0, worst_of_bound = 0, farthest = 0, sum = 0;
        std::vector<double> thinned;
        int sections = 0;
        for (const double pixels : {1.6, 2.0, 2.3, 3.0, 3.7, 6.0})
            for (int k = 0; k < 12; ++k) {
                const PictureTruth truth = bent_view(k, pixels);
                const std::vector<PixelPoint>& line = truth.instruments[0].pixels;
                // a flat end's corners are of no cross-section, and leave spurs of a skeleton: a width at each end is left out
                const auto near_end = [&](double column, double row) {
                    return std::min(std::hypot(column - line.front().column, row - line.front().row),
                                    std::hypot(column - line.back().column, row - line.back().row)) <= pixels + 1;
                };
                for (const auto& [column, row, by_rows] : run_middles(truth.mask, bent_side, bent_side)) {
                    const Foot foot = nearest_on(line, column, row);
                    const double across = by_rows ? std::abs(foot.ey) : std::abs(foot.ex),
                                 along = by_rows ? std::abs(foot.ex) : std::abs(foot.ey);
                    if (near_end(column, row) || across < along) continue;  // the other direction cuts this place more squarely
                    const double bound =
                        0.5 * across + pixels * pixels / (8 * foot.bend) * along * along / (across * across) + 0.02;
                    worst = std::max(worst, foot.distance), worst_of_bound = std::max(worst_of_bound, foot.distance / bound);
                    ++sections;
                }
                for (const auto& [column, row] : skeleton_of(truth.mask, bent_side, bent_side)) {
                    if (near_end(column, row)) continue;
                    thinned.push_back(nearest_on(line, column, row).distance);
                    farthest = std::max(farthest, thinned.back()), sum += thinned.back();
                }
            }
        REQUIRE(sections > 7000);
        REQUIRE(thinned.size() > 7000);
        std::sort(thinned.begin(), thinned.end());
        MESSAGE(sections << " middles: " << worst << " pixels at most, " << worst_of_bound
                         << " of the bound; thinned: " << sum / static_cast<double>(thinned.size()) << " in the mean, 95 % "
                         << thinned[thinned.size() * 95 / 100] << ", at most " << farthest);
        CHECK(worst <= 0.5);
        CHECK(worst_of_bound <= 1);
        CHECK(sum / static_cast<double>(thinned.size()) < 0.5);
        CHECK(farthest <= 1);
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
            const PictureTruth truth = truth_of(
                arm, frame_of({test::straight_wire(middle - Vec3(0.02, 0, 0), middle + Vec3(0.02, 0, 0), 0.5 * (top - bottom))}));
            CHECK(truth.mask[10 * 21 + 10] == 1);
            CHECK(truth.mask[9 * 21 + 10] == 0);
            CHECK(truth.mask[11 * 21 + 10] == (fraction > 0.5 ? 1 : 0));
        }
    }

    TEST_CASE("property: of three instruments in each other the inner one wins, whatever the order in the scene")
    {
        const WireLine sheath = test::straight_wire(Vec3(0, 0, 0), Vec3(0.02, 0, 0), 1.5e-3),
                       catheter = test::straight_wire(Vec3(-0.01, 0, 0), Vec3(0.02, 0, 0), 1e-3),
                       wire = test::straight_wire(Vec3(-0.02, 0, 0), Vec3(0.02, 0, 0), 4e-4);
        const PictureTruth truth = truth_of(arm_of(161, 3e-4), frame_of({sheath, catheter, wire}));
        const PictureTruth turned = truth_of(arm_of(161, 3e-4), frame_of({wire, catheter, sheath}));
        for (std::size_t k = 0; k < truth.mask.size(); ++k)
            REQUIRE((truth.mask[k] == 0 ? 0 : 4 - truth.mask[k]) == turned.mask[k]);
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
        CHECK(truth.depth[100 * 201 + 100] == test::about(0.51 - 2e-3).epsilon(1e-4));  // of a pixel's rays the nearest
        CHECK(truth.depth[0] == 0);
    }

    TEST_CASE("analytic: the lumen of a tube is as thick along the ray for a camera as for an X-ray")
    {
        // across the axis in the middle: twice the apothem of the 48-sided tube, or its radius where the ray meets edges
        const WallMesh tube = close_openings(test::straight_tube(5e-3, 0.08));
        CArm arm = arm_of(101, 3e-4);
        for (const CArmView& view : {CArmView(arm), pinhole_view(test::side_camera(0.5), {0, 0, 101, 101})}) {
            const std::vector<float> length = trace_mesh(view, tube).length;
            CHECK(length[50 * 101 + 50] == test::about(0.01).epsilon(0.003));
            CHECK(std::count_if(length.begin(), length.end(), [](float l) { return l > 0; }) > 300);
        }
    }

    TEST_CASE("property: a sheet shows frames and views evenly, none twice")
    {
        for (const auto& [frames, views] :
             {std::pair{171u, 2u}, {61u, 1u}, {1u, 40u}, {2u, 9u}, {3u, 3u}, {4u, 8u}, {1u, 1u}, {16u, 1u}, {5u, 100u}}) {
            const std::size_t count = std::min<std::size_t>(16, frames * views);
            std::set<std::pair<std::size_t, std::size_t>> shown;
            std::map<std::size_t, int> of_view;
            for (std::size_t i = 0; i < count; ++i) {
                const auto [frame, view] = LabelSheet::pick(i, count, frames, views);
                CHECK(frame < frames);
                CHECK(view < views);
                shown.insert({frame, view}), ++of_view[view];
            }
            CAPTURE(frames);
            CAPTURE(views);
            CHECK(shown.size() == count);
            CHECK(of_view.size() == std::min<std::size_t>(views, count));
        }
    }

    TEST_CASE("property: what lies outside of the field is said, and warned of with the tip")
    {
        const CArm arm = arm_of(101, 3e-4);  // 30 mm at the isocentre
        const WireFrame frame = frame_of({test::straight_wire(Vec3(0, 0, 0), Vec3(0.03, 0, 0), 3e-4),
                                          test::straight_wire(Vec3(0.03, 0, 0), Vec3(0, 0, 0), 3e-4)});
        const PictureTruth truth = truth_of(arm, frame);
        CHECK(truth.instruments[0].pixels.front().in_field);
        CHECK_FALSE(truth.instruments[0].pixels.back().in_field);
        // the one that leaves counts as half
        const double piece = 1.0 / static_cast<double>(truth.instruments[0].centreline.size() - 1);
        CHECK(std::abs(truth.instruments[0].cut_off - 0.5) < 0.5 * piece + 1e-12);
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
        WireFrame frame = frame_of({test::straight_wire(Vec3(0, 0, 0), Vec3(0.01, 0, 0), 1e-3),
                                    test::straight_wire(Vec3(0, 0, 0), Vec3(0.01, 0, 0), 3e-4)});
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

}  // namespace seldinger::test::test_labels
