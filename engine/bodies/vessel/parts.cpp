// Components by area, and sentences about them.
#include "vessel/parts.h"

#include "vessel/mesh_components.h"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <numeric>

namespace seldinger {

VesselParts::VesselParts(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings) : mesh_(mesh)
{
    const MeshEdges edges = find_edges(mesh);
    const std::vector<std::int32_t> label = label_components(mesh, edges);
    const std::vector<MeshComponent> all = measure_components(mesh, edges, label);
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return all[a].area > all[b].area; });
    double area = 0;
    for (const MeshComponent& part : all) area += part.area;
    std::vector<int> rank(all.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        const MeshComponent& part = all[order[k]];
        rank[order[k]] = static_cast<int>(k);
        parts_.push_back({area > 0 ? part.area / area : 0, 0, part.volume > 0, part.box});
    }
    part_of_vertex_ = labels_of_vertices(mesh, label);
    for (int& part : part_of_vertex_)
        if (part >= 0) part = rank[static_cast<std::size_t>(part)];
    for (const BoundaryLoop& loop : openings)
        if (!loop.vertices.empty())
            ++parts_[static_cast<std::size_t>(part_of_vertex_[static_cast<std::size_t>(loop.vertices[0])])].openings;
}

int VesselParts::part_at(const Vec3& p) const
{
    int best = -1;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v)
        if (const double d = (mesh_.vertices[v] - p).squaredNorm(); part_of_vertex_[v] >= 0 && d < distance) {
            distance = d;
            best = part_of_vertex_[v];
        }
    return best;
}

std::vector<std::string> VesselParts::describe_choice(int part) const
{
    if (parts_.size() < 2 || part < 0) return {};
    const auto words = [&](std::size_t k) {
        const VesselPart& p = parts_[k];
        const Vec3 at = 1e3 * p.box.center();
        return fmt::format("part {} ({:.3g} % of the surface, {} opening{}, around [{:.1f}, {:.1f}, {:.1f}] mm{})", k + 1,
                           100 * p.share, p.openings, p.openings == 1 ? "" : "s", at.x(), at.y(), at.z(),
                           p.obstacle ? ", inside another part" : "");
    };
    const auto entered = static_cast<std::size_t>(part);
    double obstacles = 0;
    for (const VesselPart& p : parts_) obstacles += p.obstacle ? p.share : 0;
    const double left_out = 1 - parts_[entered].share - (parts_[entered].obstacle ? 0 : obstacles);
    std::vector<std::string> lines = {
        fmt::format("the surface is in {} separate parts; the wire enters {}, and {:.2g} % of the surface is out of its reach",
                    parts_.size(), words(entered), 100 * std::max(0.0, left_out))};
    std::string others;
    for (std::size_t k = 0; k < std::min<std::size_t>(parts_.size(), 5); ++k)
        if (k != entered) others += (others.empty() ? "" : ", ") + words(k);
    if (parts_.size() > 5) others += fmt::format(" and {} smaller ones", parts_.size() - 5 - (entered >= 5 ? 1 : 0));
    lines.push_back("the others: " + others);
    if (entered > 0 && !parts_[0].obstacle)
        lines.push_back(
            fmt::format("part 1 is larger than the part that is entered. Fix: take an inlet that leads into it, or join the "
                        "parts in the segmentation"));
    return lines;
}

}  // namespace seldinger
