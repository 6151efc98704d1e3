// Repair: every triangle faces the lumen.
#include "core/error.h"
#include "repair/repair_steps.h"
#include "vessel/mesh_components.h"
#include "vessel/triangle_geometry.h"
#include "vessel/work_budget.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace seldinger::repair_steps {
namespace {

/// Spreads one triangle's orientation over all that hang together with it. Edges of two triangles go first; an edge that more
/// share only decides for what could not be reached otherwise, by opposing what already runs along it.
class OrientationSpread {
public:
    OrientationSpread(const WallMesh& mesh, const MeshEdges& edges)
        : mesh_(mesh),
          edges_(edges),
          edge_of_(3 * mesh.triangles.size()),
          flip_(mesh.triangles.size(), kUnknown),
          net_(edges.count(), 0),
          settled_(edges.count(), 0)
    {
        for (std::size_t k = 0; k < edges.count(); ++k)
            for (const std::int32_t h : edges.uses(k)) edge_of_[static_cast<std::size_t>(h)] = k;
    }

    std::vector<std::int8_t> run()
    {
        for (std::size_t seed = 0; seed < flip_.size(); ++seed) {
            if (flip_[seed] != kUnknown) continue;
            settle(static_cast<std::int32_t>(seed), 0);
            while (!plain_.empty() || !crowded_.empty()) {
                auto& list = plain_.empty() ? crowded_ : plain_;
                const std::size_t edge = list.back();
                list.pop_back();
                across(edge);
            }
        }
        return flip_;
    }

private:
    static constexpr std::int8_t kUnknown = -1;

    [[nodiscard]] int direction(std::int32_t h) const
    {
        const int along = half_edge_from(mesh_, h) < half_edge_to(mesh_, h) ? 1 : -1;
        return flip_[static_cast<std::size_t>(h / 3)] == 1 ? -along : along;
    }
    void settle(std::int32_t t, std::int8_t flip)
    {
        flip_[static_cast<std::size_t>(t)] = flip;
        for (int e = 0; e < 3; ++e) {
            const std::size_t edge = edge_of_[static_cast<std::size_t>(3 * t + e)];
            net_[edge] += direction(3 * t + e);
            const std::size_t users = edges_.uses(edge).size();
            if (users == 2) plain_.push_back(edge);
            else if (users > 2) crowded_.push_back(edge);
        }
    }
    void across(std::size_t edge)
    {
        const auto uses = edges_.uses(edge);
        // settled triangles stay settled: an edge of thousands of triangles is visited once and not once for each
        for (std::uint32_t& k = settled_[edge]; k < uses.size(); ++k) {
            const std::int32_t h = uses[k];
            if (flip_[static_cast<std::size_t>(h / 3)] != kUnknown) continue;
            const bool against = direction(h) * net_[edge] > 0;
            settle(h / 3, against ? 1 : 0);
            if (uses.size() > 2) {  // one at a time: its own neighbours may decide for the rest
                crowded_.push_back(edge);
                return;
            }
        }
    }

    const WallMesh& mesh_;
    const MeshEdges& edges_;
    std::vector<std::size_t> edge_of_;
    std::vector<std::int8_t> flip_;
    std::vector<int> net_;                // of each edge: directions of its settled triangles, added up
    std::vector<std::uint32_t> settled_;  // of each edge: its first uses that are
    std::vector<std::size_t> plain_, crowded_;
};

/// Whether there is nothing to spread: neighbours run against each other along every edge.
bool is_consistent(const WallMesh& mesh, const MeshEdges& edges)
{
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() > 2 || (uses.size() == 2 && half_edge_from(mesh, uses[0]) == half_edge_from(mesh, uses[1]))) return false;
    }
    return true;
}

void turn(WallMesh& mesh, std::size_t t) { std::swap(mesh.triangles[t][1], mesh.triangles[t][2]); }

/// True when p lies inside the part, its openings capped: the winding number rounds to something else than 0.
/// Solid angles of the caps are left out, so an opening that p looks through may cost up to half a turn: hence 0.5.
bool encloses(const WallMesh& mesh, const MeshComponent& part, const Vec3& p, WorkBudget& work)
{
    work.spend(1);
    // one triangle fills at most half of the view
    if (part.triangles.size() < 2 || !part.box.contains(p)) return false;
    work.spend(20 * static_cast<double>(part.triangles.size()));
    double angle = 0;
    for (const std::int32_t t : part.triangles) angle += solid_angle(p, triangle_of(mesh, static_cast<std::size_t>(t)));
    return std::abs(angle) > 0.5 * 4 * std::numbers::pi;
}

/// Compactness 6 sqrt(pi) V / A^(3/2): 1 for a sphere, 0.2 for a tube a hundred radii long, 0 for a patch.
double compactness(const MeshComponent& part)
{
    return part.area > 0 ? 6 * std::sqrt(std::numbers::pi) * std::abs(part.volume) / std::pow(part.area, 1.5) : 0.0;
}

constexpr long places_of_part = 8;

/// How many of some of its vertices lie inside another part.
long inside_of(const WallMesh& mesh, const MeshComponent& part, const MeshComponent& other, WorkBudget& work)
{
    long inside = 0;
    for (std::size_t k = 0; k < places_of_part; ++k) {
        const auto t = static_cast<std::size_t>(part.triangles[k * part.triangles.size() / places_of_part]);
        inside += encloses(mesh, other, mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][0])], work);
    }
    return inside;
}

void note_components(const std::vector<MeshComponent>& parts, long nested, long crossing, RepairReport& report)
{
    if (parts.size() > 1) {
        double all = 0, largest = 0;
        for (const MeshComponent& part : parts) all += part.area, largest = std::max(largest, part.area);
        report.notes.push_back(
            fmt::format("The surface falls into {} separate parts; each was turned on its own. The largest has {:.3g} % of the "
                        "surface; a wire stays in the part that it enters.",
                        parts.size(), all > 0 ? 100 * largest / all : 0));
    }
    if (nested > 0)
        report.notes.push_back(fmt::format("{} part{} inside another and count{} as an obstacle in its lumen.", nested,
                                           nested == 1 ? " lies" : "s lie", nested == 1 ? "s" : ""));
    if (crossing > 0)
        report.notes.push_back(fmt::format("{} part{} in part inside others: there a wire meets the walls of both. Fix: unite "
                                           "parts that are one lumen (a Boolean union) before the export.",
                                           crossing, crossing == 1 ? " lies" : "s lie"));
}

}  // namespace

void orient(WallMesh& mesh, MeshEdges& edges, RepairReport& report)
{
    std::vector<std::array<std::int32_t, 3>> as_read = mesh.triangles;
    if (!is_consistent(mesh, edges)) {
        const std::vector<std::int8_t> flip = OrientationSpread(mesh, edges).run();
        for (std::size_t t = 0; t < flip.size(); ++t)
            if (flip[t] == 1) turn(mesh, t);
        if (std::find(flip.begin(), flip.end(), 1) != flip.end()) edges = find_edges(mesh);
    }
    const bool shell = take_inner_shell(mesh, edges, as_read, report);
    if (shell) edges = find_edges(mesh);
    const std::vector<MeshComponent> parts = measure_components(mesh, edges, label_components(mesh, edges));

    // a noisy patch reaches 1e-5; nothing a wire could enter stays below 1e-3
    constexpr double kFlat = 1e-4;
    if (std::all_of(parts.begin(), parts.end(), [](const MeshComponent& part) { return compactness(part) < kFlat; }))
        throw Error(ErrorKind::BadFile,
                    fmt::format("the mesh bounds no lumen: got {} triangle{} of a flat patch, of sheets on each other or of "
                                "loose pieces; expected a tube or a closed surface",
                                mesh.triangles.size(), mesh.triangles.size() == 1 ? "" : "s"));
    long nested = 0, crossing = 0;
    WorkBudget work("telling which of its parts lie inside others", 5e8 + 5000.0 * static_cast<double>(mesh.triangles.size()));
    for (const MeshComponent& part : parts) {
        long around = 0, some = 0;
        for (const MeshComponent& other : parts) {
            const long inside = &other == &part ? 0 : inside_of(mesh, part, other, work);
            around += 2 * inside > places_of_part, some += inside > 0 && inside < places_of_part;
        }
        const bool obstacle = around % 2 == 1;
        nested += obstacle, crossing += some > 0;
        if ((part.volume > 0) != obstacle)
            for (const std::int32_t t : part.triangles) turn(mesh, static_cast<std::size_t>(t));
    }
    const long turned = std::inner_product(as_read.begin(), as_read.end(), mesh.triangles.begin(), 0L, std::plus<>{},
                                           [](const auto& a, const auto& b) { return a == b ? 0L : 1L; });
    const long count = static_cast<long>(mesh.triangles.size());
    report.inverted = 2 * turned > count;
    report.flipped = report.inverted ? count - turned : turned;
    note_components(parts, nested, crossing, report);
    if (shell) drop_unused_vertices(mesh);
    if (turned > 0) edges = find_edges(mesh);
}

}  // namespace seldinger::repair_steps
