#pragma once
// Vessels that are hard on contact: a box channel, a stenosis, a bifurcation with its carina, two channels side by side.

#include "repair/repair.h"
#include "shapes/swept_lumen.h"
#include "vessel/extract_centreline.h"
#include "vessel/mesh_fixtures.h"

#include "support/world_fixture.h"

namespace seldinger::test {

/// Wall swept along x over closed sections (all of the same number of points, counter-clockwise seen against x), open at both
/// ends.
inline WallMesh sweep_sections(const std::vector<std::vector<Vec3>>& sections)
{
    WallMesh mesh;
    const int around = static_cast<int>(sections[0].size());
    for (const auto& section : sections) mesh.vertices.insert(mesh.vertices.end(), section.begin(), section.end());
    for (int row = 0; row + 1 < static_cast<int>(sections.size()); ++row)
        for (int k = 0; k < around; ++k) {
            const int a = row * around + k, b = row * around + (k + 1) % around, c = b + around, d = a + around;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

/// Straight channel of rectangular section [y0, y1] x [z0, z1] from x = 0 to `length`, cut into `rows` along it; one panel per
/// wall and row.
inline WallMesh box_channel(double length, double y0, double y1, double z0, double z1, int rows)
{
    std::vector<std::vector<Vec3>> sections;
    for (int k = 0; k <= rows; ++k) {
        const double x = length * k / rows;
        sections.push_back({{x, y0, z0}, {x, y1, z0}, {x, y1, z1}, {x, y0, z1}});
    }
    return sweep_sections(sections);
}

/// The same with walls of squares about `edge` wide.
inline WallMesh fine_channel(double length, double y0, double y1, double z0, double z1, double edge)
{
    const int ny = std::max(1, static_cast<int>(std::lround((y1 - y0) / edge))),
              nz = std::max(1, static_cast<int>(std::lround((z1 - z0) / edge)));
    std::vector<std::vector<Vec3>> sections;
    const int rows = static_cast<int>(std::lround(length / edge));
    for (int k = 0; k <= rows; ++k) {
        const double x = length * k / rows;
        std::vector<Vec3> section;
        for (int i = 0; i < ny; ++i) section.emplace_back(x, y0 + (y1 - y0) * i / ny, z0);
        for (int i = 0; i < nz; ++i) section.emplace_back(x, y1, z0 + (z1 - z0) * i / nz);
        for (int i = 0; i < ny; ++i) section.emplace_back(x, y1 - (y1 - y0) * i / ny, z1);
        for (int i = 0; i < nz; ++i) section.emplace_back(x, y0, z1 - (z1 - z0) * i / nz);
        sections.push_back(std::move(section));
    }
    return sweep_sections(sections);
}

/// Tube along x of radius(x), `around` facets.
inline WallMesh tube_of(const std::function<double(double)>& radius, double length, int rows, int around)
{
    std::vector<std::vector<Vec3>> sections;
    for (int k = 0; k <= rows; ++k) {
        const double x = length * k / rows;
        std::vector<Vec3> section;
        for (int i = 0; i < around; ++i) {
            const double phi = 2 * std::numbers::pi * i / around;
            section.emplace_back(x, radius(x) * std::cos(phi), radius(x) * std::sin(phi));
        }
        sections.push_back(std::move(section));
    }
    return sweep_sections(sections);
}

/// Tube that narrows to `neck` at `at` over a cosine `width` long.
inline WallMesh stenosis(double radius, double neck, double at, double width, double length, int rows = 160, int around = 24)
{
    return tube_of(
        [=](double x) {
            const double u = (x - at) / width;
            return std::abs(u) > 0.5 ? radius : radius - (radius - neck) * (0.5 + 0.5 * std::cos(2 * std::numbers::pi * u));
        },
        length, rows, around);
}

/// A trunk along x of 40 mm and 4 mm radius that divides into two branches of 2.8 mm at +-35 degrees in the x-z plane. The
/// carina is a saddle at about x = 43 mm whose edge runs along y.
inline WallMesh bifurcation(int triangles = 8000)
{
    const auto line = [](Vec3 from, const Vec3& step, int count, double radius) {
        SweptTube tube;
        for (int k = 0; k < count; ++k, from += step) {
            tube.points.push_back(from);
            tube.radius.push_back(radius);
        }
        return tube;
    };
    const double angle = 35 * std::numbers::pi / 180;
    std::vector<SweptTube> tubes{line({-0.006, 0, 0}, {0.001, 0, 0}, 43, 0.004)};
    std::vector<LumenEnd> ends{{{0, 0, 0}, {-1, 0, 0}, 0.010}};
    for (const double side : {1.0, -1.0}) {
        const Vec3 along(std::cos(angle), 0, side * std::sin(angle));
        tubes.push_back(line({0.034, 0, 0}, 0.001 * along, 47, 0.0028));
        ends.push_back({Vec3(0.034, 0, 0) + 0.040 * along, along, 0.008});
    }
    return mesh_lumen(SweptLumen(std::move(tubes), 0.0015), ends, triangles);
}

/// A wire fed along the floor into a bend of 90 degrees, 30 mm to the axis, in a lumen of 3 mm: it meets the wall head on, then
/// lies along it.
inline TestSetup fed_into_bend(double speed, double length = 0.1, int nodes = 41)
{
    TestSetup setup = in_bend(0.003, 0.03);
    setup.wires = {fed_wire(steel_wire(length, nodes), {0.0005, 0, -0.0024}, speed)};
    return setup;
}

/// F8: a wire at rest on a plane of `size`, gravity turned by `angle` against it. @param at  x of its middle [m]
inline TestSetup on_a_slope(double size, int triangles, double at, double angle)
{
    VesselSpec plane{.shape = VesselShape::Plane, .size = size, .triangles = triangles};
    TestSetup setup;
    setup.start_settled = true;
    setup.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
    add_vessel(setup, make_plane(plane), plane);
    setup.wires = {placed_wire(steel_wire(0.05, 6), {at, 0, 0.4445e-3 - 4.6e-7})};
    setup.wires[0].contact.samples_per_edge = 4;
    return setup;
}

/// F15: pushed 70 mm into the bend, then three times 8 mm back and forth.
struct PushPull {
    static constexpr double speed = 0.05, inside = 0.07, stroke = 0.008, half = stroke / speed, dt = 1e-3;
    TestSetup setup = fed_into_bend(0, 0.12, 49);
    int before = static_cast<int>(std::lround(inside / speed / dt)), cycle = static_cast<int>(std::lround(2 * half / dt));

    PushPull()
    {
        std::vector<FeedKey>& keys = setup.wires[0].feed.keys;
        keys = {{0, 0, 0}, {inside / speed, inside, 0}};
        for (int k = 1; k <= 6; ++k) keys.push_back({inside / speed + k * half, inside - (k % 2 ? stroke : 0), 0});
    }
};

/// F16: the base of a wire soft in torsion, on a tube's floor, is turned by 4 rad a step for 60 steps of a sixtieth of a second.
struct Spun {
    static constexpr double dt = 1.0 / 60, turn = 240;  // [s], [rad]
    TestSetup setup;

    Spun()
    {
        add_tube(setup, tube(0.003, 0.2, 4000));
        TestWire wire = placed_wire(steel_wire(0.1, 21), {0.005, 0, -0.003 + 0.4445e-3});
        wire.wire.shaft.twist_stiffness = 1e-8;
        wire.holds = {{.position = true, .direction = true, .spin = true, .turn = {{0, 0}, {60 * dt, turn}}}};
        setup.wires = {wire};
    }
};

inline void use_mesh(TestSetup& setup, WallMesh mesh)
{
    setup.vessel.shape = VesselShape::Mesh;
    setup.mesh = std::move(mesh);
    setup.centreline = {};
}

/// A wall of 0.8 mm in tissue; a mesh that comes without a centreline is given one.
inline void make_elastic(TestSetup& setup, double youngs)
{
    setup.vessel.elastic = true;
    setup.vessel.youngs = youngs;
    setup.vessel.thickness = 8e-4;
    if (setup.vessel.shape == VesselShape::Plane || !setup.centreline.points.empty()) return;
    const RepairReport found = repair(setup.mesh);
    setup.centreline = extract_centreline(setup.mesh, found.loops, LumenQuery(setup.mesh, found.loops));
}

}  // namespace seldinger::test
