// Vessels as segmentations, printers and CAD programs make them: in parts, with a thick wall, of exact spheres.
#include "core/error.h"
#include "repair/repair.h"
#include "shapes/aortic_arch.h"
#include "shapes/swept_lumen.h"
#include "support/approx.h"
#include "vessel/extract_centreline.h"
#include "vessel/mesh_edges.h"
#include "vessel/mesh_fixtures.h"
#include "vessel/parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace seldinger::test::test_field_vessels {

namespace {

constexpr double pi = std::numbers::pi;

/// Tube along x about the axis, from x = 0 to `length`, normals outwards.
WallMesh tube(double radius, double length, int around, int along, double x0 = 0)
{
    WallMesh mesh;
    for (int i = 0; i <= along; ++i)
        for (int j = 0; j < around; ++j) {
            const double b = 2 * pi * j / around;
            mesh.vertices.emplace_back(x0 + length * i / along, radius * std::cos(b), radius * std::sin(b));
        }
    for (std::int32_t i = 0; i < along; ++i)
        for (std::int32_t j = 0; j < around; ++j) {
            const std::int32_t a = i * around + j, b = i * around + (j + 1) % around, c = b + around, d = a + around;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

void turn_all(WallMesh& mesh)
{
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) flip(mesh, t);
}

/// Outer and inner tube; rims between their ends where they are joined.
WallMesh thick_tube(double inner, double outer, bool joined)
{
    const int around = 32, along = 60;
    WallMesh mesh = tube(outer, 0.06, around, along), inside = tube(inner, 0.06, around, along);
    turn_all(inside);
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    append(mesh, inside);
    for (std::int32_t j = 0; joined && j < around; ++j)
        for (const std::int32_t row : {0, along * around}) {
            const std::int32_t a = row + j, b = row + (j + 1) % around, c = first + b, d = first + a;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
            if (row == 0) continue;
            flip(mesh, mesh.triangles.size() - 1);
            flip(mesh, mesh.triangles.size() - 2);
        }
    return mesh;
}

/// The wall of a lumen: its surface, with noise, and another one outside; rims between them where it is open.
WallMesh wall_around(const WallMesh& lumen, double thickness, double noise)
{
    WallMesh wall = lumen, outer = lumen;  // a wall's own surface faces out of its material: here into the lumen
    std::vector<Vec3> into(lumen.vertices.size(), Vec3::Zero());
    for (std::size_t t = 0; t < lumen.triangles.size(); ++t)
        for (const std::int32_t v : lumen.triangles[t]) into[static_cast<std::size_t>(v)] += double_area(triangle_of(lumen, t));
    for (std::size_t v = 0; v < into.size(); ++v) outer.vertices[v] -= thickness * into[v].normalized();
    turn_all(outer);
    const auto shift = static_cast<std::int32_t>(lumen.vertices.size());
    append(wall, outer);
    const MeshEdges edges = find_edges(lumen);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        if (edges.uses(k).size() > 1) continue;
        const std::int32_t a = half_edge_from(lumen, edges.uses(k)[0]), b = half_edge_to(lumen, edges.uses(k)[0]);
        wall.triangles.push_back({b, a, a + shift});
        wall.triangles.push_back({b, a + shift, b + shift});
    }
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, 1);
    for (Vec3& v : wall.vertices)
        for (int c = 0; c < 3; ++c) v[c] += noise * normal(random);
    return wall;
}

/// A closed profile swept along a path of frames; its ends are open. Normals point outwards where the profile runs
/// counter-clockwise.
template <class Frame>
WallMesh swept(const std::vector<std::pair<double, double>>& profile, int along, const Frame& frame)
{
    WallMesh mesh;
    const auto around = static_cast<std::int32_t>(profile.size());
    for (int i = 0; i <= along; ++i)
        for (const auto& [u, v] : profile) mesh.vertices.push_back(frame(static_cast<double>(i) / along, u, v));
    for (std::int32_t i = 0; i < along; ++i)
        for (std::int32_t j = 0; j < around; ++j) {
            const std::int32_t a = i * around + j, b = i * around + (j + 1) % around, c = b + around, d = a + around;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

std::vector<std::pair<double, double>> ellipse(double a, double b, int around)
{
    std::vector<std::pair<double, double>> profile;
    for (int j = 0; j < around; ++j) profile.emplace_back(a * std::cos(2 * pi * j / around), b * std::sin(2 * pi * j / around));
    return profile;
}

/// A false lumen that lies round three fifths of a true one.
std::vector<std::pair<double, double>> crescent(double inner, double outer, int around)
{
    std::vector<std::pair<double, double>> profile;
    for (const bool out : {true, false})
        for (int j = 0; j <= around; ++j) {
            const double b = 2 * pi * 0.3 * (out ? 1 - 2.0 * j / around : 2.0 * j / around - 1), r = out ? outer : inner;
            profile.emplace_back(r * std::cos(b), r * std::sin(b));
        }
    return profile;
}

bool has_note(const RepairReport& report, const char* text)
{
    return std::any_of(report.notes.begin(), report.notes.end(),
                       [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

double largest_radius(const WallMesh& mesh)
{
    double r = 0;
    for (const Vec3& v : mesh.vertices) r = std::max(r, std::hypot(v.y(), v.z()));
    return r;
}

/// Tube with a hemisphere of its radius at its end: all points of the hemisphere are equally far from its middle.
WallMesh hemispherical(int around, int along, double radius, double length)
{
    WallMesh mesh = tube(radius, length, around, along);
    const std::int32_t quarter = around / 4;
    std::int32_t ring = along * around;
    for (std::int32_t q = 1; q < quarter; ++q) {
        const double t = 0.5 * pi * q / quarter;
        const auto next = static_cast<std::int32_t>(mesh.vertices.size());
        for (int j = 0; j < around; ++j) {
            const double b = 2 * pi * j / around;
            mesh.vertices.emplace_back(length + radius * std::sin(t), radius * std::cos(t) * std::cos(b),
                                       radius * std::cos(t) * std::sin(b));
        }
        for (std::int32_t j = 0; j < around; ++j) {
            const std::int32_t k = (j + 1) % around;
            mesh.triangles.push_back({ring + j, next + k, ring + k});
            mesh.triangles.push_back({ring + j, next + j, next + k});
        }
        ring = next;
    }
    const auto top = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(length + radius, 0, 0);
    for (std::int32_t j = 0; j < around; ++j) mesh.triangles.push_back({ring + j, top, ring + (j + 1) % around});
    return mesh;
}

Centreline axis_of(WallMesh& mesh, RepairReport& report)
{
    report = repair(mesh);
    return extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops));
}

}  // namespace

TEST_SUITE("vessel/field_vessels")
{
    TEST_CASE("property: of a thick wall the inner shell is taken, rims joined or not, whichever way the shells face")
    {
        for (const bool joined : {false, true})
            for (const int turned : {0, 1, 2}) {
                CAPTURE(joined);
                CAPTURE(turned);
                WallMesh mesh = thick_tube(3e-3, 4.5e-3, joined);
                if (turned == 1) turn_all(mesh);
                if (turned == 2 && !joined)
                    for (std::size_t t = 0; t < mesh.triangles.size() / 2; ++t) flip(mesh, t);  // both shells face inwards
                const RepairReport report = repair(mesh);
                CHECK(largest_radius(mesh) == about(3e-3).epsilon(1e-6));
                CHECK(mesh.triangles.size() == 2 * 32 * 60);
                CHECK(report.loops.size() == 2);
                CHECK(has_note(report, "inner of its two shells"));
                const LumenQuery lumen(mesh, report.loops);
                CHECK(lumen.inside(Vec3(0.03, 0, 0)));
                CHECK_FALSE(lumen.inside(Vec3(0.03, 0.0037, 0)));
            }
    }

    TEST_CASE(
        "property: of a rough wall in one surface the inner side is taken: straight, bent and branching, whatever its triangles")
    {
        constexpr double thickness = 1.8e-3;
        for (const VesselShape shape : {VesselShape::Tube, VesselShape::Arc, VesselShape::Arch})
            for (const double noise : {0.0, 0.1e-3, 0.2e-3, 0.35e-3, 0.5e-3})
                for (const int triangles : {10000, 25000}) {
                    CAPTURE(static_cast<int>(shape));
                    CAPTURE(noise);
                    CAPTURE(triangles);
                    VesselSpec spec = tube_spec(9e-3, 0.15, triangles);
                    spec.bend_radius = 0.04, spec.angle = pi, spec.lead_in = spec.lead_out = 0.03;
                    const GeneratedVessel made = shape == VesselShape::Tube  ? make_tube(spec)
                                                 : shape == VesselShape::Arc ? make_arc(spec)
                                                                             : make_aortic_arch(spec);
                    WallMesh mesh = wall_around(made.mesh, thickness, noise);
                    if (triangles == 10000) turn_all(mesh);
                    const RepairReport report = repair(mesh);
                    CHECK(has_note(report, "inner of its two shells"));
                    WallMesh alone = made.mesh;
                    CHECK(report.loops.size() == repair(alone).loops.size());
                    CHECK(report.components == 1);
                    // all of the inner surface but for what noise takes at the rims, and nothing else; less noise than before
                    const LumenQuery lumen(made.mesh, {});
                    double square = 0, area = 0, whole = 0;
                    for (const Vec3& v : mesh.vertices)
                        square += std::pow(lumen.signed_distance(v), 2) / static_cast<double>(mesh.vertices.size());
                    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area += double_area(triangle_of(mesh, t)).norm();
                    for (std::size_t t = 0; t < made.mesh.triangles.size(); ++t)
                        whole += double_area(triangle_of(made.mesh, t)).norm();
                    CHECK(std::sqrt(square) < 1e-6 + 1.1 * noise);
                    CHECK(area > (noise == 0 ? 0.99 : 0.9) * whole);
                }
    }

    TEST_CASE("property: a wall may be thick and uneven; one whose inner side is not certain is refused with what to do")
    {
        const auto bulging = [](double inner, double thin, double thick) {
            WallMesh mesh = thick_tube(inner, inner + thin, true);
            for (Vec3& v : mesh.vertices)
                if (v.x() > 0.045 && std::hypot(v.y(), v.z()) > inner + 0.5 * thin) {
                    const double wider = (inner + thick) / std::hypot(v.y(), v.z());
                    v.y() *= wider, v.z() *= wider;
                }
            return mesh;
        };
        for (const auto& [thin, thick] : {std::pair{3.3e-3, 3.3e-3}, {0.9e-3, 4e-3}}) {
            CAPTURE(thin);
            WallMesh mesh = bulging(3e-3, thin, thick);
            CHECK(has_note(repair(mesh), "inner of its two shells"));
            CHECK(largest_radius(mesh) == about(3e-3).epsilon(1e-6));
        }
        WallMesh mesh = bulging(3e-3, 0.6e-3, 5e-3);
        CHECK_THROWS_WITH_AS(
            (void)repair(mesh),
            doctest::Contains("whose inner side could not be told for certain; expected the lumen's surface. Fix:"), Error);
    }

    TEST_CASE("property: thin, flat, wound and crescent lumens are no walls")
    {
        const auto straight = [](double s, double u, double v) { return Vec3(0.15 * s, u, v); };
        // three turns that touch, along a helix of 12 mm: its inner side is enclosed by the others
        const auto helix = [](double s, double u, double v) {
            const double b = 6 * pi * s;
            const Vec3 out(0, std::cos(b), std::sin(b));
            return Vec3((12e-3 + u) * out + Vec3(18e-3 * s * 1.1 + v, 0, 0));
        };
        const std::pair<const char*, WallMesh> lumens[] = {{"thin tube", tube(0.5e-3, 0.3, 12, 600)},
                                                           {"flattened vein", swept(ellipse(8e-3, 1e-3, 48), 80, straight)},
                                                           {"helix", swept(ellipse(3e-3, 3e-3, 24), 400, helix)},
                                                           {"crescent", swept(crescent(8e-3, 13e-3, 40), 80, straight)}};
        for (const auto& [name, lumen] : lumens)
            for (const double noise : {0.0, 0.1e-3}) {
                CAPTURE(name);
                CAPTURE(noise);
                WallMesh mesh = lumen;
                std::mt19937 random(3);
                std::normal_distribution<double> normal(0, 1);
                for (Vec3& v : mesh.vertices)
                    for (int c = 0; c < 3; ++c) v[c] += noise * normal(random);
                const RepairReport report = repair(mesh);
                CHECK_FALSE(has_note(report, "inner of its two shells"));
                CHECK(mesh.triangles.size() == lumen.triangles.size());
            }
    }

    TEST_CASE("property: what lies in a lumen without filling it stays an obstacle, and vessels side by side stay two")
    {
        WallMesh catheter = tube(5e-3, 0.06, 32, 60), rod = tube(1e-3, 0.05, 16, 100, 0.005);
        append(catheter, rod);
        const RepairReport obstacle = repair(catheter);
        CHECK(catheter.triangles.size() == 2 * 32 * 60 + 2 * 16 * 100);
        CHECK(has_note(obstacle, "counts as an obstacle"));
        WallMesh pair = tube(3e-3, 0.06, 32, 60), other = tube(3e-3, 0.06, 32, 60);
        for (Vec3& v : other.vertices) v += Vec3(0, 0.0065, 0);
        append(pair, other);
        CHECK(repair(pair).components == 2);
        CHECK(pair.triangles.size() == 2 * 2 * 32 * 60);
    }

    TEST_CASE("property: of a segmentation in parts the largest is the vessel, and each part is named with its share")
    {
        for (const bool closed : {false, true}) {
            CAPTURE(closed);
            // a wide stump of 15 mm beside a longer, narrower vessel, and crumbs
            WallMesh mesh = closed ? sphere(12e-3, Vec3(0, 0.05, 0), 4) : tube(10e-3, 0.015, 40, 10, 0.2);
            WallMesh vessel = closed ? hemispherical(40, 150, 4e-3, 0.15) : tube(4e-3, 0.15, 40, 150);
            for (std::int32_t j = 1; closed && j + 1 < 40; ++j) vessel.triangles.push_back({0, j, j + 1});  // its flat end
            append(mesh, vessel);
            for (int k = 0; k < 5; ++k) append(mesh, sphere(5e-4, Vec3(0.05, 0.05 + 0.01 * k, 0.02), 1));
            RepairReport report;
            const Centreline line = axis_of(mesh, report);
            CHECK(report.components == 7);
            REQUIRE(line.points.size() > 10);
            for (const Vec3& p : line.points) CHECK(std::hypot(p.y(), p.z()) < 4e-3);  // in the vessel
            CHECK(line.total_length() > 0.12);
            const VesselParts parts(mesh, report.loops);
            CHECK(parts.parts()[0].share > parts.parts()[1].share);
            CHECK(parts.part_at(Vec3(0.07, 0, 0)) == 0);
            double all = 0;
            for (const VesselPart& part : parts.parts()) all += part.share;
            CHECK(all == about(1));
            const std::vector<std::string> from_stump = parts.describe_choice(1);
            REQUIRE(from_stump.size() == 3);
            CHECK(from_stump[0].find("7 separate parts") != std::string::npos);
            CHECK(from_stump[2].find("part 1 is larger") != std::string::npos);
            CHECK(parts.describe_choice(0).size() == 2);
        }
    }

    TEST_CASE("regression: a tube through an exact sphere has an axis through its middle")
    {
        // the middle of the sphere is as far from each of its 30,000 triangles
        constexpr double radius = 2e-3, sphere_radius = 5e-3, middle = 15e-3;
        WallMesh mesh = tube(1, 30e-3, 160, 140);
        for (Vec3& p : mesh.vertices) {
            const double x = p.x() - middle, end = std::sqrt(sphere_radius * sphere_radius - radius * radius);
            const double turn = std::clamp(x / 9e-3, -1.0, 1.0), widest = std::asin(end / sphere_radius);
            // 84 rings lie on the sphere at equal angles, the others along the tube
            const double along = std::abs(turn) < 1
                                     ? sphere_radius * std::sin(widest * turn)
                                     : std::copysign(end + (std::abs(x) - 9e-3) * (middle - end) / (middle - 9e-3), x);
            const double out = std::abs(turn) < 1 ? sphere_radius * std::cos(widest * turn) : radius;
            p = Vec3(middle + along, out * p.y(), out * p.z());
        }
        RepairReport report;
        const Centreline line = axis_of(mesh, report);
        CHECK(report.loops.size() == 2);
        REQUIRE_FALSE(line.empty());
        int in_sphere = 0;
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            const Vec3& p = line.points[i];
            CHECK(std::hypot(p.y(), p.z()) < 0.1 * radius);
            double nearest = INFINITY;
            for (const Vec3& v : mesh.vertices) nearest = std::min(nearest, (v - p).norm());
            // of edges of up to 0.26 mm, half of which is (0.13 mm)^2/(2 rho) nearer than its ends at a distance rho
            CHECK(line.radius[i] <= nearest + 1e-9);
            CHECK(line.radius[i] > nearest - 1e-5);
            in_sphere += line.radius[i] > 1.5 * radius;
        }
        CHECK(in_sphere > 2);
    }

    TEST_CASE("regression: a tube that ends in an exact hemisphere has an axis from its opening to the dome")
    {
        // every query for the middle of the sphere visited all of it: 240 million steps from 64,680 triangles on
        WallMesh mesh = hemispherical(120, 240, 2.5e-3, 25e-3);
        RepairReport report;
        const Centreline line = axis_of(mesh, report);
        CHECK(report.loops.size() == 1);
        REQUIRE_FALSE(line.empty());
        double far = 0;
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            far = std::max(far, line.points[i].x());
            CHECK(std::hypot(line.points[i].y(), line.points[i].z()) < 0.1 * 2.5e-3);
        }
        CHECK(far > 24e-3);
        CHECK(far < 27.5e-3);
    }

    TEST_CASE("regression: a flap of triangles left over from a cut bends neither the opening nor the axis")
    {
        // in front of the flap the nearest wall is its own front: spheres as wide as the vessel is long, and an axis out there
        constexpr double radius = 15e-3, length = 0.15, flap = 0.04;
        constexpr int around = 48;
        WallMesh mesh = tube(radius, length + flap, around, 76);
        std::erase_if(mesh.triangles, [&](const auto& t) {
            const Vec3 at = (mesh.vertices[static_cast<std::size_t>(t[0])] + mesh.vertices[static_cast<std::size_t>(t[1])] +
                             mesh.vertices[static_cast<std::size_t>(t[2])]) /
                            3;
            return at.x() > length && std::abs(std::atan2(at.z(), at.y())) > 0.25;
        });
        RepairReport report;
        const Centreline line = axis_of(mesh, report);
        REQUIRE(report.loops.size() == 2);
        for (const BoundaryLoop& loop : report.loops) {
            CHECK(loop.radius == about(radius).epsilon(0.01));
            CHECK(std::hypot(loop.centre.y(), loop.centre.z()) < 0.05 * radius);
            CHECK(std::abs(loop.inward.x()) > 0.999);
            CHECK((rim_height(mesh, loop) > 0.9 * flap) == (loop.centre.x() > 0.1));
        }
        CHECK(line.main_path().size() == line.points.size());  // one way, without branches
        CHECK(line.total_length() == about(length).epsilon(0.05));
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            CHECK(std::hypot(line.points[i].y(), line.points[i].z()) < 0.1 * radius);
            CHECK(line.radius[i] < 1.02 * radius);
        }
    }

    TEST_CASE("regression: a flap with a longer outline than the rim, bent outwards, is not taken for the rim")
    {
        // the plane that most vertices of this outline lie in is that of the flap itself
        constexpr double radius = 6e-3, length = 0.07, flap = 0.03;
        for (const double lean : {0.0, 0.35}) {
            CAPTURE(lean);
            WallMesh mesh = tube(radius, length + flap, 48, 200);
            std::erase_if(mesh.triangles, [&](const auto& t) {
                const Vec3 at = (mesh.vertices[static_cast<std::size_t>(t[0])] + mesh.vertices[static_cast<std::size_t>(t[1])] +
                                 mesh.vertices[static_cast<std::size_t>(t[2])]) /
                                3;
                return at.x() > length && std::abs(std::atan2(at.z(), at.y())) > 0.35;
            });
            for (Vec3& v : mesh.vertices) v.y() += lean * std::max(0.0, v.x() - length);
            RepairReport report;
            const Centreline line = axis_of(mesh, report);
            REQUIRE(report.loops.size() == 2);
            for (const BoundaryLoop& loop : report.loops) {
                CHECK(loop.radius == about(radius).epsilon(0.05));
                CHECK(std::hypot(loop.centre.y(), loop.centre.z()) < 0.15 * radius);  // the plane's thickness in radii
                CHECK(std::abs(loop.inward.x()) > 0.99);
            }
            CHECK(line.main_path().size() == line.points.size());
            CHECK(line.total_length() == about(length).epsilon(0.05));
            for (const double r : line.radius) CHECK(r < 1.02 * radius);
        }
    }

    TEST_CASE("property: where single triangles are missing along a cut, small holes are closed and the opening stays one")
    {
        // holes that meet in corners: the shortest filling of one gave an edge a third triangle, and the rim was lost there
        constexpr double radius = 4e-3, length = 0.06;
        for (unsigned seed = 1; seed <= 11; ++seed) {
            CAPTURE(seed);
            WallMesh mesh = tube(radius, length, 32, 80);
            std::mt19937 random(seed);
            std::uniform_real_distribution<double> even(0, 1);
            std::erase_if(mesh.triangles, [&](const auto& t) {
                const double x = mesh.vertices[static_cast<std::size_t>(t[0])].x();
                return even(random) < (x - 0.055) / 0.003;
            });
            RepairReport report;
            const Centreline line = axis_of(mesh, report);
            CHECK(report.hole_loops_closed > 0);
            CHECK(report.non_manifold_edges == 0);
            REQUIRE(report.loops.size() == 2);  // none of the holes is an opening of its own
            CHECK(report.loops[1].radius > 0.8 * radius);
            CHECK(line.points[static_cast<std::size_t>(line.main_path().back())].x() * line.points[0].x() < 1e-4);  // end to end
            CHECK(line.total_length() > 0.05);
        }
    }

    TEST_CASE("property: of a rough wall whose triangles are long along the vessel the inner side is taken")
    {
        // noise folds slivers: their area counts more than the wall's own, and evening them moved whole rims
        const int around = 40, along = 16;
        for (const double noise : {0.05e-3, 0.1e-3, 0.2e-3, 0.3e-3}) {
            CAPTURE(noise);
            WallMesh inner = tube(3e-3, 0.08, around, along);
            turn_all(inner);
            WallMesh mesh = wall_around(inner, 1.6e-3, noise);
            const RepairReport report = repair(mesh);
            CHECK(has_note(report, "inner of its two shells"));
            for (const Vec3& v : mesh.vertices) CHECK(std::hypot(v.y(), v.z()) < 3e-3 + 0.8e-3 + 3 * noise);
        }
    }

    TEST_CASE("regression: a lumen as flat as those of a dissection has an axis along it, no comb of paths across it")
    {
        // 24 x 7 mm, 200 mm long, triangles of 1 mm
        constexpr int wide = 24, high = 7, along = 200, around = 2 * (wide + high);
        WallMesh mesh;
        for (int i = 0; i <= along; ++i)
            for (int j = 0; j < around; ++j) {
                const int k = j % (wide + high);
                const double side = j < wide + high ? 1 : -1;
                const double y = k < wide ? -0.5 * wide + k : 0.5 * wide, z = k < wide ? -0.5 * high : -0.5 * high + (k - wide);
                mesh.vertices.emplace_back(1e-3 * i, 1e-3 * side * y, 1e-3 * side * z);
            }
        for (std::int32_t i = 0; i < along; ++i)
            for (std::int32_t j = 0; j < around; ++j) {
                const std::int32_t a = i * around + j, b = i * around + (j + 1) % around, c = b + around, d = a + around;
                mesh.triangles.push_back({a, c, b});
                mesh.triangles.push_back({a, d, c});
            }
        const RepairReport report = repair(mesh);
        REQUIRE(report.loops.size() == 2);
        CentrelineGaps gaps;
        const Centreline line = extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops), &gaps);
        CHECK(line.total_length() > 0.19);
        CHECK(line.total_length() < 0.3);
        CHECK(gaps.side_by_side >= 12);
    }

    TEST_CASE("property: branches as narrow as their triangles are long are on the axis")
    {
        // a trunk, two arms and four twigs of 0.4 mm, of triangles of about 0.35 mm
        const auto straight = [](const Vec3& from, const Vec3& to, double radius) {
            SweptTube made;
            for (int k = 0; k <= 60; ++k) made.points.push_back(from + (to - from) * k / 60.0), made.radius.push_back(radius);
            return made;
        };
        std::vector<SweptTube> tubes = {straight({0, 0, 0}, {0.03, 0, 0}, 3e-3)};
        std::vector<Vec3> tips;
        for (const double y : {-1.0, 1.0}) {
            const Vec3 arm(0.045, 0.012 * y, 0);
            tubes.push_back(straight({0.03, 0, 0}, arm, 0.9e-3));
            for (const double z : {-1.0, 1.0}) {
                tips.push_back(arm + Vec3(0.008, 0.004 * y, 0.006 * z));
                tubes.push_back(straight(arm, tips.back(), 0.4e-3));
            }
        }
        const SweptLumen lumen(tubes, 0.2e-3);
        WallMesh mesh = mesh_lumen(lumen, {{{0.002, 0, 0}, -Vec3::UnitX(), 6e-3}}, 16000);
        const RepairReport report = repair(mesh);
        REQUIRE(report.loops.size() == 1);
        CentrelineGaps gaps;
        const LumenQuery query(mesh, report.loops);
        const Centreline line = extract_centreline(mesh, report.loops, query, &gaps);
        CHECK(gaps.unreached.empty());
        for (const Vec3& tip : tips) {
            double to_tip = 1;
            for (const Vec3& p : line.points) to_tip = std::min(to_tip, (p - tip).norm());
            CHECK(to_tip < 2e-3);
        }
        CHECK(line.total_length() < 1.2 * (0.03 + 2 * 0.0192 + 4 * 0.0108));  // no path to and fro
        for (const Vec3& p : line.points) CHECK(query.locate(p).signed_distance > -1e-6);
    }

    TEST_CASE("regression: folds of long slivers, as decimation leaves them, do not draw the axis to the wall")
    {
        // the nearest wall of a point in the middle may be the back of a fold: it was taken for a point in the wall
        constexpr double radius = 3e-3, length = 0.06;
        constexpr std::int32_t columns = 24, along = 80;
        for (const double noise : {0.1e-3, 0.2e-3, 0.3e-3}) {
            CAPTURE(noise);
            // columns of 80 points, each between two that have their ends alone
            WallMesh mesh;
            std::mt19937 random(1);
            std::uniform_real_distribution<double> even(-noise, noise);
            std::vector<std::int32_t> first;
            for (std::int32_t j = 0; j < columns; ++j) {
                const std::int32_t points = j % 2 == 0 ? along : 1;
                first.push_back(static_cast<std::int32_t>(mesh.vertices.size()));
                for (std::int32_t i = 0; i <= points; ++i) {
                    const bool moved = i > 0 && i < points;
                    const auto off = [&] { return moved ? even(random) : 0.0; };
                    const double r = radius + off(), b = 2 * pi * j / columns + off() / radius;
                    mesh.vertices.emplace_back(length * i / points + off(), r * std::cos(b), r * std::sin(b));
                }
            }
            for (std::size_t j = 0; j < columns; ++j)
                for (const std::size_t beside : {j + 1, j + columns - 1}) {
                    if (j % 2 == 1) continue;
                    const std::int32_t near = first[j], ends = first[beside % columns];
                    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
                        mesh.triangles.push_back({a, beside > j + 1 ? c : b, beside > j + 1 ? b : c});
                    };
                    for (std::int32_t i = 0; i < along; ++i) add(near + i, near + i + 1, i < along / 2 ? ends : ends + 1);
                    add(ends, near + along / 2, ends + 1);
                }
            RepairReport report;
            const Centreline line = axis_of(mesh, report);
            REQUIRE(report.loops.size() == 2);
            CHECK(line.total_length() == about(length).epsilon(0.05));
            for (const double r : line.radius) CHECK(r > 0.7 * radius);
        }
    }

    TEST_CASE("property: parts whose rims nearly meet, or are divided differently, are one vessel")
    {
        // a half and its mirror image, not turned, a micrometre apart
        WallMesh half = tube(4e-3, 0.06, 32, 60);
        std::erase_if(half.triangles, [&](const auto& t) {
            double z = 0;
            for (const std::int32_t v : t) z += half.vertices[static_cast<std::size_t>(v)].z();
            return z < 0;
        });
        WallMesh other = half;
        for (Vec3& v : other.vertices) v.z() = -v.z() - 1e-6;
        append(half, other);
        const RepairReport halves = repair(half);
        CHECK(halves.components == 1);
        CHECK(halves.loops.size() == 2);
        CHECK(has_note(halves, "rims of parts that nearly meet were joined"));
        // two prisms of twelve sides: one's sides have two edges each, the other's three
        const auto prism = [](int edges, double x0) {
            WallMesh made = tube(1, 0.03, 12 * edges, 20, x0);
            for (Vec3& v : made.vertices) {
                const double turn = 12 * edges * std::atan2(v.z(), v.y()) / (2 * pi);
                const int k = static_cast<int>(std::lround(turn + 12 * edges)), corner = k / edges % 12;
                const double w = static_cast<double>(k % edges) / edges, b = 2 * pi * corner / 12,
                             c = 2 * pi * ((corner + 1) % 12) / 12;
                v.y() = 4e-3 * ((1 - w) * std::cos(b) + w * std::cos(c));
                v.z() = 4e-3 * ((1 - w) * std::sin(b) + w * std::sin(c));
            }
            return made;
        };
        WallMesh parts = prism(2, 0);
        append(parts, prism(3, 0.03));
        const RepairReport report = repair(parts);
        CHECK(report.components == 1);
        CHECK(report.loops.size() == 2);
    }

    TEST_CASE("property: tubes that run into each other without a union are named, and none is an obstacle")
    {
        WallMesh mesh = tube(5e-3, 0.06, 32, 60), branch = tube(3e-3, 0.05, 24, 50);
        for (Vec3& v : branch.vertices) v = Vec3(0.03 - v.y(), v.x(), v.z());
        append(mesh, branch);
        const RepairReport report = repair(mesh);
        CHECK(has_note(report, "lies in part inside others") != has_note(report, "lie in part inside others"));
        CHECK_FALSE(has_note(report, "obstacle"));
    }

    TEST_CASE("regression: to the opening of another part of the mesh leads no path through the air")
    {
        RepairReport report;
        WallMesh mesh = hemispherical(40, 150, 4e-3, 0.1), other = tube(2e-3, 0.02, 24, 20);
        for (Vec3& v : other.vertices) v += Vec3(0.02, 0.03, 0);
        append(mesh, other);
        const Centreline line = axis_of(mesh, report);
        REQUIRE(report.loops.size() == 3);
        CHECK(line.total_length() == about(0.1).epsilon(0.1));
        for (const Vec3& p : line.points) CHECK(std::hypot(p.y(), p.z()) < 0.1 * 4e-3);
    }
}

}  // namespace seldinger::test::test_field_vessels
