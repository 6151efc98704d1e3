// Closed ends of a vessel and tips that press on them; rims of tears and edges of flat lumens, which are none.
#include "run/closed_ends.h"

#include "repair/repair.h"
#include "scene/scene.h"
#include "support/world_fixture.h"

#include <array>

namespace seldinger::test::test_closed_ends {

namespace {

constexpr double radius = 5e-3, length = 0.1;

/// A tube along x with a flat lid at its far end, or at both.
struct Tube {
    WallMesh mesh;
    Centreline line;
    std::vector<BoundaryLoop> openings;
    explicit Tube(int lids = 1)
    {
        VesselSpec spec = test::tube(radius, length);
        spec.axis = Vec3::UnitX();
        mesh = make_tube(spec).mesh;
        for (const BoundaryLoop& loop : describe(mesh).loops) {
            if (lids == 0 || (lids == 1 && loop.centre.x() < 0.5 * length)) {
                openings.push_back(loop);
                continue;
            }
            const auto centre = static_cast<std::int32_t>(mesh.vertices.size());
            mesh.vertices.push_back(loop.centre);
            for (std::size_t k = 0; k < loop.vertices.size(); ++k)
                mesh.triangles.push_back({centre, loop.vertices[(k + 1) % loop.vertices.size()], loop.vertices[k]});
        }
        for (int k = 0; k <= 40; ++k) {  // as found: from one end nearly to the other
            line.points.emplace_back(1.5e-3 + (length - 3e-3) * k / 40, 0, 0);
            line.radius.push_back(radius);
            line.parent.push_back(k - 1);
        }
    }
    [[nodiscard]] ClosedEnds ends(const std::vector<Vec3>& inlets = {}) const { return {openings, mesh, line, inlets}; }
};

/// A tip on the lid, which presses back; `normal` and place may be others.
Output pressed(const Vec3& tip, const Vec3& normal, double force = 0.1)
{
    Output now;
    now.time = 2.5;
    now.wires.resize(1);
    now.wires[0].tip = tip;
    now.contacts = {{.normal = normal, .normal_force = force}};
    return now;
}

EndTouch touched(const ClosedEnds& ends, const Output& now)
{
    EndTouch touch;
    ends.watch(touch, now);
    return touch;
}

}  // namespace

TEST_SUITE("run/closed_ends")
{
    TEST_CASE("property: a tip that presses on a lid is said, with its place and time; the first one stays")
    {
        const ClosedEnds ends = Tube().ends();
        REQUIRE_FALSE(ends.empty());
        const Vec3 tip(length - 5e-4, 1e-3, 0);
        EndTouch touch = touched(ends, pressed(tip, -Vec3::UnitX()));
        CHECK(touch.rows == 1);
        Scene scene;
        CHECK(describe(touch, scene).find("pressed on a closed end of the vessel from 2.5 s on, near [0.0995, 0.001, 0] m") !=
              std::string::npos);
        Output later = pressed(tip, -Vec3::UnitX());
        later.time = 3;
        ends.watch(touch, later);
        CHECK(touch.rows == 2);
        CHECK(touch.time == 2.5);
        CHECK(describe(EndTouch(), scene).empty());
    }

    TEST_CASE("property: the side of the tube, a contact without force, another place and the wire's shaft press on no end")
    {
        const ClosedEnds ends = Tube().ends();
        const Vec3 tip(length - 5e-4, 1e-3, 0);
        CHECK(touched(ends, pressed(tip, -Vec3::UnitY())).rows == 0);
        CHECK(touched(ends, pressed(tip, -Vec3::UnitX(), 0)).rows == 0);
        CHECK(touched(ends, pressed({0.5 * length, 0, 0}, -Vec3::UnitX())).rows == 0);
        Output shaft = pressed(tip, -Vec3::UnitX());
        shaft.contacts[0].along_a = 2 * radius;
        CHECK(touched(ends, shaft).rows == 0);
        Output other = pressed(tip, -Vec3::UnitX());
        other.contacts[0].b.kind = BodyKind::Rod;
        CHECK(touched(ends, other).rows == 0);
    }

    TEST_CASE("property: openings, and the end where instruments enter, are no closed ends")
    {
        CHECK(Tube(0).ends().empty());
        const Tube closed(2);
        CHECK_FALSE(closed.ends({{radius, 0, 0}}).empty());
        CHECK(closed.ends({{radius, 0, 0}, {length - radius, 0, 0}}).empty());
    }

    TEST_CASE("property: where the lumen goes on beyond the tip of a path, as at a tear or beside a flat lumen, is no closed end")
    {
        // the path of one lumen of a dissection stops at the rim of a tear: wall on one side, the other lumen on the other
        Tube tube;
        tube.line.points.resize(21), tube.line.radius.resize(21), tube.line.parent.resize(21);
        CHECK(tube.ends().empty());
        // a flat lumen of 30 x 6 mm, closed all round: a path to its narrow edge
        WallMesh flat;
        for (const double z : {-3e-3, 3e-3})
            for (const double y : {-15e-3, 15e-3})
                for (const double x : {0.0, length}) flat.vertices.emplace_back(x, y, z);
        const std::array<std::int32_t, 4> sides[] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                                     {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
        for (const auto& [a, b, c, d] : sides) flat.triangles.push_back({a, b, c}), flat.triangles.push_back({a, c, d});
        Centreline across;
        for (int k = 0; k <= 8; ++k) {
            across.points.emplace_back(0.5 * length, -4e-3 + 2e-3 * k, 0);
            across.radius.push_back(3e-3);
            across.parent.push_back(k - 1);
        }
        CHECK(ClosedEnds({}, flat, across, {across.points[0]}).empty());
    }
}

}  // namespace seldinger::test::test_closed_ends
