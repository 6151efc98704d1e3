// Control meshes of generated and of patients' walls: topology, sizes, angles, distance; the choice of the edge; refusals.
#include "core/error.h"
#include "repair/repair.h"
#include "setup/vessel_load.h"
#include "shapes/aortic_arch.h"
#include "shapes/subdivide.h"
#include "shapes/swept_lumen.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/shared_folder.h"
#include "surface/control_mesh.h"
#include "surface/edit_mesh.h"
#include "vessel/mesh_fixtures.h"
#include "vessel/tree.h"
#include "wall/wall_model.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>
#include <set>

namespace seldinger::test::test_control_mesh {

namespace {

constexpr double degree = std::numbers::pi / 180;

struct Wall {
    const char* name;
    WallMesh mesh;
    Centreline axis;
    double edges[2];  // [m]
};

GeneratedVessel arc()
{
    VesselSpec spec = tube_spec(0.006, 0, 20'000);
    spec.bend_radius = 0.02;
    spec.angle = 2;
    spec.lead_in = spec.lead_out = 0.03;
    return make_arc(spec);
}

GeneratedVessel plane(int triangles = 20'000)
{
    VesselSpec spec{.size = 0.08, .triangles = triangles};
    return make_plane(spec);
}

/// One tube that becomes two.
GeneratedVessel fork()
{
    const auto line = [](const Vec3& a, const Vec3& b, double radius) {
        SweptTube tube;
        for (int i = 0; i <= 40; ++i) tube.points.push_back(a + i / 40.0 * (b - a)), tube.radius.push_back(radius);
        return tube;
    };
    const Vec3 root(-0.04, 0, 0), left(0.04, 0.025, 0), right(0.04, -0.025, 0);
    const std::vector<SweptTube> tubes = {line(root, Vec3::Zero(), 0.006), line(Vec3::Zero(), left, 0.0045),
                                          line(Vec3::Zero(), right, 0.0045)};
    std::vector<LumenEnd> ends;
    for (const Vec3& p : {root, left, right}) ends.push_back({0.95 * p, p.normalized(), 0.012});
    GeneratedVessel vessel{mesh_lumen(SweptLumen(tubes, 0.002), ends, 20'000), {}};
    for (const SweptTube& tube : tubes)
        for (std::size_t i = 0; i < tube.points.size(); ++i) {
            vessel.centreline.points.push_back(tube.points[i]);
            vessel.centreline.radius.push_back(tube.radius[i]);
            vessel.centreline.parent.push_back(i == 0 ? -1 : static_cast<int>(vessel.centreline.points.size()) - 2);
        }
    return vessel;
}

WallMesh torus(double around, double radius, int n, int m)
{
    WallMesh mesh;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) {
            const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m, r = around + radius * std::cos(v);
            mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), radius * std::sin(v));
            const auto at = [&](int a, int b) { return (i + a) % n * m + (j + b) % m; };
            mesh.triangles.push_back({at(0, 0), at(1, 1), at(1, 0)});
            mesh.triangles.push_back({at(0, 0), at(0, 1), at(1, 1)});
        }
    return mesh;
}

const std::vector<Wall>& walls()
{
    static const std::vector<Wall> all = [] {
        std::vector<Wall> list;
        const auto add = [&](const char* name, GeneratedVessel v, double fine, double coarse) {
            list.push_back({name, std::move(v.mesh), std::move(v.centreline), {fine, coarse}});
        };
        add("tube", make_tube(tube_spec(0.01, 0.2, 30'000)), 0.0033, 0.0055);
        add("short tube", make_tube(tube_spec(0.01, 0.01, 10'000)), 0.002, 0.004);
        add("coarse tube", make_tube(tube_spec(0.01, 0.1, 600)), 0.002, 0.004);  // finer than the wall itself
        add("arc", arc(), 0.002, 0.0035);
        add("plane", plane(), 0.002, 0.006);
        add("arch", make_aortic_arch(ArchSpec{}), 0.0033, 0.0055);
        add("fork", fork(), 0.0015, 0.0027);
        list.push_back({"torus", torus(0.03, 0.008, 200, 60), {}, {0.002, 0.004}});
        return list;
    }();
    return all;
}

struct Topology {
    long euler = 0;
    std::size_t rims = 0;
    bool sheet = true;  // edges of one or two triangles that agree, vertices with one fan, no vertex alone
};

Topology topology_of(const WallMesh& mesh)
{
    Topology result;
    const MeshEdges edges = find_edges(mesh);
    result.euler = static_cast<long>(mesh.vertices.size() + mesh.triangles.size()) - static_cast<long>(edges.count());
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        result.sheet &= uses.size() < 3;
        if (uses.size() == 2) result.sheet &= half_edge_from(mesh, uses[0]) == half_edge_to(mesh, uses[1]);
    }
    if (!result.sheet) return result;
    const EditMesh fans(mesh, edges);  // a vertex with two fans becomes two
    result.sheet &= fans.vertex_count() == static_cast<std::int32_t>(mesh.vertices.size());
    for (std::int32_t v = 0; v < fans.vertex_count(); ++v) result.sheet &= fans.has_vertex(v);
    result.rims = boundary_chains(mesh, edges).size();
    return result;
}

/// Ends of all edges of one triangle.
std::vector<std::pair<Vec3, Vec3>> rim_edges(const WallMesh& wall)
{
    std::vector<std::pair<Vec3, Vec3>> list;
    const MeshEdges edges = find_edges(wall);
    for (std::size_t k = 0; k < edges.count(); ++k)
        if (const std::int32_t h = edges.uses(k)[0]; edges.uses(k).size() == 1)
            list.emplace_back(wall.vertices[half_edge_from(wall, h)], wall.vertices[half_edge_to(wall, h)]);
    return list;
}

double distance_to_rims(const std::vector<std::pair<Vec3, Vec3>>& rims, const Vec3& p)
{
    double least = 1e9;
    for (const auto& [a, b] : rims) {
        const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        least = std::min(least, (p - a - t * (b - a)).norm());
    }
    return least;
}

/// Triangles that look away from the wall's nearest one.
int turned_over(const WallMesh& wall, const WallMesh& control)
{
    const WallTree tree = build_wall_tree(wall);
    int count = 0;
    for (std::size_t t = 0; t < control.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(control, t);
        const TreeHit hit = nearest_on_wall(tree, (tri.a + tri.b + tri.c) / 3);
        count += double_area(tri).dot(double_area(triangle_of(wall, tree.original[hit.triangle]))) <= 0;
    }
    return count;
}

void refused(const WallMesh& mesh, const std::string& expected)
{
    ControlMeshSpec spec;
    spec.edge = 0.004;
    check_refused([&] { return make_control_mesh(mesh, spec); }, {expected}, ErrorKind::BadFile);
}

}  // namespace

TEST_SUITE("surface/control_mesh")
{
    TEST_CASE("property: topology and orientation are the wall's, and edges and angles are what was asked for")
    {
        for (const Wall& wall : walls())
            for (const double edge : wall.edges) {
                CAPTURE(wall.name);
                CAPTURE(edge);
                ControlMeshSpec spec;
                spec.edge = edge;
                spec.centreline = &wall.axis;
                ControlMeshReport report;
                const WallMesh mesh = make_control_mesh(wall.mesh, spec, &report);
                const Topology before = topology_of(wall.mesh), after = topology_of(mesh);
                REQUIRE(after.sheet);
                CHECK(after.euler == before.euler);
                CHECK(after.rims == before.rims);
                CHECK(report.rims == static_cast<long>(before.rims));
                CHECK(turned_over(wall.mesh, mesh) == 0);
                // split at 4/3 and collapsed at 4/5 of the target; the last moves and turns stretch that by a little
                CHECK(report.fit_least > 0.5);
                CHECK(report.fit_most < 1.6);
                CHECK(report.angle_least > 20 * degree);
                CHECK(report.regular > 0.7);
                // edges of at most 1.33 * 0.6 R on a cylinder: the middle of such a triangle is (e / sqrt 3)^2 / 2R off
                CHECK(report.distance < 0.25 * edge);
            }
    }

    TEST_CASE("analytic: on a tube the mesh is off by the sagitta of its triangles")
    {
        const Wall& tube = walls()[0];
        for (const double edge : tube.edges) {
            ControlMeshSpec spec;
            spec.edge = edge;
            spec.centreline = &tube.axis;
            ControlMeshReport report;
            (void)make_control_mesh(tube.mesh, spec, &report);
            // a point of a triangle is at most its circumradius from a corner on the tube; the longest edge spans it
            const double most = report.edge_most / std::sqrt(3.0);
            CHECK(report.distance < most * most / (2 * 0.01) + 1e-5);  // the fine wall's own sagitta, 8 um
            CHECK(report.distance > 0.1 * most * most / (2 * 0.01));
        }
    }

    TEST_CASE("property: vertices lie on the wall, rims on its rims, corners of a plane on its corners")
    {
        for (const Wall& wall : walls()) {
            CAPTURE(wall.name);
            ControlMeshSpec spec;
            spec.edge = wall.edges[1];
            spec.centreline = &wall.axis;
            const WallMesh mesh = make_control_mesh(wall.mesh, spec);
            const WallTree tree = build_wall_tree(wall.mesh);
            const auto rims = rim_edges(wall.mesh);
            double off = 0, rim_off = 0;
            // the tree's wall is rounded to float32: 2^-24 of 0.3 m
            for (const Vec3& p : mesh.vertices) off = std::max(off, std::sqrt(nearest_on_wall(tree, p).distance2));
            CHECK(off < 5e-8);
            for (const auto& chain : boundary_chains(mesh, find_edges(mesh))) {
                CHECK(chain.size() >= 4);
                for (const std::int32_t v : chain) rim_off = std::max(rim_off, distance_to_rims(rims, mesh.vertices[v]));
            }
            CHECK(rim_off < 1e-14);  // interpolated along the rim: a few roundings of 0.3 m
        }
        const Wall& square = walls()[4];
        ControlMeshSpec spec;
        spec.edge = 0.006;
        const WallMesh mesh = make_control_mesh(square.mesh, spec);
        for (const double x : {-0.04, 0.04})
            for (const double y : {-0.04, 0.04})
                CHECK(std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                                  [&](const Vec3& p) { return (p - Vec3(x, y, 0)).norm() < 1e-15; }));
    }

    TEST_CASE("property: edges are short where the lumen is narrow")
    {
        const Wall& vessel = walls()[6];  // the fork: 6 mm and 4.5 mm
        ControlMeshSpec spec;
        spec.edge = 0.005;
        spec.centreline = &vessel.axis;
        const WallMesh mesh = make_control_mesh(vessel.mesh, spec);
        double root = 0, branch = 0;
        int in_root = 0, in_branch = 0;
        const MeshEdges edges = find_edges(mesh);
        for (std::size_t k = 0; k < edges.count(); ++k) {
            const Vec3 &a = mesh.vertices[half_edge_from(mesh, edges.uses(k)[0])],
                       &b = mesh.vertices[half_edge_to(mesh, edges.uses(k)[0])];
            if (a.x() < -0.01) root += (b - a).norm(), ++in_root;
            if (a.x() > 0.02) branch += (b - a).norm(), ++in_branch;
        }
        REQUIRE(in_root > 50);
        REQUIRE(in_branch > 50);
        // 0.6 of the radius, to the tenth by which the mean edge differs from its target
        CHECK(root / in_root == about(0.6 * 0.006).epsilon(0.1));
        CHECK(branch / in_branch == about(0.6 * 0.0045).epsilon(0.1));
    }

    TEST_CASE("property: the same wall gives the same bits, whatever was made before")
    {
        const Wall& wall = walls()[5];
        ControlMeshSpec spec;
        spec.edge = wall.edges[1];
        spec.centreline = &wall.axis;
        const WallMesh first = make_control_mesh(wall.mesh, spec), second = make_control_mesh(wall.mesh, spec);
        CHECK(first.triangles == second.triangles);
        CHECK(first.vertices == second.vertices);
    }

    TEST_CASE("property: a finer wall of the same shape gives a control mesh of the same size")
    {
        // 14,000 and 230,000 triangles: numbers of vertices follow area and target, not the wall's own
        ControlMeshSpec spec;
        spec.edge = 0.004;
        std::vector<double> vertices;
        for (const int triangles : {14'000, 230'000}) {
            const GeneratedVessel tube = make_tube(tube_spec(0.012, 0.15, triangles));
            spec.centreline = &tube.centreline;
            vertices.push_back(static_cast<double>(make_control_mesh(tube.mesh, spec).vertices.size()));
        }
        CHECK(vertices[0] == about(vertices[1]).epsilon(0.08));
        CHECK(vertices[0] == about(2 * std::numbers::pi * 0.012 * 0.15 / (0.5 * std::sqrt(3.0) * 0.004 * 0.004)).epsilon(0.3));
    }

    TEST_CASE("property: a sheet that touches itself in a vertex is parted there")
    {
        // two quadrilaterals that share a corner are taken out of a plane: one hole whose rim passes the corner twice
        WallMesh mesh = plane(800).mesh;
        const auto in_quad = [&](std::size_t t, int sign) {
            const Triangle3 tri = triangle_of(mesh, t);
            const Vec3 c = sign * (tri.a + tri.b + tri.c) / 3;
            return c.x() > 0 && c.y() > 0 && c.x() < 0.004 && c.y() < 0.004;
        };
        std::vector<std::array<std::int32_t, 3>> kept;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            if (!in_quad(t, 1) && !in_quad(t, -1)) kept.push_back(mesh.triangles[t]);
        REQUIRE(kept.size() == mesh.triangles.size() - 4);
        mesh.triangles = kept;
        CHECK_FALSE(topology_of(mesh).sheet);
        ControlMeshSpec spec;
        spec.edge = 0.006;
        ControlMeshReport report;
        const WallMesh control = make_control_mesh(mesh, spec, &report);
        CHECK(topology_of(control).sheet);
        CHECK(report.rims == 2);
        CHECK(topology_of(control).euler == 0);
        CHECK(report.angle_least > 15 * degree);
    }

    TEST_CASE("property: what is no sheet is refused by a line that says where")
    {
        const WallMesh tube = make_tube(tube_spec(0.01, 0.05, 2000)).mesh;
        refused({}, "the wall has no triangles");
        WallMesh winged = tube;
        winged.vertices.push_back(Vec3(0.02, 0.02, 0));
        winged.triangles.push_back(
            {tube.triangles[500][0], tube.triangles[500][1], static_cast<std::int32_t>(tube.vertices.size())});
        refused(winged, "but 1 of its edges belong to three triangles or more, the first at (");
        WallMesh mixed = tube;
        flip(mixed, 500);
        refused(mixed, "must have two sides, but at (");
        WallMesh two = tube;
        append(two, sphere(0.002, Vec3(0.02, 0, 0), 1));
        (void)repair(two);  // the sphere's triangles have their own corners
        refused(two, "but it is in 2 pieces, the smallest of 32 triangles at (");
        WallMesh flat = plane(200).mesh;  // squashed to a line
        for (Vec3& v : flat.vertices) v.y() = 0;
        refused(flat, "folded flat or pinched");
    }

    TEST_CASE("property: edges that memory has no room for are refused with what they would take")
    {
        CHECK_NOTHROW(check_control_edge(0.02, 0.003));
        const std::string message = refusal([] { check_control_edge(0.02, 1e-5); }, ErrorKind::BadScene);
        CHECK(message.find("vessel.wall_edge_m: 1e-05 m makes about 2.3e+08 vertices, whose matrix factor takes ") == 0);
        const WallMesh tube = make_tube(tube_spec(0.01, 0.05, 2000)).mesh;
        ControlMeshSpec spec;
        spec.edge = 1e-6;
        CHECK_THROWS_AS((void)make_control_mesh(tube, spec), Error);
    }
}

TEST_SUITE("wall/wall_edge")
{
    /// The edge chosen for a vessel.
    WallEdge chosen(const VesselSpec& spec, const GeneratedVessel& vessel)
    {
        return choose_wall_edge(WallModel(spec, vessel.mesh, vessel.centreline));
    }

    TEST_CASE("analytic: a third of the radius, or half the decay length of Hetenyi's beam")
    {
        VesselSpec spec = tube_spec(0.01, 0.03, 5000);
        spec.thickness = 0.001;
        const double bend = 1e6 * 1e-9 / (12 * (1 - 0.45 * 0.45)), beta4 = (1e6 * 0.001 / 1e-4 + 1e6) / (4 * bend);
        const WallEdge thin = chosen(spec, make_tube(spec));
        CHECK(thin.edge == about(0.5 * std::pow(beta4, -0.25)).epsilon(1e-12));
        CHECK(thin.share == 0.6);
        CHECK(thin.why == "1.2 mm (half the decay length)");
        spec.thickness = 0.009;  // half of 1/beta is 0.4 sqrt(t R) without tissue, above R/3 for t > 0.69 R
        spec.support = 0;
        const WallEdge thick = chosen(spec, make_tube(spec));
        CHECK(thick.edge == about(0.01 / 3).epsilon(1e-12));
        CHECK(thick.why == "3.3 mm (a third of the lumen's radius)");
        // of a plane only the tissue counts
        spec = VesselSpec{};
        spec.size = 0.03;
        spec.triangles = 2000;
        const WallEdge flat = chosen(spec, make_plane(spec));
        CHECK(flat.edge == about(0.5 * std::pow(1e6 / (4 * bend), -0.25)).epsilon(1e-12));
    }

    TEST_CASE("property: not more than about 2,000 vertices, and it says so")
    {
        VesselSpec spec = tube_spec(0.01, 0.3, 20'000);
        const GeneratedVessel tube = make_tube(spec);
        const WallEdge longer = chosen(spec, tube);
        CHECK(longer.vertices == about(2000).epsilon(0.005));
        CHECK(longer.why == "3.3 mm (2,000 vertices; half the decay length would be 1.2 mm)");
        ControlMeshSpec control;
        control.edge = longer.edge;
        control.centreline = &tube.centreline;
        // the lattice found on a regular wall may be 10 % finer or coarser than asked: a quarter in vertices
        CHECK(static_cast<double>(make_control_mesh(tube.mesh, control).vertices.size()) == about(2000).epsilon(0.3));
        // a plane without tissue has no decay length
        spec = VesselSpec{};
        spec.size = 0.03;
        spec.triangles = 2000;
        spec.support = 0;
        CHECK(chosen(spec, make_plane(spec)).why == "0.72 mm (2,000 vertices)");
        // a long narrow vessel needs more than 0.6 of its radius allows
        spec = tube_spec(0.002, 1.0, 20'000);
        const WallEdge narrow = chosen(spec, make_tube(spec));
        CHECK(narrow.share > 0.6);
        CHECK(narrow.share <= 1.0);
    }
}

TEST_SUITE("surface/edit_mesh")
{
    TEST_CASE("property: no sequence of changes alters the topology")
    {
        for (const WallMesh& start : {make_tube(tube_spec(0.01, 0.03, 300)).mesh, torus(0.03, 0.01, 20, 8), plane(100).mesh}) {
            EditMesh mesh(start, find_edges(start));
            const Topology before = topology_of(start);
            std::mt19937 random(7);
            int done[3] = {0, 0, 0};
            for (int step = 0; step < 20'000; ++step) {
                const auto h = static_cast<std::int32_t>(random() % static_cast<unsigned>(mesh.half_edge_count()));
                // more collapses than splits, so that the link condition is met at its limits
                const unsigned kind = mesh.has_triangle_of(h) ? random() % 8 : 8;
                if (kind < 1) mesh.split(h), ++done[0];
                else if (kind < 3 && mesh.can_flip(h)) mesh.flip(h), ++done[1];
                else if (kind >= 3 && kind < 8 && mesh.can_collapse(h)) mesh.collapse(h), ++done[2];
                if (step % 100 != 99) continue;
                WallMesh now;
                const auto to = mesh.compact();
                now.triangles = mesh.triangles();
                now.vertices.resize(static_cast<std::size_t>(mesh.vertex_count()), Vec3::Zero());
                const Topology after = topology_of(now);
                REQUIRE(after.sheet);
                REQUIRE(after.euler == before.euler);
                REQUIRE(after.rims == before.rims);
                for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
                    std::set<std::int32_t> around;
                    mesh.for_neighbours(v, [&](std::int32_t w) { around.insert(w); });
                    REQUIRE(static_cast<int>(around.size()) == mesh.valence(v));
                }
            }
            for (const int count : done) CHECK(count > 20);  // a torus of seven vertices has no edge left that could turn
        }
    }
}

TEST_SUITE("wall/patients")
{
    TEST_CASE("property: control meshes of the shared patients' vessels")
    {
        const auto shared = shared_folder_or_skip();
        if (!shared) return;
        struct Row {
            const char *file, *units;
            double angle;  // [degrees]; lower where the wall itself is folded flat (a coronary on the border of its volume) or
                           // pinched
        };
        for (const Row& row :
             {Row{"tha001-arch/aorta_arch_30k.stl", "mm", 18}, Row{"seqseg-aortoiliac/demo.vtp", "cm", 15},
              Row{"tha016-root-coronary/marfan_ao.obj", "mm", 0}, Row{"sofa-carotids/carotids.stl", "mm", 20},
              Row{"vmtk-aorta-bif/aorta-surface.stl", "mm", 20}, Row{"vmtk-aorta-bif/aorta-surface-open-ends.stl", "mm", 20},
              Row{"seqseg-shawn260-hostile/shawn_260.vtp", "cm", 0}}) {
            CAPTURE(row.file);
            VesselSpec spec{.shape = VesselShape::Mesh, .mesh = *shared / "vessels" / row.file, .units = row.units};
            const LoadedVessel vessel = load_vessel(spec);
            ControlMeshSpec control;
            control.edge = 0.0035;
            control.centreline = &vessel.centreline;
            ControlMeshReport report;
            const WallMesh mesh = make_control_mesh(vessel.mesh, control, &report);
            const Topology before = topology_of(vessel.mesh), after = topology_of(mesh);
            REQUIRE(after.sheet);
            CHECK(after.euler == before.euler);
            CHECK(after.rims == before.rims);
            CHECK(report.fit_least > 0.5);
            CHECK(report.fit_most < 1.6);
            CHECK(report.angle_least > row.angle * degree);
            CHECK(report.distance < 0.0035);
        }
    }
}

}  // namespace seldinger::test::test_control_mesh
