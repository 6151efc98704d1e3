// Mesh files to WallMesh. Every reader hands on doubles: coordinates are rounded to float32 only when the mesh has been centred
// (vessel/tree.cpp).
#include "io/mesh_file.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/label_map.h"
#include "io/mesh_readers.h"
#include "io/vtp_read.h"
#include "vessel/mesh_limits.h"
#include "vessel/work_budget.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

[[noreturn]] void bad_file(const std::filesystem::path& path, const std::string& message)
{
    throw Error(ErrorKind::BadFile, fmt::format("{}: {}", path.string(), message));
}

/// Cuts a polygon by ears, in order of appearance; fewer than three corners give nothing. Quadratic in the corners of a convex
/// polygon, cubic in those of one that cuts itself.
void triangulate(const std::vector<Vec3>& vertices, std::vector<std::int32_t> polygon, WallMesh& mesh, WorkBudget& work)
{
    auto at = [&](std::size_t i) -> const Vec3& { return vertices[static_cast<std::size_t>(polygon[i % polygon.size()])]; };
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
    while (polygon.size() > 3) {
        const std::size_t n = polygon.size();
        std::size_t ear = 0;  // a polygon without a clean ear (it cuts itself) loses its first corner
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 &a = at(i + n - 1), &b = at(i), &c = at(i + 1);
            work.spend(1);
            if ((b - a).cross(c - b).dot(normal) <= 0) continue;
            bool empty = true;
            std::size_t k = 0;
            for (; k < n && empty; ++k) {
                if (k == i || k == (i + 1) % n || k == (i + n - 1) % n) continue;
                const Vec3& p = at(k);
                empty = (b - a).cross(p - a).dot(normal) < 0 || (c - b).cross(p - b).dot(normal) < 0 ||
                        (a - c).cross(p - c).dot(normal) < 0;
            }
            work.spend(static_cast<double>(k));
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

/// Triangles that all cells together give.
std::uint64_t triangles_of(const PolyData& data)
{
    std::uint64_t triangles = 0;
    for (const PolyCells* cells : {&data.polys, &data.strips}) {
        std::int64_t begin = 0;
        for (const std::int64_t end : cells->offsets) {
            triangles += static_cast<std::uint64_t>(std::max<std::int64_t>(end - begin - 2, 0));
            begin = end;
        }
    }
    return triangles;
}

/// Before anything is made room for. A file's triangle takes four bytes where nothing packs it, and three in strips packed by
/// VTK's own writer at its best (a regular tube).
void check_size(const PolyData& data, std::uint64_t file_bytes, const std::filesystem::path& path)
{
    const std::uint64_t triangles = triangles_of(data);
    if (triangles > file_bytes / 2 + 1000)
        bad_file(path, fmt::format("{} triangles in {} bytes are more than any writer gets into them: damaged, or made to fill "
                                   "the memory; write the mesh anew",
                                   triangles, file_bytes));
    constexpr std::uint64_t most = 1u << 29;  // half-edges, three a triangle, are counted in 32 bits
    if (triangles > most || data.points.size() > most)
        bad_file(path,
                 fmt::format("{} triangles and {} vertices; at most {} of each are read", triangles, data.points.size(), most));
}

WallMesh from_polydata(const PolyData& data)
{
    WallMesh mesh;
    mesh.vertices.reserve(data.points.size());
    mesh.triangles.reserve(triangles_of(data));
    // a convex polygon of 10,000 corners takes half of this; three and four corners take one step each
    WorkBudget work("cutting its polygons into triangles", 1e8 + 10.0 * static_cast<double>(data.polys.connectivity.size()));
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
        triangulate(mesh.vertices, corners, mesh, work);
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

PolyData cells_of(const std::string& bytes, const std::filesystem::path& path)
{
    const std::string extension = lower_extension(path), name = path.string();
    if (extension == ".vtp") return parse_poly_data(bytes, name, PolyParts::Geometry);
    if (extension == ".vtk") return parse_legacy_vtk(bytes, name);
    if (extension == ".stl") return parse_stl(bytes, name);
    if (extension == ".obj") return parse_obj(bytes, name);
    return parse_ply(bytes, name);
}

WallMesh triangles_in(const std::string& bytes, const std::filesystem::path& path, std::vector<std::string>& notes)
{
    const PolyData data = cells_of(bytes, path);
    check_size(data, bytes.size(), path);
    if (!data.note.empty()) notes.push_back(data.note);
    try {
        return from_polydata(data);
    } catch (const Error& error) {
        bad_file(path, error.what());
    }
}

WallMesh surface_in(const std::string& bytes, const std::filesystem::path& path, const std::string& label,
                    std::vector<std::string>& notes)
{
    LabelVoxels voxels = read_label(bytes, path, label);
    const LumenVoxels lumen = lumen_of(voxels.grid, voxels.runs);
    notes = std::move(voxels.notes);
    notes.insert(notes.end(), lumen.notes.begin(), lumen.notes.end());
    return surface_of(voxels.grid, lumen, voxels.fractions);
}

void require_known(const std::filesystem::path& path)
{
    const std::string extension = lower_extension(path);
    for (const char* known : {".stl", ".obj", ".ply", ".vtp", ".vtk"})
        if (extension == known) return;
    if (is_label_map(path)) return;
    std::string fix = "export the surface as one of these";
    for (const char* image : {".hdr", ".img", ".gz", ".nhdr", ".dcm"})
        if (extension == image) fix = "segment the lumen and save the label map as .nii.gz, .nrrd or .mha";
    for (const char* cad : {".step", ".stp", ".iges", ".igs", ".sldprt", ".x_t", ".3mf", ".3dm", ".brep"})
        if (extension == cad) fix = "export it from the CAD program as binary STL, in millimetres";
    for (const char* grid : {".vtu", ".vtm", ".pvd", ".vts", ".msh", ".cas"})
        if (extension == grid) fix = "extract its surface (ParaView: Extract Surface) and save that as .vtp";
    bad_file(path, fmt::format("got format \"{}\"; expected .stl, .obj, .ply, .vtp or .vtk, or a label map (.nii, .nii.gz, "
                               ".nrrd, .mha, .mhd). Fix: {}",
                               extension, fix));
}

void require_usable(const WallMesh& mesh, const std::filesystem::path& path, const std::string& units)
{
    const std::int64_t v = first_unusable_vertex(mesh);
    if (v < 0) return;
    const Vec3 at = mesh.vertices[static_cast<std::size_t>(v)] / metres_per_unit(units);
    bad_file(path, fmt::format("vertex {} (counted from 1): got [{:.6g}, {:.6g}, {:.6g}] {}; expected numbers within {:.0f} m. "
                               "Fix: check the units, or export "
                               "the mesh again",
                               v + 1, at.x(), at.y(), at.z(), units, most_coordinate));
}

}  // namespace

std::string lower_extension(const std::filesystem::path& path)
{
    std::string text = path.extension().string();
    for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
    return text;
}

double metres_per_unit(const std::string& units)
{
    if (units == "m") return 1.0;
    if (units == "cm") return 1e-2;
    if (units == "mm") return 1e-3;
    if (units == "um") return 1e-6;
    if (units == "in") return 0.0254;
    throw Error(ErrorKind::BadScene,
                fmt::format("units: got \"{}\"; expected m, cm, mm, um or in. Fix: name the unit of the file's numbers", units));
}

WallMesh read_mesh(const std::filesystem::path& path, const std::string& units, MeshFileFacts* facts, const std::string& label)
{
    return parse_mesh(read_mesh_bytes(path, units), path, units, facts, label);
}

std::string read_mesh_bytes(const std::filesystem::path& path, const std::string& units)
{
    (void)metres_per_unit(units);
    require_known(path);
    return lower_extension(path) == ".mhd" ? with_voxels(read_file(path), path) : read_file(path);
}

WallMesh parse_mesh(const std::string& bytes, const std::filesystem::path& path, const std::string& units, MeshFileFacts* facts,
                    const std::string& label)
{
    const double scale = metres_per_unit(units);
    require_known(path);
    if (bytes.empty()) bad_file(path, "the file is empty");
    WallMesh mesh;
    std::vector<std::string> notes;
    if (is_label_map(path)) mesh = surface_in(bytes, path, label, notes);
    else if (!label.empty())
        bad_file(path, fmt::format("got label \"{}\" for a mesh; expected it with a label map only. Fix: take it out", label));
    else mesh = triangles_in(bytes, path, notes);
    if (mesh.triangles.empty()) bad_file(path, "got no triangles; expected a surface. Fix: export the mesh again");
    if (facts) *facts = {static_cast<long>(mesh.triangles.size()), scale * float32_rounding(mesh.vertices), std::move(notes)};
    for (Vec3& v : mesh.vertices) v *= scale;
    require_usable(mesh, path, units);
    return mesh;
}

}  // namespace seldinger
