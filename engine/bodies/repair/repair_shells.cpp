// Vessels with a wall of a thickness: an outer and an inner shell, as separate parts or joined by rims. The wire is in the inner.
#include "core/error.h"
#include "repair/repair_steps.h"
#include "vessel/mesh_components.h"
#include "vessel/triangle_geometry.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace seldinger::repair_steps {
namespace {

constexpr double least_share = 0.2;    // of the surface: a shell, not a crumb, a stent's strut or a catheter
/// How much alike the two sides are.
struct Likeness {
    double ratio;   // largest, of the areas, as of the radii: a coronary artery's outer radius is 1.6 inner ones
    double uneven;  // largest, of the thickness at 90 % of the places, in medians
};
constexpr Likeness separate{1.8, 2.5}, joined_sides{3, 6};  // of sides, more is known: plaque and thrombus thicken a wall
constexpr std::size_t samples = 200;

struct Patch {
    std::int32_t label = 0;
    double area = 0;
    std::vector<std::int32_t> triangles;
    Box3 box;
};

/// The two largest patches, the larger first; fewer where another one is no shell.
std::vector<Patch> shells_of(const WallMesh& mesh, const std::vector<std::int32_t>& label)
{
    std::vector<Patch> patches;
    double all = 0;
    for (std::size_t t = 0; t < label.size(); ++t) {
        const auto k = static_cast<std::size_t>(label[t]);
        if (k >= patches.size()) patches.resize(k + 1);
        const Triangle3 corners = triangle_of(mesh, t);
        const double area = 0.5 * double_area(corners).norm();
        patches[k].label = label[t];
        patches[k].area += area;
        patches[k].triangles.push_back(static_cast<std::int32_t>(t));
        for (const Vec3& p : {corners.a, corners.b, corners.c}) patches[k].box.extend(p);
        all += area;
    }
    std::stable_sort(patches.begin(), patches.end(), [](const Patch& a, const Patch& b) { return a.area > b.area; });
    while (!patches.empty() && (patches.size() > 2 || patches.back().area < least_share * all)) patches.pop_back();
    return patches;
}

/// Corners of a patch, evenly chosen.
std::vector<Vec3> chosen_points(const WallMesh& mesh, const Patch& patch)
{
    std::vector<Vec3> points;
    const std::size_t step = std::max<std::size_t>(1, patch.triangles.size() / samples);
    for (std::size_t k = 0; k < patch.triangles.size(); k += step)
        points.push_back(triangle_of(mesh, static_cast<std::size_t>(patch.triangles[k])).a);
    return points;
}

double distance_to(const WallMesh& mesh, const Patch& patch, const Vec3& p)
{
    double least = std::numeric_limits<double>::infinity();
    for (const std::int32_t t : patch.triangles) {
        const Triangle3 c = triangle_of(mesh, static_cast<std::size_t>(t));
        least = std::min({least, (c.a - p).squaredNorm(), ((c.a + c.b + c.c) / 3 - p).squaredNorm()});
    }
    return std::sqrt(least);
}

bool encloses(const WallMesh& mesh, const Patch& outer, const std::vector<Vec3>& points)
{
    std::size_t inside = 0, asked = 0;
    for (std::size_t k = 0; k < points.size(); k += std::max<std::size_t>(1, points.size() / 20), ++asked) {
        if (!outer.box.contains(points[k])) continue;
        double angle = 0;
        for (const std::int32_t t : outer.triangles)
            angle += solid_angle(points[k], triangle_of(mesh, static_cast<std::size_t>(t)));
        inside += std::abs(angle) > 0.5 * 4 * std::numbers::pi;  // ends of open shells are seen, hence not all of 4 pi
    }
    return 4 * inside > 3 * asked;
}

/// Thickness of the wall between two shells, the smaller one inside; nothing where they are no such shells.
std::optional<double> wall_between(const WallMesh& mesh, const std::vector<Patch>& shells, const Likeness& most)
{
    if (shells.size() != 2 || shells[0].area > most.ratio * shells[1].area) return std::nullopt;
    const std::vector<Vec3> points = chosen_points(mesh, shells[1]);
    if (!encloses(mesh, shells[0], points)) return std::nullopt;
    std::vector<double> gaps;
    for (const Vec3& p : points) gaps.push_back(distance_to(mesh, shells[0], p));
    std::sort(gaps.begin(), gaps.end());
    const double middle = gaps[gaps.size() / 2];
    if (gaps[gaps.size() * 9 / 10] > most.uneven * middle) return std::nullopt;
    return middle;
}

void keep(WallMesh& mesh, const std::vector<bool>& kept, std::vector<std::array<std::int32_t, 3>>& beside)
{
    std::size_t to = 0;
    for (std::size_t t = 0; t < kept.size(); ++t)
        if (kept[t]) {
            mesh.triangles[to] = mesh.triangles[t];
            beside[to++] = beside[t];
        }
    mesh.triangles.resize(to);
    beside.resize(to);
}

/// Of a mesh of one large part: its outer side and rims are labelled 0, its inner side 1, small parts 2. @return the mesh without
/// noise; nothing where it is no wall of two sides
std::optional<WallMesh> part_sides(const WallMesh& mesh, const MeshEdges& edges, const Patch& part,
                                   std::vector<std::int32_t>& label)
{
    const bool all = part.triangles.size() == mesh.triangles.size();
    WallMesh own;
    if (!all) {
        own.vertices = mesh.vertices;
        for (const std::int32_t t : part.triangles) own.triangles.push_back(mesh.triangles[static_cast<std::size_t>(t)]);
    }
    std::optional<WallSides> sides = all ? sides_of_wall(mesh, edges) : sides_of_wall(own, find_edges(own));
    if (!sides) return std::nullopt;
    std::fill(label.begin(), label.end(), 2);
    for (std::size_t k = 0; k < part.triangles.size(); ++k)
        label[static_cast<std::size_t>(part.triangles[k])] = sides->inner[k] ? 1 : 0;
    sides->even.triangles = mesh.triangles;
    return std::move(sides->even);
}

double root_mean_square_move(const WallMesh& from, const WallMesh& to)
{
    double sum = 0;
    for (std::size_t v = 0; v < from.vertices.size(); ++v) sum += (to.vertices[v] - from.vertices[v]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(from.vertices.size()));
}

[[noreturn]] void refuse_wall()
{
    throw Error(ErrorKind::BadFile,
                "got a vessel's wall with its thickness, whose inner side could not be told for certain; expected the lumen's "
                "surface. Fix: "
                "export the lumen (the blood) instead; in 3D Slicer, fill the wall's segment and subtract the wall from it "
                "(Logical operators)");
}

}  // namespace

bool take_inner_shell(WallMesh& mesh, const MeshEdges& edges, std::vector<std::array<std::int32_t, 3>>& as_read,
                      RepairReport& report)
{
    std::vector<std::int32_t> label = label_components(mesh, edges);
    std::vector<Patch> shells = shells_of(mesh, label);
    std::optional<double> thickness = wall_between(mesh, shells, separate);
    const bool joined = !thickness && shells.size() == 1;
    double noise = 0;
    if (joined) {
        std::optional<WallMesh> even = part_sides(mesh, edges, shells[0], label);
        if (!even) return false;
        shells = shells_of(*even, label);
        thickness = wall_between(*even, shells, joined_sides);
        if (!thickness) refuse_wall();
        noise = root_mean_square_move(mesh, *even);
        mesh.vertices = std::move(even->vertices);
    }
    if (!thickness) return false;
    std::vector<bool> kept(mesh.triangles.size());
    for (std::size_t t = 0; t < kept.size(); ++t) kept[t] = joined ? label[t] == shells[1].label : label[t] != shells[0].label;
    const auto dropped = std::count(kept.begin(), kept.end(), false);
    keep(mesh, kept, as_read);
    report.notes.push_back(fmt::format(
        "The wall has a thickness, of {:.3g} mm in the middle: the inner of its two shells is taken for the lumen, and the {} "
        "triangles of the outer one{} are left out.",
        1e3 * *thickness, dropped, joined ? " and of the rims" : ""));
    if (noise > 0)
        report.notes.push_back(
            fmt::format("The wall is rough: noise of {:.2g} mm (root mean square) was averaged out of it.", 1e3 * noise));
    return true;
}

}  // namespace seldinger::repair_steps
