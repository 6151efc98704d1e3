// Mesh files to WallMesh: STL, OBJ and PLY through Assimp after checks that it leaves out, VTK's own by vtk_*.cpp.
#include "scene/mesh_file.h"

#include "core/error.h"
#include "core/file_io.h"
#include "scene/vtk_legacy.h"

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>

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

/// What Assimp accepts in silence: a binary STL whose count does not fit its size, an ASCII one that stops half-way.
void check_stl(const std::filesystem::path& path, const std::string& bytes)
{
    if (bytes.size() >= 84) {
        std::uint32_t count;
        std::memcpy(&count, bytes.data() + 80, 4);
        if (bytes.size() == 84 + 50 * static_cast<std::uint64_t>(count)) {
            if (count == 0) bad_file(path, "holds no triangle");
            return;
        }
    }
    const bool text = bytes.compare(0, 5, "solid") == 0 && bytes.find("facet") != std::string::npos;
    if (!text) {
        if (bytes.size() < 84) bad_file(path, fmt::format("{} bytes are too few for an STL file", bytes.size()));
        std::uint32_t count;
        std::memcpy(&count, bytes.data() + 80, 4);
        bad_file(path, fmt::format("the header announces {} triangles, the file has room for {}: truncated or damaged", count,
                                   (bytes.size() - 84) / 50));
    }
    if (bytes.find("endsolid") == std::string::npos) bad_file(path, "ASCII STL without \"endsolid\": truncated");
}

/// Faces that a PLY header announces, to be compared with what arrived.
long announced_ply_faces(const std::filesystem::path& path, const std::string& bytes)
{
    if (bytes.compare(0, 3, "ply") != 0) bad_file(path, "does not begin with \"ply\"");
    const std::size_t end = bytes.find("end_header"), at = bytes.find("element face ");
    if (end == std::string::npos) bad_file(path, "the PLY header has no end_header: truncated");
    if (at == std::string::npos || at > end) bad_file(path, "holds no faces");
    long count = -1;
    std::from_chars(bytes.data() + at + 13, bytes.data() + end, count);
    if (count <= 0) bad_file(path, "holds no faces");
    return count;
}

WallMesh read_with_assimp(const std::filesystem::path& path, const std::string& extension)
{
    long announced = 0;
    {
        const std::string bytes = read_file(path);
        if (extension == ".stl") check_stl(path, bytes);
        if (extension == ".ply") announced = announced_ply_faces(path, bytes);
    }
    Assimp::Importer importer;
    // no post-processing: Assimp's own triangulation trusts indices, and crashes on a truncated PLY
    const aiScene* scene = importer.ReadFile(path.string(), 0);
    if (!scene) bad_file(path, importer.GetErrorString());
    WallMesh mesh;
    long faces = 0;
    std::vector<std::int32_t> corners;
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        const aiMesh& part = *scene->mMeshes[m];
        const auto first = static_cast<std::int32_t>(mesh.vertices.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v)
            mesh.vertices.emplace_back(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z);
        for (unsigned f = 0; f < part.mNumFaces; ++f, ++faces) {
            corners.clear();
            for (unsigned c = 0; c < part.mFaces[f].mNumIndices; ++c) {
                const unsigned index = part.mFaces[f].mIndices[c];
                if (index >= part.mNumVertices)
                    bad_file(path, fmt::format("face {} names vertex {}, only {} exist: truncated or damaged", faces, index,
                                               part.mNumVertices));
                corners.push_back(first + static_cast<std::int32_t>(index));
            }
            triangulate(mesh.vertices, corners, mesh);  // leaves points and lines out
        }
    }
    if (faces < announced)
        bad_file(path, fmt::format("the header announces {} faces, {} could be read: truncated or damaged", announced, faces));
    return mesh;
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

WallMesh read_mesh(const std::filesystem::path& path, const std::string& units, long* triangles_read)
{
    const double scale = metres_per_unit(units);
    const std::string extension = lower_extension(path);
    if (std::error_code ignored;
        std::filesystem::is_regular_file(path, ignored) && std::filesystem::file_size(path, ignored) == 0)
        bad_file(path, "the file is empty");
    WallMesh mesh;
    if (extension == ".vtp") mesh = from_polydata(read_poly_data(path));
    else if (extension == ".vtk") mesh = from_polydata(read_legacy_vtk(path));
    else if (extension == ".stl" || extension == ".obj" || extension == ".ply") mesh = read_with_assimp(path, extension);
    else bad_file(path, fmt::format("unknown mesh format \"{}\"; .stl, .obj, .ply, .vtp or .vtk expected", extension));
    if (mesh.triangles.empty()) bad_file(path, "holds no triangle");
    for (Vec3& v : mesh.vertices) v *= scale;
    if (triangles_read) *triangles_read = static_cast<long>(mesh.triangles.size());
    return mesh;
}

}  // namespace seldinger
