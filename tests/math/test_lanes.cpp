// rod/elastic.cpp and rod/frames.cpp take as many nodes at a time as the processor has lanes: with the bits of one at a time.

#include "rod/rod_fixture.h"

namespace seldinger::test::test_lanes {

namespace {

OneWire bent_wire(int n, double rest_kappa)
{
    std::mt19937 rng(n);
    std::uniform_real_distribution<double> sign(-1, 1);
    OneWire wire(n, n + 3);
    std::vector<Vec3> nodes;
    for (int i = 0; i < n; ++i) nodes.emplace_back(i, 0.4 * sign(rng), 0.4 * sign(rng));
    wire.place(nodes);
    const RodView& rod = wire.rod;
    set_rest_shape(rod, uniform_spec(rod.material_s[n - 1], 1.3, 0.9, 20), false);
    for (int i = 0; i < n; ++i) {
        rod.rest_kappa1[i] = rest_kappa;
        rod.rest_twist[i] = 0.1 * sign(rng);
        rod.bend_stiffness[i] *= 1 + 0.3 * sign(rng);
        if (i + 1 < n) rod.rest_length[i] *= 1 + 0.1 * sign(rng), rod.theta[i] = sign(rng);
    }
    const auto clamp = [&](int node, bool direction, bool spin) {
        wire.clamps.push_back({.node = node, .direction = direction, .spin = spin});
    };
    clamp(n - 1, true, true);
    if (n > 3) clamp(0, true, false);
    if (n > 6) clamp(n / 2, true, true), clamp(3, false, true);
    return wire;
}

}  // namespace

TEST_SUITE("rod/lanes")
{
    // Natural curvature is beyond lanes: those nodes are taken one at a time, with pair.h. So little of it adds 1e-250 at most,
    // which changes no bit of a number that is not that small itself.
    TEST_CASE("twin: forces and Hessians of nodes side by side have the bits of one stencil at a time")
    {
        for (int n = 2; n < 28; ++n) {
            CAPTURE(n);
            OneWire lanes = bent_wire(n, 0), single = bent_wire(n, 1e-250);
            REQUIRE(lanes.update());
            REQUIRE(single.update());
            CHECK((lanes.gradient() - single.gradient()).lpNorm<Eigen::Infinity>() < 1e-200);
            CHECK((lanes.hessian(HessianMode::Exact) - single.hessian(HessianMode::Exact)).lpNorm<Eigen::Infinity>() < 1e-200);
            if (n > 2) REQUIRE(lanes.gradient().norm() > 0.1);
        }
    }

    // the frames of a wire that ends in the middle of a vector, against those of a longer one that begins with the same nodes
    TEST_CASE("property: frames do not depend on what stands beside a node")
    {
        for (int n = 3; n < 20; ++n) {
            CAPTURE(n);
            OneWire longer(30), shorter(n);
            std::mt19937 rng(5);
            std::uniform_real_distribution<double> sign(-1, 1);
            std::vector<Vec3> nodes;
            for (int i = 0; i < 30; ++i) nodes.emplace_back(i, 0.4 * sign(rng), 0.4 * sign(rng));
            longer.place(nodes);
            shorter.place({nodes.begin(), nodes.begin() + n});
            for (int j = 0; j + 1 < n; ++j) {
                shorter.rod.theta[j] = longer.rod.theta[j] = sign(rng);
                shorter.rod.set_ref_d1(j, longer.rod.ref_d1(j));
            }
            REQUIRE(longer.update());
            REQUIRE(shorter.update());
            for (int i = 0; i + 1 < n; ++i) {
                CHECK(longer.frames.tangent[i] == shorter.frames.tangent[i]);
                CHECK(longer.frames.d1[i] == shorter.frames.d1[i]);
                CHECK(longer.frames.kb[i] == shorter.frames.kb[i]);
                CHECK(longer.frames.twist[i] == shorter.frames.twist[i]);
                CHECK(longer.frames.kappa1[i] == shorter.frames.kappa1[i]);
            }
        }
    }

    TEST_CASE("property: the energy of a straight wire is the same with and without material frames")
    {
        OneWire with = bent_wire(17, 0), without = bent_wire(17, 0);
        without.frames.material = false;
        REQUIRE(with.update());
        REQUIRE(without.update());
        CHECK(without.energy() == about(with.energy()).epsilon(1e-14));
    }
}

}  // namespace seldinger::test::test_lanes
