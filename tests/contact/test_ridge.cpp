// Tangent of contact over a ridge and a corner of the wall, where the normal turns as the wire moves past (contact_point.h, add_ridge).

#include "contact/one_quadrature_point.h"

#include <doctest/doctest.h>

#include <algorithm>

namespace test_ridge {

using namespace seldinger;
using namespace seldinger::test;

namespace {

constexpr double r = 4e-4;

/// A point law without friction.
OneQuadraturePoint over(const Soup& soup)
{
    QuadratureModel m{};
    m.weight = m.length = 1e-3;
    m.radius = r;
    m.stiffness = 1e8;
    m.exponent = 1.5;
    m.friction_stiffness = 1e5;
    m.speed_floor = 1e-3;
    OneQuadraturePoint point(m);
    point.par.friction = SEL_FRICTION_NONE;
    point.soup = soup;
    return point;
}

/// A roof along x whose top is at z = 0, sides falling by half.
Soup roof()
{
    Soup soup;
    for (const double side : {-1.0, 1.0}) {
        const vec3 a = v3(-0.01, 0, 0), b = v3(0.01, 0, 0), c = v3(0.01, side * 0.01, -0.005), d = v3(-0.01, side * 0.01, -0.005);
        if (side > 0) soup.add(a, b, c), soup.add(a, c, d);
        else soup.add(a, c, b), soup.add(a, d, c);
    }
    return soup;
}

/// A pyramid of four sides, top at the origin.
Soup pyramid()
{
    Soup soup;
    const vec3 top = v3(0, 0, 0), corner[4] = {v3(0.01, 0, -0.008), v3(0, 0.01, -0.008), v3(-0.01, 0, -0.008), v3(0, -0.01, -0.008)};
    for (int k = 0; k < 4; ++k) soup.add(top, corner[k], corner[(k + 1) % 4]);
    return soup;
}

}  // namespace

// Central differences are exact to 1e-6 of the largest entry (one_quadrature_point.h). The part that would be missing without
// ridges is f/d across the ridge, beside a slope of 1.5 f/depth: 2/3 of depth/d = 1/40, of which 1/100 and more would show.
TEST_CASE("ridge: the tangent has how the normal turns over a ridge and a corner")
{
    for (const Soup& soup : {roof(), pyramid()})
        for (const double y : {0.0, 5e-5, -8e-5}) {
            const double z = std::sqrt(0.975 * r * 0.975 * r - y * y);
            const std::array<double, 4> q = {2e-5, y, z, 0.4};
            REQUIRE(over(soup).at(q).contacts == 1);
            CHECK(tangent_error(over(soup), q) < 1e-5);
        }
}

TEST_CASE("ridge: a flat floor has none")
{
    Soup soup;
    add_floor(soup);
    const ContactForce force = over(soup).at({1e-5, 2e-5, 0.98 * r, 0.4});
    REQUIRE(force.contacts == 1);
    CHECK(std::count(force.sym, force.sym + 10, 0.0) == 9);  // across the floor alone
}

}  // namespace test_ridge
