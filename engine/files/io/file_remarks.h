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
    bool by_format = false;  // a label map's surface has the axes and the unit that its reader gives it
};

/// Reads SPACE=RAS or LPS and UNITS=mm where programs write them. Case does not matter; UNIT and "units: millimetres" count
/// too. Binary STL: the 80 bytes before the triangles. ASCII STL: the solid's name. PLY and OBJ: comments. Legacy VTK: title
/// and FIELD data. VTP: FieldData.
/// @param bytes  of the file; its beginning is enough but for strings that a .vtp has in its appended data
[[nodiscard]] FileRemarks remarks_in(std::string_view bytes, const std::filesystem::path& name);

/// The same from the beginning of a file; nothing where it cannot be read: whoever reads the mesh says why.
[[nodiscard]] FileRemarks remarks_of_file(const std::filesystem::path& path);

}  // namespace seldinger
