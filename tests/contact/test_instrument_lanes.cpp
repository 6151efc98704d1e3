// Nearest places side by side (instrument_lanes.h) against searches one by one.

#include "contact/spline_rod.h"
#include "shared/instrument_near.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <random>
#include <vector>

namespace test_instrument_lanes {

using namespace seldinger;
using test::SplineRod;

namespace {

/// A wavy rod about along x, edges of 3 mm and more.
SplineRod wavy(int count, double offset, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> some(-1, 1);
    SplineRod rod;
    double x = 0, s = 0;
    for (int i = 0; i < count; ++i) {
        const double y = offset + 1e-4 * some(random), z = 1e-4 * some(random);
        rod.position.insert(rod.position.end(), {x, y, z});
        rod.material.push_back(s);
        rod.theta.push_back(0);
        const double longer = 3e-3 * (1 + 0.2 * some(random));
        x += longer;
        s += 1.0001 * longer;
    }
    return rod;
}

struct Strands {
    SplineRod a, b, a_t0, b_t0;
    InstrumentScene scene{};
    Strands(unsigned seed, uint touch) : a(wavy(12, 2e-4, seed)), b(wavy(12, 0, seed + 1)), a_t0(a), b_t0(b)
    {
        std::mt19937 random(seed + 2);
        std::uniform_real_distribution<double> some(-1, 1);
        for (SplineRod* rod : {&a_t0, &b_t0})
            for (double& x : rod->position) x += 2e-5 * some(random);
        scene.a = a.view(), scene.b = b.view(), scene.a_t0 = a_t0.view(), scene.b_t0 = b_t0.view();
        scene.part.touch = touch;
        scene.part.low = touch == SEL_TOUCH_INSIDE ? 0.1 : 0;
        scene.part.high = 11;
        scene.part.reach_a = 4e-4;
        scene.part.reach_b = 5.5e-4;
        scene.part.rim = 1e-4;
        scene.part.high_ends = scene.part.low_ends = 1;
    }
    /// Four points about a place of b that lies well within one of its pieces, and of a's.
    [[nodiscard]] bool places(int edge, double (&s)[4], double (&start)[4], LanePlaces& out) const
    {
        const double middle = spline_material(scene.a, edge + 0.1);
        for (int k = 0; k < 4; ++k) {
            s[k] = middle + 2e-4 * (k - 1.5);
            start[k] = edge + 0.1 + 0.07 * (k - 1.5) + 0.02;
        }
        places_in_lanes(&scene, s, start, spline_at(scene.a, middle), &out);
        return out.known;
    }
};

}  // namespace

// Both end where a Newton step is shorter than 1e-7 of an edge, and leave its square.
TEST_CASE("instrument lanes: places and gaps are those of searches one by one")
{
    int known = 0, known_t0 = 0;
    for (unsigned seed = 1; seed < 20; ++seed)
        for (const uint touch : {SEL_TOUCH_INSIDE, SEL_TOUCH_OUTSIDE}) {
            const Strands strands(seed, touch);
            for (int edge = 2; edge < 9; ++edge) {
                double s[4], start[4];
                LanePlaces lanes;
                if (!strands.places(edge, s, start, lanes)) continue;
                ++known;
                known_t0 += lanes.known_t0;
                for (int k = 0; k < 4; ++k) {
                    const CellPoint one = cell_point(&strands.scene, s[k], start[k]);
                    CHECK(std::abs(lanes.of_a[k] - spline_at(strands.scene.a, s[k])) < 1e-12);
                    CHECK(std::abs(lanes.at[k] - one.g.at) < 1e-12);
                    CHECK(std::abs(lanes.gap[k] - one.gap) < 1e-15);
                    CellPoint at;
                    set_point_at(&strands.scene, strands.scene.part, s[k], {lanes.of_a[k], {lanes.at[k], 0}}, &at);
                    CHECK(std::abs(at.slope - one.slope) < 1e-11);
                    CHECK(std::abs(at.g.bend - one.g.bend) < 1e-9 * std::abs(one.g.bend));
                    if (!lanes.known_t0) continue;
                    const vec3 x = test::point_of_material(strands.scene.a_t0, s[k]);
                    CHECK(std::abs(lanes.gap[4 + k] - instrument_gap(strands.scene.b_t0, x, start[k], strands.scene.part).gap) <
                          1e-15);
                }
            }
        }
    CHECK(known > 150);  // of 266: the others lie across a knot of b
    CHECK(known_t0 > 150);
}

TEST_CASE("instrument lanes: nothing is known across a knot, at the mouth, of one rod with itself")
{
    Strands strands(3, SEL_TOUCH_INSIDE);
    double s[4], start[4];
    LanePlaces lanes;
    int edge = 2;
    while (edge < 9 && !strands.places(edge, s, start, lanes)) ++edge;
    REQUIRE(edge < 9);
    strands.scene.part.low = start[1];  // a mouth in the middle of the points
    CHECK_FALSE(strands.places(edge, s, start, lanes));
    strands.scene.part.low = 0.1;
    strands.scene.part.touch = SEL_TOUCH_SELF;
    CHECK_FALSE(strands.places(edge, s, start, lanes));
    strands.scene.part.touch = SEL_TOUCH_INSIDE;
    const double knot = spline_material(strands.scene.a, edge + 0.5);
    for (int k = 0; k < 4; ++k) s[k] = knot + 2e-4 * (k - 1.5);
    places_in_lanes(&strands.scene, s, start, edge + 0.49, &lanes);
    CHECK_FALSE(lanes.known);
}

}  // namespace test_instrument_lanes
