// Where unknowns live: every unknown has one place, and the band is as wide as the map says.
#include "math/dof_map.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace seldinger::test::test_dof_map {

namespace {

/// Largest distance between unknowns of one rod that a stencil joins: all within two nodes, but no coordinate with a spin two
/// nodes on.
int widest(const DofMap& map)
{
    int most = 0;
    for (int rod = 0; rod < map.rods(); ++rod)
        for (int i = 0; i < map.nodes(rod); ++i)
            for (int j = i; j < std::min(i + RodDofs::reach + 1, map.nodes(rod)); ++j)
                for (int a = 0; a < RodDofs::per_node; ++a)
                    for (int b = 0; b < RodDofs::per_node; ++b) {
                        if (j == i + RodDofs::reach && b == RodDofs::spin_place) continue;
                        most = std::max(most, std::abs(map.node(rod, i) + a - map.node(rod, j) - b));
                    }
    return most;
}

void check_one_place_each(const DofMap& map)
{
    std::set<int> places;
    for (int rod = 0; rod < map.rods(); ++rod)
        for (int i = 0; i < map.nodes(rod); ++i) {
            for (int c = 0; c < RodDofs::coordinates; ++c) places.insert(map.position(rod, i, c));
            places.insert(map.spin(rod, i));
        }
    CHECK(static_cast<int>(places.size()) == map.size());
    CHECK(*places.begin() == 0);
    CHECK(*places.rbegin() == map.size() - 1);
}

}  // namespace

TEST_SUITE("math/dof_map")
{
    TEST_CASE("property: every unknown has one place, one rod after the other")
    {
        DofMap map;
        const int nodes[] = {7, 3, 5};
        map.lay_out(nodes);
        CHECK(map.rods() == 3);
        CHECK(map.size() == RodDofs::count(15));
        CHECK(map.first(1) == RodDofs::count(7));
        check_one_place_each(map);
        CHECK(map.half_bandwidth() == RodDofs::half_bandwidth);
        CHECK(widest(map) == RodDofs::half_bandwidth);
    }

    // equal rods side by side: nodes alternate, so that a stencil of three nodes reaches 4 places
    TEST_CASE("property: interleaved along the hub distance, and the band as wide as that makes it")
    {
        DofMap map;
        const int nodes[] = {5, 5};
        const double from_hub[] = {0.4, 0.3, 0.2, 0.1, 0.0, 0.4, 0.3, 0.2, 0.1, 0.0};
        map.lay_out(nodes, DofMap::Order::Interleaved, from_hub);
        check_one_place_each(map);
        CHECK(map.node(0, 0) == 0);
        CHECK(map.node(1, 0) == RodDofs::count(1));
        CHECK(map.node(0, 1) == RodDofs::count(2));
        CHECK(map.half_bandwidth() == RodDofs::per_node * 4 + RodDofs::coordinates - 1);
        CHECK(map.half_bandwidth() >= widest(map));
    }

    TEST_CASE("property: a rod that ends sooner and has finer nodes is interleaved where it is")
    {
        DofMap map;
        const int nodes[] = {4, 6};
        const double from_hub[] = {0.9, 0.6, 0.3, 0.0, 0.25, 0.2, 0.15, 0.1, 0.05, 0.0};
        map.lay_out(nodes, DofMap::Order::Interleaved, from_hub);
        check_one_place_each(map);
        CHECK(map.node(0, 2) < map.node(1, 0));  // the coarse rod's third node is farther from the hub than all of the fine one
        // of the coarse rod from its second node to the hub, past five of the fine one's: 7 places
        CHECK(map.half_bandwidth() == RodDofs::per_node * 7 + RodDofs::coordinates - 1);
        CHECK(map.half_bandwidth() >= widest(map));
    }
}

}  // namespace seldinger::test::test_dof_map
