// kernels/shared/smooth_maximum.h: depth and normal where several facets meet.

#include "contact/wall_fixture.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <vector>

namespace seldinger::test::test_smooth_maximum {

namespace {

constexpr double r = 0.4445e-3, smoothing = 0.002, slope = 0.3, height = 0.97 * r;
constexpr double rounding = 1e-9;  // [m] far corners at 2 mm in float

/// A pit of facets that meet at the origin, whose normals lean by `slope` from z.
struct Pit {
    Soup soup;
    std::vector<vec3> normal;
    explicit Pit(int facets = 3)
    {
        const auto corner = [=](int k) {
            const double phi = 2 * std::numbers::pi * k / facets, far = 2e-3;
            return v3(far * std::cos(phi), far * std::sin(phi), far * std::tan(slope) * std::cos(std::numbers::pi / facets));
        };
        for (int k = 0; k < facets; ++k) {
            soup.add(v3(0, 0, 0), corner(k), corner(k + 1));
            const vec3 n = cross3(corner(k), corner(k + 1));
            normal.push_back((1 / norm(n)) * n);
        }
    }
    [[nodiscard]] double width(int i, int j) const
    {
        return joint_width(norm(normal[static_cast<std::size_t>(i)] - normal[static_cast<std::size_t>(j)]), r, smoothing);
    }
    /// The maximum over shares of three planes, looked for on a grid of 1/200.
    [[nodiscard]] double depth(vec3 p) const
    {
        std::array<double, 3> d{};
        for (std::size_t k = 0; k < 3; ++k) d[k] = r - dot3(normal[k], p);
        const int cells = 200;
        double best = 0;
        for (int i = 0; i <= cells; ++i)
            for (int j = 0; i + j <= cells; ++j) {
                const double a = double(i) / cells, b = double(j) / cells, c = 1 - a - b;
                best = std::max(best,
                                a * d[0] + b * d[1] + c * d[2] + a * b * width(0, 1) + b * c * width(1, 2) + a * c * width(0, 2));
            }
        return best;
    }
    [[nodiscard]] ContactPoint at(vec3 p) const { return contacts_at(soup, p, r, 1e-4, smoothing).first; }
};

/// A facet along y from (x, z) by (dx, dz).
void add_strip(Soup& soup, double x, double z, double dx, double dz)
{
    soup.add_patch(v3(x, -2e-3, z), v3(dx, 0, dz), v3(0, 4e-3, 0));
}

}  // namespace

TEST_SUITE("contact/smooth_maximum")
{
    // a grid of 1/200 misses the maximum by at most the widest eps/200^2, 1e-11 m
    TEST_CASE("analytic: the depth over three facets is the maximum over their shares, found by search")
    {
        const Pit pit;
        const double eps = pit.width(0, 1);
        double most = 0;
        for (const double x : {-1.5, -0.4, 0.0, 0.3, 0.9})
            for (const double y : {-1.2, -0.2, 0.0, 0.5, 1.4}) {
                CAPTURE(x);
                CAPTURE(y);
                const vec3 p = v3(x * eps, y * eps, height);
                const double plane = r - std::min({dot3(pit.normal[0], p), dot3(pit.normal[1], p), dot3(pit.normal[2], p)});
                CHECK(std::abs(pit.at(p).depth - pit.depth(p)) <= rounding);
                most = std::max(most, pit.at(p).depth - plane);
            }
        CHECK(most > 0.3 * eps);  // with equal shares it is eps/3: all three take part
    }

    // between two planes the normal turns by |n_i - n_j| over 2 eps of their depths: |turn|/(2 smoothing r) per metre across, and
    // no faster with a third one
    TEST_CASE("property: the normal does not jump where a third facet joins, or the nearest one changes")
    {
        const Pit pit;
        const double eps = pit.width(0, 1), step = eps / 500, rate = 2 * norm(pit.normal[0] - pit.normal[1]) / (smoothing * r);
        for (const double offset : {-0.8, -0.3, 0.2, 0.7}) {
            CAPTURE(offset);
            double most = 0;
            vec3 last{};
            for (int k = -1500; k <= 1500; ++k) {
                const vec3 now = pit.at(v3(k * step, offset * eps + 0.1 * k * step, height)).normal;
                if (k > -1500) most = std::max(most, norm(now - last));
                last = now;
            }
            CHECK(most <= rate * step);
            CHECK(most > 0);
        }
    }

    // with t = |n_i - n_j| the normal turns by t^2 / 2 eps = (sqrt(t^2 + 4 s^2) + 2 s) / 2 s r per metre across, s the smoothing;
    // by positions of 1e-9 m in float
    TEST_CASE("property: the normal does not jump where the neighbour of a flat valley begins to count")
    {
        for (const double angle : {3e-4, 1e-3, 2e-3, 4e-3, 1e-2}) {
            CAPTURE(angle);
            Soup soup;
            add_strip(soup, -2e-3, 0, 2e-3, 0);
            add_strip(soup, 0, 0, 2e-3, 2e-3 * angle);
            const double step = r * angle / 1000,
                         rate = (std::sqrt(angle * angle + 4 * smoothing * smoothing) + 2 * smoothing) / (2 * smoothing * r);
            double most = 0;
            vec3 last{};
            for (int k = -3000; k <= 3000; ++k) {
                const vec3 now = contacts_at(soup, v3(k * step, 0, height), r).first.normal;
                if (k > -3000) most = std::max(most, norm(now - last));
                last = now;
            }
            CHECK(most <= 1.01 * rate * step);
            CHECK(most > 0);
        }
    }

    // A narrow facet between two others, as wide as makes the left one begin to count where the other two are equally deep. The
    // normal turns by at most twice the rate of the two outer facets (as above).
    TEST_CASE("property: the normal does not jump where a third facet begins to count between two that have shares")
    {
        for (const auto& [left, right] : {std::pair(0.0225, 0.0656), {0.005, 0.1}, {0.05, 0.1}, {0.1, 0.1}}) {
            CAPTURE(left);
            CAPTURE(right);
            const double wide = height * (left + right) / 2 + joint_width(left, r, smoothing) / left;
            Soup soup;
            add_strip(soup, -2e-3, 2e-3 * left, 2e-3, -2e-3 * left);
            add_strip(soup, 0, 0, wide, 0);
            add_strip(soup, wide, 0, 2e-3, 2e-3 * right);
            const double turn = left + right, step = 2e-9;
            const double rate = 2 * (std::sqrt(turn * turn + 4 * smoothing * smoothing) + 2 * smoothing) / (2 * smoothing * r);
            double most = 0;
            vec3 last{};
            for (int k = -10000; k <= 10000; ++k) {
                const vec3 now = contacts_at(soup, v3(wide - height * right / 2 + k * step, 0, height), r).first.normal;
                if (k > -10000) most = std::max(most, norm(now - last));
                last = now;
            }
            CHECK(most <= rate * step);
            CHECK(most > 0);
        }
    }

    TEST_CASE("derivative: the second derivatives are those of the normal, however many facets have a share")
    {
        for (const auto& [facets, x] : {std::pair(3, -0.1), {3, 0.15}, {4, 0.05}, {6, 0.02}, {12, 0.005}}) {
            CAPTURE(facets);
            const Pit pit(facets);
            const double eps = pit.width(0, 1), h = 1e-3 * eps;
            const vec3 p = v3(x * eps, 0.7 * x * eps, height);
            const ContactPoint here = pit.at(p);
            const double* s = here.hessian;
            const double full[3][3] = {{s[0], s[1], s[2]}, {s[1], s[3], s[4]}, {s[2], s[4], s[5]}};
            for (int c = 0; c < 3; ++c) {
                const vec3 e = v3(c == 0 ? h : 0, c == 1 ? h : 0, c == 2 ? h : 0);
                const vec3 d = (-1 / (2 * h)) * (pit.at(p + e).normal - pit.at(p - e).normal);
                // planes: the normal is linear in the position; what is left is rounding of 1e-16 m in depth over h
                CHECK(std::abs(d.x - full[0][c]) + std::abs(d.y - full[1][c]) + std::abs(d.z - full[2][c]) <=
                      1e-4 / (smoothing * r));
            }
        }
    }

    // over a pit of many facets, all equally deep, shares are the same all round: depth grows by half the mean distance of
    // normals, 4/pi sin(slope) on their circle
    TEST_CASE("analytic: of more facets than the list holds those are kept that lie all round")
    {
        const double mean = smoothing * r * 4 / std::numbers::pi * std::sin(slope);
        for (const int facets : {12, 24, 40, 64}) {
            CAPTURE(facets);
            const double joined = Pit(facets).at(v3(0, 0, height)).depth - (r - height * std::cos(slope));
            CHECK(joined <= mean / 2 + rounding);
            CHECK(joined >= 0.95 * mean / 2 - rounding);
        }
    }

    TEST_CASE("property: a ridge is not joined with its own edge: beside it the normal is the facet's")
    {
        Soup soup;
        add_strip(soup, 0, 0, 2e-3, -0.6e-3);
        add_strip(soup, -2e-3, -0.6e-3, 2e-3, 0.6e-3);
        const vec3 n = (1 / std::hypot(0.3, 1.0)) * v3(0.3, 0, 1), along = v3(n.z, 0, -n.x);
        for (const double beside : {0.1, 0.5, 1.0, 1.7}) {  // of smoothing r
            CAPTURE(beside);
            const ContactPoint contact = contacts_at(soup, height * n + beside * smoothing * r * along, r).first;
            CHECK(norm(contact.normal - n) <= 1e-6);
            CHECK(std::abs(contact.depth - (r - height)) <= rounding);
            for (const double second : contact.hessian) CHECK(second == 0);
        }
    }

    TEST_CASE("property: an edge counts once, whatever triangles it has")
    {
        // a floor, a step of 20 um that rises by 3 um, and beyond it a facet that rises less: their edge is as near as the floor
        const double w = 20e-6, rise = 3e-6;
        Soup two, three;
        for (Soup* soup : {&two, &three}) {
            add_strip(*soup, -2e-3, 0, 2e-3, 0);
            add_strip(*soup, 0, 0, w, rise);
        }
        add_strip(three, w, rise, 2e-3, 0.1e-3);
        const double x = w - std::sqrt(2 * height * rise);
        for (const double shift : {-0.2e-6, 0.0, 0.2e-6}) {
            CAPTURE(shift);
            const ContactPoint a = contacts_at(two, v3(x + shift, 0, height), r).first,
                               b = contacts_at(three, v3(x + shift, 0, height), r).first;
            CHECK(std::abs(a.depth - b.depth) <= 1e-3 * rounding);
            CHECK(norm(a.normal - b.normal) <= 1e-6);
            CHECK(a.hessian[0] > 0);  // the edge has a share
        }
    }
}

}  // namespace seldinger::test::test_smooth_maximum
