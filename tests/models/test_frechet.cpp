// The Fréchet distance on curves where it is known.

#include "models/frechet.h"
#include "support/approx.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace seldinger::test::test_frechet {

namespace {

std::vector<Vec3> arc(double radius, double angle, int points)
{
    std::vector<Vec3> line;
    for (int i = 0; i < points; ++i) {
        const double a = angle * i / (points - 1);
        line.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
    }
    return line;
}

}  // namespace

TEST_SUITE("models/frechet")
{
    TEST_CASE("analytic: shifted straight lines are as far apart as they are shifted, however they are divided")
    {
        const std::vector<Vec3> a = {{0, 0, 0}, {1, 0, 0}};
        const std::vector<Vec3> b = {{0, 0.25, 0}, {0.1, 0.25, 0}, {0.7, 0.25, 0}, {0.71, 0.25, 0}, {1, 0.25, 0}};
        CHECK(frechet_distance(a, b) == about(0.25).epsilon(1e-6));
        CHECK(frechet_distance(b, a) == about(0.25).epsilon(1e-6));
        CHECK(frechet_distance(a, a) == 0);
    }

    TEST_CASE("property: curves that are nowhere have no distance, and looking for it ends")
    {
        const std::vector<Vec3> a = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
        for (const double nowhere : {std::numeric_limits<double>::infinity(), std::nan(""), 1e300}) {
            std::vector<Vec3> b = a;
            b[1].y() = nowhere;
            CHECK_FALSE(std::isfinite(frechet_distance(a, b)));
            CHECK_FALSE(std::isfinite(frechet_distance(b, a)));
        }
    }

    TEST_CASE("analytic: concentric arcs are R - r apart")
    {
        // both polylines have their vertices on the circles: between them the chords are nearer by at most the sagittas
        const auto inner = arc(0.04, std::numbers::pi, 400), outer = arc(0.05, std::numbers::pi, 313);
        const double sagitta = 0.05 * std::pow(std::numbers::pi / 312, 2) / 8;
        CHECK(std::abs(frechet_distance(inner, outer) - 0.01) <= sagitta + 1e-8);
    }

    TEST_CASE("analytic: a curve and the same curve divided otherwise differ by the sagitta of its chords, not by the spacing")
    {
        const int edges = 10;
        const auto fine = arc(0.05, 1.0, 2001), coarse = arc(0.05, 1.0, edges + 1);
        const double sagitta = 0.05 * (1 - std::cos(0.5 / edges));
        CHECK(frechet_distance(fine, coarse) == about(sagitta).epsilon(2e-3));  // the fine one has a sagitta of its own
    }

    TEST_CASE("analytic: walking order matters, nearness alone does not")
    {
        const std::vector<Vec3> straight = {{0, 0, 0}, {1, 0, 0}};
        // forth to 0.7, back to 0.3, forth again: Alt & Godau's zigzag; the walker on the straight line waits half-way
        const std::vector<Vec3> zigzag = {{0, 0, 0}, {0.7, 0, 0}, {0.3, 0, 0}, {1, 0, 0}};
        CHECK(frechet_distance(straight, zigzag) == about(0.2).epsilon(1e-5));
        const std::vector<Vec3> reversed = {{1, 0, 0}, {0, 0, 0}};
        CHECK(frechet_distance(straight, reversed) == about(1.0).epsilon(1e-6));
    }

    TEST_CASE("property: at least the ends' distances, at most the walk at equal fractions, and symmetric")
    {
        auto a = arc(0.03, 2.0, 57), b = arc(0.031, 1.9, 91);
        for (std::size_t i = 0; i < b.size(); ++i) b[i].z() = 0.002 * std::sin(0.37 * static_cast<double>(i));
        const double d = frechet_distance(a, b);
        CHECK(d >= (a.back() - b.back()).norm());
        CHECK(d >= (a.front() - b.front()).norm());
        CHECK(d == about(frechet_distance(b, a)).epsilon(3e-6));
        // against the discrete distance on a fine division, which is above the continuous one by at most a spacing
        const auto divide = [](const std::vector<Vec3>& line) {
            std::vector<Vec3> out;
            for (std::size_t i = 0; i + 1 < line.size(); ++i)
                for (int k = 0; k < 8; ++k) out.push_back(line[i] + (line[i + 1] - line[i]) * (k / 8.0));
            out.push_back(line.back());
            return out;
        };
        const auto p = divide(a), q = divide(b);
        std::vector<double> row(q.size(), 1e9);
        for (std::size_t i = 0; i < p.size(); ++i) {
            double diagonal = i == 0 ? 0 : 1e9;  // value at (i - 1, j - 1)
            for (std::size_t j = 0; j < q.size(); ++j) {
                const double above = row[j], left = j > 0 ? row[j - 1] : (i == 0 ? 0 : 1e9);
                const double reach = i == 0 && j == 0 ? 0 : std::min({above, left, j > 0 ? diagonal : (i == 0 ? 0.0 : 1e9)});
                diagonal = above;
                row[j] = std::max(reach, (p[i] - q[j]).norm());
            }
        }
        const double spacing = 0.03 * 2.0 / 56 / 8;
        CHECK(row.back() >= d * (1 - 1e-5));
        CHECK(row.back() <= d + spacing);
    }
}

}  // namespace seldinger::test::test_frechet
