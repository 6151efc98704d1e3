// kernels/shared/contact_gap.h: gaps and normals of an axis point against walls whose answer is known.

#include "contact/wall_fixture.h"

#include "shapes/shapes.h"

#include <algorithm>
#include <numbers>

namespace seldinger::test::test_contact_point {

namespace {

constexpr double r = 0.4445e-3;    // 0.035 inch wire [m]
constexpr double rounding = 1e-9;  // [m] a wall coordinate of 10 mm in float: 2^-24 of it, rounded

Soup floor_patch(int squares)
{
    Soup soup;
    soup.add_patch(v3(-0.01, -0.01, 0), v3(0.02, 0, 0), v3(0, 0.02, 0), squares);
    return soup;
}

// two half-planes that meet in the y axis, each rising by `angle` from the horizontal: a valley for angle > 0, a ridge for < 0
Soup wedge(double angle)
{
    const double c = 0.01 * std::cos(angle), s = 0.01 * std::sin(angle);
    Soup soup;
    soup.add_patch(v3(0, -0.01, 0), v3(c, 0, s), v3(0, 0.02, 0));
    soup.add_patch(v3(-c, -0.01, s), v3(c, 0, -s), v3(0, 0.02, 0));
    return soup;
}

// tube along x of n facets with vertices at `radius`, 20 mm long
Soup neck_of(double radius, int n)
{
    Soup soup;
    const auto at = [&](int k) {
        return v3(-0.01, radius * std::cos(2 * std::numbers::pi * k / n), radius * std::sin(2 * std::numbers::pi * k / n));
    };
    for (int k = 0; k < n; ++k) soup.add_patch(at(k + 1), at(k) - at(k + 1), v3(0.02, 0, 0));
    return soup;
}

// force = k depth^1.5 times the gradient of depth, and its potential, of both contact points
struct Push {
    double energy = 0;
    vec3 force = {0, 0, 0};
};
Push push(const ContactPointPair& t)
{
    Push out;
    for (const ContactPoint* contact : {&t.first, &t.second}) {
        if (!contact->found || contact->depth <= 0) continue;
        out.energy += std::pow(contact->depth, 2.5) / 2.5;
        out.force = out.force + std::pow(contact->depth, 1.5) * contact->normal;
    }
    return out;
}

}  // namespace

TEST_SUITE("contact/contact_point")
{
    TEST_CASE("analytic: over a plane depth is r less height and the normal is the plane's; beyond reach there is nothing")
    {
        const Soup soup = floor_patch(7);
        for (double h : {0.5 * r, 0.9 * r, r, 1.1 * r}) {
            const ContactPointPair t = contacts_at(soup, v3(0.00123, -0.00234, h), r);
            CAPTURE(h);
            CHECK(t.first.found == 1);
            CHECK(std::abs(t.first.depth - (r - h)) <= 1e-18);
            CHECK(norm(t.first.normal - v3(0, 0, 1)) <= 1e-14);
            CHECK(t.second.found == 0);
            CHECK(t.first.outside == 0);
        }
        CHECK(contacts_at(soup, v3(0, 0, r + 1.01e-4), r).first.found == 0);
    }

    TEST_CASE("property: facets cut finer in their own plane leave depth and normal as they are")
    {
        for (int squares : {1, 2, 5, 16, 40}) {
            const Soup soup = floor_patch(squares);
            for (int k = 0; k < 200; ++k) {
                // on edges of squares, on vertices and between
                const vec3 p =
                    v3(0.01 * std::sin(1.0 * k), k % 3 ? 0.0005 * (k % 20) - 0.005 : 0.01 * std::cos(2.0 * k), 0.7 * r);
                const ContactPointPair t = contacts_at(soup, p, r);
                CHECK(t.first.found == 1);
                CHECK(std::abs(t.first.depth - 0.3 * r) <= 1e-15);
                // copies of a vertex may differ by a float's rounding: over such a crack the nearest point is that far to the
                // side
                CHECK(norm(t.first.normal - v3(0, 0, 1)) <= rounding / (0.7 * r));
                CHECK(t.second.found == 0);
            }
        }
    }

    TEST_CASE("property: the order of triangles does not matter")
    {
        Soup soup;
        std::mt19937 rng(3);
        std::uniform_real_distribution<double> draw(-1, 1);
        soup.add_patch(v3(-0.01, -0.01, 0), v3(0.02, 0, 0), v3(0, 0.02, 0), 20);
        for (std::size_t k = 2; k < soup.vertices.size(); k += 3) {  // a bumpy floor, the same bump wherever a vertex is repeated
            const double x = soup.vertices[k - 2], y = soup.vertices[k - 1];
            soup.vertices[k] = static_cast<float>(2e-4 * std::sin(900 * x) * std::cos(700 * y));
        }
        soup.rebox();
        int found = 0;
        for (int k = 0; k < 100; ++k) {
            // one after the other: which argument of a call is drawn first is the compiler's choice
            const double z = 0.8 * r + 1e-4 * draw(rng), y = 0.008 * draw(rng), x = 0.008 * draw(rng);
            const vec3 p = v3(x, y, z);
            const ContactPointPair a = contacts_at(soup, p, r);
            std::vector<std::uint32_t> order = soup.all;
            std::shuffle(order.begin(), order.end(), rng);
            const ContactPointPair b = contacts_at(soup, p, r, 1e-4, 0.002, order);
            CHECK(a.first.found == b.first.found);
            CHECK(a.second.found == b.second.found);
            found += a.first.found;
            // sums of the blend run in list order: its rounding, and nothing else, may differ
            CHECK(std::abs(a.first.depth - b.first.depth) <= 1e-15);
            CHECK(norm(a.first.normal - b.first.normal) <= 1e-6);  // on a shared edge either facet's noise tells v / d
        }
        REQUIRE(found >= 95);
    }

    TEST_CASE("analytic: inside a tube, towards a line of vertices, depth is rho + r - R and the normal points to the axis")
    {
        VesselSpec spec{.shape = VesselShape::Tube, .radius = 0.003, .length = 0.02, .triangles = 6000};
        const GeneratedVessel tube = make_tube(spec);
        Soup soup;
        for (const auto& t : tube.mesh.triangles) {
            const Vec3 a = tube.mesh.vertices[t[0]], b = tube.mesh.vertices[t[1]], c = tube.mesh.vertices[t[2]];
            soup.add(v3(a.x(), a.y(), a.z()), v3(b.x(), b.y(), b.z()), v3(c.x(), c.y(), c.z()));
        }
        int around = 0;  // vertices of the first ring
        for (const Vec3& v : tube.mesh.vertices) around += std::abs(v.x()) < 1e-9;
        REQUIRE(around >= 16);
        for (double sign : {1.0, -1.0})
            for (double overlap : {1e-6, 2e-5}) {
                const double rho = spec.radius - r + overlap;
                // the two facets that meet in the line of vertices are tilted by pi / n, so p is nearer to them than to the line
                const double depth = r - (r - overlap) * std::cos(std::numbers::pi / around);
                const ContactPointPair t = contacts_at(soup, v3(0.0101, 0, sign * rho), r);
                CAPTURE(overlap);
                // At the same distance from both, the smooth maximum adds eps/4. So it does where the nearest point lies on a
                // diagonal that two triangles of the other facet share. Their normals differ by 2 sin(pi / n)
                const double bias = 0.25 * joint_width(2 * std::sin(std::numbers::pi / around), r, 0.002);
                CHECK(std::abs(t.first.depth - depth - bias) <= rounding);
                const vec3 n = (1 / norm(t.first.normal)) * t.first.normal;
                CHECK(n.z * -sign == about(1).epsilon(1e-3));  // half a facet's angle squared at most
                CHECK(t.second.found == 0);
            }
    }

    TEST_CASE("analytic: at a convex edge the normal is radial from the edge and the depth r less the distance")
    {
        const Soup soup = wedge(-0.5);
        for (double phi : {-0.45, -0.2, 0.0, 0.3, 0.49}) {  // within the edge's own Voronoi region, +-0.5
            const double d = 0.8 * r;
            const ContactPointPair t = contacts_at(soup, v3(d * std::sin(phi), 0.0013, d * std::cos(phi)), r);
            CAPTURE(phi);
            CHECK(std::abs(t.first.depth - 0.2 * r) <= rounding);
            CHECK(norm(t.first.normal - v3(std::sin(phi), 0, std::cos(phi))) <= 1e-5);  // float of the far corners
            CHECK(t.second.found == 0);
        }
    }

    TEST_CASE("property: across a valley the force is minus the gradient of its potential, and the bias stays below eps/4")
    {
        // rise 0.2: blended, since the two normals enclose 0.4 rad; rise 1.0: 2.0 rad apart, so two opposite walls, summed
        for (double rise : {0.05, 0.2, 0.7, 1.0}) {
            CAPTURE(rise);
            const Soup soup = wedge(rise);
            const double eps = joint_width(2 * std::sin(rise), r, 0.002);  // of the two facets' normals
            const double h = 0.9 * r / std::cos(rise);  // the axis line overlaps each plane by 0.1 r at the middle
            const int steps = 40000;
            const double length = 0.1 * r, dx = length / steps;
            double work = 0, worst_bias = 0, largest = 0, jump = 0;
            Push last = push(contacts_at(soup, v3(-length / 2, 1.7e-4, h), r));
            const double start = last.energy;
            for (int k = 1; k <= steps; ++k) {
                const double x = -length / 2 + k * dx;
                const ContactPointPair t = contacts_at(soup, v3(x, 1.7e-4, h), r);
                const Push now = push(t);
                work -= 0.5 * (now.force.x + last.force.x) * dx;
                // depth against the nearer plane alone
                const double plane = r - (h * std::cos(rise) - std::abs(x) * std::sin(rise));
                worst_bias = std::max(worst_bias, std::abs(t.first.depth - plane));
                largest = std::max(largest, std::abs(now.force.x));
                jump = std::max(jump, norm(now.force - last.force) / norm(now.force));
                last = now;
            }
            const double change = last.energy - start;
            // trapezoids over the blend (width eps / sin(rise), some 40 steps wide): 1/40^2 of the force there times that width
            CHECK(std::abs(work - change) <= largest * length * 1e-4);
            CHECK(worst_bias <= (rise < 0.785 ? eps / 4 : 0) + rounding);
            if (rise > 0.1 && rise < 0.785) CHECK(worst_bias >= eps / 8);  // the smooth maximum is there at all
            CHECK(jump <= 0.1);  // continuous: in one step of 0.1 r / 40000 a normal that switched would jump by 2 tan(rise)
        }
    }

    TEST_CASE("analytic: two opposite walls both push")
    {
        Soup soup = floor_patch(3);
        const double gap = 1.9 * r;
        soup.add_patch(v3(-0.01, -0.01, gap), v3(0, 0.02, 0), v3(0.02, 0, 0), 3);  // ceiling, facing down
        const ContactPointPair t = contacts_at(soup, v3(0.001, 0.002, 0.93 * r), r);
        REQUIRE(t.first.found == 1);
        REQUIRE(t.second.found == 1);
        CHECK(std::abs(t.first.depth - 0.07 * r) <= rounding);
        CHECK(std::abs(t.second.depth - 0.03 * r) <= rounding);
        CHECK(norm(t.first.normal - v3(0, 0, 1)) <= 1e-6);
        CHECK(norm(t.second.normal - v3(0, 0, -1)) <= 1e-6);
    }

    // depth of the nearest of the n facets' planes, and the blend's bias: planes within 0.004 r at most, a quarter of that each
    TEST_CASE("regression: in a neck narrower than the wire both contact points are as deep as a wall is, not metres deep")
    {
        const int n = 24;
        const double neck = 0.9 * r, apothem = neck * std::cos(std::numbers::pi / n);
        const Soup soup = neck_of(neck, n);
        for (const double off : {0.0, 1e-7, 1e-6, 5e-6, 2e-5})
            for (int k = 0; k < 97; ++k) {
                const double phi = 2 * std::numbers::pi * k / 97;
                const ContactPointPair t = contacts_at(soup, v3(0, off * std::cos(phi), off * std::sin(phi)), r);
                CAPTURE(off);
                CAPTURE(phi);
                REQUIRE(t.first.found == 1);
                REQUIRE(t.second.found == 1);
                const double bias = n * 0.001 * r;
                CHECK(t.first.depth >= r - apothem + off * std::cos(std::numbers::pi / n) - rounding);
                CHECK(t.first.depth <= r - apothem + off + rounding + bias);
                CHECK(t.second.depth <= r - apothem + off + rounding + bias);
                CHECK(t.second.depth >= r - apothem - off - rounding);
            }
    }

    // a round trip 5 um about the axis of the neck: without the axis the deepest of the facing walls is now to the left, now to
    // the right
    TEST_CASE("property: which wall is of which side is told by the axis, wherever the point goes")
    {
        const Soup soup = neck_of(0.9 * r, 24);
        const vec3 axis = v3(0, 0, 1);
        for (int k = 0; k < 360; ++k) {
            const double phi = 2 * std::numbers::pi * k / 360;
            const vec3 p = v3(0, 5e-6 * std::cos(phi), 5e-6 * std::sin(phi));
            const ContactPointPair t = contacts_at(soup, p, r, 1e-4, 0, soup.all, axis);
            const ContactPoint& up = dot3(t.first.side, axis) > 0 ? t.first : t.second;
            const ContactPoint& down = dot3(t.first.side, axis) > 0 ? t.second : t.first;
            CAPTURE(phi);
            // the facets' middles are at odd multiples of 7.5 degrees from the axis; the deepest of each side, of which the lower
            // begins where normals look against the axis by a fifth
            CHECK(dot3(up.normal, axis) > -SEL_SIDE);
            CHECK(dot3(down.normal, axis) < -SEL_SIDE);
            double deepest_up = 0, deepest_down = 0;
            for (int f = 0; f < 24; ++f) {
                const double at = (f + 0.5) * std::numbers::pi / 12;
                const double depth = r - 0.9 * r * std::cos(std::numbers::pi / 24) + p.y * std::cos(at) + p.z * std::sin(at);
                double& deepest = std::sin(at) < SEL_SIDE ? deepest_up : deepest_down;
                deepest = std::max(deepest, depth);
            }
            CHECK(std::abs(up.depth - deepest_up) < rounding);
            CHECK(std::abs(down.depth - deepest_down) < rounding);
        }
    }

    // three walls of a box, and an axis that is theirs but for rounding: one side of the lumen, pushed out of by the nearest
    TEST_CASE("regression: walls at right angles are of one side, whatever rounding says of the axis")
    {
        Soup soup;
        soup.add_patch(v3(0, 0, 0), v3(0.01, 0, 0), v3(0, 0.01, 0));
        soup.add_patch(v3(0, 0, 0), v3(0, 0.01, 0), v3(0, 0, 0.01));
        soup.add_patch(v3(0, 0, 0), v3(0, 0, 0.01), v3(0.01, 0, 0));
        const vec3 p = v3(r - 1e-5, r - 2e-5, r - 3e-5);
        for (const double tilt : {0.0, 1e-17, -1e-17, 1e-3, -1e-3}) {
            CAPTURE(tilt);
            const ContactPointPair t = contacts_at(soup, p, r, 1e-4, 0.002, soup.all, v3(1, tilt, -tilt));
            CHECK_FALSE(t.second.found);
            CHECK(t.first.depth == about(3e-5).epsilon(1e-6));
            CHECK(t.first.normal.z == about(1).epsilon(1e-9));
        }
    }

    TEST_CASE("analytic: the other side of a thin septum never pushes")
    {
        Soup soup = floor_patch(3);
        const double septum = 0.1e-3;
        soup.add_patch(v3(-0.01, -0.01, -septum), v3(0, 0.02, 0), v3(0.02, 0, 0), 3);  // the other lumen's wall, facing away
        for (double h : {0.95 * r, 0.7 * r, 0.55 * r}) {
            const ContactPointPair t = contacts_at(soup, v3(0.001, 0.002, h), r);
            CAPTURE(h);
            CHECK(std::abs(t.first.depth - (r - h)) <= rounding);
            CHECK(t.first.normal.z > 0.999999);
            CHECK(t.second.found == 0);
        }
    }

    TEST_CASE("analytic: at a carina the far side of the septum does not even tilt the normal")
    {
        Soup soup;
        soup.add_patch(v3(-0.01, -0.01, 0), v3(0.01, 0, 0), v3(0, 0.02, 0));    // this lumen's floor, up to x = 0
        soup.add_patch(v3(0, -0.01, 0), v3(-0.01, 0, -0.001), v3(0, 0.02, 0));  // from there back: the other lumen's, facing down
        for (double x : {-1e-7, -5e-7, -1e-6}) {
            const ContactPointPair t = contacts_at(soup, v3(x, 0.0012, 0.8 * r), r);
            CAPTURE(x);
            CHECK(std::abs(t.first.depth - 0.2 * r) <= 1e-15);  // seen from the front, a facet there would add 0.1 nm
            CHECK(norm(t.first.normal - v3(0, 0, 1)) <= 1e-12);
            CHECK(t.second.found == 0);
        }
    }

    TEST_CASE("analytic: an axis beyond the wall has depth r + d and a normal that points back")
    {
        const Soup soup = floor_patch(5);
        for (double d : {1e-7, 1e-5, 0.5 * r, 0.9 * r}) {
            const ContactPointPair t = contacts_at(soup, v3(0.0003, 0.0007, -d), r);
            CAPTURE(d);
            REQUIRE(t.first.found == 1);
            CHECK(t.first.outside == 1);
            CHECK(std::abs(t.first.depth - (r + d)) <= 1e-18);
            CHECK(norm(t.first.normal - v3(0, 0, 1)) <= 1e-12);
            CHECK(t.second.found == 0);
        }
    }

    // Distance to a convex set is continuous, so is the push of the floor's free edge when the wire slides off it; a bar has no
    // sides.
    TEST_CASE("analytic: the rim of an opening pushes like a bar, from every side, and the back of the face beside it does not")
    {
        // a floor that ends at x = 0: edge c-a of the one triangle that borders it is the boundary feature, both its ends are
        // boundary feature vertices
        Soup soup;
        soup.add(v3(0, -0.01, 0), v3(0.02, 0, 0), v3(0, 0.01, 0), 1u << 2 | 8u << 0 | 8u << 2);
        for (double angle :
             {0.1, 0.8, 1.57, 2.5, 3.1, 4.0, 4.6}) {  // round the boundary feature, from over the floor to under it
            const vec3 p = (0.7 * r) * v3(std::cos(angle), 0, std::sin(angle));
            const ContactPointPair t = contacts_at(soup, p, r);
            CAPTURE(angle);
            REQUIRE(t.first.found == 1);
            if (angle > 1.6) {
                CHECK(t.first.outside == 0);
                CHECK(std::abs(t.first.depth - 0.3 * r) <= 1e-15);
                CHECK(norm(t.first.normal - (1 / norm(p)) * p) <= 1e-12);
            } else {
                CHECK(std::abs(t.first.depth - (r - 0.7 * r * std::sin(angle))) <= 1e-15);
            }
        }
        std::vector<std::uint32_t> all = {0};
        const ContactBall ball = contact_ball(v3(0.3 * r, 0, -0.5 * r), v3(0, 0, 0), r, 0.1 * r, 0.002);
        NearList list;
        CHECK(nearest_contact_point(ball, all_of(soup, all), 0, 1e30, &list).outside == 1);
        CHECK(nearest_contact_point(ball, all_of(soup, all), 1, 1e30, &list).found == 0);
    }

    TEST_CASE("property: facets without area beside real ones change nothing")
    {
        const Soup plain = floor_patch(4);
        Soup dirty = plain;
        dirty.add(v3(0.001, 0.001, 0), v3(0.001, 0.001, 0), v3(0.001, 0.001, 0));
        dirty.add(v3(0, 0, 0), v3(0.004, 0, 0), v3(0.002, 0, 0));
        for (int k = 0; k < 100; ++k) {
            const vec3 p = v3(0.004 * std::sin(3.0 * k), k % 2 ? 0.001 : 0, 0.8 * r);
            const ContactPointPair a = contacts_at(plain, p, r), b = contacts_at(dirty, p, r);
            CHECK(b.first.found == 1);
            CHECK(b.first.outside == a.first.outside);
            CHECK(std::abs(a.first.depth - b.first.depth) <= 1e-15);
            CHECK(norm(a.first.normal - b.first.normal) <= 1e-12);
        }
    }
}

}  // namespace seldinger::test::test_contact_point
