// Rest shape, stiffness and mass from the wire's description; the storage of all wires.

#include "rod/rod_fixture.h"

#include <numbers>
#include <set>

namespace seldinger::test::test_rest_shape {

TEST_SUITE("rod/rest_shape")
{
    TEST_CASE("property: later sections win, ends belong to the wire")
    {
        WireSpec spec = uniform_spec(0.1, 1, 1, 1);
        WireSection soft = spec.shaft, softer = spec.shaft;
        soft.bend_stiffness = 0.5;
        softer.bend_stiffness = 0.25;
        spec.sections = {{0.0, 0.05, soft}, {0.04, 0.06, softer}, {0.09, 0.1, soft}};
        CHECK(spec.at(0.0).bend_stiffness == 0.5);
        CHECK(spec.at(-1.0).bend_stiffness == 0.5);
        CHECK(spec.at(0.039).bend_stiffness == 0.5);
        CHECK(spec.at(0.04).bend_stiffness == 0.25);
        CHECK(spec.at(0.045).bend_stiffness == 0.25);
        CHECK(spec.at(0.06).bend_stiffness == 1.0);
        CHECK(spec.at(0.1).bend_stiffness == 0.5);
        CHECK(spec.at(7.0).bend_stiffness == 0.5);
    }

    TEST_CASE("analytic: cells across a jump add compliance, mass and natural curvature")
    {
        WireSpec spec = uniform_spec(0.4, 1.0, 0.8, 100);
        WireSection tip = spec.shaft;
        tip.bend_stiffness = 1e-3;
        tip.twist_stiffness = 2e-3;
        tip.stretch_stiffness = 10;
        tip.density = 4000;
        tip.radius = 0.5e-3;
        tip.rest_curvature = {20, -5};
        spec.sections = {{0, 0.17, tip}};
        OneWire wire(5);
        wire.place(straight_nodes(5, 0.4));
        set_rest_shape(wire.rod, spec, false);
        const RodView& rod = wire.rod;

        // node 2 at 0.2 covers 0.15..0.25, edge 1 for 0.1..0.2; 0.02 and 0.07 of them are tip
        CHECK(rod.bend_stiffness[2] == about(0.1 / (0.02 / 1e-3 + 0.08 / 1.0)));
        CHECK(rod.twist_stiffness[2] == about(0.1 / (0.02 / 2e-3 + 0.08 / 0.8)));
        CHECK(rod.rest_kappa1[2] == about(20 * 0.02));
        CHECK(rod.rest_kappa2[2] == about(-5 * 0.02));
        CHECK(rod.stretch_stiffness[1] == about(0.1 / (0.07 / 10 + 0.03 / 100)));
        CHECK(rod.rest_length[1] == about(0.1));
        // tip and hub: their half cell
        CHECK(rod.rest_kappa1[0] == about(20 * 0.05));
        CHECK(rod.bend_stiffness[0] == about(1e-3));
        CHECK(rod.rest_kappa1[4] == 0);

        const double line_tip = 4000 * std::numbers::pi * 0.25e-6, line_shaft = 8000 * std::numbers::pi * 1e-6;
        double mass = 0, inertia = 0;
        for (int i = 0; i < 5; ++i) mass += rod.mass[i];
        for (int j = 0; j < 4; ++j) inertia += rod.spin_inertia[j];
        CHECK(mass == about(0.17 * line_tip + 0.23 * line_shaft));
        CHECK(inertia == about(0.5 * (0.17 * line_tip * 0.25e-6 + 0.23 * line_shaft * 1e-6)));
        CHECK(rod.mass[2] == about(0.02 * line_tip + 0.08 * line_shaft));
    }

    TEST_CASE("property: a wire at rest where it was placed carries nothing, with its ends clamped too")
    {
        const int n = 30;
        std::vector<Vec3> nodes;
        for (int i = 0; i < n; ++i) nodes.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 0.03 * i});
        OneWire wire(n);
        wire.place(nodes);
        for (int j = 0; j < n - 1; ++j) wire.rod.theta[j] = 0.05 * j;
        set_rest_shape(wire.rod, uniform_spec(wire.rod.material_s[n - 1], 1, 0.7, 100), true);
        REQUIRE(wire.update());
        const Eigen::VectorXd g = wire.gradient();
        CHECK(g.lpNorm<Eigen::Infinity>() < 1e-12);

        // a clamp along the helix' own tangent at the hub node: off by what the half cell cannot know, O(h^2)
        const double a = 0.1 * (n - 1);
        wire.clamps = {{.node = n - 1, .tangent = Vec3(-0.1 * std::sin(a), 0.1 * std::cos(a), 0.03).normalized()}};
        REQUIRE(wire.update());
        // chord against tangent in a helix: kappa torsion h^2/6 = 4.5e-4, so 2e-6 J; 0.02 without the half cell's rest curvature
        CHECK(wire.energy() < 3e-6);
    }

    TEST_CASE("property: each wire has its own slice of every array, and nodes come and go inside it")
    {
        RodArrays rods(std::vector<int>{4, 7});
        CHECK(rods.total_capacity() == 11);
        CHECK(rods.node_begin(1) == 4);
        std::set<const double*> starts;
        for (int w = 0; w < 2; ++w) {
            const auto arrays = rods.arrays(w);
            for (std::size_t k = 0; k < arrays.size(); ++k) {
                CHECK(static_cast<int>(arrays[k].size()) == rods.capacity(w));
                starts.insert(arrays[k].data());
                for (double& value : arrays[k]) value = 100 * w + static_cast<double>(k);
            }
        }
        CHECK(starts.size() == 2 * 32);
        CHECK(rods.view(1).material_s[0] == 100);
        CHECK(rods.view(1).clamp_twist_b[6] == 131);
        CHECK(rods.view(0).clamp_twist_b[3] == 31);

        rods.set_node_count(1, 5);
        RodView rod = rods.view(1);
        CHECK(rod.n == 5);
        for (int i = 0; i < 5; ++i) rod.x[i] = rod.theta[i] = i;
        rods.insert_node(1, 3);
        rod = rods.view(1);
        REQUIRE(rod.n == 6);
        const double after_insert[] = {0, 1, 2, 3, 3, 4};
        for (int i = 0; i < 6; ++i) CHECK((rod.x[i] == after_insert[i] && rod.theta[i] == after_insert[i]));
        rods.erase_node(1, 2);
        rod = rods.view(1);
        REQUIRE(rod.n == 5);
        const double after_erase[] = {0, 1, 3, 3, 4};
        for (int i = 0; i < 5; ++i) CHECK(rod.x[i] == after_erase[i]);
        CHECK(rods.view(0).clamp_twist_b[3] == 31);
    }
}

}  // namespace seldinger::test::test_rest_shape
