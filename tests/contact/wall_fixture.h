#pragma once
// Small walls for contact tests, as the kernels take them: a triangle soup in float, rim bits, and one sample's state.

#include "shared/contact_sample.h"
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

/// Triangles in leaf order with their rim bits; every triangle is a candidate.
struct Soup {
    std::vector<float> vertices;      // [T][9] [m]
    std::vector<std::uint32_t> rims;  // [T]
    std::vector<std::uint32_t> all;   // [T] 0, 1, ...
    std::vector<TreeNode> nodes;      // [T] cells of one triangle each, so that a cell's index is its triangle's

    void add(vec3 a, vec3 b, vec3 c, std::uint32_t rim = 0)
    {
        for (const vec3& p : {a, b, c})
            for (double x : {p.x, p.y, p.z}) vertices.push_back(static_cast<float>(x));
        all.push_back(static_cast<std::uint32_t>(rims.size()));
        rims.push_back(rim);
        nodes.push_back(leaf(rims.size() - 1));
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
        for (std::size_t t = 0; t < rims.size(); ++t) nodes.push_back(leaf(t));
    }
    /// Parallelogram `corner`, `corner + u`, ...; normal u x v; cut into cells x cells squares of two triangles.
    void add_patch(vec3 corner, vec3 u, vec3 v, int cells = 1)
    {
        const double step = 1.0 / cells;
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j) {
                const vec3 a = corner + i * step * u + j * step * v, b = a + step * u, c = a + step * v, d = b + step * v;
                add(a, b, d);
                add(a, d, c);
            }
    }
};

struct Touches {
    Touch first, second;
};

/// Both touches of an axis point, as evaluate_sample finds them. `side`: last normal of a touch that lives, or 0.
inline Touches touches_at(const Soup& soup, vec3 p, double radius, double reach, double blend,
                          const std::vector<std::uint32_t>& order, vec3 side = make_vec3(0, 0, 0))
{
    const vec3 origin = v3(0, 0, 0);
    const auto count = static_cast<std::uint32_t>(order.size());
    Touches t;
    NearList list;
    t.first = nearest_touch(p, origin, radius, reach, blend, 0, 1e30, order.data(), count, soup.nodes.data(),
                            soup.vertices.data(), soup.rims.data(), &list);
    t.first.side = side;
    t.second = blend_and_oppose(&t.first, p, origin, radius, reach, blend, order.data(), count, soup.nodes.data(),
                                soup.vertices.data(), soup.rims.data(), &list);
    list.count = SEL_NEAR_MOST + 1;  // it was of the first
    if (t.second.found)
        (void)blend_and_oppose(&t.second, p, origin, radius, reach, blend, order.data(), count, soup.nodes.data(),
                               soup.vertices.data(), soup.rims.data(), &list);
    return t;
}
inline Touches touches_at(const Soup& soup, vec3 p, double radius, double reach = 1e-4, double blend = 0.002)
{
    return touches_at(soup, p, radius, reach, blend, soup.all);
}

}  // namespace seldinger::test
