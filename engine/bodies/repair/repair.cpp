// The order of the repair, and the counts at its end.
#include "repair/repair.h"

#include "core/error.h"
#include "core/printable.h"
#include "repair/repair_steps.h"
#include "vessel/mesh_components.h"
#include "vessel/mesh_limits.h"
#include "vessel/triangle_geometry.h"

#include <fmt/format.h>
#include <algorithm>

namespace seldinger {
namespace {

void require_triangles(const WallMesh& mesh, const RepairReport& report)
{
    if (!mesh.triangles.empty()) return;
    throw Error(
        ErrorKind::BadFile,
        fmt::format("no usable triangle is left of {}: {} with non-finite corners, {} degenerate, {} duplicates",
                    report.triangles_read, report.non_finite_dropped, report.degenerate_dropped, report.duplicates_dropped));
}

void count(const WallMesh& mesh, const MeshEdges& edges, RepairReport& report)
{
    report.triangles = static_cast<long>(mesh.triangles.size());
    report.vertices = static_cast<long>(mesh.vertices.size());
    report.boundary_edges = report.non_manifold_edges = report.slivers = 0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        report.boundary_edges += edges.uses(k).size() == 1;
        report.non_manifold_edges += edges.uses(k).size() > 2;
    }
    const std::vector<std::int32_t> label = label_components(mesh, edges);
    report.components = label.empty() ? 0 : 1 + *std::max_element(label.begin(), label.end());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        report.slivers += triangle_quality(triangle_of(mesh, t)) < repair_steps::kSliverQuality;
    report.loops.clear();
    for (const auto& chain : boundary_chains(mesh, edges)) report.loops.push_back(describe_loop(mesh, chain));
    const std::vector<bool> main = vertices_of_largest(mesh, label);
    const auto rank = [&](const BoundaryLoop& loop) { return main.empty() || main[static_cast<std::size_t>(loop.vertices[0])]; };
    // the largest part first: the vessel, not a crumb. Then the widest, where the inlet usually is
    std::stable_sort(report.loops.begin(), report.loops.end(), [&](const BoundaryLoop& a, const BoundaryLoop& b) {
        return rank(a) != rank(b) ? rank(a) : a.radius > b.radius;
    });
}

void write_notes(RepairReport& report)
{
    const auto say = [&](long number, const char* one, const char* many) { repair_steps::note(report, number, one, many); };
    say(report.non_finite_dropped, "triangle had a corner that is not a number and was removed",
        "triangles had a corner that is not a number and were removed");
    say(report.degenerate_dropped, "triangle without area was removed", "triangles without area were removed");
    say(report.duplicates_dropped, "triangle was there twice; the copy was removed",
        "triangles were there twice; the copies were removed");
    say(report.flipped, "triangle faced the other way than its neighbours and was turned",
        "triangles faced the other way than their neighbours and were turned");
    if (report.inverted) report.notes.push_back("The surface faced out of the lumen; all of it was turned.");
    say(report.non_manifold_edges, "edge is shared by more than two triangles; both sides of it are kept as they are",
        "edges are shared by more than two triangles; all sides of them are kept as they are");
    say(report.slivers, "triangle is a sliver (quality below 0.05): its normal is less exact",
        "triangles are slivers (quality below 0.05): their normals are less exact");
    if (report.loops.empty())
        report.notes.push_back("The surface is closed: it has no opening, a wire starts from a point inside.");
}

}  // namespace

void repair_steps::note(RepairReport& report, long number, const char* one, const char* many)
{
    if (number > 0) report.notes.push_back(count_of(static_cast<std::size_t>(number), one, many) + ".");
}

RepairReport repair(WallMesh& mesh, bool holes)
{
    using namespace repair_steps;
    RepairReport report;
    report.triangles_read = static_cast<long>(mesh.triangles.size());
    drop_non_finite(mesh, report);
    weld(mesh, report);
    drop_degenerate(mesh, report);
    drop_duplicates(mesh, report);
    MeshEdges edges = drop_flaps(mesh, report);
    require_triangles(mesh, report);
    require_no_strays(mesh, median_edge(mesh));
    weld_rims(mesh, edges, report);
    drop_crumbs(mesh, edges, report);
    orient(mesh, edges, report);
    if (holes) close_holes(mesh, edges, report);
    dissolve_needles(mesh, edges, report);
    require_triangles(mesh, report);
    count(mesh, edges, report);
    write_notes(report);
    return report;
}

RepairReport describe(const WallMesh& mesh)
{
    RepairReport report;
    report.triangles_read = static_cast<long>(mesh.triangles.size());
    count(mesh, find_edges(mesh), report);
    return report;
}

}  // namespace seldinger
