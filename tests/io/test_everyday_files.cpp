// Files as the field's programs write them: 3D Slicer, VMTK, SimVascular, ParaView, CAD exporters, editors.
#include "core/error.h"
#include "io/centreline_file.h"
#include "io/file_remarks.h"
#include "io/mesh_file.h"
#include "support/approx.h"
#include "support/bytes.h"
#include "support/refusal.h"
#include "support/shared_folder.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger::test::test_everyday_files {

namespace {

std::string refusal(const std::string& bytes, const char* name)
{
    return test::refusal([&] { return parse_mesh(bytes, name, "mm"); });
}

/// Four triangles of a tetrahedron with edges 1, 2, 3 along the axes: volume 1.
void check_tetrahedron(const WallMesh& mesh)
{
    REQUIRE(mesh.triangles.size() == 4);
    double volume = 0;
    for (const auto& t : mesh.triangles) {
        const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
        volume += at(0).dot(at(1).cross(at(2))) / 6;
    }
    CHECK(volume == test::about(1e-9).epsilon(1e-6));  // float32 at most
}

struct LegacyFile {
    bool binary, new_cells;
    std::string field;  // before POINTS

    [[nodiscard]] std::string text() const
    {
        const std::vector<float> xyz = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3};
        const std::vector<std::int32_t> old = {3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 3, 2};
        const std::vector<std::int64_t> offsets = {0, 3, 6, 9, 12}, corners = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
        const auto numbers = [&](const auto& values) {
            std::string list;
            for (const auto& v : values) list += fmt::format("{} ", v);
            return (binary ? as_bytes(values, true) : list) + "\n";
        };
        std::string file = fmt::format("# vtk DataFile Version {}\nvtk output\n{}\nDATASET POLYDATA\n{}POINTS 4 float\n",
                                       new_cells ? "5.1" : "4.2", binary ? "BINARY" : "ASCII", field);
        file += numbers(xyz);
        if (new_cells) {
            file += "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n";
            file += "POLYGONS 5 12\nOFFSETS vtktypeint64\n" + numbers(offsets) + "CONNECTIVITY vtktypeint64\n" + numbers(corners);
        } else {
            file += "POLYGONS 4 16\n" + numbers(old);
        }
        return file + "\nCELL_DATA 4\nSCALARS id int\nLOOKUP_TABLE default\n";
    }
};

/// FIELD data that writers put before POINTS.
std::vector<std::string> fields(bool binary)
{
    const auto numbers = [&](const auto& values) {
        std::string list;
        for (const auto& v : values) list += fmt::format("{} ", v);
        return (binary ? as_bytes(values, true) : list) + "\n";
    };
    const std::string text = binary ? "\xC3RAS\n" : "RAS\n";
    return {
        "",
        "FIELD FieldData 1\nSPACE 1 1 string\n" + text + "\n",
        "FIELD FieldData 1\nTimeValue 1 1 double\n" + numbers(std::vector<double>{0.25}),
        "FIELD FieldData 3\nTimeValue 1 1 double\n" + numbers(std::vector<double>{10}) +  // 10: a byte of its own is a line's end
            "METADATA\nINFORMATION 0\n\nSPACE 1 1 string\n" + text + "Flag%20of%20it 2 3 unsigned_char\n" +
            numbers(std::vector<unsigned char>{1, 2, 3, 4, 5, 255}),
        "FIELD FieldData 1\nMatrix 16 1 vtktypeint64\n" + numbers(std::vector<std::int64_t>(16, 7)),
        "FIELD FieldData 0\n",
    };
}

std::string facets(const char* end)
{
    const char* const corner[4] = {"0 0 0", "1 0 0", "0 2 0", "0 0 3"};
    const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    std::string text;
    for (const auto& f : face) {
        text += fmt::format("  facet normal nan 0 0{0}    outer loop{0}", end);
        for (const int c : f) text += fmt::format("      vertex {}{}", corner[c], end);
        text += fmt::format("    endloop{0}  endfacet{0}", end);
    }
    return text;
}

std::string upper(std::string text)
{
    for (char& c : text) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c);
    return text;
}

/// Polylines with point data, as .vtp.
std::string centreline_vtp(const std::vector<Vec3>& points, const std::vector<std::vector<int>>& lines, const std::string& arrays)
{
    std::string xyz, connectivity, offsets;
    std::size_t end = 0;
    for (const Vec3& p : points) xyz += fmt::format("{} {} {} ", p.x(), p.y(), p.z());
    for (const auto& line : lines) {
        for (const int i : line) connectivity += fmt::format("{} ", i);
        offsets += fmt::format("{} ", end += line.size());
    }
    return fmt::format(
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"{}\" NumberOfLines=\"{}\"><Points><DataArray "
        "type=\"Float64\" format=\"ascii\">{}</DataArray></Points><Lines><DataArray type=\"Int32\" Name=\"connectivity\" "
        "format=\"ascii\">{}</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">{}</DataArray></Lines>"
        "<PointData>{}</PointData></Piece></PolyData></VTKFile>",
        points.size(), lines.size(), xyz, connectivity, offsets, arrays);
}

std::string array(const char* name, const std::string& values)
{
    return fmt::format("<DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">{}</DataArray>", name, values);
}

}  // namespace

TEST_SUITE("io/everyday_files")
{
    TEST_CASE("property: legacy .vtk with FIELD data before POINTS, ASCII and binary, of versions 4.2 and 5.1")
    {
        for (const bool binary : {false, true})
            for (const bool new_cells : {false, true}) {
                int k = 0;
                for (const std::string& field : fields(binary)) {
                    CAPTURE(binary);
                    CAPTURE(new_cells);
                    CAPTURE(k);
                    ++k;
                    const std::string file = LegacyFile{binary, new_cells, field}.text();
                    check_tetrahedron(parse_mesh(file, "x.vtk", "mm"));
                    const bool says = field.find("SPACE") != std::string::npos;
                    CHECK((remarks_in(file, "x.vtk").axes == FileAxes::Ras) == says);
                }
            }
    }

    TEST_CASE("property: FIELD data that are cut short or lie are refused")
    {
        const auto with = [](bool binary, const std::string& field) {
            return refusal(LegacyFile{binary, false, field}.text(), "x.vtk");
        };
        CHECK_FALSE(with(false, "FIELD FieldData 2\nTimeValue 1 1 double\n0.5\n").empty());  // POINTS is taken for an array
        CHECK(has(with(true, "FIELD FieldData 1\na 1000000 1000000 double\n"), "no more than the file has bytes for"));
        CHECK(has(with(true, "FIELD FieldData 1\na 1 90 double\n"), "is cut off"));
        CHECK(has(with(true, "FIELD FieldData 1\na 1 1 string\n\x7f\xff\xff\xff\n"), "cut off in its strings"));
        CHECK(has(with(true, "FIELD FieldData 1\na 1 1 quaternion\n1\n"), "got type \"quaternion\""));
        const std::string grid = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n";
        CHECK(has(refusal(grid, "x.vtk"), "Fix: extract its surface"));
    }

    TEST_CASE("property: ASCII STL in capitals, with CRLF, a byte-order mark, leading blanks, several solids")
    {
        for (const char* end : {"\n", "\r\n", "\r"})
            for (const bool capitals : {false, true})
                for (const char* before : {"", "\xEF\xBB\xBF", "  \t", "\xEF\xBB\xBF \r\n"}) {
                    CAPTURE(capitals);
                    CAPTURE(before);
                    std::string text = std::string("solid lumen") + end + facets(end) + "endsolid lumen" + end;
                    if (capitals) text = upper(text);
                    check_tetrahedron(parse_mesh(before + text, "x.stl", "mm"));
                }
        CHECK(has(refusal("SOLID a\n" + upper(facets("\n")), "x.stl"), "truncated"));
        CHECK(has(refusal(std::string("\xFF\xFEs\0o\0l\0i\0d\0", 12), "x.stl"), "UTF-16"));
    }

    TEST_CASE("property: a binary STL whose count is wrong gives all that its body holds, with a note")
    {
        const auto stl = [](std::uint32_t count, std::size_t facets, std::size_t left_over) {
            const float corners[4][9] = {{0, 0, 0, 0, 2, 0, 1, 0, 0},
                                         {0, 0, 0, 1, 0, 0, 0, 0, 3},
                                         {1, 0, 0, 0, 2, 0, 0, 0, 3},
                                         {0, 0, 0, 0, 0, 3, 0, 2, 0}};
            std::string bytes(80, ' ');
            bytes.append(reinterpret_cast<const char*>(&count), 4);
            for (std::size_t t = 0; t < facets; ++t)
                bytes.append(12, '\0').append(reinterpret_cast<const char*>(corners[t]), sizeof corners[t]).append(2, '\0');
            return bytes.append(left_over, '\n');
        };
        const auto read = [](const std::string& bytes) {
            MeshFileFacts facts;
            check_tetrahedron(parse_mesh(bytes, "x.stl", "mm", &facts));
            return facts.notes.empty() ? std::string() : facts.notes[0];
        };
        CHECK(read(stl(4, 4, 0)).empty());
        CHECK(has(read(stl(0, 4, 0)), "announces 0 triangles, its body holds 4"));
        CHECK(has(read(stl(3, 4, 0)), "announces 3 triangles, its body holds 4"));
        CHECK(read(stl(~std::uint32_t{0}, 4, 0)).find("its body holds 4") != std::string::npos);
        for (const std::size_t left_over : {1, 2, 49})
            CHECK(has(read(stl(4, 4, left_over)), fmt::format("{} bytes behind its 4 triangles", left_over)));
        // cut short, or nothing that is known to be facets
        for (const std::string& bytes : {stl(5, 4, 0), stl(5, 4, 20), stl(0, 4, 7), stl(3, 4, 7)})
            CHECK(has(refusal(bytes, "x.stl"), "truncated or damaged"));
        CHECK(has(refusal(stl(0, 0, 0), "x.stl"), "no triangles"));
    }

    TEST_CASE("property: a byte-order mark before OBJ and PLY costs no vertex")
    {
        const std::string mark = "\xEF\xBB\xBF", faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
        check_tetrahedron(parse_mesh(mark + "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n" + faces, "x.obj", "mm"));
        const std::string ply =
            "ply\r\nformat ascii 1.0\r\ncomment SPACE=LPS\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\n"
            "property float z\r\nelement face 4\r\nproperty list uchar int vertex_indices\r\nend_header\r\n0 0 0\r\n"
            "1 0 0\r\n0 2 0\r\n0 0 3\r\n3 0 2 1\r\n3 0 1 3\r\n3 1 2 3\r\n3 0 3 2\r\n";
        check_tetrahedron(parse_mesh(mark + ply, "x.ply", "mm"));
        CHECK(remarks_in(mark + ply, "x.ply").axes == FileAxes::Lps);
    }

    TEST_CASE("property: decimal commas are named, not taken for damage")
    {
        const std::pair<const char*, std::string> files[] = {
            {"t.stl",
             "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0,5 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
             "x\n"},
            {"t.obj", "v 0,5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
            {"t.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face "
             "1\nproperty list uchar int vertex_index\n"
             "end_header\n0,5 0 0\n3 0 0 0\n"},
            {"t.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0,5 0 0\n"},
            {"t.vtp",
             "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Float32\" "
             "NumberOfComponents=\"3\" "
             "format=\"ascii\">\n0,5 0 0\n</DataArray></Points></Piece></PolyData></VTKFile>"}};
        for (const auto& [name, text] : files) {
            CAPTURE(name);
            const std::string said = refusal(text, name);
            CHECK_MESSAGE(said.find("got \"0,5\"; expected a number with a decimal point, not a comma. Fix: export it again") !=
                              std::string::npos,
                          said);
        }
        CHECK_FALSE(has(refusal("v zero, 0 0\n", "t.obj"), "decimal"));
    }

    TEST_CASE("property: axes and unit are read wherever programs write them")
    {
        const auto says = [](const std::string& bytes, const char* name, FileAxes axes, const char* units) {
            CAPTURE(name);
            CAPTURE(bytes.substr(0, 80));
            const FileRemarks remarks = remarks_in(bytes, name);
            CHECK(remarks.axes == axes);
            CHECK(remarks.units == units);
        };
        std::string header = "3D Slicer output. SPACE=RAS", body(100, '\7');
        header.resize(84, '\0');
        says(header + body, "x.stl", FileAxes::Ras, "");
        header.replace(0, 40, "UNITS=mm COLOR=\1\2\3\4,MATERIAL=          ");
        says(header + body, "x.STL", FileAxes::Unsaid, "mm");
        says("solid 3D Slicer output. SPACE=LPS\nfacet", "x.stl", FileAxes::Lps, "");
        says("# space = right-anterior-superior\n# Units: centimeters\nv 0 0 0\n", "x.obj", FileAxes::Ras, "cm");
        says("v 0 0 0\no SPACE=RAS\n", "x.obj", FileAxes::Unsaid, "");
        says("ply\nformat ascii 1.0\nobj_info unit=inch\nend_header\nSPACE=RAS", "x.ply", FileAxes::Unsaid, "in");
        says("# vtk DataFile Version 4.2\n3D Slicer output. SPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n", "x.vtk",
             FileAxes::Ras, "");
        const std::string strings =
            "<Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">82 65 83 0</Array>";
        const auto vtp = [](const std::string& field) {
            return "<VTKFile type=\"PolyData\"><PolyData><FieldData>" + field +
                   "</FieldData><Piece NumberOfPoints=\"0\"></Piece></PolyData></VTKFile>";
        };
        says(vtp(strings), "x.vtp", FileAxes::Ras, "");
        // UInt32 length 4, then "LPS\0", in base64
        says(vtp("<Array type=\"String\" Name=\"SPACE\" format=\"binary\">BAAAAExQUwA=</Array>"), "x.vtp", FileAxes::Lps, "");
        says(vtp(array("SPACE", "1")), "x.vtp", FileAxes::Unsaid, "");
        says("solid AEROSPACE=RAS UNITS=furlong\n", "x.stl", FileAxes::Unsaid, "");
    }

    TEST_CASE("property: the radius of a centreline by any of its names")
    {
        const std::vector<Vec3> points = {{0, 0, 0}, {10, 0, 0}, {20, 0, 0}};
        const auto read = [&](const std::string& arrays) {
            return parse_centreline(centreline_vtp(points, {{0, 1, 2}}, arrays), "c.vtp", "mm").radius;
        };
        const std::vector<double> expected = {3e-3, 2e-3, 1e-3};
        const auto same = [&](const std::vector<double>& radius) {
            REQUIRE(radius.size() == 3);
            for (std::size_t i = 0; i < 3; ++i) CHECK(radius[i] == test::about(expected[i]).epsilon(1e-14));
        };
        for (const char* name :
             {"MaximumInscribedSphereRadius", "Radius", "radius", "RADIUS", "InscribedRadius", "vessel_radius"})
            same(read(array("Curvature", "9 9 9") + array(name, "3 2 1")));
        same(read(array("Diameter", "6 4 2")));
        same(read(array("OuterRadius", "9 9 9") + array("Radius", "3 2 1")));
        same(read(array("Radius", "9 9 9") + array("MaximumInscribedSphereRadius", "3 2 1")));
        for (const std::string& arrays :
             {array("Thickness", "3 2 1"), array("OuterRadius", "3 2 1") + array("InnerRadius", "3 2 1")}) {
            std::string said;
            try {
                (void)read(arrays);
            } catch (const Error& error) {
                said = error.what();
            }
            CHECK(has(said, "expected the lumen's radius at each point"));
        }
        const std::string legacy =
            "# vtk DataFile Version 4.2\ncentreline\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 10 0 0 20 0 0\n"
            "LINES 1 4\n3 0 1 2\nCELL_DATA 1\nFIELD FieldData 1\nId 1 1 int\n7\nPOINT_DATA 3\n";
        for (const char* attribute :
             {"SCALARS Radius double\nLOOKUP_TABLE default\n3 2 1\n", "SCALARS Radius double 1\nLOOKUP_TABLE default\n3 2 1\n",
              "NORMALS n float\n0 0 1 0 0 1 0 0 1\nFIELD FieldData 2\nT 2 3 int\n1 2 3 4 5 6\nRadius 1 3 double\n3 2 1\n"})
            same(parse_centreline(legacy + attribute, "c.vtk", "mm").radius);
    }

    TEST_CASE("property: lines cut and turned as one likes give one tree with its ends at the ends")
    {
        // a trunk of 20 along x, a branch of 10 from its middle
        std::vector<Vec3> points;
        std::vector<std::vector<int>> pairs;
        std::string radius;
        for (int i = 0; i <= 20; ++i) points.emplace_back(i, 0, 0), radius += i == 20 ? "4 " : "3 ";
        for (int i = 1; i <= 10; ++i) points.emplace_back(10, i, 0), radius += "2 ";
        for (int i = 1; i <= 20; ++i) pairs.push_back({i - 1, i});
        for (int i = 1; i <= 10; ++i) pairs.push_back({i == 1 ? 10 : 19 + i, 20 + i});
        std::vector<std::vector<int>> turned = pairs, shuffled;
        for (std::size_t k = 0; k < turned.size(); k += 2) std::swap(turned[k][0], turned[k][1]);
        for (std::size_t k = 0; k < pairs.size(); ++k) shuffled.push_back(pairs[(7 * k + 13) % pairs.size()]);
        std::vector<int> trunk, back, side;
        for (int i = 0; i <= 20; ++i) trunk.push_back(i), back.push_back(20 - i);
        for (int i = 0; i <= 10; ++i) side.push_back(i == 0 ? 10 : 20 + i);
        std::vector<int> side_back(side.rbegin(), side.rend());
        // {lines, x of the root}
        const std::pair<std::vector<std::vector<int>>, double> files[] = {
            {pairs, 0}, {turned, 20}, {shuffled, 20}, {{trunk, side}, 0}, {{trunk, side_back}, 0}, {{trunk, back, side}, 0}};
        for (const auto& [lines, root] : files) {
            const Centreline line = parse_centreline(centreline_vtp(points, lines, array("Radius", radius)), "c.vtp", "mm");
            CHECK(line.points.size() == points.size());
            CHECK(line.total_length() == test::about(30e-3).epsilon(1e-12));
            REQUIRE(std::count(line.parent.begin(), line.parent.end(), -1) == 1);
            CHECK(line.points[0].x() == test::about(1e-3 * root));
            std::vector<int> children(points.size(), 0);
            for (std::size_t i = 0; i < line.parent.size(); ++i) {
                CHECK(line.parent[i] < static_cast<int>(i));  // behind its parent
                if (line.parent[i] >= 0) ++children[static_cast<std::size_t>(line.parent[i])];
            }
            CHECK(std::count(children.begin(), children.end(), 0) == 2);
        }
    }

    TEST_CASE("property: lines that begin a step off the trunk, or beside each other at one inlet, are joined to it")
    {
        std::vector<Vec3> points = {{0, 0, 0},     {10, 0, 0}, {20, 0, 0},  {10.5, 1, 0}, {10.5, 9, 0},
                                    {0.1, 0.1, 0}, {9, -2, 0}, {18, -9, 0}, {500, 0, 0},  {510, 0, 0}};
        const std::string file =
            centreline_vtp(points, {{0, 1, 2}, {3, 4}, {5, 6, 7}, {8, 9}}, array("Radius", "3 3 3 2 2 3 2 2 1 1"));
        const Centreline line = parse_centreline(file, "c.vtp", "mm");
        CHECK(std::count(line.parent.begin(), line.parent.end(), -1) == 2);  // the last line is nowhere near
        CHECK(line.points[0] == Vec3(0, 0, 0));
        CHECK(line.parent[3] == 1);
        CHECK(line.parent[5] == 0);
    }

    TEST_CASE("property: the field cases of the shared data are read")
    {
        const auto shared = test::shared_folder_or_skip();
        if (!shared) return;
        const auto folder = *shared / "field-cases";
        if (!std::filesystem::is_directory(folder)) return test::skip("no shared field cases");
        for (const char* name :
             {"00-tube-reference.stl", "01-slicer-field-before-points.vtk", "01b-fielddata-number-binary51.vtk",
              "02-slicer-space-ras.stl", "03-uppercase-crlf.stl", "03b-utf8-bom.stl"}) {
            CAPTURE(name);
            const bool ascii_stl = std::string(name).starts_with("03");  // these two hold half of the tube
            CHECK(read_mesh(folder / name, "mm").triangles.size() == (ascii_stl ? 1000 : 2000));
        }
        CHECK(remarks_of_file(folder / "01-slicer-field-before-points.vtk").axes == FileAxes::Ras);
        CHECK(remarks_of_file(folder / "02-slicer-space-ras.stl").axes == FileAxes::Ras);
        CHECK(read_centreline(folder / "13-centreline-Radius.vtp", "mm").points.size() == 60);
    }
}

}  // namespace seldinger::test::test_everyday_files
