// Builds the maps' walls (damaged bend, stenosis, septum, fork) and writes them as PLY files, once.
#include "lab/stability_meshes.h"

#include "io/mesh_file.h"
#include "shapes/shapes.h"
#include "shapes/swept_lumen.h"

#include <fmt/format.h>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

void write_once(const fs::path& folder, const std::string& name, const auto& make)
{
    if (!fs::exists(folder / name)) write_mesh(folder / name, make(), "mm");
}

SweptTube straight_tube(const Vec3& from, const Vec3& to, double radius, const auto& narrowed)
{
    SweptTube tube;
    const int pieces = 60;
    for (int k = 0; k <= pieces; ++k) {
        const double t = static_cast<double>(k) / pieces;
        tube.points.push_back(from + t * (to - from));
        tube.radius.push_back(narrowed(t * (to - from).norm(), radius));
    }
    return tube;
}

SweptTube straight_tube(const Vec3& from, const Vec3& to, double radius)
{
    return straight_tube(from, to, radius, [](double, double r) { return r; });
}

LumenEnd end_of(const Vec3& inner, const Vec3& outer, double radius) { return {outer, (outer - inner).normalized(), 2 * radius}; }

// A spread of the first `count` whole numbers that looks random and is the same everywhere: k -> k p mod count, p prime.
std::size_t scattered(std::size_t k, std::size_t count) { return k * 7919 % count; }

WallMesh spoilt(WallMesh mesh, double share)
{
    const std::size_t count = mesh.triangles.size();
    const auto spoil = static_cast<std::size_t>(std::lround(share * static_cast<double>(count)));
    std::vector<bool> gone(count, false);
    for (std::size_t k = 0; k < spoil; ++k) {
        const std::size_t at = scattered(k, count);
        auto t = mesh.triangles[at];
        switch (k % 4) {
            case 0:
                mesh.triangles.push_back(t);
                break;
            case 1:
                std::swap(mesh.triangles[at][1], mesh.triangles[at][2]);
                break;
            case 2:
                gone[at] = true;
                break;
            default: {
                // three from one: its middle point lies 1 % off a corner
                const Vec3 a = mesh.vertices[t[0]], m = (mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 2;
                const auto v = static_cast<std::int32_t>(mesh.vertices.size());
                mesh.vertices.push_back(a + 0.01 * (m - a));
                mesh.triangles[at] = {t[0], t[1], v};
                mesh.triangles.push_back({t[1], t[2], v});
                mesh.triangles.push_back({t[2], t[0], v});
            }
        }
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
        if (k >= count || !gone[k]) mesh.triangles[kept++] = mesh.triangles[k];
    mesh.triangles.resize(kept);
    return mesh;
}

WallMesh bend_wall()
{
    VesselSpec spec;
    spec.shape = VesselShape::Arc;
    spec.radius = 0.004;
    spec.bend_radius = 0.03;
    spec.angle = std::numbers::pi / 2;
    spec.lead_in = 0.005;
    spec.lead_out = 0.02;
    spec.triangles = 3000;
    return make_arc(spec).mesh;
}

WallMesh fork()
{
    const double angle = 35 * std::numbers::pi / 180, branch = 0.003;
    const Vec3 start(-0.001, 0, 0), fork_point(0.03, 0, 0);
    const Vec3 left = fork_point + 0.04 * Vec3(std::cos(angle), std::sin(angle), 0);
    const Vec3 right = fork_point + 0.04 * Vec3(std::cos(angle), -std::sin(angle), 0);
    const SweptLumen lumen({straight_tube(start, fork_point, carina_radius), straight_tube(fork_point, left, branch),
                            straight_tube(fork_point, right, branch)},
                           0.0015);
    return mesh_lumen(
        lumen, {end_of(fork_point, start, carina_radius), end_of(fork_point, left, branch), end_of(fork_point, right, branch)},
        4000);
}

WallMesh narrowed_tube(double throat)
{
    const Vec3 start(-0.001, 0, 0), end(0.05, 0, 0);
    const SweptTube tube = straight_tube(start, end, 0.003, [throat](double x, double r) {
        const double from_middle = std::abs(x - 0.021) / 0.005;  // the throat is 2 cm from the inlet
        return from_middle < 1 ? throat + (r - throat) * (1 - std::cos(std::numbers::pi * from_middle)) / 2 : r;
    });
    return mesh_lumen(SweptLumen({tube}, 0.001), {end_of(end, start, 0.003), end_of(start, end, 0.003)}, 6000);
}

WallMesh two_tubes(double thickness)
{
    VesselSpec spec;
    spec.shape = VesselShape::Tube;
    spec.radius = 0.003;
    spec.length = 0.06;
    spec.origin = {-0.001, 0, 0};
    spec.triangles = 2500;
    WallMesh both = make_tube(spec).mesh;
    const auto first = static_cast<std::int32_t>(both.vertices.size());
    spec.origin.z() = -(2 * spec.radius + thickness);
    const WallMesh other = make_tube(spec).mesh;
    both.vertices.insert(both.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (auto t : other.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return both;
}

}  // namespace

std::string damaged_mesh_name(double share) { return fmt::format("bend-spoilt-{}.ply", share); }
std::string carina_mesh_name() { return "carina.ply"; }
std::string stenosis_mesh_name(double value) { return fmt::format("stenosis-{}.ply", value); }
std::string septum_mesh_name(double value) { return fmt::format("septum-{}.ply", value); }

void write_damaged_mesh(const fs::path& folder, double share)
{
    write_once(folder, damaged_mesh_name(share), [&] { return spoilt(bend_wall(), share); });
}

void write_carina_mesh(const fs::path& folder) { write_once(folder, carina_mesh_name(), fork); }

void write_stenosis_mesh(const fs::path& folder, double throat, double value)
{
    write_once(folder, stenosis_mesh_name(value), [&] { return narrowed_tube(throat); });
}

void write_septum_mesh(const fs::path& folder, double thickness, double value)
{
    write_once(folder, septum_mesh_name(value), [&] { return two_tubes(thickness); });
}

}  // namespace seldinger
