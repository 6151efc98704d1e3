#pragma once
// Reads and writes vessel meshes; reads label maps as their surfaces. Units convert here: metres inside, doubles throughout.
// Nothing is repaired here.

#include "vessel/centreline.h"
#include "vessel/wall_mesh.h"

#include <filesystem>
#include <string>

namespace seldinger {

/// With its dot, in lower case.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Metres in one of the file's units: m, cm, mm, um, in. @throws Error BadScene for any other name
[[nodiscard]] double metres_per_unit(const std::string& units);

/// What a mesh does not say of its file.
struct MeshFileFacts {
    long triangles = 0;    // before any repair
    double rounding = 0;   // half of the last bit of the largest coordinate where the file holds no more than float32 [m]; else 0
    std::vector<std::string> notes;  // PolyData::note; of a label map what was taken of it
};

/// Triangles of an STL (binary, ASCII), OBJ, PLY, VTP or legacy VTK polydata file; polygons are cut into triangles. Or the
/// surface of a label in a NIfTI, NRRD or MetaImage file (io/label_map.h), in DICOM's axes.
/// @param facts  out, may be null
/// @param label  of a label map: number or name; empty: the only one
/// @throws Error BadFile: missing, unreadable, empty, truncated, counts that do not fit, unknown extension, a vertex that is no
///         number or beyond ten kilometres, polygons too tangled to be cut
[[nodiscard]] WallMesh read_mesh(const std::filesystem::path& path, const std::string& units, MeshFileFacts* facts = nullptr,
                                 const std::string& label = {});

/// The bytes that read_mesh parses. @throws Error as there, where no parsing is needed to know
[[nodiscard]] std::string read_mesh_bytes(const std::filesystem::path& path, const std::string& units);

/// Same, from the bytes of a file. @param path  its name, for messages and the format
[[nodiscard]] WallMesh parse_mesh(const std::string& bytes, const std::filesystem::path& path, const std::string& units,
                                  MeshFileFacts* facts = nullptr, const std::string& label = {});

/// Format by extension: .stl (binary), .obj, .ply (binary), .vtp. Written beside its place, then renamed, so that a reader
/// never meets half a file. STL holds float32, the others doubles. @throws Error BadFile
void write_mesh(const std::filesystem::path& path, const WallMesh& mesh, const std::string& units);

/// One polyline per branch, from its branching point to the next one or its end; radius as MaximumInscribedSphereRadius.
void write_centreline_vtp(const std::filesystem::path& path, const Centreline& centreline, const std::string& units);

}  // namespace seldinger
