// kernels/shared/triangle.h: the nearest point of a triangle against a search over its face and its three segments.

#include "contact/wall_fixture.h"

#include <algorithm>

namespace seldinger::test::test_triangle {

namespace {

vec3 closest_on_segment(vec3 p, vec3 a, vec3 b)
{
    const vec3 d = b - a;
    const double length2 = dot3(d, d);
    return length2 > 0 ? a + std::clamp(dot3(p - a, d) / length2, 0.0, 1.0) * d : a;
}

// the foot on the triangle's plane where it lies inside, else the best of the three segments
double reference_distance(vec3 p, const Triangle& t)
{
    double best = INFINITY;
    for (const auto& [a, b] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}})
        best = std::min(best, norm(p - closest_on_segment(p, a, b)));
    const vec3 n = cross3(t.b - t.a, t.c - t.a);
    const double n2 = dot3(n, n);
    if (n2 == 0) return best;
    const vec3 foot = p - (dot3(p - t.a, n) / n2) * n;
    const bool inside = dot3(cross3(t.b - t.a, foot - t.a), n) >= 0 && dot3(cross3(t.c - t.b, foot - t.b), n) >= 0 &&
                        dot3(cross3(t.a - t.c, foot - t.c), n) >= 0;
    return inside ? std::min(best, std::abs(dot3(p - t.a, n)) / std::sqrt(n2)) : best;
}

struct Draw {
    std::mt19937 rng{7};
    double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng); }
    vec3 point(double size) { return v3((*this)(-size, size), (*this)(-size, size), (*this)(-size, size)); }
};

}  // namespace

TEST_SUITE("contact/triangle")
{
    TEST_CASE("analytic: the seven regions of a triangle answer with their own point and feature")
    {
        const Triangle t{v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0)};
        const struct {
            vec3 p, expected;
            int feature;
        } cases[] = {
            {v3(0.2, 0.3, 0.7), v3(0.2, 0.3, 0), SEL_FEATURE_FACE}, {v3(0.4, -0.5, 0.1), v3(0.4, 0, 0), SEL_FEATURE_EDGE},
            {v3(1, 1, 0.2), v3(0.5, 0.5, 0), SEL_FEATURE_EDGE + 1}, {v3(-0.5, 0.25, 0.1), v3(0, 0.25, 0), SEL_FEATURE_EDGE + 2},
            {v3(-1, -1, 1), v3(0, 0, 0), SEL_FEATURE_VERTEX},       {v3(2, -0.5, 0), v3(1, 0, 0), SEL_FEATURE_VERTEX + 1},
            {v3(-0.5, 3, -1), v3(0, 1, 0), SEL_FEATURE_VERTEX + 2},
        };
        for (const auto& c : cases) {
            CAPTURE(c.feature);
            int feature = -1;
            CHECK(norm(closest_on_triangle(c.p, t, &feature) - c.expected) <= 1e-15);
            CHECK(feature == c.feature);
        }
    }

    TEST_CASE("property: nearest distance agrees with a search over face and edges, slivers included")
    {
        Draw draw;
        // Both answers solve a quotient whose divisor is (twice the area)^2 or an edge's square. A height of `flat` times the
        // base costs eps / flat of the position across the sliver. But a point that is off along the sliver is still on it: the
        // distance stays good to a few eps over flat of the height itself.
        for (double flat : {1.0, 1e-2, 1e-4, 1e-6}) {
            double worst = 0;
            for (int k = 0; k < 20000; ++k) {
                Triangle t{draw.point(1), draw.point(1), draw.point(1)};
                t.c = t.a + draw(-0.5, 1.5) * (t.b - t.a) + flat * (t.c - t.a);
                const vec3 p = draw.point(1.5);
                int feature;
                const vec3 q = closest_on_triangle(p, t, &feature);
                worst = std::max(worst, std::abs(norm(p - q) - reference_distance(p, t)));
            }
            CAPTURE(flat);
            CHECK(worst <= 1e-15 / flat + 1e-14);
        }
    }

    TEST_CASE("property: samples exactly on an edge, on a vertex, and on the face have distance 0 to rounding")
    {
        Draw draw;
        for (int k = 0; k < 2000; ++k) {
            const Triangle t{draw.point(1), draw.point(1), draw.point(1)};
            const double s = draw(0, 1), u = draw(0, 1) * (1 - s);
            int feature;
            for (const vec3& p : {t.a, t.b, t.c}) CHECK(norm(p - closest_on_triangle(p, t, &feature)) == 0);
            for (const vec3& p : {t.a + s * (t.b - t.a), t.b + s * (t.c - t.b), t.a + s * (t.b - t.a) + u * (t.c - t.a)})
                CHECK(norm(p - closest_on_triangle(p, t, &feature)) <= 1e-12);  // 1e-15 through a triangle of height 1e-3
        }
    }

    TEST_CASE("property: triangles of no area answer with their edges' nearest point")
    {
        Draw draw;
        double worst = 0;
        for (int k = 0; k < 4000; ++k) {
            // whole numbers, so that the three corners are collinear to the last bit, in every order
            const vec3 a = v3(std::round(draw(-9, 9)), std::round(draw(-9, 9)), std::round(draw(-9, 9)));
            const vec3 d = v3(std::round(draw(-9, 9)), std::round(draw(-9, 9)), std::round(draw(-9, 9)));
            const Triangle t{a, a + std::round(draw(-5, 5)) * d, a + std::round(draw(-5, 5)) * d};
            const vec3 p = draw.point(60);
            int feature;
            const vec3 q = closest_on_triangle(p, t, &feature);
            REQUIRE(std::isfinite(q.x + q.y + q.z));
            worst = std::max(worst, norm(p - q) - reference_distance(p, t));
            CHECK(norm(triangle_normal(t)) == 0);
        }
        CHECK(worst <= 1e-13);
    }
}

}  // namespace seldinger::test::test_triangle
