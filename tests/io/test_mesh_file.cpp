// Reading and writing mesh files: every format, every encoding of .vtp, and what broken files answer.
#include "core/error.h"
#include "core/file_io.h"
#include "io/centreline_file.h"
#include "io/mesh_file.h"
#include "support/approx.h"
#include "support/bytes.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "vessel/mesh_fixtures.h"
#include "vtp_samples.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace seldinger::test::test_mesh_file {

namespace fs = std::filesystem;

namespace {

/// "" when it was read, else the message of the BadFile error.
std::string refusal(const fs::path& path)
{
    const std::string text = test::refusal([&] { return read_mesh(path, "mm"); }, ErrorKind::BadFile);
    if (!text.empty()) CHECK(has(text, path.filename().string()));
    return text;
}

/// The samples' tetrahedron: four faces, volume 1 * 2 * 3 / 6 of the unit cubed, facing outwards.
void check_tetrahedron(const WallMesh& mesh, double unit)
{
    REQUIRE(mesh.triangles.size() == 4);
    double volume = 0;
    for (std::size_t t = 0; t < 4; ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        volume += tri.a.dot(double_area(tri)) / 6;
    }
    CHECK(volume == about(unit * unit * unit).epsilon(1e-6));
}

std::string sample(const char* name)
{
    for (const VtpSample& s : kVtpSamples)
        if (std::strcmp(s.name, name) == 0) return s.text;
    FAIL("no such sample");
    return "";
}

}  // namespace

TEST_SUITE("scene/mesh_file")
{
    TEST_CASE("property: what is written comes back, in every format and unit")
    {
        const TemporaryFolder folder;
        const WallMesh tube = make_tube(tube_spec(0.01, 0.1, 600)).mesh;
        for (const char* units : {"m", "cm", "mm", "um", "in"})
            for (const char* name : {"a.stl", "a.obj", "a.ply", "a.vtp"}) {
                CAPTURE(units);
                CAPTURE(name);
                write_mesh(folder.path() / name, tube, units);
                MeshFileFacts facts;
                const WallMesh back = read_mesh(folder.path() / name, units, &facts);
                REQUIRE(facts.triangles == static_cast<long>(tube.triangles.size()));
                double off = 0;
                for (std::size_t t = 0; t < tube.triangles.size(); ++t) {
                    const Triangle3 a = triangle_of(tube, t), b = triangle_of(back, t);
                    off = std::max({off, (a.a - b.a).norm(), (a.b - b.b).norm(), (a.c - b.c).norm()});
                }
                // binary STL holds float32 (2^-24 of 0.1 m), the others doubles
                CHECK(off < (std::strcmp(name, "a.stl") == 0 ? 1.1e-8 : 1e-16));
            }
        CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 4);  // no temporary file is left
        CHECK_THROWS_AS(write_mesh(folder.path() / "a.xyz", tube, "mm"), Error);
        CHECK_THROWS_AS(write_mesh(folder.path() / "none" / "a.stl", tube, "mm"), Error);
        CHECK_THROWS_AS((void)read_mesh(folder.path() / "a.stl", "furlong"), Error);
    }

    TEST_CASE("property: every encoding of .vtp that VTK writes gives the same tetrahedron")
    {
        const TemporaryFolder folder;
        for (const VtpSample& s : kVtpSamples) {
            CAPTURE(s.name);
            check_tetrahedron(read_mesh(folder.write("t.vtp", s.text), "cm"), 0.01);
        }
    }

    TEST_CASE("property: raw appended data, strips, quadrilaterals and several pieces")
    {
        const TemporaryFolder folder;
        // raw: UInt32 length before each array; bytes that look like tags must not matter
        const std::string points = as_bytes<float>({0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3}),
                          offsets = as_bytes<std::int32_t>({3, 6, 9, 12});
        const std::string connectivity = as_bytes<std::int32_t>({0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2});
        auto with_length = [](const std::string& bytes) {
            return as_bytes<std::uint32_t>({static_cast<std::uint32_t>(bytes.size())}) + bytes;
        };
        const std::string raw = with_length("</a> & <b") + with_length(points) + with_length(connectivity) + with_length(offsets);
        const std::string text =
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData><Piece "
            "NumberOfPoints=\"4\" NumberOfPolys=\"4\">"
            "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" offset=\"13\"/></Points>"
            "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"appended\" offset=\"65\"/>"
            "<DataArray type=\"Int32\" Name=\"offsets\" format=\"appended\" offset=\"117\"/></Polys></Piece></PolyData>"
            "<AppendedData encoding=\"raw\">_" +
            raw + "</AppendedData></VTKFile>";
        check_tetrahedron(read_mesh(folder.write("raw.vtp", text), "m"), 1);

        auto piece = [](const char* cells) { return std::string("<Piece NumberOfPoints=\"4\" ") + cells; };
        const std::string square =
            "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 1 1 "
            "0</DataArray></Points>";
        const std::string both =
            "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData>" + piece("NumberOfStrips=\"1\">") + square +
            "<Strips><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
            "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray></Strips></Piece>" +
            piece("NumberOfPolys=\"1\">") + square +
            "<Polys><DataArray type=\"UInt8\" Name=\"connectivity\" format=\"ascii\">0 1 3 2</DataArray>"
            "<DataArray type=\"UInt8\" Name=\"offsets\" format=\"ascii\">4</DataArray></Polys></Piece></PolyData></VTKFile>";
        const WallMesh mesh = read_mesh(folder.write("two.vtp", both), "m");
        REQUIRE(mesh.vertices.size() == 8);
        REQUIRE(mesh.triangles.size() == 4);
        for (std::size_t t = 0; t < 4; ++t) CHECK(double_area(triangle_of(mesh, t)).z() == about(1.0));  // all face +z
        for (std::size_t t = 0; t < 2; ++t)  // polygons come before strips; the second piece has its own points
            CHECK(*std::min_element(mesh.triangles[t].begin(), mesh.triangles[t].end()) >= 4);
    }

    TEST_CASE("analytic: a concave polygon is cut into triangles of its own area")
    {
        const TemporaryFolder folder;
        // an L of three unit squares; a fan from its first corner would cover empty space
        const std::string text =
            "# vtk DataFile Version 3.0\nL\nASCII\nDATASET POLYDATA\nPOINTS 6 double\n2 0 0 2 1 0 1 1 0 1 2 0 0 2 0 0 0 0\n"
            "POLYGONS 1 7\n6 0 1 2 3 4 5\n";
        const WallMesh mesh = read_mesh(folder.write("l.vtk", text), "m");
        REQUIRE(mesh.triangles.size() == 4);
        double area = 0;
        for (std::size_t t = 0; t < 4; ++t) {
            const double part = 0.5 * double_area(triangle_of(mesh, t)).z();
            CHECK(part >= 0);
            area += part;
        }
        CHECK(area == about(3.0).epsilon(1e-12));
    }

    TEST_CASE("property: legacy .vtk, ASCII and binary, old and new cells")
    {
        const TemporaryFolder folder;
        const std::string head = "# vtk DataFile Version 4.2\ntetrahedron\n", points_text = "0 0 0 1 0 0\n0 2 0 0 0 3\n";
        check_tetrahedron(
            read_mesh(folder.write("old.vtk", head + "ASCII\nDATASET POLYDATA\nPOINTS 4 float\n" + points_text +
                                                  "POLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\nCELL_DATA 4\n"),
                      "mm"),
            1e-3);
        check_tetrahedron(
            read_mesh(folder.write("new.vtk", head + "ASCII\nDATASET POLYDATA\nPOINTS 4 double\n" + points_text +
                                                  "METADATA\nINFORMATION 0\n\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 "
                                                  "12\nCONNECTIVITY vtktypeint64\n0 2 1 0 1 3 1 2 3 0 3 2\n"),
                      "mm"),
            1e-3);
        const std::string points = as_bytes<float>({0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3}, true);
        const std::string cells = as_bytes<std::int32_t>({3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 3, 2}, true);
        const std::string binary =
            head + "BINARY\nDATASET POLYDATA\nPOINTS 4 float\n" + points + "\nPOLYGONS 4 16\n" + cells + "\n";
        check_tetrahedron(read_mesh(folder.write("binary.vtk", binary), "mm"), 1e-3);
        CHECK(has(refusal(folder.write("cut.vtk", binary.substr(0, binary.size() - 20))), "cut off"));
        CHECK(has(refusal(folder.write("grid.vtk", head + "ASCII\nDATASET UNSTRUCTURED_GRID\n")), "expected POLYDATA"));
        CHECK(has(refusal(folder.write("lie.vtk", head + "ASCII\nDATASET POLYDATA\nPOINTS 4000000000 float\n1 2 3\n")),
                  "no more than"));
    }

    TEST_CASE("property: ASCII STL, and polygons of a PLY")
    {
        const TemporaryFolder folder;
        const std::string facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
        CHECK(read_mesh(folder.write("a.stl", "solid a\n" + facet + "endsolid a\n"), "mm").triangles.size() == 1);
        CHECK(has(refusal(folder.write("b.stl", "solid b\n" + facet)), "truncated"));
        const std::string ply =
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
        CHECK(read_mesh(folder.write("a.ply", ply + "4 0 1 2 3\n"), "mm").triangles.size() == 2);
    }

    TEST_CASE("property: coordinates far from the origin arrive as the doubles that the file holds, and float32 is told")
    {
        const TemporaryFolder folder;
        const char* const text[3] = {"2600.123456789012 -1.0000000000001 +3e0", "2601.123456789012 -1 3.25",
                                     "2600.123456789012 0.1 3"};
        const double exact[3][3] = {
            {2600.123456789012, -1.0000000000001, 3}, {2601.123456789012, -1, 3.25}, {2600.123456789012, 0.1, 3}};
        std::string facet = "solid far vertex\nfacet normal nan 0 0\nouter loop\n", obj = "# far\n", list;
        for (const char* line : text) {
            facet += std::string("VERTEX ") + line + "\n";
            obj += std::string("v ") + line + " 0.5 0.5 0.5\n";
            list += std::string(line) + "\n";
        }
        obj += "vt 0 0\nvn 0 0 1\nf -3/1/1 \\\n 2//1 3\n";
        const std::string head =
            "element vertex 3\ncomment far\nproperty double x\nproperty double y\nproperty float64 z\n"
            "element edge 1\nproperty int a\nproperty list uchar short b\nelement face 1\n"
            "property uchar flag\nproperty list uchar uint vertex_index\nend_header\n";
        std::vector<double> values;
        for (const auto& row : exact) values.insert(values.end(), row, row + 3);
        const auto binary = [&](const auto& bytes) {
            return bytes(values) + bytes(std::vector<std::int32_t>{7}) + std::string(1, 2) +
                   bytes(std::vector<std::int16_t>{5, 6}) + std::string("\1\3", 2) + bytes(std::vector<std::uint32_t>{0, 1, 2});
        };
        const auto little = [](const auto& list_of) { return as_bytes(list_of); };
        const auto big = [](const auto& list_of) { return as_bytes(list_of, true); };
        const std::pair<const char*, std::string> files[] = {
            {"far.stl", facet + "endloop\nendfacet\nendsolid far\n"},
            {"far.obj", obj},
            {"far.ply", "ply\r\nformat ascii 1.0\r\n" + head + list + "7 2 5 6\n1 3 0 1 2"},
            {"little.ply", "ply\nformat binary_little_endian 1.0\n" + head + binary(little)},
            {"big.ply", "ply\nformat binary_big_endian 1.0\n" + head + binary(big)},
        };
        for (const auto& file : files) {
            const char* const name = file.first;
            const std::string& bytes = file.second;
            CAPTURE(name);
            MeshFileFacts facts;
            const WallMesh mesh = read_mesh(folder.write(name, bytes), "m", &facts);
            REQUIRE(mesh.triangles.size() == 1);
            CHECK(facts.triangles == 1);
            CHECK(facts.rounding == 0);
            for (int c = 0; c < 3; ++c)
                for (int d = 0; d < 3; ++d)
                    CHECK(mesh.vertices[static_cast<std::size_t>(mesh.triangles[0][static_cast<std::size_t>(c)])][d] ==
                          exact[c][d]);
        }
        // half of the last bit of a float32 in [2048, 4096): 2^11 2^-24
        write_mesh(folder.path() / "b.stl", read_mesh(folder.path() / "far.obj", "mm"), "mm");
        MeshFileFacts facts;
        const WallMesh rounded = read_mesh(folder.path() / "b.stl", "mm", &facts);
        CHECK(facts.rounding == about(std::exp2(-13) * 1e-3).epsilon(1e-12));
        const double off = std::abs(rounded.vertices[0].x() - 2.600123456789012);
        CHECK(off <= facts.rounding);
        CHECK(off > 1e-9);
    }

    TEST_CASE("property: a PLY, OBJ or STL that lies is refused before anything is made room for")
    {
        const TemporaryFolder folder;
        const std::string vertices = "property float x\nproperty float y\nproperty float z\n",
                          faces = "property list uchar int vertex_indices\n", ascii = "ply\nformat ascii 1.0\n",
                          three = "element vertex 3\n", one = "element face 1\n", end = "end_header\n",
                          points = "0 0 0\n1 0 0\n0 1 0\n";
        const auto ply = [&](const std::string& text) { return refusal(folder.write("lie.ply", text)); };
        CHECK(has(ply(ascii + "element vertex 40\n" + vertices + one + faces + end + points + "3 0 1 2\n"), "announces"));
        CHECK(has(ply(ascii + "element other 40\nproperty list uchar int a\n" + three + vertices + one + faces + end + points +
                      "3 0 1 2\n"),
                  "announces"));
        CHECK(has(ply(ascii + three + vertices + "element face 40\n" + faces + end + points + "3 0 1 2\n"), "announces"));
        // nothing to read of an element without properties, however many there are
        CHECK(ply(ascii + "element nothing 40\n" + three + vertices + one + faces + end + points + "3 0 1 2\n").empty());
        CHECK(has(ply(ascii + three + vertices + one + faces + end + points + "200 0 1 2\n"), "announces 200 items"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + points + "3 0 1 3\n"),
                  "got vertex 3 in a face; expected 0 to 2"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + points + "3 0 1 -1\n"), "got vertex -1 in a face"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + points + "3 0 1 1e300\n"),
                  "expected the number of a face's vertex"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + points + "3 0 1\n"), "expected a number"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + points + "-3 0 1 2\n"), "announces -3 items"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + "0 0 x\n"), "announces"));
        CHECK(has(ply(ascii + three + vertices + one + faces + end + "0 0 x\n" + points + "3 0 1 2\n"), "\"x\""));
        CHECK(has(ply(ascii + three + "property float x\n" + one + faces + end + points), "without x, y and z"));
        CHECK(has(ply(ascii + three + vertices + one + "property list uchar int other\n" + end + points + "3 0 1 2\n"),
                  "vertex_indices"));
        CHECK(has(ply(ascii + three + "property real x\n" + end), "expected a type of PLY"));
        CHECK(has(ply(ascii + "property float x\n" + end), "expected an element before it"));
        CHECK(has(ply("ply\n" + three + vertices + one + faces + end + points + "3 0 1 2\n"), "no format"));
        CHECK(has(ply(ascii + three + vertices + end + points), "no faces"));
        CHECK(has(ply(ascii + three + vertices), "end_header"));
        const auto obj = [&](const std::string& text) { return refusal(folder.write("lie.obj", text)); };
        CHECK(obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").empty());  // a face before its vertices
        CHECK(has(obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "got vertex 4 in a face; expected 1 to 3"));
        CHECK(has(obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n"), "got vertex"));
        CHECK(has(obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n"), "expected the number of a face's vertex"));
        CHECK(has(obj("v 0 0 0\nv 1 0\n"), "vertex 2"));
        CHECK(has(obj("g nothing\n"), "no triangle"));
        CHECK(has(refusal(folder.write("c.stl",
                                       "solid c\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 zero 0\nendloop\n"
                                       "endfacet\nendsolid c\n")),
                  "\"zero\""));
    }

    TEST_CASE("property: broken files are refused with the file and the reason")
    {
        const TemporaryFolder folder;
        const WallMesh tube = make_tube(tube_spec(0.01, 0.1, 600)).mesh;
        CHECK_FALSE(refusal(folder.path() / "missing.stl").empty());
        CHECK(has(refusal(folder.write("empty.stl", "")), "empty"));
        CHECK(has(refusal(folder.write("empty.vtp", "")), "empty"));
        CHECK(refusal(folder.write("a.step", "ISO-10303-21;")).find("export it from the CAD program") != std::string::npos);
        fs::create_directories(folder.path() / "folder.stl");
        CHECK_FALSE(refusal(folder.path() / "folder.stl").empty());

        for (const char* name : {"t.stl", "t.ply", "t.vtp"}) {
            CAPTURE(name);
            write_mesh(folder.path() / name, tube, "mm");
            const std::string whole = read_file(folder.path() / name);
            for (const double part : {0.02, 0.3, 0.7, 0.95})
                CHECK_FALSE(refusal(folder.write(name, whole.substr(0, static_cast<std::size_t>(
                                                                           part * static_cast<double>(whole.size())))))
                                .empty());
        }
        // a header that announces more than there is
        write_mesh(folder.path() / "lie.stl", tube, "mm");
        std::string lie = read_file(folder.path() / "lie.stl");
        const auto many = static_cast<std::uint32_t>(tube.triangles.size() + 1);
        std::memcpy(lie.data() + 80, &many, 4);
        CHECK(has(refusal(folder.write("lie.stl", lie)), fmt::format("announces {} triangles", many)));
        auto vtp_with = [&](const std::string& from, const std::string& to) {
            std::string text = sample("ascii");
            const std::size_t at = text.find(from);
            REQUIRE(at != std::string::npos);
            return folder.write("bad.vtp", text.replace(at, from.size(), to));
        };
        CHECK(has(refusal(vtp_with("NumberOfPoints=\"4\"", "NumberOfPoints=\"5\"")), "expected 3 x 5"));
        CHECK(has(refusal(vtp_with("NumberOfPolys=\"4\"", "NumberOfPolys=\"3\"")), "NumberOfPolys"));
        CHECK(has(refusal(vtp_with("0 2 1 0 1 3", "0 2 1 0 1 7")), "not there"));
        CHECK(has(refusal(vtp_with("0 2 1 0 1 3", "0 2 1 0 1 -1")), "not there"));
        CHECK(has(refusal(vtp_with("3 6 9 12", "3 9 6 12")), "damaged"));
        CHECK(has(refusal(vtp_with("0 0 0 1 0 0", "0 0 0 x 0 0")), "expected a number"));
        CHECK(has(refusal(vtp_with("type=\"PolyData\"", "type=\"ImageData\"")), "expected PolyData"));
        CHECK(has(refusal(folder.write("no.vtp", "hello")), "XML"));
        std::string zlib = sample("inline_zlib");
        const std::size_t at = zlib.find("eF5j");  // where the first zlib stream begins
        REQUIRE(at != std::string::npos);
        zlib[at + 12] = zlib[at + 12] == 'A' ? 'B' : 'A';
        CHECK_FALSE(refusal(folder.write("zlib.vtp", zlib)).empty());
    }

    TEST_CASE("property: a centreline written and read keeps its tree, radii and length")
    {
        const TemporaryFolder folder;
        Centreline line;
        line.points = {{0, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0}, {0.03, 0.01, 0}, {0.03, -0.01, 0}, {0.04, -0.02, 0.01}};
        line.radius = {0.005, 0.005, 0.004, 0.003, 0.002, 0.001};
        line.parent = {-1, 0, 1, 2, 2, 4};
        write_centreline_vtp(folder.path() / "c.vtp", line, "mm");
        const Centreline back = read_centreline(folder.path() / "c.vtp", "mm");
        REQUIRE(back.points.size() == line.points.size());
        CHECK(back.total_length() == about(line.total_length()).epsilon(1e-14));
        CHECK(back.main_path().size() == line.main_path().size());
        CHECK(std::count(back.parent.begin(), back.parent.end(), -1) == 1);
        std::vector<double> a = line.radius, b = back.radius;
        std::sort(a.begin(), a.end());
        std::sort(b.begin(), b.end());
        for (std::size_t i = 0; i < a.size(); ++i) CHECK(b[i] == about(a[i]).epsilon(1e-14));
        CHECK_THROWS_AS((void)read_centreline(folder.write("t.vtp", sample("ascii")), "mm"), Error);
    }
}

}  // namespace seldinger::test::test_mesh_file
