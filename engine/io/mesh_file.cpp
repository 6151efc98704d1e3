// Mesh files to WallMesh. Every reader hands on doubles: coordinates are rounded to float32 only when the mesh has been centred
// (vessel/tree.cpp).
#include "io/mesh_file.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/ply_read.h"
#include "io/stl_obj_read.h"
#include "io/vtk_legacy.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

[[noreturn]] void bad_file(const std::filesystem::path& path, const std::string& message)
{
    throw Error(ExitCode::BadFile, fmt::format("{}: {}", path.string(), message));
}

std::string lower_extension(const std::filesystem::path& path)
{
    std::string text = path.extension().string();
    for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
    return text;
}

/// Cuts a polygon by ears, in order of appearance; fewer than three corners give nothing.
void triangulate(const std::vector<Vec3>& vertices, std::vector<std::int32_t> polygon, WallMesh& mesh)
{
    auto at = [&](std::size_t i) -> const Vec3& { return vertices[static_cast<std::size_t>(polygon[i % polygon.size()])]; };
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
    while (polygon.size() > 3) {
        const std::size_t n = polygon.size();
        std::size_t ear = 0;  // a polygon without a clean ear (it cuts itself) loses its first corner
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 &a = at(i + n - 1), &b = at(i), &c = at(i + 1);
            if ((b - a).cross(c - b).dot(normal) <= 0) continue;
            bool empty = true;
            for (std::size_t k = 0; k < n && empty; ++k) {
                if (k == i || k == (i + 1) % n || k == (i + n - 1) % n) continue;
                const Vec3& p = at(k);
                empty = (b - a).cross(p - a).dot(normal) < 0 || (c - b).cross(p - b).dot(normal) < 0 ||
                        (a - c).cross(p - c).dot(normal) < 0;
            }
            if (empty) {
                ear = i;
                break;
            }
        }
        mesh.triangles.push_back({polygon[(ear + n - 1) % n], polygon[ear], polygon[(ear + 1) % n]});
        polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    if (polygon.size() == 3) mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
}

WallMesh from_polydata(const PolyData& data)
{
    WallMesh mesh;
    for (const auto& p : data.points) mesh.vertices.emplace_back(p[0], p[1], p[2]);
    std::vector<std::int32_t> corners;
    std::int64_t begin = 0;
    auto next_cell = [&](const PolyCells& cells, std::int64_t end) {
        corners.clear();
        for (; begin < end; ++begin)
            corners.push_back(static_cast<std::int32_t>(cells.connectivity[static_cast<std::size_t>(begin)]));
    };
    for (const std::int64_t end : data.polys.offsets) {
        next_cell(data.polys, end);
        triangulate(mesh.vertices, corners, mesh);
    }
    begin = 0;
    for (const std::int64_t end : data.strips.offsets) {
        next_cell(data.strips, end);
        for (std::size_t k = 0; k + 2 < corners.size(); ++k)  // every second triangle of a strip runs the other way
            mesh.triangles.push_back({corners[k], corners[k + 1 + k % 2], corners[k + 2 - k % 2]});
    }
    return mesh;
}

/// Half of the last bit of the largest coordinate, where no coordinate holds more than a float32 does; else 0. In the file's
/// unit.
double float32_rounding(const std::vector<Vec3>& vertices)
{
    double largest = 0;
    for (const Vec3& v : vertices)
        for (const double c : v) {
            if (!std::isfinite(c)) continue;
            if (static_cast<double>(static_cast<float>(c)) != c) return 0;
            largest = std::max(largest, std::abs(c));
        }
    return largest > 0 ? 0.5 * std::exp2(std::ilogb(largest) - 23) : 0;
}

}  // namespace

double metres_per_unit(const std::string& units)
{
    if (units == "m") return 1.0;
    if (units == "cm") return 1e-2;
    if (units == "mm") return 1e-3;
    if (units == "um") return 1e-6;
    if (units == "in") return 0.0254;
    throw Error(ExitCode::BadScene, fmt::format("units: \"{}\" given; m, cm, mm, um or in expected", units));
}

WallMesh read_mesh(const std::filesystem::path& path, const std::string& units, long* triangles_read, double* rounding)
{
    const double scale = metres_per_unit(units);
    const std::string extension = lower_extension(path);
    if (std::error_code ignored;
        std::filesystem::is_regular_file(path, ignored) && std::filesystem::file_size(path, ignored) == 0)
        bad_file(path, "the file is empty");
    WallMesh mesh;
    if (extension == ".vtp") mesh = from_polydata(read_poly_data(path));
    else if (extension == ".vtk") mesh = from_polydata(read_legacy_vtk(path));
    else if (extension == ".stl") mesh = from_polydata(parse_stl(read_file(path), path.string()));
    else if (extension == ".obj") mesh = from_polydata(parse_obj(read_file(path), path.string()));
    else if (extension == ".ply") mesh = from_polydata(parse_ply(read_file(path), path.string()));
    else bad_file(path, fmt::format("unknown mesh format \"{}\"; .stl, .obj, .ply, .vtp or .vtk expected", extension));
    if (mesh.triangles.empty()) bad_file(path, "holds no triangle");
    if (rounding) *rounding = scale * float32_rounding(mesh.vertices);
    for (Vec3& v : mesh.vertices) v *= scale;
    if (triangles_read) *triangles_read = static_cast<long>(mesh.triangles.size());
    return mesh;
}

}  // namespace seldinger
