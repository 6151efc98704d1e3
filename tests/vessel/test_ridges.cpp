// engine/bodies/vessel/ridges: a roof, a valley, a bend that is meshed finer and finer; what contact samples make of them.

#include "vessel/ridges.h"

#include "contact/quadrature.h"
#include "shapes/shapes.h"
#include "support/approx.h"

#include <cmath>
#include <numbers>

namespace seldinger::test::test_ridges {

namespace {

/// Two squares of side 1 that meet in the y axis, each falling off by `slope` [rad] (rising when negative); normals upward.
WallMesh roof(double slope)
{
    WallMesh mesh;
    const double c = std::cos(slope), s = std::sin(slope);
    mesh.vertices = {{-c, 0, -s}, {0, 0, 0}, {0, 1, 0}, {-c, 1, -s}, {c, 0, -s}, {c, 1, -s}};
    mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}, {{1, 4, 5}}, {{1, 5, 2}}};
    return mesh;
}

WallMesh bend(int triangles)
{
    VesselSpec spec{
        .shape = VesselShape::Arc, .radius = 0.002, .bend_radius = 0.02, .angle = std::numbers::pi / 2, .triangles = triangles};
    return make_arc(spec).mesh;
}

}  // namespace

TEST_SUITE("vessel/ridges")
{
    TEST_CASE("analytic: a roof has the angle between its facets, a valley and a plane none")
    {
        for (const double slope : {0.02, 0.1, 0.5})
            CHECK(mean_ridge_angle(roof(slope), 0) == test::about(2 * slope).epsilon(1e-12));
        CHECK(mean_ridge_angle(roof(-0.1), 0) == 0);
        CHECK(mean_ridge_angle(roof(0), 0) == 0);
        CHECK(mean_ridge_angle(roof(0.1), 1.5) == 0);  // facets of sides 1, 1 and 1.41
        CHECK(mean_ridge_angle(roof(0.1), 1.4) > 0);
    }

    // the wall of a bend is a ridge along its inner side only: facets of length l turn by l/(bend radius - lumen radius) at most
    TEST_CASE("property: ridges of a bend grow flat as its facets grow small, and are no sharper than the facets' turning")
    {
        const double coarse = mean_ridge_angle(bend(100), 0), fine = mean_ridge_angle(bend(10000), 0);
        CHECK(coarse > 0.1);
        CHECK(coarse < std::numbers::pi / 2 / 4);  // at least four rows
        CHECK(fine < 0.05);
        CHECK(mean_ridge_angle({}, 0) == 0);
    }

    // r up to 0.12 rad, from there on with the square of the angle, a quarter of r from 0.24 rad on. A wire is a whole number of
    // stretches.
    TEST_CASE("analytic: contact samples lie closer on sharp ridges, and no closer than need be")
    {
        const double r = 0.5;  // the facets are longer than 2 r
        for (const double ridge : {0.05, 0.119, 0.121, 0.16, 0.2, 0.24, 0.5}) {
            CAPTURE(ridge);
            const double closer = ridge <= 0.12 ? 1.0 : std::max(std::pow(0.12 / ridge, 2), 0.25);
            const VesselSpec plain;
            const WallMesh mesh = roof(0.5 * ridge);
            const Centreline none;
            const WallModel wall(plain, mesh, none);
            WireSpec wire;
            wire.length = 1000;
            wire.shaft.radius = r;
            ContactSetup setup{{wire}, {{}}, wall};
            CHECK(make_quadrature(setup).wires[0].spacing == test::about(closer * r).epsilon(1e-3));
        }
    }
}

}  // namespace seldinger::test::test_ridges
