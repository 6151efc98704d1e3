// Contents of the picture, checked against a pinhole camera that is computed here and not by the renderer.
#include "support/refusal.h"
#include "view/canvas.h"
#include "view/colour.h"
#include "view/legend.h"
#include "view_fixtures.h"

#include <algorithm>
#include <random>

namespace seldinger::test::test_renderer {

namespace {

/// Column and row of a point for side_camera(): the textbook pinhole, independent of project().
std::array<double, 2> pinhole(const Vec3& p, double distance, int width, int height)
{
    const double focal = 0.5 * height / std::tan(0.15);
    return {0.5 * width + focal * p.x() / (distance + p.y()), 0.5 * height - focal * p.z() / (distance + p.y())};
}

std::vector<double> greys_down(const Renderer& r, int column)
{
    std::vector<double> greys;
    for (int row = 0; row < r.height(); ++row) greys.push_back(pixel_at(r, column, row).grey());
    return greys;
}

}  // namespace

TEST_SUITE("view/renderer")
{
    TEST_CASE("analytic: a wire in space covers the pixels that its projection says, in the wire's colour")
    {
        const int width = 480, height = 320;
        const auto r = renderer_or_skip(width, height, bare_look());
        if (!r) return;
        const double distance = 1, radius = 0.004;
        const Vec3 tip = {-0.12, 0.05, -0.03}, hub = {0.15, -0.1, 0.06};
        WireFrame frame;
        frame.wires = {straight_wire(tip, hub, radius)};
        r->set_camera(side_camera(distance));
        r->draw(frame);
        for (double t : {0.02, 0.2, 0.4, 0.6, 0.8, 0.98}) {
            CAPTURE(t);
            const Vec3 p = tip + t * (hub - tip);
            const auto [column, row] = pinhole(p, distance, width, height);
            CHECK(looks_like_wire(pixel_at(*r, column, row)));
            // 2.5 radii to the side there is background
            const double scale = 0.5 * height / std::tan(0.15) / (distance + p.y());
            CHECK(pixel_at(*r, column, row + 2.5 * radius * scale).grey() > 200);
            CHECK(pixel_at(*r, column, row - 2.5 * radius * scale).grey() > 200);
        }
        const auto [column, row] = pinhole(tip - 3 * radius * (hub - tip).normalized(), distance, width, height);
        CHECK(pixel_at(*r, column, row).grey() > 200);  // beyond the tip
    }

    TEST_CASE("analytic: the drawn width is the real one, or three pixels where that is less")
    {
        const int width = 320, height = 240;
        const double distance = 1, focal = 0.5 * height / std::tan(0.15);
        for (double radius : {0.008, 0.003, 0.0001}) {
            CAPTURE(radius);
            const auto r = renderer_or_skip(width, height, bare_look());
            if (!r) return;
            WireFrame frame;
            frame.wires = {straight_wire({-0.1, 0, 0}, {0.1, 0, 0}, radius)};
            r->set_camera(side_camera(distance));
            r->draw(frame);
            // coverage summed down one column: the background is near 245, the wire's body under 115, so a pixel counts as the
            // share by which it is darker. The light outline and shading move a sum by less than a pixel on either side.
            double dark = 0;
            for (double g : greys_down(*r, width / 2)) dark += g < 150 ? 1 : 0;
            const double expected = std::max(2 * radius * focal / distance, 3.0);
            CHECK(std::abs(dark - expected) <= 1.5);
        }
    }

    TEST_CASE("property: the wire shows inside a vessel, along all its length")
    {
        const auto r = renderer_or_skip(480, 320, bare_look());
        if (!r) return;
        r->set_wall(straight_tube(0.03, 0.25));
        r->set_camera(side_camera(1));
        const double radius = 0.003;
        // in the middle, touching the far wall, touching the near wall
        for (double y : {0.0, 0.03 - radius, -0.03 + radius}) {
            CAPTURE(y);
            WireFrame frame;
            frame.wires = {straight_wire({-0.11, y, -0.004}, {0.11, y, 0.01}, radius)};
            r->draw(frame);
            for (const Vec3& node : frame.wires[0].nodes) {
                const auto [column, row] = pinhole(node, 1, 480, 320);
                CHECK(looks_like_wire(pixel_at(*r, column, row)));
            }
            CHECK_FALSE(looks_like_wire(pixel_at(*r, 240, 160 - 25)));  // the lumen beside it
        }
    }

    TEST_CASE("property: a wire behind another vessel shows through it, fainter")
    {
        const auto r = renderer_or_skip(480, 320, bare_look());
        if (!r) return;
        WireFrame frame;
        frame.wires = {straight_wire({-0.11, 0.1, 0}, {0.11, 0.1, 0}, 0.004)};
        r->set_wall(straight_tube(0.03, 0.1));  // in front of the middle of the wire
        r->set_camera(side_camera(1));
        r->draw({});
        const Pixel wall = pixel_at(*r, 240, 160);
        r->draw(frame);
        const Pixel ghost = pixel_at(*r, 240, 160);
        const auto [column, row] = pinhole({0.1, 0.1, 0}, 1, 480, 320);
        const Pixel clear = pixel_at(*r, column, row);
        CHECK(looks_like_wire(clear));
        CHECK(ghost.grey() < wall.grey() - 20);
        CHECK(ghost.grey() > clear.grey() + 20);
    }

    TEST_CASE("property: contacts get lighter with force")
    {
        const int width = 960, height = 600;
        const auto r = renderer_or_skip(width, height, bare_look());
        if (!r) return;
        WireFrame frame;
        const int count = 9;
        for (int i = 0; i < count; ++i) frame.contacts.push_back({{0.04 * (i - 4), 0, 0}, Vec3::Zero(), 0.01 * i});
        r->set_camera(side_camera(1));
        r->set_force_scale(0.08);
        r->draw(frame);
        double before = 0;
        for (const ContactMark& c : frame.contacts) {
            CAPTURE(c.force);
            const auto [column, row] = pinhole(c.point, 1, width, height);
            const Pixel p = pixel_at(*r, column, row);
            const auto hex = static_cast<std::uint32_t>((p.r << 16) | (p.g << 8) | p.b);
            const double light = lightness(rgb_from_hex(hex));
            // one step of the scale is 0.07 of lightness; light on the ball, equal for all, compresses it by less than half
            CHECK(light > before + 0.03);
            before = light;
        }
    }

    TEST_CASE("property: two renderers give the same bytes")
    {
        Look look = bare_look();
        const auto a = renderer_or_skip(320, 200, look), b = renderer_or_skip(320, 200, look);
        if (!a || !b) return;
        WireFrame frame;
        frame.wires = {straight_wire({-0.11, 0, -0.004}, {0.11, 0, 0.01}, 0.002)};
        frame.contacts = {{{0, 0, -0.03}, {0, 0, 1}, 0.2}};
        for (Renderer* r : {a.get(), b.get()}) {
            r->set_wall(straight_tube(0.03, 0.25));
            r->draw(frame);
        }
        CHECK(a->pixels() == b->pixels());
        const std::vector<std::uint8_t> first = a->pixels();
        a->draw({});
        CHECK(a->pixels() != first);  // and the wire is in them
        a->draw(frame);
        CHECK(a->pixels() == first);  // nothing is left over from the picture before
    }

    TEST_CASE("property: the order of triangles does not matter")
    {
        const auto r = renderer_or_skip(320, 200, bare_look());
        if (!r) return;
        // three tubes behind each other: up to three layers of glass
        WallMesh mesh;
        for (double y : {0.0, 0.1, 0.2}) {
            const WallMesh tube = straight_tube(0.03, 0.2, {0.02 * y, y, 0});
            const auto shift = static_cast<std::int32_t>(mesh.vertices.size());
            mesh.vertices.insert(mesh.vertices.end(), tube.vertices.begin(), tube.vertices.end());
            for (const auto& t : tube.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
        }
        r->set_wall(mesh);
        r->set_camera(side_camera(1));
        r->draw({});
        const std::vector<std::uint8_t> first = r->pixels();
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(7));
        r->set_wall(mesh);
        r->set_camera(side_camera(1));
        r->draw({});
        int worst = 0;
        for (std::size_t i = 0; i < first.size(); ++i) worst = std::max(worst, std::abs(first[i] - r->pixels()[i]));
        // sums in half floats (11 bits) round differently: under 2^-11 each, three layers, at most 1.5 levels of 255 after sRGB;
        // vertex normals are summed in another order too, which is far less
        CHECK(worst <= 2);
    }

    TEST_CASE("analytic: the scale bar is as long as its label says")
    {
        const auto r = renderer_or_skip(1280, 720, Look{});
        if (!r) return;
        const double distance = 1;
        r->set_camera(side_camera(distance));
        r->draw({});
        const Viewport main = r->main_view();
        const double scale = 0.5 * main.height / std::tan(0.15) / distance;  // pixels per metre at the target
        // the longest run of ink near the lower left corner
        int longest = 0;
        for (int row = 680; row < 720; ++row) {
            int run = 0;
            for (int column = 0; column < main.width; ++column) {
                run = pixel_at(*r, column, row).grey() < 90 ? run + 1 : 0;
                longest = std::max(longest, run);
            }
        }
        const double metres = longest / scale;
        const double nearest = round_up_125(metres * 0.98);
        CHECK(std::abs(metres - nearest) * scale <= 1.5);  // ends fall within a pixel each
        CHECK(longest > 0.05 * main.width);
    }

    TEST_CASE("analytic: the target's ring is as wide as the target, where that is")
    {
        Look look;
        look.target = TargetMark{{0.03, 0.02, -0.04}, 0.015, "left"};
        const auto r = renderer_or_skip(1280, 720, look);
        if (!r) return;
        r->set_camera(side_camera(1));
        r->draw({});
        const Viewport main = r->main_view();
        const auto [column, row] = pinhole(look.target->at, 1, main.width, main.height);
        const double radius = look.target->radius * 0.5 * main.height / std::tan(0.15) / (1 + look.target->at.y());
        const auto green = [&](double x, double y) {
            const Pixel p = pixel_at(*r, x, y);
            return p.g > p.r + 40 && p.g > p.b + 40;
        };
        for (int k = 0; k < 12; ++k) {
            const double angle = 2 * std::numbers::pi * k / 12;
            CHECK(green(column + radius * std::cos(angle), row + radius * std::sin(angle)));
            CHECK_FALSE(green(column + (radius - 5) * std::cos(angle), row + (radius - 5) * std::sin(angle)));
            CHECK_FALSE(green(column + (radius + 5) * std::cos(angle), row + (radius + 5) * std::sin(angle)));
        }
    }

    TEST_CASE("regression: the force scale of the legend has the colours of the contacts, at sizes that divide unevenly")
    {
        for (const auto& size : {std::pair{1280, 720}, {960, 540}, {777, 501}}) {
            const int w = size.first, h = size.second;
            CAPTURE(w);
            const auto r = renderer_or_skip(w, h, Look{});
            if (!r) return;
            r->set_force_scale(0.1);
            r->draw({});
            // some row of the panel holds the scale's colours in order, each to the rounding of a byte
            bool found = false;
            for (int row = 0; row < h && !found; ++row) {
                int step = 0;
                for (int column = r->main_view().width; column < w && step <= 10; ++column) {
                    const auto c = srgb_bytes(force_colour(0.02 + 0.096 * step));
                    const Pixel p = pixel_at(*r, column, row);
                    // neighbouring columns differ by up to 3 levels of a byte
                    if (std::abs(p.r - c[0]) <= 3 && std::abs(p.g - c[1]) <= 3 && std::abs(p.b - c[2]) <= 3) ++step;
                }
                found = step > 10;
            }
            CHECK(found);
        }
    }

    TEST_CASE("regression: sizes that no picture can have")
    {
        for (const auto& size : {std::pair{0, 720}, {1280, -1}, {100000, 720}}) {
            const int w = size.first, h = size.second;
            CAPTURE(w);
            check_refused([&] { Renderer r(w, h); }, {"--size"}, ErrorKind::BadScene);
        }
    }

    TEST_CASE("regression: nothing to draw, one node, repeated nodes and no legend space give a picture")
    {
        for (auto [w, h] : {std::pair{64, 48}, {48, 64}, {400, 300}}) {
            const auto r = renderer_or_skip(w, h, Look{});
            if (!r) return;
            r->draw({});
            WireFrame frame;
            frame.wires = {WireLine{{Vec3(1, 2, 3)}, {0.001}},
                           WireLine{{Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0.1, 0, 0)}, {1e-3, 1e-3, 1e-3}}};
            frame.contacts = {{Vec3(0, 0, 0), Vec3(0, 0, 0), 0.0}};
            r->draw(frame);
            CHECK(r->pixels().size() == static_cast<std::size_t>(3 * w * h));
        }
    }
}

}  // namespace seldinger::test::test_renderer
