// CGAL's AABB tree over triangles in double: a traversal of our own for capsules (the same box test as the kernels'), its own
// closest point.
#include "exact.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>

namespace peers {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Traits = CGAL::AABB_traits<Kernel, Primitive>;
using Tree = CGAL::AABB_tree<Traits>;

/// What Tree::traversal() asks.
struct Collector {
    const Problem& problem;
    const Triangles& triangles;
    const Capsule& capsule;
    seldinger::CapsuleBox box;
    std::vector<std::uint32_t>& out;

    [[nodiscard]] bool go_further() const { return true; }
    void intersection(const Capsule&, const Primitive& primitive)
    {
        const auto t = static_cast<std::uint32_t>(primitive.id() - triangles.begin());
        if (within(problem, capsule, t)) out.push_back(t);
    }
    template <class Node>
    [[nodiscard]] bool do_intersect(const Capsule&, const Node& node) const
    {
        const CGAL::Bbox_3 b = node.bbox();
        seldinger::TreeNode box_node{};
        for (int d = 0; d < 3; ++d)
            box_node.lo[d] = static_cast<float>(b.min(d)),
            box_node.hi[d] = static_cast<float>(b.max(d));  // exact: floats they were
        return seldinger::capsule_meets_box(box, box_node);
    }
};

class Cgal final : public Peer {
public:
    Cgal() { name = "CGAL AABB_tree"; }
    void build(const Problem& problem) override
    {
        tree_.clear();
        triangles_.clear();
        triangles_.reserve(problem.triangles());
        for (std::size_t t = 0; t < problem.triangles(); ++t) {
            const float* v = &problem.tree->vertices[9 * t];
            triangles_.emplace_back(Kernel::Point_3(v[0], v[1], v[2]), Kernel::Point_3(v[3], v[4], v[5]),
                                    Kernel::Point_3(v[6], v[7], v[8]));
        }
        tree_.insert(triangles_.cbegin(), triangles_.cend());
        tree_.build();
        tree_.accelerate_distance_queries();
    }
    void sets(const Problem& problem, Sets& out) override
    {
        on_two_threads(problem.capsules.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                out[k].clear();
                const Capsule& c = problem.capsules[k];
                Collector collector{problem, triangles_, c, seldinger::capsule_box(vec(c.a), vec(c.b), c.radius), out[k]};
                tree_.traversal(c, collector);
            }
        });
    }
    void nearest(const Problem& problem, Distances& out) override
    {
        on_two_threads(problem.points.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const auto& p = problem.points[k];
                out[k] = std::sqrt(tree_.squared_distance(Kernel::Point_3(p[0], p[1], p[2])));
            }
        });
    }

private:
    Triangles triangles_;
    Tree tree_;
};

}  // namespace

std::unique_ptr<Peer> make_cgal() { return std::make_unique<Cgal>(); }

}  // namespace peers
