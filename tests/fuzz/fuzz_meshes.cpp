// Fuzz targets of meshes: each reader, and what a mesh goes through before a run.
#include "fuzz_support.h"
#include "fuzz_targets.h"

#include "io/centreline_file.h"
#include "io/file_remarks.h"
#include "io/mesh_file.h"
#include "repair/repair.h"
#include "vessel/extract_centreline.h"
#include "vessel/inlets.h"

#include <cmath>
#include <cstring>

namespace seldinger::fuzz {
namespace {

void read_as(Bytes bytes, const char* name)
{
    answer([&] { (void)parse_mesh(text_of(bytes), name, "mm"); });
    (void)remarks_in(text_of(bytes), name);  // refuses nothing
}

/// As vessel_load.cpp and the `vessel` command do. Every reading of an accepted mesh has to be a number.
void prepare(const std::string& bytes, const char* name)
{
    answer([&] {
        WallMesh mesh = parse_mesh(bytes, name, "mm");
        const RepairReport report = repair(mesh);
        const Centreline line = extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops));
        require(std::isfinite(line.total_length()));
        for (const double radius : line.radius) require(std::isfinite(radius) && radius >= 0);
        for (const Inlet& inlet : find_inlets(report.loops, line))
            require(inlet.point.allFinite() && inlet.direction.allFinite() && std::isfinite(inlet.radius));
    });
}

}  // namespace

void stl(Bytes bytes) { read_as(bytes, "x.stl"); }
void obj(Bytes bytes) { read_as(bytes, "x.obj"); }
void ply(Bytes bytes) { read_as(bytes, "x.ply"); }
void vtp(Bytes bytes) { read_as(bytes, "x.vtp"); }
void vtk(Bytes bytes) { read_as(bytes, "x.vtk"); }

/// A label map, in the format that it begins like. Every vertex that comes of it has to be a number.
void label(Bytes bytes)
{
    const std::string text = text_of(bytes);
    const char* name = text.starts_with("NRRD")                             ? "x.nrrd"
                       : text.starts_with("\x1f\x8b")                       ? "x.nii.gz"
                       : text.find("ElementDataFile") != std::string::npos ? "x.mha"
                                                                           : "x.nii";
    for (const char* which : {"", "1", "a"})
        answer([&] {
            for (const Vec3& v : parse_mesh(text, name, "mm", nullptr, which).vertices) require(v.allFinite());
        });
}

void centreline(Bytes bytes)
{
    answer([&] {
        const Centreline line = parse_centreline(text_of(bytes), "x.vtp", "mm");
        require(std::isfinite(line.total_length()));
        require(!line.main_path().empty());
    });
}

void pipeline(Bytes bytes) { prepare(text_of(bytes), "x.obj"); }

/// Triangles of an indexed mesh straight from the bytes, so that mutations reach the geometry and not the syntax: a count of
/// vertices, their coordinates as bytes or as floats, then corners.
void pipeline_raw(Bytes bytes)
{
    if (bytes.size() < 8) return;
    const std::size_t vertices = 3 + bytes[0];
    const bool floats = bytes[1] & 1;
    const std::size_t width = floats ? 4 : 1, head = 2 + 3 * width * vertices;
    if (bytes.size() < head + 3) return;
    std::string obj;
    for (std::size_t v = 0; v < vertices; ++v) {
        obj += 'v';
        for (std::size_t d = 0; d < 3; ++d) {
            const std::uint8_t* at = bytes.data() + 2 + width * (3 * v + d);
            float x = static_cast<float>(*at) - 128;
            if (floats) std::memcpy(&x, at, 4);
            obj += ' ' + std::to_string(x);
        }
        obj += '\n';
    }
    for (std::size_t k = head; k + 3 <= bytes.size(); k += 3) {
        obj += 'f';
        for (std::size_t c = 0; c < 3; ++c) obj += ' ' + std::to_string(1 + bytes[k + c] % vertices);
        obj += '\n';
    }
    prepare(obj, "x.obj");
}

}  // namespace seldinger::fuzz
