// The extracted axis of generated vessels, whose axes are known, and the tree's own methods.
#include "mesh_fixtures.h"
#include "repair/repair.h"
#include "shapes/aortic_arch.h"
#include "support/approx.h"
#include "vessel/extract_centreline.h"
#include "vessel/inlets.h"

#include <algorithm>
#include <numbers>

namespace seldinger::test::test_centreline {

namespace {

Centreline extract(const WallMesh& mesh, const RepairReport& report)
{
    return extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops));
}

double distance_to(const Centreline& line, const Vec3& p)
{
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < line.points.size(); ++i) {
        if (line.parent[i] < 0) continue;
        const Vec3 &a = line.points[i], &b = line.points[static_cast<std::size_t>(line.parent[i])];
        const double t = std::clamp((p - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-300), 0.0, 1.0);
        best = std::min(best, (p - a - t * (b - a)).norm());
    }
    return best;
}

}  // namespace

TEST_SUITE("vessel/centreline")
{
    TEST_CASE("analytic: a straight tube's axis, end to end, at its radius")
    {
        const GeneratedVessel tube = make_tube(tube_spec(0.01, 0.15, 6000));
        const RepairReport report = describe(tube.mesh);
        const Centreline line = extract(tube.mesh, report);
        REQUIRE(line.points.size() > 10);
        CHECK(line.main_path().size() == line.points.size());
        CHECK(line.total_length() == about(0.15).epsilon(0.01));
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            CHECK(std::hypot(line.points[i].y(), line.points[i].z()) < 0.02 * 0.01);
            CHECK(line.radius[i] == about(0.01).epsilon(0.02));
        }
    }

    TEST_CASE("analytic: a bend's axis to a tenth of the radius")
    {
        VesselSpec spec = tube_spec(0.005, 0, 8000);
        spec.bend_radius = 0.03;
        spec.angle = std::numbers::pi;
        spec.lead_in = spec.lead_out = 0.04;
        const GeneratedVessel arc = make_arc(spec);
        const Centreline line = extract(arc.mesh, describe(arc.mesh));
        CHECK(line.total_length() == about(arc.centreline.total_length()).epsilon(0.03));
        for (const Vec3& p : line.points) CHECK(distance_to(arc.centreline, p) < 0.1 * 0.005);
    }

    TEST_CASE("property: the aortic arch gives back its five ends, its length and its radii, all points inside")
    {
        const GeneratedVessel arch = make_aortic_arch(ArchSpec{});
        const RepairReport report = describe(arch.mesh);
        const LumenQuery lumen(arch.mesh, report.loops);
        const Centreline line = extract_centreline(arch.mesh, report.loops, lumen);
        std::vector<int> children(line.points.size(), 0);
        for (const int parent : line.parent)
            if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
        CHECK(std::count(children.begin(), children.end(), 0) == 4);  // and the root makes five
        CHECK(line.total_length() == about(arch.centreline.total_length()).epsilon(0.1));
        int outside = 0;
        for (const Vec3& p : line.points) outside += !lumen.inside(p);
        CHECK(outside == 0);
        // the spec's own axis in the straight descending aorta
        for (std::size_t i = 0; i < line.points.size(); ++i)
            if (line.points[i].x() > 0.02 && line.points[i].x() < 0.1 && line.points[i].z() < 0.01) {
                CHECK(distance_to(arch.centreline, line.points[i]) < 0.001);
                CHECK(line.radius[i] == about(0.01225).epsilon(0.03));
            }
    }

    TEST_CASE("property: a closed vessel has its root at an end, and an inlet inside that looks in")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.15, 6000)).mesh;
        // close both ends with fans
        for (const BoundaryLoop& loop : describe(mesh).loops) {
            const auto centre = static_cast<std::int32_t>(mesh.vertices.size());
            mesh.vertices.push_back(loop.centre);
            for (std::size_t i = 0; i < loop.vertices.size(); ++i)
                mesh.triangles.push_back({loop.vertices[(i + 1) % loop.vertices.size()], loop.vertices[i], centre});
        }
        const RepairReport report = repair(mesh);
        REQUIRE(report.loops.empty());
        const LumenQuery lumen(mesh, report.loops);
        const Centreline line = extract_centreline(mesh, report.loops, lumen);
        // the ends narrow over the last radius: between L - 2 R and L
        CHECK(line.total_length() > 0.13);
        CHECK(line.total_length() < 0.152);
        const Inlet inlet = pick_inlet(report.loops, line);
        CHECK(inlet.opening == -1);
        CHECK(lumen.inside(inlet.point));
        CHECK(std::abs(inlet.direction.x()) > 0.99);
        CHECK((inlet.point.x() < 0.075) == (inlet.direction.x() > 0));
        CHECK(inlet.radius > 0.006);
    }

    TEST_CASE("analytic: main path, length and nearest point of a small tree")
    {
        //        4
        //        |
        // 0 - 1 - 2 - 3      parents may stand behind their children
        Centreline line;
        line.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {2, 5, 0}};
        line.radius.assign(5, 0.6);
        line.parent = {-1, 0, 1, 2, 2};
        CHECK(line.main_path() == std::vector<int>{0, 1, 2, 4});
        CHECK(line.total_length() == 8);
        CHECK(line.nearest({2.9, 0.2, 0}) == 3);
        CHECK(line.nearest({2.9, 0.2, 0}, 0) == 3);
        CHECK(Centreline{}.nearest(Vec3::Zero()) == -1);
        CHECK(Centreline{}.main_path().empty());
    }

    TEST_CASE("property: nearest with a hint equals nearest without, along a winding line")
    {
        Centreline line;
        for (int i = 0; i < 400; ++i) {
            line.points.emplace_back(0.001 * i, 0.02 * std::sin(0.05 * i), 0);
            line.radius.push_back(0.004);
            line.parent.push_back(i - 1);
        }
        int hint = 0;
        for (int i = 0; i < 1000; ++i) {
            const double s = 0.4 * i;
            const Vec3 p(0.001 * s + 0.0005, 0.02 * std::sin(0.05 * s) + 0.002, 0.001);
            hint = line.nearest(p, hint);
            REQUIRE(hint == line.nearest(p));
        }
    }
}

}  // namespace seldinger::test::test_centreline
