// A coil that is pushed into an aneurysm lies on itself, and across its own inlet.

#include "support/world_fixture.h"
#include "vessel/mesh_fixtures.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_coil {

namespace {

constexpr double radius = 0.3e-3;

WireSpec coil(double length, double bend_radius)
{
    WireSpec spec = steel_wire(length, 0);
    spec.shaft.radius = radius;
    spec.shaft.density = 9000;
    spec.shaft.bend_stiffness = spec.shaft.twist_stiffness = 2e-7;
    spec.shaft.stretch_stiffness = 50;
    spec.shaft.rest_curvature = {1 / bend_radius, 0};
    spec.min_edge = 0.6e-3;
    spec.max_edge = 1.2e-3;
    return spec;
}

/// Least distance of two segments, by its closed form.
double distance(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& v)
{
    const Vec3 w = p - q;
    const double a = u.dot(u), b = u.dot(v), c = v.dot(v), det = a * c - b * b;
    double s = det > 0 ? std::clamp((b * v.dot(w) - c * u.dot(w)) / det, 0.0, 1.0) : 0.0;
    const double t = std::clamp((b * s + v.dot(w)) / c, 0.0, 1.0);
    s = std::clamp((b * t - u.dot(w)) / a, 0.0, 1.0);
    return (w + s * u - t * v).norm();
}

/// Least distance of edges that are farther apart along the wire than half a circle of its surface [m].
double least_distance(const World& world)
{
    const ConstRodView rod = world.rod(0);
    double least = INFINITY;
    for (int i = 0; i + 1 < rod.n; ++i)
        for (int j = i + 1; j + 1 < rod.n; ++j)
            if (rod.material_s[j] - rod.material_s[i + 1] > 3.2 * radius)
                least =
                    std::min(least, distance(rod.pos(i), rod.pos(i + 1) - rod.pos(i), rod.pos(j), rod.pos(j + 1) - rod.pos(j)));
    return least;
}

struct Pushed {
    double least = INFINITY;  // distance of its axis from itself [m]
    double inserted = 0;      // [m]
    int touching = 0;         // steps
};

Pushed push(const TestSetup& from, int steps)
{
    WorldSetup made = from;
    made.instruments_touch = true;
    World world(made);
    const KeyFrames keys(from.keys());
    Pushed pushed;
    for (int k = 0; k < steps; ++k) {
        const StepReport report = step(world, keys.control(), 1e-3);
        CAPTURE(k);
        REQUIRE_FALSE(report.failed());
        const double least = least_distance(world);
        pushed.least = std::min(pushed.least, least);
        pushed.touching += least < 2 * radius;
    }
    pushed.inserted = world.readings(0).inserted;
    return pushed;
}

/// Closed, with the lumen inside.
void add_sphere(TestSetup& setup, double size)
{
    setup.mesh = sphere(size, Vec3::Zero(), 4);
    for (auto& triangle : setup.mesh.triangles) std::swap(triangle[1], triangle[2]);
    setup.vessel.shape = VesselShape::Mesh;
}

// The law lets axes of one wire come 1.5 radii near, whatever pushes. Edges of the polygon are nearer than the curve by up to
// kappa l^2/8, 0.06 mm at 1.2 mm and 1/3 mm: no more than 0.1 radii of it count, as at most one of two strands is bent towards
// the other.
constexpr double nearest = 1.4 * radius;

}  // namespace

TEST_SUITE("step/coil")
{
    // The second half of the ring is tilted so that the tip comes back 1.2 radii beside the wire that it is fed with.
    TEST_CASE("property: a ring that closes on its own inlet does not enter itself")
    {
        constexpr double bend = 3e-3;
        TestSetup setup;
        setup.gravity = Vec3::Zero();
        add_tube(setup, tube(0.02, 0.06, 1000));
        WireSpec spec = coil(0.04, bend);
        WireSection tilted = spec.shaft;
        tilted.rest_curvature = Vec2(std::cos(0.06), std::sin(0.06)) / bend;
        spec.sections.push_back({0, 0.012, tilted});
        setup.wires = {fed_wire(spec, {0.03, 0, 0}, 0.04)};
        const Pushed pushed = push(setup, 700);
        CHECK(pushed.inserted == about(0.028));
        CHECK(pushed.touching > 50);
        CHECK(pushed.least > nearest);
    }

    TEST_CASE("property: a coil fills a sphere and passes nothing, itself included")
    {
        TestSetup setup;
        setup.gravity = Vec3::Zero();
        add_sphere(setup, 3.5e-3);
        setup.wires = {fed_wire(coil(0.08, 2.8e-3), {-2.5e-3, 0, 0}, 0.06)};
        const Pushed pushed = push(setup, 1000);
        CHECK(pushed.inserted == about(0.06));
        CHECK(pushed.touching > 300);
        CHECK(pushed.least > nearest);
    }
}

}  // namespace seldinger::test::test_coil
