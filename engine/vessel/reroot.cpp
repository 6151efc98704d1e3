// Walks the tree from each of its ends.
#include "vessel/reroot.h"

#include <algorithm>

namespace seldinger {
namespace {

// Of the widest end, which an end must have to be a way in: a common femoral artery (radius 4 mm) has a quarter of an aortic
// root's (16 mm), a coronary artery at its mouth (2 mm) an eighth.
constexpr double least_width = 0.2;

}  // namespace

void reroot_at_widest_end(Centreline& tree, WorkBudget& work)
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
        double reach, width;  // to the farthest end; mean radius over the first six radii of path [m]
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
        double sum = 0, number = 0;
        for (const std::size_t p : order)
            if (length[p] <= 6 * tree.radius[i]) {
                sum += tree.radius[p];
                number += 1;
            }
        ends.push_back({i, *std::max_element(length.begin(), length.end()), sum / number});
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
        best = nullptr;
        for (const End& end : ends)
            if (end.width >= 0.5 * widest && (!best || end.reach > best->reach)) best = &end;
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
