#pragma once
// Small walls for contact tests, as the kernels take them: a triangle soup in float, boundary feature bits, and one quadrature
// point's state.

#include "shared/contact_point.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace seldinger::test {

inline vec3 v3(double x, double y, double z) { return make_vec3(x, y, z); }
inline double norm(vec3 a) { return std::sqrt(dot3(a, a)); }

/// Triangles in leaf order with their boundary feature bits; every triangle is a candidate.
struct Soup {
    std::vector<float> vertices;          // [T][9] [m]
    std::vector<std::uint32_t> boundary;  // [T]
    std::vector<std::uint32_t> all;       // [T] 0, 1, ...
    std::vector<TreeNode> nodes;          // [T] cells of one triangle each, so that a cell's index is its triangle's

    void add(vec3 a, vec3 b, vec3 c, std::uint32_t at_boundary = 0)
    {
        for (const vec3& p : {a, b, c})
            for (double x : {p.x, p.y, p.z}) vertices.push_back(static_cast<float>(x));
        all.push_back(static_cast<std::uint32_t>(boundary.size()));
        boundary.push_back(at_boundary);
        nodes.push_back(leaf(boundary.size() - 1));
    }
    [[nodiscard]] TreeNode leaf(std::size_t t) const
    {
        TreeNode node{};
        node.left_or_first = static_cast<std::uint32_t>(t);
        node.count = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const float* x = &vertices[9 * t + k];
            node.lo[k] = std::min({x[0], x[3], x[6]});
            node.hi[k] = std::max({x[0], x[3], x[6]});
        }
        return node;
    }
    /// Boxes again, where vertices were changed by hand.
    void rebox()
    {
        nodes.clear();
        for (std::size_t t = 0; t < boundary.size(); ++t) nodes.push_back(leaf(t));
    }
    /// Parallelogram `corner`, `corner + u`, ...; normal u x v; cut into squares x squares of two triangles.
    void add_patch(vec3 corner, vec3 u, vec3 v, int squares = 1)
    {
        const double step = 1.0 / squares;
        for (int i = 0; i < squares; ++i)
            for (int j = 0; j < squares; ++j) {
                const vec3 a = corner + i * step * u + j * step * v, b = a + step * u, c = a + step * v, d = b + step * v;
                add(a, b, d);
                add(a, d, c);
            }
    }
};

/// All of a soup as the wall near a ball.
inline NearWallView all_of(const Soup& soup, const std::vector<std::uint32_t>& order)
{
    return near_wall_view(wall_view(soup.nodes.data(), soup.vertices.data(), soup.boundary.data()), order.data(),
                          static_cast<std::uint32_t>(order.size()));
}
inline NearWallView all_of(const Soup& soup) { return all_of(soup, soup.all); }

inline ContactPoint nearest_contact_point(ContactBall ball, NearWallView near, int front_only, double near2, NearList* list)
{
    ContactPoint contact;
    find_nearest(&contact, ball, near, front_only, near2, list);
    return contact;
}

/// Both contact points of an axis point, as evaluate_point finds them. `side`: last normal of a contact point that lives, or 0.
inline ContactPointPair contacts_at(const Soup& soup, vec3 p, double radius, double reach, double smoothing,
                                    const std::vector<std::uint32_t>& order, vec3 side = make_vec3(0, 0, 0))
{
    const ContactBall ball = contact_ball(p, v3(0, 0, 0), radius, reach, smoothing);
    const NearWallView near = all_of(soup, order);
    ContactPointPair t;
    NearList list;
    NeighbourPlanes planes;
    t.first = nearest_contact_point(ball, near, 0, 1e30, &list);
    t.first.side = side;
    t.second = no_contact_point(reach);
    if (!has_sides(&t.first, ball)) return t;
    join_neighbours(&t.first, &planes, ball, near, &list);
    (void)walk_opposite(&t.first, &t.second, ball, near, 0);
    list.count = SEL_NEAR_MOST + 1;  // it was of the first
    if (has_sides(&t.second, ball)) join_neighbours(&t.second, &planes, ball, near, &list);
    return t;
}
/// eps of (D6d) for two facets whose normals differ by `turn`.
inline double joint_width(double turn, double radius, double smoothing)
{
    return smoothing * radius * (std::sqrt(turn * turn + 4 * smoothing * smoothing) - 2 * smoothing);
}
inline ContactPointPair contacts_at(const Soup& soup, vec3 p, double radius, double reach = 1e-4, double smoothing = 0.002)
{
    return contacts_at(soup, p, radius, reach, smoothing, soup.all);
}

}  // namespace seldinger::test
