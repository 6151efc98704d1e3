// Force of a straight wire held rigidly into a wall: its value, and that it does not depend on how the wall's facets are cut.
// The total of a free wire always equals its weight and shows nothing.

#include "contact/held_wire.h"
#include "contact/wall_law.h"

namespace seldinger::test::test_mesh_independence {

namespace {

constexpr double overlap = 5e-6;  // [m]

/// Each triangle cut into parts^2 equal ones in its own plane, with its own copies of the points on its edges.
WallMesh subdivided(const WallMesh& mesh, int parts)
{
    WallMesh fine;
    const int points = (parts + 1) * (parts + 2) / 2;  // of one triangle, row i (parts - i + 1 of them) after row
    const auto triangles = mesh.triangles.size();
    fine.vertices.reserve(triangles * static_cast<std::size_t>(points));
    fine.triangles.reserve(triangles * static_cast<std::size_t>(parts * parts));
    for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.vertices[t[0]], u = (mesh.vertices[t[1]] - a) / parts, v = (mesh.vertices[t[2]] - a) / parts;
        const int base = static_cast<int>(fine.vertices.size());
        const auto at = [&](int i, int j) { return base + i * (parts + 1) - i * (i - 1) / 2 + j; };
        for (int i = 0; i <= parts; ++i)
            for (int j = 0; i + j <= parts; ++j) fine.vertices.push_back(a + i * u + j * v);
        for (int i = 0; i < parts; ++i)
            for (int j = 0; i + j < parts; ++j) {
                fine.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
                if (i + j < parts - 1) fine.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    }
    return fine;
}

/// A square patch in the plane z = `height`, `squares` x `squares` squares of two triangles, facing up or down.
void add_floor(WallMesh& mesh, double height, bool up, int squares)
{
    const int base = static_cast<int>(mesh.vertices.size());
    for (int i = 0; i <= squares; ++i)
        for (int j = 0; j <= squares; ++j)
            mesh.vertices.emplace_back(0.1 * i / squares, 0.1 * j / squares - 0.05, height);
    for (int i = 0; i < squares; ++i)
        for (int j = 0; j < squares; ++j) {
            const int a = base + i * (squares + 1) + j, b = a + squares + 1;
            for (const auto& [p, q, r] : {std::array{a, b, b + 1}, std::array{a, b + 1, a + 1}})
                mesh.triangles.push_back(up ? std::array<std::int32_t, 3>{p, q, r} : std::array<std::int32_t, 3>{p, r, q});
        }
}

}  // namespace

TEST_SUITE("contact/mesh_independence")
{
    TEST_CASE("property: facets of a tube cut finer in their own planes, 1,000 to 3 million: the force of a held wire stays")
    {
        const VesselSpec spec = tube(0.003, 0.1, 1000);
        const GeneratedVessel vessel = make_tube(spec);
        int around = 0;
        for (const Vec3& v : vessel.mesh.vertices) around += std::abs(v.x()) < 1e-9;
        const double half = std::numbers::pi / around, r = steel_wire(0.08, 21).shaft.radius;
        device::Context context(-1);
        // over the middle of a facet, and in the valley between two, each of which presses with half of the force
        const double reach = spec.radius * std::cos(half) - r + overlap;
        const std::string names[] = {"facet", "valley"};
        const double angles[] = {half, 0}, rho[] = {reach, reach / std::cos(half)}, resultant[] = {1, std::cos(half)};
        std::vector<Pose> poses;
        for (int k = 0; k < 2; ++k) poses.push_back({rho[k] * std::sin(angles[k]), rho[k] * std::cos(angles[k])});
        double force[2] = {};
        for (const int parts : {1, 6, 22, 55}) {
            const WallMesh mesh = subdivided(vessel.mesh, parts);
            const std::vector<Push> exact = push_at(context, mesh, vessel.centreline, Detection::Swept, poses);
            const std::vector<Push> published = push_at(context, mesh, vessel.centreline, Detection::Layer, poses);
            for (int k = 0; k < 2; ++k) {
                // beside it, and only shown: triangles times stiffness, where its rays meet the wire at all
                MESSAGE(names[k] << ", " << mesh.triangles.size() << " triangles: capsule " << exact[k].normal << " N, layer "
                                 << published[k].normal << " N (" << published[k].contacts << " pairs)");
                if (parts == 1) force[k] = exact[k].normal;
                REQUIRE(exact[k].normal > 0.1);
                CHECK(exact[k].normal == about(force[k]).epsilon(1e-3));
                const Vec3 outwards(0, std::sin(angles[k]), std::cos(angles[k]));
                CHECK((exact[k].force + resultant[k] * exact[k].normal * outwards).norm() <= 1e-3 * exact[k].normal);
            }
        }
    }

    // per metre k depth^1.5 / (1 - depth/depth_max) under every quadrature point, and the tip's own k_tip depth^2 (D6b, D6c)
    TEST_CASE("analytic: one wall pushes as the law says, edges under the wire or not; two opposite walls twice; a septum once")
    {
        device::Context context(-1);
        const WireSection section = steel_wire(0.08, 21).shaft;
        const VesselSpec wall;
        const double r = section.radius, harden = 1 - overlap / (0.5 * r), z = r - overlap;
        const double line = line_stiffness(rod_side(r, 0), wall_side(INFINITY, r, foundation_modulus(wall))) *
                            std::pow(overlap, 1.5) * 0.08 / harden;
        const double tip = std::numbers::pi * foundation_modulus(wall) * r * overlap * overlap / harden;
        const Centreline none;
        const auto on = [&](const WallMesh& mesh, double y) {
            return push_at(context, mesh, none, Detection::Swept, {{y, z}}).front();
        };
        for (const int squares : {1, 4, 40, 333}) {
            CAPTURE(squares);
            WallMesh floor;
            add_floor(floor, 0, true, squares);
            for (const double y : {0.0, 0.1 / 333, 0.0137}) {  // along a row of edges, of other edges, and anywhere
                CAPTURE(y);
                const Push push = on(floor, y);
                // 5 um between float32 coordinates of 5 cm: 4e-9 off, 1.5 times that in the force
                CHECK(push.normal == about(line + tip).epsilon(1.5 * 4e-9 / overlap));
                CHECK(push.contacts == 181);
                CHECK((push.force - Vec3(0, 0, push.normal)).norm() <= 1e-6);
            }
        }
        WallMesh both;
        add_floor(both, 0, true, 10);
        add_floor(both, 2 * z, false, 7);
        const Push squeezed = on(both, 0.003);
        CHECK(squeezed.normal == about(2 * (line + tip)).epsilon(1.5 * 4e-9 / overlap));
        CHECK(squeezed.contacts == 2 * 181);
        CHECK(squeezed.force.norm() <= 1.5 * 4e-9 / overlap * squeezed.normal);

        // the other lumen's floor is 50 um below this one and faces away: within reach, even inside the wire's radius of its axis
        WallMesh septum;
        add_floor(septum, 0, true, 10);
        add_floor(septum, -50e-6, false, 7);
        const Push one = on(septum, 0.003);
        CHECK(one.normal == about(line + tip).epsilon(1.5 * 4e-9 / overlap));
        CHECK(one.contacts == 181);
    }
}

}  // namespace seldinger::test::test_mesh_independence
