// Tangent of contact over a ridge and a corner of the wall, where the normal turns as the wire moves past (opposite_wall.h,
// add_ridge; contact_law.h, add_friction_turn).

#include "contact/one_quadrature_point.h"
#include "contact/wall_fixture.h"

#include <utility>

namespace seldinger::test::test_ridge {

namespace {

constexpr double r = 4e-4;

OneQuadraturePoint over(const Soup& soup, uint friction)
{
    QuadratureModel m{};
    m.weight = m.length = 1e-3;
    m.radius = r;
    m.stiffness = 1e8;
    m.exponent = 1.5;
    m.friction_stiffness = 1e5;
    m.mu_static = m.mu_sliding = 0.3;
    m.speed_floor = 1e-3;
    OneQuadraturePoint point(m);
    point.par.friction = friction;
    point.soup = soup;
    return point;
}

/// Two facets that meet in y = at along x, rising by `rise` to either side: a roof (< 0) or a valley.
void add_facets(Soup& soup, double at, double wide, double rise)
{
    for (const double side : {-1.0, 1.0}) {
        const double y = at + side * wide, z = rise * wide;
        const vec3 a = v3(-0.01, at, 0), b = v3(0.01, at, 0), c = v3(0.01, y, z), d = v3(-0.01, y, z);
        if (side > 0) soup.add(a, b, c), soup.add(a, c, d);
        else soup.add(a, c, b), soup.add(a, d, c);
    }
}

Soup facets(double rise)
{
    Soup soup;
    add_facets(soup, 0, 0.01, rise);
    return soup;
}

/// Two roofs, equally near to what is above the line between them.
Soup two_roofs()
{
    Soup soup;
    add_facets(soup, -1e-4, 0.9e-4, -1);
    add_facets(soup, 1e-4, 0.9e-4, -1);
    return soup;
}

/// A pyramid of four sides, top at the origin.
Soup pyramid()
{
    Soup soup;
    const vec3 top = v3(0, 0, 0),
               corner[4] = {v3(0.01, 0, -0.008), v3(0, 0.01, -0.008), v3(-0.01, 0, -0.008), v3(0, -0.01, -0.008)};
    for (int k = 0; k < 4; ++k) soup.add(top, corner[k], corner[(k + 1) % 4]);
    return soup;
}

}  // namespace

// Central differences are exact to 1e-6 of the largest entry (one_quadrature_point.h). The part of a ridge is f/d across it,
// beside a slope of 1.5 f/depth: 2/3 of depth/d = 1/40 of the largest entry.
TEST_CASE("derivative: the tangent has how the normal turns over a ridge and a corner")
{
    for (const Soup& soup : {facets(-0.5), pyramid()})
        for (const double y : {0.0, 5e-5, -8e-5}) {
            const double z = std::sqrt(0.975 * r * 0.975 * r - y * y);
            const std::array<double, 4> q = {2e-5, y, z, 0.4};
            const OneQuadraturePoint point = over(soup, SEL_FRICTION_NONE);
            REQUIRE(point.at(q).contacts == 1);
            CHECK(tangent_error(point, q) < 1e-5);
        }
}

// The ridges' part is f/d beside f |turn|^2/(2 eps) across the valley: 4 eps/(d |turn|^2), here 8e-3 of the largest entry. Left
// out is how eps changes with the directions, by a twentieth of that.
TEST_CASE("derivative: two ridges that are joined have their parts by their shares")
{
    for (const double y : {0.0, 1e-7, -2e-7}) {
        CAPTURE(y);
        const std::array<double, 4> q = {2e-5, y, std::sqrt(0.975 * r * 0.975 * r - 1e-8), 0.4};
        const OneQuadraturePoint point = over(two_roofs(), SEL_FRICTION_NONE);
        const ContactPoint contact = contacts_at(point.soup, v3(q[0], q[1], q[2]), r).first;
        REQUIRE(std::abs(contact.normal.y) < 0.2);  // either alone has 0.26
        CHECK(tangent_error(point, q) < 1e-3);
    }
}

// Without how friction turns mu of the normal's part is missing: f/d over a ridge, f |turn|/(2 eps) in a valley.
TEST_CASE("derivative: friction turns with the normal, over a ridge and in a valley, in stick and in slip")
{
    for (const auto& [soup, y] : {std::pair(facets(-0.5), 5e-5), {pyramid(), -8e-5}, {facets(0.2), 1e-7}})
        for (const uint law : {SEL_FRICTION_STICK_SLIP, SEL_FRICTION_SMOOTH})
            for (const double slip : {2e-8, 2e-5}) {
                CAPTURE(law);
                CAPTURE(slip);
                OneQuadraturePoint point = over(soup, law);
                const double z = y == 1e-7 ? 0.975 * r * std::sqrt(1.04) : std::sqrt(0.975 * r * 0.975 * r - y * y);
                const std::array<double, 4> q = {2e-5, y, z, 0.4};
                point.start = v3(q[0] - slip, q[1] - 0.3 * slip, q[2] + 0.1 * slip);
                point.theta0 = q[3] - 0.5 * slip / r;
                REQUIRE(point.at(q).contacts == 1);
                CHECK(tangent_error(point, q) < 1e-5);
            }
}

TEST_CASE("property: a flat floor has no curvature")
{
    Soup soup;
    add_floor(soup);
    const ContactPoint contact = contacts_at(soup, v3(1e-5, 2e-5, 0.98 * r), r).first;
    REQUIRE(contact.found);
    for (const double second : contact.hessian) CHECK(second == 0);
}

}  // namespace seldinger::test::test_ridge
