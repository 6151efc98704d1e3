// Contact's symmetric tangent without what pulls a wire on: EdgeSums::make_positive.

#include "contact/edge_sums.h"
#include "support/approx.h"

#include <array>
#include <random>
#include <vector>

namespace seldinger::test::test_positive_tangent {

namespace {

constexpr double radius = 4e-4;  // [m]
constexpr int unknowns = 8;      // of two nodes: x, y, z, theta of each; the last takes no part

/// One edge whose tangent is `stiffness` v v^T - `negative` w w^T, v and w in (x_a, x_b, radius theta).
EdgeSums one_edge(double stiffness, const std::array<double, 7>& v, double negative, const std::array<double, 7>& w)
{
    const auto entry = [&](int i, int j) {
        const double lengths = (i == 6 ? radius : 1) * (j == 6 ? radius : 1);
        return lengths * (stiffness * v[i] * v[j] - negative * w[i] * w[j]);
    };
    EdgeForce f{};
    f.contacts = 1;
    f.flags = SEL_FORCE_SLIDING;
    f.torque = 1e-6;
    f.u_ab[1] = 7;
    for (int i = 0, k = 0; i < 3; ++i) {
        f.force_a[i] = i + 1;
        for (int j = 0; j < 3; ++j) {
            f.s_ab[3 * i + j] = entry(i, 3 + j);
            if (j < i) continue;
            f.s_aa[k] = entry(i, j);
            f.s_bb[k++] = entry(3 + i, 3 + j);
        }
        f.st_a[i] = entry(i, 6);
        f.st_b[i] = entry(3 + i, 6);
    }
    f.s_tt = entry(6, 6);
    EdgeSums sums;
    sums.edges = {f};
    sums.edge_node = {0};
    sums.wire_edges = {0, 1};
    return sums;
}

/// q^T A q with the assembled tangent.
double along(const EdgeSums& sums, const std::array<double, unknowns>& q, bool symmetric)
{
    std::vector<double> residual(unknowns), product(unknowns);
    BandMatrix band(unknowns);
    band.reset(unknowns);
    sums.add(0, 0, residual, &band, symmetric);
    band.multiply(q, product);
    double sum = 0;
    for (int i = 0; i < unknowns; ++i) sum += q[i] * product[i];
    return sum;
}

std::array<double, unknowns> as_unknowns(const std::array<double, 7>& v)
{
    return {v[0], v[1], v[2], v[6] / radius, v[3], v[4], v[5], 0};
}

}  // namespace

// v and w are orthogonal, so that they are the modes. Rounding: 1e-16 of 3e4 N/m in some tens of products.
TEST_CASE("analytic: the negative mode of an edge's tangent is left out, the positive one and the forces stay")
{
    const std::array<double, 7> v{0.6, 0, 0, 0, 0, 0, 0.8}, w{0.64, 0, 0, 0, 0.6, 0, -0.48};
    EdgeSums sums = one_edge(3e4, v, 2e4, w);
    const auto at_v = as_unknowns(v), at_w = as_unknowns(w);
    CHECK(along(sums, at_w, true) == about(-2e4).epsilon(1e-12));
    sums.make_positive(0, radius);
    CHECK(along(sums, at_v, true) == about(3e4).epsilon(1e-12));
    CHECK(std::abs(along(sums, at_w, true)) < 1e-9);
    std::mt19937 rng(1);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 20; ++k) {
        std::array<double, 7> q;
        for (double& x : q) x = normal(rng);
        CHECK(along(sums, as_unknowns(q), true) >= -1e-9);
    }
    const EdgeForce& f = sums.edges[0];
    CHECK(f.force_a[2] == 3);
    CHECK(f.torque == 1e-6);
    CHECK(f.u_ab[1] == 7);  // what sliding makes unsymmetric
}

}  // namespace seldinger::test::test_positive_tangent
