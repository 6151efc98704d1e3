// Walks the tree from each of its ends.
#include "vessel/reroot.h"

#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

// Least width of an inlet, relative to the widest end: a common femoral artery (radius 4 mm) has 1/4 of an aortic root's (16 mm),
// a coronary artery at its mouth (2 mm) 1/8.
constexpr double least_width = 0.2;

// Part of a lumen's cross section that a plane across its end must fill to be a cut. In a hemisphere 10 % lie in the layer that
// counts as the plane.
constexpr double least_flat = 0.5;
constexpr double flat_layer = 0.05;  // thickness of that layer in radii

/// Whether the lumen of this radius ends in a plane ahead of `from`.
bool ends_flat(const WallMesh& mesh, const LumenQuery& lumen, const Vec3& from, const Vec3& outward, double radius)
{
    const double ahead = first_hit(lumen.tree(), from, outward);
    if (!std::isfinite(ahead)) return false;
    const LumenPlace end = lumen.locate(from + ahead * outward);
    double twice_area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 corners = triangle_of(mesh, t);
        const Vec3 away = (corners.a + corners.b + corners.c) / 3 - end.nearest, area = double_area(corners);
        if (away.norm() < 1.5 * radius && std::abs(away.dot(end.normal)) < flat_layer * radius &&
            area.dot(end.normal) > 0.98 * area.norm())
            twice_area += area.norm();
    }
    return twice_area > 2 * least_flat * std::numbers::pi * radius * radius;
}

}  // namespace

void reroot_at_widest_end(Centreline& tree, const WallMesh& mesh, const LumenQuery& lumen, WorkBudget& work)
{
    const std::size_t count = tree.points.size();
    if (count < 2) return;
    std::vector<std::vector<std::size_t>> links(count);
    for (std::size_t i = 0; i < count; ++i)
        if (tree.parent[i] >= 0) {
            links[i].push_back(static_cast<std::size_t>(tree.parent[i]));
            links[static_cast<std::size_t>(tree.parent[i])].push_back(i);
        }
    struct End {
        std::size_t point;
        double reach, width;  // to the farthest end; mean radius of what is within six radii of path [m]
        double mouth;         // largest radius within two radii of path: of this end alone, no branches of it [m]
        Vec3 outward;         // unit, over the last two mouths of path
    };
    std::vector<End> ends;
    std::vector<double> length(count);
    std::vector<std::size_t> order;
    auto walk_from = [&](std::size_t start) {
        std::fill(length.begin(), length.end(), -1.0);
        length[start] = 0;
        order.assign(1, start);
        for (std::size_t k = 0; k < order.size(); ++k)
            for (const std::size_t next : links[order[k]])
                if (length[next] < 0) {
                    length[next] = length[order[k]] + (tree.points[next] - tree.points[order[k]]).norm();
                    order.push_back(next);
                }
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (links[i].size() != 1) continue;
        work.spend(10 * static_cast<double>(count));
        walk_from(i);
        double sum = 0, number = 0, mouth = 0;
        for (const std::size_t p : order) {
            if (length[p] <= 6 * tree.radius[i]) {
                sum += tree.radius[p];
                number += 1;
            }
            if (length[p] <= 2 * tree.radius[i]) mouth = std::max(mouth, tree.radius[p]);
        }
        const auto inner = std::find_if(order.begin(), order.end(), [&](std::size_t p) { return length[p] >= 2 * mouth; });
        const Vec3 back = tree.points[inner == order.end() ? order.back() : *inner];
        ends.push_back(
            {i, *std::max_element(length.begin(), length.end()), sum / number, mouth, (tree.points[i] - back).normalized()});
    }
    const double longest =
        std::max_element(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.reach < b.reach; })->reach;
    const End* best = nullptr;
    for (const End& end : ends)
        if (end.reach >= 0.9 * longest && (!best || end.width > best->width)) best = &end;
    // ends all along a longest path may be tips (both coronaries of an aortic root): then the wide end that is farthest from them
    const double widest =
        std::max_element(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.width < b.width; })->width;
    if (best->width < least_width * widest) {
        double widest_mouth = 0;
        for (const End& end : ends) widest_mouth = std::max(widest_mouth, end.mouth);
        best = nullptr;
        bool best_flat = false;
        for (const End& end : ends) {
            if (end.mouth < 0.5 * widest_mouth) continue;
            work.spend(10 * static_cast<double>(mesh.triangles.size()));
            const bool flat = ends_flat(mesh, lumen, tree.points[end.point], end.outward, end.mouth);
            if (best && (best_flat != flat ? best_flat : end.reach <= best->reach)) continue;
            best = &end;
            best_flat = flat;
        }
    }
    walk_from(best->point);
    // parents anew, and points in the order of the walk, so that a parent stands before its children
    Centreline turned;
    std::vector<int> place(count, -1);
    for (const std::size_t p : order) {
        int parent = -1;
        for (const std::size_t q : links[p])
            if (place[q] >= 0) parent = place[q];
        place[p] = static_cast<int>(turned.points.size());
        turned.points.push_back(tree.points[p]);
        turned.radius.push_back(tree.radius[p]);
        turned.parent.push_back(parent);
    }
    tree = std::move(turned);
}

}  // namespace seldinger
