// Repair: which loops of the boundary are openings of the vessel, and closing the others.
#include "repair/repair_steps.h"
#include "vessel/mesh_components.h"
#include "vessel/triangle_geometry.h"
#include "vessel/work_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace seldinger::repair_steps {
namespace {

constexpr std::size_t kLongestHole = 200;  // vertices; filling is cubic in it
constexpr long most_named = 3;             // holes, in a note

/// A hole is one of these. (1) A loop of at most four edges: no one models a lumen with four facets. (2) A loop of at most
/// twelve edges and 1/3 of the lumen's radius: too coarse for a branch that anyone means to enter. Or (3) a loop in the plane
/// of the wall around it that is clearly smaller than the lumen. At the end of a tube the wall's normals are square to the
/// loop's, at a hole they are along it. The bound is a mean |cosine| of 0.6; a tube cut at 45 degrees reaches 0.45. A hole of
/// the lumen's own width in a flat cap is a cap cut open on purpose.
/// @param facing  mean |cosine| between the loop's normal and those of the triangles along it
/// @param lumen_radius  2 V / A of its component: the radius of a tube with that volume and wall [m]
/// @return the rule that it is one by, in words; null: it is an opening
const char* hole_by(const BoundaryLoop& loop, double facing, double lumen_radius)
{
    if (loop.vertices.size() > kLongestHole) return nullptr;
    if (loop.vertices.size() <= 4) return "at most 4 edges";
    if (loop.vertices.size() <= 12 && loop.radius < 0.35 * lumen_radius)
        return "at most 12 edges, below 0.35 of the lumen's radius";
    return facing > 0.6 && loop.radius < 0.5 * lumen_radius ? "flat in the wall, below half of the lumen's radius" : nullptr;
}

using Edge = std::pair<std::int32_t, std::int32_t>;
Edge edge_of(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Fills the loop with the triangles of least total area [Barequet & Sharir 1995, doi:10.1016/0167-8396(94)00011-G]; with a fan
/// round its middle where these would give an edge a third triangle, as beside other holes of a ragged rim.
/// @param taken  edges between vertices of loops; the new ones are added
void fill(WallMesh& mesh, const std::vector<std::int32_t>& loop, const Vec3& middle, std::set<Edge>& taken)
{
    const std::size_t n = loop.size();
    auto at = [&](std::size_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(loop[i])]; };
    std::vector<double> cost(n * n, 0.0);
    std::vector<std::size_t> apex(n * n, 0);  // of each span; a span's middle where no area is the least, so that spans end
    for (std::size_t span = 2; span < n; ++span)
        for (std::size_t i = 0; i + span < n; ++i) {
            const std::size_t j = i + span;
            double best = std::numeric_limits<double>::infinity();
            apex[i * n + j] = i + span / 2;
            for (std::size_t k = i + 1; k < j; ++k) {
                const double c = cost[i * n + k] + cost[k * n + j] + double_area({at(i), at(k), at(j)}).norm();
                if (c < best) {
                    best = c;
                    apex[i * n + j] = k;
                }
            }
            cost[i * n + j] = best;
        }
    std::vector<std::array<std::int32_t, 3>> filling;
    std::set<Edge> diagonals;
    bool fits = true;
    std::vector<std::pair<std::size_t, std::size_t>> todo = {{0, n - 1}};
    while (!todo.empty()) {
        const auto [i, j] = todo.back();
        todo.pop_back();
        if (j - i < 2) continue;
        if (j - i + 1 < n) fits = fits && !taken.contains(edge_of(loop[i], loop[j])), diagonals.insert(edge_of(loop[i], loop[j]));
        const std::size_t k = apex[i * n + j];
        filling.push_back({loop[j], loop[k], loop[i]});  // against the loop, as a neighbour must run
        todo.push_back({i, k});
        todo.push_back({k, j});
    }
    if (fits) {
        taken.merge(diagonals);
    } else {
        filling.clear();
        for (std::size_t i = 0; i < n; ++i)
            filling.push_back({loop[(i + 1) % n], loop[i], static_cast<std::int32_t>(mesh.vertices.size())});
        mesh.vertices.push_back(middle);
    }
    mesh.triangles.insert(mesh.triangles.end(), filling.begin(), filling.end());
}

}  // namespace

void close_holes(WallMesh& mesh, MeshEdges& edges, RepairReport& report)
{
    const std::vector<std::vector<std::int32_t>> chains = boundary_chains(mesh, edges);
    if (chains.empty()) return;
    const std::vector<std::int32_t> label = label_components(mesh, edges);
    const std::vector<MeshComponent> parts = measure_components(mesh, edges, label);
    // area-weighted normal and component of the triangles along each boundary vertex's outgoing edge
    std::vector<std::int32_t> along(mesh.vertices.size(), -1);
    for (std::size_t k = 0; k < edges.count(); ++k)
        if (edges.uses(k).size() == 1)
            along[static_cast<std::size_t>(half_edge_from(mesh, edges.uses(k)[0]))] = edges.uses(k)[0] / 3;

    std::set<Edge> taken;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t h = edges.uses(k)[0], from = half_edge_from(mesh, h), to = half_edge_to(mesh, h);
        if (along[static_cast<std::size_t>(from)] >= 0 && along[static_cast<std::size_t>(to)] >= 0)
            taken.insert(edge_of(from, to));
    }

    // a hole of 200 corners takes 1.3 million steps
    std::string places;
    WorkBudget work("filling its holes", 1e8 + 100.0 * static_cast<double>(mesh.triangles.size()));
    for (const auto& chain : chains) {
        const BoundaryLoop loop = describe_loop(mesh, chain);
        double facing = 0;
        for (const std::int32_t v : chain) {
            const Vec3 area = double_area(triangle_of(mesh, static_cast<std::size_t>(along[static_cast<std::size_t>(v)])));
            facing += area.norm() > 0 ? std::abs(area.normalized().dot(loop.inward)) : 0.0;
        }
        facing /= static_cast<double>(chain.size());
        const MeshComponent& part =
            parts[static_cast<std::size_t>(label[static_cast<std::size_t>(along[static_cast<std::size_t>(chain[0])])])];
        const char* rule = hole_by(loop, facing, 2 * std::abs(part.volume) / part.area);
        if (!rule) continue;
        work.spend(std::pow(static_cast<double>(chain.size()), 3) / 6);
        fill(mesh, chain, loop.centre, taken);
        if (++report.hole_loops_closed <= most_named) {
            const Vec3& at = loop.centre;
            places += fmt::format("{}at [{:.4g}, {:.4g}, {:.4g}] m, radius {:.3g} mm ({})", places.empty() ? "" : "; ", at.x(),
                                  at.y(), at.z(), 1e3 * loop.radius, rule);
        }
    }
    const long closed = report.hole_loops_closed;
    if (closed == 0) return;
    edges = find_edges(mesh);
    if (closed > most_named) places += fmt::format("; and {} more", closed - most_named);
    report.notes.push_back(fmt::format("{} small hole{} closed: {}. vessel.close_holes = false leaves {} open.", closed,
                                       closed == 1 ? " was" : "s were", places, closed == 1 ? "it" : "them"));
}

}  // namespace seldinger::repair_steps
