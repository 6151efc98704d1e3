// Writing meshes and centrelines.
#include "core/error.h"
#include "core/file_io.h"
#include "io/binary_text.h"
#include "io/mesh_file.h"
#include "vessel/triangle_geometry.h"

#include <fmt/format.h>
#include <array>
#include <bit>

namespace seldinger {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary STL, PLY and VTP are written little-endian as they lie in memory");

template <class T>
void append(std::string& bytes, const T& value)
{
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string stl_bytes(const WallMesh& mesh, double scale, const std::string& units)
{
    std::string bytes = "Seldinger vessel wall, normals into the lumen. UNITS=" + units;
    bytes.resize(80, ' ');
    append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        const Vec3 area = double_area(tri), normal = area.norm() > 0 ? Vec3(area.normalized()) : Vec3(Vec3::Zero());
        for (const Vec3& p : {normal, Vec3(tri.a * scale), Vec3(tri.b * scale), Vec3(tri.c * scale)})
            for (int d = 0; d < 3; ++d) append(bytes, static_cast<float>(p[d]));
        append(bytes, std::uint16_t{0});
    }
    return bytes;
}

std::string obj_text(const WallMesh& mesh, double scale, const std::string& units)
{
    fmt::memory_buffer out;
    auto it = fmt::appender(out);
    fmt::format_to(it, "# Seldinger vessel wall, normals into the lumen. UNITS={}\n", units);
    for (const Vec3& v : mesh.vertices) fmt::format_to(it, "v {} {} {}\n", v.x() * scale, v.y() * scale, v.z() * scale);
    for (const auto& t : mesh.triangles) fmt::format_to(it, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return fmt::to_string(out);
}

std::string ply_bytes(const WallMesh& mesh, double scale, const std::string& units)
{
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Seldinger vessel wall, normals into the lumen. UNITS={}\n"
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        units, mesh.vertices.size(), mesh.triangles.size());
    for (const Vec3& v : mesh.vertices)
        for (int d = 0; d < 3; ++d) append(bytes, v[d] * scale);
    for (const auto& t : mesh.triangles) {
        append(bytes, std::uint8_t{3});
        for (const std::int32_t v : t) append(bytes, v);
    }
    return bytes;
}

/// One <DataArray>, inline base64, uncompressed, UInt64 header.
template <class T>
std::string data_array(const char* type, const char* name, int components, const std::vector<T>& values)
{
    std::string bytes;
    append(bytes, static_cast<std::uint64_t>(values.size() * sizeof(T)));
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">{}</DataArray>\n", type,
                       name, components, base64(bytes));
}

std::string vtp_text(const std::vector<Vec3>& points, double scale, const char* kind,
                     const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& offsets,
                     const std::string& point_data)
{
    std::vector<double> coordinates;
    for (const Vec3& p : points)
        for (int d = 0; d < 3; ++d) coordinates.push_back(p[d] * scale);
    return fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
        "<Piece NumberOfPoints=\"{}\" NumberOf{}=\"{}\">\n<PointData>\n{}</PointData>\n<Points>\n{}</Points>\n"
        "<{}>\n{}{}</{}>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        points.size(), kind, offsets.size(), point_data, data_array("Float64", "Points", 3, coordinates), kind,
        data_array("Int64", "connectivity", 1, connectivity), data_array("Int64", "offsets", 1, offsets), kind);
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const WallMesh& mesh, const std::string& units)
{
    const double scale = 1.0 / metres_per_unit(units);
    const std::string extension = path.extension().string();
    if (extension == ".stl") return write_file(path, stl_bytes(mesh, scale, units));
    if (extension == ".obj") return write_file(path, obj_text(mesh, scale, units));
    if (extension == ".ply") return write_file(path, ply_bytes(mesh, scale, units));
    if (extension != ".vtp")
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got the ending \"{}\"; expected .stl, .obj, .ply or .vtp. Fix: rename the file",
                                path.string(), extension));
    std::vector<std::int64_t> connectivity, offsets;
    for (const auto& t : mesh.triangles) {
        connectivity.insert(connectivity.end(), t.begin(), t.end());
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    }
    write_file(path, vtp_text(mesh.vertices, scale, "Polys", connectivity, offsets, ""));
}

void write_centreline_vtp(const std::filesystem::path& path, const Centreline& centreline, const std::string& units)
{
    const double scale = 1.0 / metres_per_unit(units);
    const std::size_t count = centreline.points.size();
    std::vector<int> children(count, 0);
    for (const int parent : centreline.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    std::vector<std::int64_t> connectivity, offsets;
    for (std::size_t end = 0; end < count; ++end) {
        // each branch is written at its far end: a tip or a branching point
        if (children[end] == 1 || centreline.parent[end] < 0) continue;
        std::vector<std::int64_t> line = {static_cast<std::int64_t>(end)};
        for (int at = centreline.parent[end]; at >= 0; at = centreline.parent[static_cast<std::size_t>(at)]) {
            line.push_back(at);
            if (children[static_cast<std::size_t>(at)] > 1) break;
        }
        connectivity.insert(connectivity.end(), line.rbegin(), line.rend());
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    }
    std::vector<double> radius;
    for (const double r : centreline.radius) radius.push_back(r * scale);
    write_file(path, vtp_text(centreline.points, scale, "Lines", connectivity, offsets,
                              data_array("Float64", "MaximumInscribedSphereRadius", 1, radius)));
}

}  // namespace seldinger
