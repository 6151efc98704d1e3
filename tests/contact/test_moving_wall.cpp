// Contact with a wall that moves: forces, slip and damping go by the motion of the wire relative to the wall's own; what is
// remembered of the wall's place loses its force as the wall moves. Motions here are prescribed.
//
// Vertices are floats, so a wall's place is rounded, to 2^-28 m within 62 mm of its centre. Where a test asks for equal forces,
// vertices and moves are whole multiples of 2^-26 m: nothing is rounded but the kernels' own arithmetic, 1e-16 of millimetres
// over an overlap of micrometres.

#include "contact/moved_wall.h"
#include "core/error.h"

#include <doctest/doctest.h>

#include <random>

using namespace seldinger;
using namespace seldinger::test;

namespace {

constexpr double unit = 0x1p-26;        // [m]
constexpr double h = 1e-3;              // [s]
constexpr double overlap = 128 * unit;  // of the wire that rests on the floor, 1.9 um
constexpr double equal = 1e-9;

// z = 0, 125 mm by 31 mm, facing up
WallMesh floor_mesh()
{
    WallMesh mesh;
    const int nx = 16, ny = 4;
    for (int i = 0; i <= nx; ++i)
        for (int j = 0; j <= ny; ++j) mesh.vertices.push_back({(i - nx / 2) * 0x1p-7, (j - ny / 2) * 0x1p-7, 0});
    for (int i = 0; i < nx; ++i)
        for (int j = 0; j < ny; ++j) {
            const int a = i * (ny + 1) + j, b = a + ny + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

TestSetup on_floor(Detection detection = Detection::Swept, NormalLaw normal = NormalLaw::HuntCrossley,
                    FrictionLaw friction = FrictionLaw::StickSlip)
{
    TestSetup setup;
    setup.mesh = floor_mesh();
    WireSpec spec = steel_wire(0x1p-5, 9);
    spec.shaft.radius = 0x1p-11;
    setup.wires.push_back(placed_wire(spec, {-0x1p-6, 0x1p-9, 0x1p-11 - overlap}));
    setup.wires[0].contact.detection = detection;
    setup.wires[0].contact.normal = normal;
    setup.wires[0].contact.friction = friction;
    return setup;
}

void check_same(MovedWall& a, MovedWall& b)
{
    const std::vector<ContactRow> x = a.rows(), y = b.rows();
    REQUIRE(x.size() > 20);
    REQUIRE(x.size() == y.size());
    CHECK(y[0].normal_force == doctest::Approx(x[0].normal_force).epsilon(equal));
    for (std::size_t k = 0; k < x.size(); ++k) {
        CAPTURE(k);
        CHECK(x[k].stuck == y[k].stuck);
        CHECK(std::abs(x[k].gap - y[k].gap) <= equal * overlap);
        CHECK(std::abs(x[k].normal_force - y[k].normal_force) <= equal * x[k].normal_force);
        CHECK((x[k].friction - y[k].friction).norm() <= equal * x[k].normal_force);
    }
}

}  // namespace

TEST_SUITE("contact/moving_wall")
{
    TEST_CASE("property: Galilean invariance: wire and wall that move together are as both at rest")
    {
        device::Context context;
        const Vec3 pull(8 * unit, 3 * unit, 0), together(1024 * unit, -512 * unit, 256 * unit);  // 15 um a step: 15 mm/s
        for (const Detection detection : {Detection::Swept, Detection::Capsule, Detection::Nodes})
            for (const NormalLaw law : {NormalLaw::HuntCrossley, NormalLaw::Augmented, NormalLaw::Constraint}) {
                if (detection == Detection::Nodes && law != NormalLaw::HuntCrossley) continue;
                TestSetup setup = on_floor(detection, law);
                if (detection == Detection::Nodes) setup.wires[0].wire.nodes = 65;
                MovedWall rest(context, setup), moving(context, setup);
                CAPTURE(static_cast<int>(law));
                for (int k = 0; k < 12; ++k) {
                    const Vec3 own = k < 3 ? pull : Vec3::Zero();  // loads the anchors of friction, then holds
                    rest.step(own, Vec3::Zero(), h);
                    moving.step(own + together, together, h);
                }
                check_same(rest, moving);
                REQUIRE(rest.rows()[0].friction.norm() > 1e-3 * rest.rows()[0].normal_force);
            }
    }

    TEST_CASE("property: on a wall that moves as a whole, any way, contact sticks where it did, to the rounding of vertices")
    {
        device::Context context;
        const Vec3 together(1.1e-5, 0.7e-5, 0.3e-5);
        MovedWall rest(context, on_floor()), moving(context, on_floor());
        for (int k = 0; k < 12; ++k) {
            rest.step(Vec3::Zero(), Vec3::Zero(), h);
            moving.step(together, together, h);
        }
        const std::vector<ContactRow> x = rest.rows(), y = moving.rows();
        REQUIRE(x.size() == y.size());
        // a vertex is rounded by half of 2^-28 m, the gap and the move of a step by as much as both their vertices are
        for (std::size_t k = 0; k < x.size(); ++k) {
            CHECK(y[k].stuck);
            CHECK(std::abs(x[k].gap - y[k].gap) <= 0x1p-28);
        }
    }

    TEST_CASE("analytic: a wire held still on a wall that slides feels mu N in the direction in which the wall goes")
    {
        device::Context context;
        const TestSetup setup = on_floor();
        MovedWall rig(context, setup);
        const Vec3 way = Vec3(-4, 3, 0) / 5;
        for (int k = 0; k < 30; ++k) rig.step(Vec3::Zero(), 1280 * unit * Vec3(-4, 3, 0) / 5, h);
        const std::vector<ContactRow> rows = rig.rows();
        REQUIRE(rows.size() > 20);
        for (const ContactRow& row : rows) {
            CHECK(!row.stuck);
            CHECK((row.friction - setup.wires[0].wire.shaft.mu_sliding * row.normal_force * way).norm() <=
                  equal * row.normal_force);
        }
    }

    TEST_CASE("property: a floor that rises under a wire is damped as a wire that sinks")
    {
        device::Context context;
        const Vec3 up(0, 0, 16 * unit);
        for (const NormalLaw law : {NormalLaw::HuntCrossley, NormalLaw::LankaraniNikravesh, NormalLaw::Impulse}) {
            MovedWall sinking(context, on_floor(Detection::Swept, law)), rising(context, on_floor(Detection::Swept, law));
            double fixed = 0;
            for (int k = 0; k < 6; ++k) {
                sinking.step(-up, Vec3::Zero(), h);
                rising.step(Vec3::Zero(), up, h);
                CHECK(rising.totals().normal == doctest::Approx(sinking.totals().normal).epsilon(equal));
                fixed = sinking.totals().normal;
            }
            REQUIRE(fixed > 0);
        }
        // and the damping is there to be seen: the same overlap at rest carries less
        MovedWall rising(context, on_floor()), still(context, on_floor());
        rising.step(Vec3::Zero(), up, h);
        for (int k = 0; k < 2; ++k) still.step(k == 0 ? Vec3(-up) : Vec3::Zero(), Vec3::Zero(), h);
        CHECK(rising.totals().normal > 1.05 * still.totals().normal);
    }

    TEST_CASE("property: a wall that turns under a wire drags it by its speed there")
    {
        device::Context context;
        MovedWall rig(context, on_floor());
        // a turn about the axis x = y = 0, straight on: displacement of a vertex = phi z x its place
        std::vector<Vec3> turned = floor_mesh().vertices;
        const double phi = 0x1p-10;
        for (Vec3& p : turned) p = phi * Vec3(-p.y(), p.x(), 0);
        rig.step(Vec3::Zero(), Vec3::Zero(), h);
        rig.step_to(Vec3::Zero(), turned, true, h);
        const std::vector<ContactRow> rows = rig.rows();
        REQUIRE(rows.size() > 20);
        int seen = 0;
        for (const ContactRow& row : rows) {
            const Vec3 way = phi * Vec3(-row.point.y(), row.point.x(), 0);
            if (row.friction.norm() == 0 || row.stuck) continue;
            CHECK(row.friction.normalized().dot(way.normalized()) >= 1 - 1e-6);
            ++seen;
        }
        REQUIRE(seen > 10);
    }

    TEST_CASE("property: contact after any moves of the wall is that of one move to the same place")
    {
        device::Context context;
        std::mt19937 rng(3);
        std::uniform_real_distribution<double> draw(-1, 1);
        TestSetup setup;
        add_tube(setup, tube(0.002, 0.06, 3000));
        setup.wires.push_back(placed_wire(steel_wire(0.04, 21), {0.01, 0, 0}));
        setup.wires[0].contact.friction = FrictionLaw::None;
        for (const Detection detection : {Detection::Swept, Detection::Nodes}) {
            setup.wires[0].contact.detection = detection;
            MovedWall walked(context, setup);
            int touched = 0, clear = 0;
            for (int k = 0; k < 60; ++k) {
                // Across the lumen, to the wall and not so far, and by so little that lists and spheres hold. The axis stays
                // inside, 1.9 mm from the middle at most: beyond the wall, contact depends on where the wire came from.
                const double angle = 3.2 * draw(rng), across = k % 6 == 0 ? 1.595e-3 + 2.5e-5 * draw(rng) : 9e-4 * draw(rng);
                const double size = k % 3 == 0 ? across : k % 3 == 1 ? 4e-5 : 1e-5;
                const Vec3 shift = size * Vec3(draw(rng), std::cos(angle), std::sin(angle));
                const Vec3 bump = std::min(std::abs(size), 1e-4) * Vec3(0, std::sin(angle), draw(rng));
                std::vector<Vec3> to =
                    k % 3 == 0 ? std::vector<Vec3>(setup.mesh.vertices.size(), Vec3::Zero()) : walked.displacement();
                for (std::size_t v = 0; v < to.size(); ++v) to[v] += shift + std::sin(200 * setup.mesh.vertices[v].x()) * bump;
                walked.step_to(Vec3::Zero(), to, true, 0);
                MovedWall once(context, setup);
                once.step_to(Vec3::Zero(), to, true, 0);
                const std::vector<ContactRow> x = once.rows(), y = walked.rows();
                CAPTURE(k);
                REQUIRE(x.size() == y.size());
                for (std::size_t i = 0; i < x.size(); ++i) {
                    CHECK(x[i].b.element == y[i].b.element);
                    CHECK(x[i].normal_force == y[i].normal_force);
                    CHECK(x[i].gap == y[i].gap);
                }
                touched += !x.empty();
                clear += x.empty();
            }
            REQUIRE(touched > 5);
            REQUIRE(clear > 10);
        }
    }

    TEST_CASE("property: a wall that may move and stands still is one that cannot")
    {
        device::Context context;
        MovedWall fixed(context, on_floor(), false), still(context, on_floor());
        for (int k = 0; k < 5; ++k) {
            const Vec3 own(k == 2 ? 40 * unit : 0, 0, k == 3 ? -10 * unit : 0);
            fixed.step(own, Vec3::Zero(), h);
            still.step(own, Vec3::Zero(), h);
        }
        const std::vector<ContactRow> x = fixed.rows(), y = still.rows();
        REQUIRE(x.size() == y.size());
        REQUIRE(!x.empty());
        for (std::size_t k = 0; k < x.size(); ++k) {
            CHECK(x[k].normal_force == y[k].normal_force);
            CHECK(x[k].friction == y[k].friction);
        }
    }

    TEST_CASE("property: `layer` refuses a wall that moves")
    {
        device::Context context;
        CHECK_THROWS_WITH_AS(MovedWall(context, on_floor(Detection::Layer)), doctest::Contains("layer"), Error);
    }
}
