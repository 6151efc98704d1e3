// The error by which nodes are judged, against its formula, term by term; and edges that touch.
#include "nodes/adapt.h"
#include "rod/rod_fixture.h"

namespace seldinger::test::test_edge_errors {

namespace {

constexpr double length = 0.3;
constexpr int capacity = 400;

/// Straight, its edges uneven, of one material.
struct StraightWire : OneWire {
    WireSpec spec = uniform_spec(length, 5e-4, 3.8e-4, 1e4);
    NodePlanner planner{spec, capacity};
    explicit StraightWire(int edges) : OneWire(edges + 1, capacity)
    {
        std::vector<Vec3> nodes;
        for (int i = 0; i <= edges; ++i)
            nodes.push_back({length * (i + 0.1 * std::sin(3.0 * i) * (i % edges != 0)) / edges, 0, 0});
        place(nodes);
        set_rest_shape(rod, spec, false);
    }
};

}  // namespace

TEST_SUITE("nodes/adapt")
{
    // e(h) = l D h^2/(12 B) + T h^2/12: D the jump of shear and T the turning of an edge's two nodes, half of each
    // (nodes/adapt.h). The tip's error by shear has |M_j+1 - M_j| h^2/(6 B) besides, of the place of angles, and that by twist
    // another direction. One material has no offsets.
    TEST_CASE("analytic: errors of shear and of twist add up over the edges, and each edge is as long as its own allows")
    {
        StraightWire wire(12);
        const RodView& rod = wire.rod;
        const auto n = static_cast<std::size_t>(rod.n);
        std::vector<Vec3> moment(n);
        std::vector<double> turning(n);
        for (std::size_t i = 0; i < n; ++i) {
            moment[i] = Vec3(0, 0, 2e-4 * static_cast<double>(i % 3));
            turning[i] = 0.4 + 0.05 * static_cast<double>(i);
        }
        NodeDemands demands;
        const auto expected = [&](bool shear, bool twist, int j, double lever) {
            const auto jump = [&](int i) {
                i = std::clamp(i, 1, rod.n - 2);  // ends are judged as their neighbours
                return ((moment[i + 1] - moment[i]) / rod.rest_length[i] - (moment[i] - moment[i - 1]) / rod.rest_length[i - 1])
                    .norm();
            };
            return (shear ? lever * 0.5 * (jump(j) + jump(j + 1)) / (12 * 5e-4) : 0.0) +
                   (twist ? 0.5 * (turning[j] + turning[j + 1]) / 12 : 0.0);
        };
        const std::vector<Vec3> none(n, Vec3::Zero());
        for (const auto& [shear, twist] : {std::pair(true, false), {false, true}, {true, true}}) {
            CAPTURE(shear);
            CAPTURE(twist);
            demands.moment = shear ? std::span<const Vec3>(moment) : std::span<const Vec3>(none);
            demands.turning = twist ? std::span<const double>(turning) : std::span<const double>();
            double turned = 0, twisted = 0;
            for (int j = 0; j + 1 < rod.n; ++j) {  // where nothing touches, the tip is moved by an edge's angle over its distance
                                                   // from the middle of the edge
                const double lever = 0.5 * (rod.material_s[j] + rod.material_s[j + 1]),
                             square = rod.rest_length[j] * rod.rest_length[j];
                turned += expected(shear, false, j, lever) * square;
                if (shear) turned += (moment[j + 1] - moment[j]).norm() / (6 * 5e-4) * square;
                twisted += expected(false, twist, j, lever) * square;
            }
            CHECK(wire.planner.tip_error(rod, wire.spec, demands) == about(std::hypot(turned, twisted)).epsilon(1e-12));
            (void)wire.planner.base_edge(rod, wire.spec, {});  // nothing touches
            const std::span<const double> longest = wire.planner.longest_edges(rod, wire.spec, demands);
            int judged = 0;
            for (int j = 0; j + 1 < rod.n; ++j) {
                const double allowed =
                    std::sqrt(wire.spec.edge_error / expected(shear, twist, j, std::min(rod.material_s[j + 1], longest_lever)));
                CHECK(longest[j] == about(std::clamp(allowed, wire.spec.min_edge, wire.spec.max_edge)).epsilon(1e-12));
                judged += allowed > wire.spec.min_edge && allowed < wire.spec.max_edge;
            }
            REQUIRE(judged > 0);
        }
    }

    // A preformed bend that a lumen holds straight: its moments rise, and there is no curve between nodes that a polyline could
    // miss.
    TEST_CASE("property: where moments hold a wire straight the polyline misses no bending energy")
    {
        StraightWire wire(12);
        std::vector<Vec3> moment;
        for (int i = 0; i < wire.rod.n; ++i) moment.emplace_back(0, 0, 2e-4 * (i % 3));
        NodeDemands demands;
        demands.moment = moment;
        const BendingError error = wire.planner.bending_error(wire.rod, wire.spec, demands);
        CHECK(error.energy > 0);
        CHECK(error.missed == 0);
    }

    TEST_CASE("property: both edges beside a node with contact are as short as asked for, and edges elsewhere are not")
    {
        StraightWire wire(12);
        wire.spec.max_edge = 0.03;
        wire.planner = NodePlanner(wire.spec, capacity);
        NodeDemands demands;
        demands.touching_edge = 0.004;
        std::vector<Vec3> contact;
        const auto feel = [&] {  // where the material lies in the middle tenth
            contact.assign(static_cast<std::size_t>(wire.rod.n), Vec3::Zero());
            for (int i = 0; i < wire.rod.n; ++i)
                if (std::abs(wire.rod.material_s[i] - 0.15) < 0.015) contact[static_cast<std::size_t>(i)] = Vec3(0, 0, 1);
            demands.contact = contact;
        };
        int calls = 0;
        for (feel(); calls < 200; ++calls, feel()) {
            const auto changes = wire.planner.plan(wire.rod, wire.spec, demands, capacity);
            if (changes.empty()) break;
            (void)apply_changes(WireNodes(wire.arrays, 0, wire.spec, {}), changes);
            wire.rod = wire.arrays.view(0);
        }
        REQUIRE(calls < 200);
        int touching = 0;
        for (int j = 0; j + 1 < wire.rod.n; ++j) {
            if (contact[static_cast<std::size_t>(j)].isZero() && contact[static_cast<std::size_t>(j) + 1].isZero()) continue;
            ++touching;
            CAPTURE(wire.rod.material_s[j]);
            CHECK(wire.rod.rest_length[j] <= 0.004 * (1 + 1e-9));
        }
        REQUIRE(touching >= 8);
        CHECK(*std::max_element(wire.rod.rest_length.begin(), wire.rod.rest_length.begin() + wire.rod.n - 1) > 0.015);
    }
}

}  // namespace seldinger::test::test_edge_errors
