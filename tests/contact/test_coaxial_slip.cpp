// Friction per length between instruments that share a centreline: its law.

#include "contact/rods/coaxial_slip.h"
#include "support/approx.h"

#include <random>

namespace seldinger::test::test_coaxial_slip {

namespace {
constexpr double give = 1e-5;  // [m]
}

TEST_SUITE("contact/coaxial slip")
{
    TEST_CASE("derivative: slope is that of the force around, stuck, sliding and in a film")
    {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> way(-3e-5, 3e-5);
        int slid = 0, held = 0;
        for (int k = 0; k < 200; ++k) {
            const SlipLawPerLength law{0.8, 0.8 / give, k % 2 == 0 ? 0.0 : 5.0};
            Vec2 start(way(random), way(random));
            start *= std::min(1.0, give / start.norm());
            const Vec2 slip(way(random), way(random));
            const double size = (start + slip).norm(), d = 1e-10;
            if (std::abs(size - give) < 10 * d) continue;  // a kink
            (size > give ? slid : held)++;
            const auto around = [&](double more) { return slip_per_length(law, start, slip + Vec2(0, more), 1e3).force.y(); };
            const double slope = slip_per_length(law, start, slip, 1e3).slope;
            // central differences: rounding 1e-16 of forces of 1 N/m over 2e-10 m, curvature (d/give)^2
            CHECK(slope == about(-(around(d) - around(-d)) / (2 * d)).epsilon(1e-5).scale(1e3));
        }
        REQUIRE(slid > 50);
        REQUIRE(held > 20);
    }

    TEST_CASE("property: no more than q per length, against the slip, and nothing comes out but what was stored")
    {
        std::mt19937 random(8);
        std::uniform_real_distribution<double> way(-2e-5, 2e-5);
        const SlipLawPerLength law{0.8, 0.8 / give, 0};
        const double stiffness = law.stiffness;
        Vec2 elastic = Vec2::Zero();
        for (int k = 0; k < 500; ++k) {
            const Vec2 slip(way(random), way(random));
            const SlipPerLength now = slip_per_length(law, elastic, slip, 0);
            CHECK(now.force.norm() <= law.limit * (1 + 1e-12));
            const double stored = 0.5 * stiffness * (now.elastic.squaredNorm() - elastic.squaredNorm());
            CHECK(-now.force.dot(slip) >= stored - 1e-18);
            CHECK(slip_per_length(law, elastic, slip, 1e3).force == now.force);
            elastic = now.elastic;
        }
        // a long way round: friction points against it, whatever was before
        const SlipPerLength far = slip_per_length(law, elastic, {3, 4}, 0);
        CHECK((far.force + law.limit * Vec2(0.6, 0.8)).norm() < 1e-5 * law.limit);
        // settling with every contact stuck: beyond q, and back within it in the next step
        const SlipPerLength stuck = slip_per_length(law, Vec2::Zero(), {3e-5, 0}, 0, true);
        CHECK(stuck.force.x() == about(-3 * law.limit));
        CHECK(slip_per_length(law, stuck.elastic, Vec2::Zero(), 0).force.x() == about(-law.limit));
    }
}

}  // namespace seldinger::test::test_coaxial_slip
