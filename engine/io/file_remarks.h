#pragma once
// What a mesh file says of itself beside its triangles: the patient's axes and its unit.

#include <filesystem>
#include <string>
#include <string_view>

namespace seldinger {

/// Where +x, +y and +z of a file point: to the patient's left, back and head (DICOM's), or to the right, front and head.
enum class FileAxes { Unsaid, Lps, Ras };

struct FileRemarks {
    FileAxes axes = FileAxes::Unsaid;
    std::string units;  // m, cm, mm, um or in; empty: not said
};

/// Reads SPACE=RAS or LPS and UNITS=mm (in any case, also UNIT, also "units: millimetres") in the places where programs put such
/// things: the 80 bytes before a binary STL's triangles, the name of an ASCII STL's solid, comments of PLY and OBJ, the title and
/// the FIELD data of legacy VTK, FieldData of .vtp.
/// @param bytes  of the file; its beginning is enough but for strings that a .vtp has in its appended data
[[nodiscard]] FileRemarks remarks_in(std::string_view bytes, const std::filesystem::path& name);

/// The same from the beginning of a file; nothing where it cannot be read: whoever reads the mesh says why.
[[nodiscard]] FileRemarks remarks_of_file(const std::filesystem::path& path);

}  // namespace seldinger
