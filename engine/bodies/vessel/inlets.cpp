// Inlets from openings and from the tips of the centreline.
#include "vessel/inlets.h"

#include "core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace seldinger {
namespace {

/// Points from a tip along its branch: towards the root, or for the root along the main path.
std::vector<int> walk_in(const Centreline& line, int tip)
{
    if (line.parent[static_cast<std::size_t>(tip)] < 0) return line.main_path();
    std::vector<int> walk;
    for (int at = tip; at >= 0; at = line.parent[static_cast<std::size_t>(at)]) walk.push_back(at);
    return walk;
}

/// A closed end narrows to nothing: go in until one local radius of lumen lies behind.
Inlet closed_end(const Centreline& line, int tip)
{
    const std::vector<int> walk = walk_in(line, tip);
    double behind = 0;
    std::size_t k = 0;
    for (; k + 1 < walk.size() && behind < line.radius[static_cast<std::size_t>(walk[k])]; ++k)
        behind += (line.points[static_cast<std::size_t>(walk[k + 1])] - line.points[static_cast<std::size_t>(walk[k])]).norm();
    const auto at = static_cast<std::size_t>(walk[k]);
    // direction over two radii of path, so that one kink does not set it
    std::size_t far = k;
    double ahead = 0;
    for (; far + 1 < walk.size() && ahead < 2 * line.radius[at]; ++far)
        ahead += (line.points[static_cast<std::size_t>(walk[far + 1])] - line.points[static_cast<std::size_t>(walk[far])]).norm();
    Inlet inlet;
    inlet.point = line.points[at];
    inlet.radius = line.radius[at];
    const Vec3 along = far > k ? Vec3(line.points[static_cast<std::size_t>(walk[far])] - inlet.point)
                               : Vec3(inlet.point - line.points[static_cast<std::size_t>(walk[0])]);
    inlet.direction = along.norm() > 0 ? Vec3(along.normalized()) : Vec3(Vec3::UnitX());
    return inlet;
}

/// A centreline begins where the vessel is entered: the opening at its root, when there is one.
std::optional<Inlet> opening_at_root(const std::vector<Inlet>& inlets, const Centreline& line)
{
    for (const Inlet& inlet : inlets)
        for (std::size_t i = 0; i < line.points.size(); ++i)
            if (line.parent[i] < 0 && (line.points[i] - inlet.point).norm() < 0.5 * inlet.radius) return inlet;
    return std::nullopt;
}

void bring_forward(std::vector<Inlet>& inlets, const Inlet& first)
{
    const auto at = std::find_if(inlets.begin(), inlets.end(), [&](const Inlet& i) { return i.point == first.point; });
    if (at != inlets.end()) std::rotate(inlets.begin(), at, at + 1);
}

/// Short tips beside each other lead to one place of the lumen: one inlet.
std::vector<Inlet> without_copies(const std::vector<Inlet>& all)
{
    std::vector<Inlet> kept;
    for (const Inlet& inlet : all) {
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const Inlet& k) {
            return (k.point - inlet.point).norm() < 0.5 * std::min(k.radius, inlet.radius) &&
                   k.direction.dot(inlet.direction) > 0.7;
        });
        if (!known) kept.push_back(inlet);
    }
    return kept;
}

}  // namespace

std::vector<Inlet> find_inlets(const std::vector<BoundaryLoop>& openings, const Centreline& centreline)
{
    std::vector<Inlet> inlets;
    for (std::size_t k = 0; k < openings.size(); ++k)
        inlets.push_back({openings[k].centre, openings[k].inward, openings[k].radius, static_cast<int>(k)});
    const bool closed = inlets.empty();
    std::optional<Inlet> root;
    if (closed) {
        std::vector<int> children(centreline.points.size(), 0);
        for (const int parent : centreline.parent)
            if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
        for (std::size_t i = 0; i < centreline.points.size() && centreline.points.size() > 1; ++i) {
            const bool is_root = centreline.parent[i] < 0;
            if (!is_root && children[i] > 0) continue;
            inlets.push_back(closed_end(centreline, static_cast<int>(i)));
            if (is_root && !root) root = inlets.back();
        }
    }
    std::stable_sort(inlets.begin(), inlets.end(), [](const Inlet& a, const Inlet& b) { return a.radius > b.radius; });
    if (!closed) root = opening_at_root(inlets, centreline);
    if (root) bring_forward(inlets, *root);
    return without_copies(inlets);
}

int inlet_through(const std::vector<BoundaryLoop>& openings, const Centreline& centreline, int opening)
{
    const std::vector<Inlet> inlets = find_inlets(openings, centreline);
    const auto at = std::ranges::find(inlets, opening, &Inlet::opening);
    return at == inlets.end() || opening < 0 ? 0 : static_cast<int>(at - inlets.begin()) + 1;
}

std::string describe(const Inlet& inlet)
{
    const Vec3 &p = inlet.point, &d = inlet.direction;
    return fmt::format(
        "[{:.5f}, {:.5f}, {:.5f}] m = [{:.2f}, {:.2f}, {:.2f}] mm along [{:.3f}, {:.3f}, {:.3f}], lumen radius {:.5f} m = {:.2f} "
        "mm{}",
        p.x(), p.y(), p.z(), 1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z(), d.x(), d.y(), d.z(), inlet.radius, 1e3 * inlet.radius,
        inlet.opening >= 0 ? "" : " (a closed end)");
}

Inlet pick_inlet(const std::vector<BoundaryLoop>& openings, const Centreline& centreline)
{
    const std::vector<Inlet> inlets = find_inlets(openings, centreline);
    if (inlets.empty())
        throw Error(ErrorKind::BadFile,
                    "the vessel has no opening and no centreline to start on: give feed.point and feed.direction");
    return inlets.front();
}

}  // namespace seldinger
