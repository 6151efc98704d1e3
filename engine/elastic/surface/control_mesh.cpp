// Checks the parts of a control mesh and measures the result.
#include "surface/control_mesh.h"

#include "core/error.h"
#include "surface/remesh.h"
#include "vessel/triangle_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace seldinger {
namespace {

constexpr int rounds = 8;
constexpr double flat_angle = 1e-3;  // [rad] of a triangle; its stiffness goes with the inverse

[[noreturn]] void refuse(const std::string& what)
{
    throw Error(ErrorKind::BadFile, fmt::format("the wall {}; repair the mesh, or set vessel.wall = \"rigid\"", what));
}

std::string in_words(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", p.x(), p.y(), p.z()); }

/// A shell needs a sheet with two sides.
void check_edges(const WallMesh& wall, const MeshEdges& edges)
{
    long shared = 0, against = 0;
    Vec3 shared_at = Vec3::Zero(), against_at = Vec3::Zero();
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        const auto middle = [&]() -> Vec3 {
            return 0.5 * (wall.vertices[half_edge_from(wall, uses[0])] + wall.vertices[half_edge_to(wall, uses[0])]);
        };
        if (uses.size() > 2 && shared++ == 0) shared_at = middle();
        if (uses.size() == 2 && half_edge_from(wall, uses[0]) == half_edge_from(wall, uses[1]) && against++ == 0)
            against_at = middle();
    }
    if (shared > 0)
        refuse(
            fmt::format("is elastic and must be one sheet, but {} of its edges belong to three triangles or more, the "
                        "first at {}",
                        shared, in_words(shared_at)));
    if (against > 0)
        refuse(fmt::format("is elastic and must have two sides, but at {} its triangles disagree on the inside",
                           in_words(against_at)));
}

/// Each piece would need its own tissue or rims to hold it, and a piece that is there by mistake is debris.
void check_one_piece(const WallMesh& wall, const EditMesh& sheet)
{
    std::vector<std::int32_t> first;  // triangle of each piece
    std::vector<long> size;
    std::vector<bool> seen(wall.triangles.size(), false);
    std::vector<std::int32_t> stack;
    for (std::int32_t seed = 0; seed < static_cast<std::int32_t>(seen.size()); ++seed) {
        if (seen[seed]) continue;
        first.push_back(seed);
        size.push_back(0);
        seen[seed] = true;
        for (stack.assign(1, seed); !stack.empty();) {
            const std::int32_t t = stack.back();
            stack.pop_back();
            ++size.back();
            for (std::int32_t e = 0; e < 3; ++e)
                if (const std::int32_t g = sheet.across(3 * t + e); g >= 0 && !seen[g / 3]) {
                    seen[g / 3] = true;
                    stack.push_back(g / 3);
                }
        }
    }
    if (size.size() < 2) return;
    const auto least = std::min_element(size.begin(), size.end()) - size.begin();
    refuse(fmt::format("is elastic and must be one sheet, but it is in {} pieces, the smallest of {} triangles at {}",
                       size.size(), size[least], in_words(triangle_of(wall, first[least]).a)));
}

/// A surface folded flat upon itself has triangles without area in any case.
void check_angles(const WallMesh& mesh)
{
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        if (least_angle(tri.a, tri.b, tri.c) < flat_angle)
            refuse(fmt::format("is elastic, but at {} it is folded flat or pinched, and no control mesh fits there",
                               in_words(tri.a)));
    }
}

void measure(const WallMesh& mesh, const Remesher& remesher, ControlMeshReport& report)
{
    report = {};
    report.vertices = static_cast<long>(mesh.vertices.size());
    report.triangles = static_cast<long>(mesh.triangles.size());
    report.rims = static_cast<long>(remesher.rim_count());
    const MeshEdges edges = find_edges(mesh);
    std::vector<int> valence(mesh.vertices.size(), 0), best(mesh.vertices.size(), 6);
    std::vector<double> fit;
    const auto distance = [&](const Vec3& p) {
        report.distance = std::max(report.distance, (remesher.surface().nearest(p).point - p).norm());
    };
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t a = half_edge_from(mesh, edges.uses(k)[0]), b = half_edge_to(mesh, edges.uses(k)[0]);
        const Vec3 middle = 0.5 * (mesh.vertices[a] + mesh.vertices[b]);
        const double length = (mesh.vertices[b] - mesh.vertices[a]).norm();
        report.edge_least = k == 0 ? length : std::min(report.edge_least, length);
        report.edge_most = std::max(report.edge_most, length);
        report.edge_mean += length / static_cast<double>(edges.count());
        fit.push_back(length / remesher.field().at(middle));
        for (const std::int32_t v : {a, b}) {
            ++valence[v];
            if (edges.uses(k).size() == 1) best[v] = 4;
        }
        distance(middle);
    }
    std::sort(fit.begin(), fit.end());
    report.fit_least = fit[fit.size() / 100];
    report.fit_most = fit[fit.size() - 1 - fit.size() / 100];
    long regular = 0;
    for (std::size_t v = 0; v < valence.size(); ++v) regular += valence[v] == best[v];
    report.regular = static_cast<double>(regular) / static_cast<double>(valence.size());
    report.angle_least = 4;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        report.angle_least = std::min(report.angle_least, least_angle(tri.a, tri.b, tri.c));
        distance((tri.a + tri.b + tri.c) / 3);
    }
}

}  // namespace

WallMesh make_control_mesh(const WallMesh& wall, const ControlMeshSpec& spec, ControlMeshReport* report)
{
    if (wall.triangles.empty()) refuse("has no triangles");
    const MeshEdges edges = find_edges(wall);
    check_edges(wall, edges);
    EditMesh sheet(wall, edges);
    check_one_piece(wall, sheet);
    check_control_edge(sample_wall(wall).area, spec.edge);
    static const Centreline none;
    Remesher remesher(wall, std::move(sheet),
                      EdgeField(spec.edge, spec.share, spec.centreline ? *spec.centreline : none, spec.path));
    remesher.run(rounds);
    WallMesh mesh = remesher.result();
    check_angles(mesh);
    if (report) measure(mesh, remesher, *report);
    return mesh;
}

}  // namespace seldinger
