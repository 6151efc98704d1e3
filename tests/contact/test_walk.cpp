// Nodes of the tree in place of lists of triangles: the nodes that are left out must not matter, and few must remain.

#include "contact/wall_fixture.h"
#include "shapes/shapes.h"
#include "shapes/subdivide.h"
#include "shared/clearance.h"
#include "vessel/tree.h"

#include <cstring>

namespace seldinger::test::test_walk {

namespace {

constexpr double r = 0.4445e-3, reach = 0.1 * r;

WallMesh bumpy_tube(int triangles, double radius)
{
    VesselSpec spec{.shape = VesselShape::Tube, .radius = radius, .length = 0.02, .triangles = triangles};
    WallMesh mesh = make_tube(spec).mesh;
    for (Vec3& v : mesh.vertices) v *= 1 + 0.01 * std::sin(900 * v.x()) * std::cos(800 * v.y());
    return mesh;
}

struct Random {
    std::mt19937 rng{5};
    double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng); }
};

/// Every triangle as a separate cell, with a box that holds everything: nothing is left out.
struct Everything {
    std::vector<TreeNode> nodes;
    std::vector<uint> near_cells;
    explicit Everything(std::size_t triangles)
    {
        for (std::size_t t = 0; t < triangles; ++t) {
            nodes.push_back({{-1, -1, -1}, static_cast<uint>(t), {1, 1, 1}, 1});
            near_cells.push_back(static_cast<uint>(t));
        }
    }
};

template <class T>
bool same_bits(const T& a, const T& b)
{
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same(const ContactPoint& a, const ContactPoint& b)
{
    if (a.found != b.found) return false;
    return !a.found || (same_bits(a.normal, b.normal) && same_bits(a.depth, b.depth) && same_bits(a.hessian, b.hessian) &&
                        a.triangle == b.triangle && a.outside == b.outside && same_bits(a.to_wall, b.to_wall));
}

AxisPoint axis(vec3 origin, vec3 offset)
{
    AxisPoint at{};
    at.origin = origin;
    at.offset = offset;
    return at;
}

}  // namespace

TEST_SUITE("contact/walk")
{
    // Wide and narrow lumens, in front of the wall and behind it, with a hint and without, the list found where the quadrature
    // point was a slack away.
    TEST_CASE("property: walking the listed nodes gives the same contact points, bit by bit, as looking at every triangle")
    {
        Random draw;
        int found = 0, opposite = 0, outside = 0;
        for (const double radius : {0.5e-3, 0.003}) {
            const WallMesh mesh = bumpy_tube(radius < 1e-3 ? 3000 : 12000, radius);
            const WallTree tree = build_wall_tree(mesh);
            const Everything all(tree.triangle_count());
            const std::vector<uint> boundary(tree.triangle_count(), 0);
            const WallView wall = wall_view(tree.nodes.data(), tree.vertices.data(), boundary.data());
            std::vector<uint> near_cells(tree.triangle_count());
            for (int k = 0; k < 300; ++k) {
                const double a = draw(0, 6.283), rho = radius - r * draw(-0.3, 1.15), slack = 0.4 * r;
                const vec3 origin = v3(static_cast<float>(draw(-0.01, 0.01)), static_cast<float>(rho * std::cos(a)),
                                       static_cast<float>(rho * std::sin(a)));
                const vec3 p = v3(draw(-1e-5, 1e-5), draw(-1e-5, 1e-5), 0);
                const vec3 then = p + v3(draw(-0.5, 0.5) * slack, draw(-0.5, 0.5) * slack, draw(-0.5, 0.5) * slack);
                const uint count = find_near_cells(axis(origin, then), r + reach + slack, SEL_NEAR_CELL_SIZE * r, wall,
                                                   static_cast<uint>(near_cells.size()), near_cells.data());
                ContactPoint states[2][2];
                for (const bool walked : {false, true}) {
                    const NearWallView around =
                        walked ? near_wall_view(wall, near_cells.data(), count)
                               : near_wall_view(wall_view(all.nodes.data(), tree.vertices.data(), boundary.data()),
                                                all.near_cells.data(), static_cast<uint>(all.near_cells.size()));
                    const ContactBall ball = contact_ball(p, origin, r, reach, 0.002);
                    NearList near, none;
                    none.count = SEL_NEAR_MOST + 1;  // the reference goes without the list as well
                    const double hint = walked && k % 2 && states[0][0].found
                                            ? triangle_distance2(p, origin, states[0][0].triangle, tree.vertices.data())
                                            : 1e30;
                    ContactPoint& first = states[walked][0];
                    first = nearest_contact_point(ball, around, 0, hint, &near);
                    if (first.outside) first = nearest_contact_point(ball, around, k % 3 == 0, hint, &near);
                    states[walked][1] = no_contact_point(reach);
                    if (!has_sides(&first, ball)) continue;
                    NeighbourPlanes planes;
                    join_neighbours(&first, &planes, ball, around, walked ? &near : &none);
                    (void)walk_opposite(&first, &states[walked][1], ball, around, 0);
                }
                CAPTURE(k);
                CAPTURE(radius);
                CHECK(same(states[0][0], states[1][0]));
                CHECK(same(states[0][1], states[1][1]));
                found += states[0][0].found;
                opposite += states[0][1].found;
                outside += states[0][0].found && states[0][0].outside;
            }
        }
        REQUIRE(found > 300);
        REQUIRE(opposite > 30);
        REQUIRE(outside > 30);
    }

    // Quadrature points that wander off from where their lists were found, and ask at every step: points within the list's
    // range, and points beyond it, both come up.
    TEST_CASE("property: a sphere of clearance holds no triangle within radius and reach, and most of the room there is")
    {
        Random draw;
        const WallTree tree = build_wall_tree(bumpy_tube(6000, 0.003));
        QuadratureModel model{};
        model.radius = r;
        model.reach = reach;
        const double slack = 0.4 * r, range = r + reach + slack;
        const WallView wall = wall_view(tree.nodes.data(), tree.vertices.data(), nullptr);
        std::vector<uint> near_cells(tree.triangle_count());
        const vec3 zero = v3(0, 0, 0);
        int clear = 0, kept = 0, touching = 0;
        for (int walk = 0; walk < 300; ++walk) {
            const double a = draw(0, 6.283), rho = 0.003 - r - draw(-0.1, 0.6) * r;
            vec3 p = v3(draw(-0.01, 0.01), rho * std::cos(a), rho * std::sin(a));
            const uint count = find_near_cells(axis(zero, p), range, SEL_NEAR_CELL_SIZE * r, wall,
                                               static_cast<uint>(near_cells.size()), near_cells.data());
            Clearance known = found_clearance(p, range, slack, r, count);
            for (int k = 0; k < 40; ++k) {
                p = p + v3(draw(-1, 1) * 0.3 * r, draw(-1, 1) * 0.3 * r, draw(-1, 1) * 0.3 * r);
                const double before = known.at[0];
                const int nothing =
                    is_clear_of_wall(axis(zero, p), model, near_wall_view(wall, near_cells.data(), count), &known);
                const double distance = std::sqrt(nearest_on_wall(tree, tree.centre + Vec3(p.x, p.y, p.z)).distance2);
                if (nothing) REQUIRE(distance > r + reach);
                if (nothing && known.at[0] != before) {
                    // p is its new centre, and the list knows the wall up to `listed`
                    const double margin = SEL_CLEARANCE_MARGIN * r, touching = r + reach + margin,
                                 listed = range - distance_from(p, known.list_at) - margin, rounding = 1e-12 * r;
                    REQUIRE(known.clear <= distance - touching + rounding);
                    REQUIRE(known.clear >= SEL_CLEARANCE_PART * (std::min(distance, listed) - touching) - rounding);
                }
                clear += nothing;
                kept += nothing && known.at[0] == before;
                touching += distance <= r + reach;
            }
        }
        REQUIRE(clear > 300);
        REQUIRE(kept > 100);  // by the sphere alone
        REQUIRE(touching > 300);
    }

    TEST_CASE("property: a leaf's slab holds its triangles, and is thin where the wall is flat")
    {
        Random draw;
        const WallTree tree = build_wall_tree(subdivide_loop(bumpy_tube(6000, 0.003)));
        int leaves = 0, thin = 0, beyond = 0;
        for (const TreeNode& node : tree.nodes) {
            if (SEL_IS_INNER(node.count)) continue;
            ++leaves;
            if (!SEL_HAS_SLAB(node.count)) continue;
            thin += SEL_HAS_SLAB(node.count) < SEL_SLAB_STEPS / 4;
            const vec3 origin = v3(node.lo[0], node.lo[1], node.lo[2]),
                       p = v3(draw(-1e-3, 1e-3), draw(-1e-3, 1e-3), draw(-1e-3, 1e-3));
            double nearest2 = 1e30;
            for (uint k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k)
                nearest2 = std::min(nearest2, triangle_distance2(p, origin, node.left_or_first + k, tree.vertices.data()));
            const double nearest = std::sqrt(nearest2);
            REQUIRE_FALSE(slab_beyond(p, node, origin, nearest * (1 + 1e-12)));
            REQUIRE(box_near2(p, node, origin) <= nearest2 * (1 + 1e-12));
            beyond += slab_beyond(p, node, origin, 0.8 * nearest);
        }
        CHECK(beyond > leaves / 2);  // nor does it hold much else
        REQUIRE(leaves > 3000);
        // triangles of 0.2 mm in a lumen of 3 mm: a leaf of two stands 0.2^2 / (8 x 3) = 2 um high on a diagonal of 0.3 mm;
        // slivers of large boxes aside
        CHECK(thin > 0.9 * leaves);
    }

    TEST_CASE("property: a wall that is sixteen times as dense is not looked at sixteen times as much")
    {
        WallMesh mesh = bumpy_tube(6000, 0.003);
        double work[2] = {0, 0};
        for (const int round : {0, 1}) {
            if (round == 1) mesh = subdivide_loop(subdivide_loop(mesh));
            const WallTree tree = build_wall_tree(mesh);
            const WallView wall = wall_view(tree.nodes.data(), tree.vertices.data(), nullptr);
            std::vector<uint> near_cells(4096);
            double most = 0;
            for (int k = 0; k < 200; ++k) {
                const double a = 0.03 * k, rho = 0.003 - r - 2e-6;
                const vec3 origin = v3(-0.005 + 5e-5 * k, rho * std::cos(a), rho * std::sin(a)), p = v3(0, 0, 0);
                const uint count =
                    find_near_cells(axis(origin, p), 1.5 * r, SEL_NEAR_CELL_SIZE * r, wall, 4096, near_cells.data());
                most = std::max(most, static_cast<double>(count));
                // triangles of the leaves that a walk to the nearest reaches, once something near is known
                const TreeHit hit = nearest_on_wall(tree, tree.centre + Vec3(origin.x, origin.y, origin.z));
                const double range = shell_distance(std::sqrt(hit.distance2), contact_ball(p, origin, r, 0, 0.002));
                Walk walk;
                start_walk(&walk);
                TreeNode leaf;
                while (next_leaf(&walk, near_wall_view(wall, near_cells.data(), count), ball_query(p, origin, range), &leaf))
                    work[round] += leaf.count;
            }
            // cells are some two radii long and cover a disc of 1.1 radii round the foot
            CHECK(most < 40);
        }
        REQUIRE(work[0] > 0);
        // boxes that reach within d of the point lie within sqrt(2 d s) of its foot, s their size: 2 d/s of them, four times as
        // many at a quarter of s
        CHECK(work[1] < 4 * work[0]);
    }
}

}  // namespace seldinger::test::test_walk
