// Mesh files that were made to crash, hang or fill the memory: each kind as a small one of our own. Files on the other side of
// each bound are read.
#include "core/error.h"
#include "io/centreline_file.h"
#include "io/mesh_file.h"
#include "repair/repair.h"
#include "support/bytes.h"
#include "support/refusal.h"
#include "support/shared_folder.h"
#include "vessel/extract_centreline.h"
#include "vessel/work_budget.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

namespace seldinger::test::test_hostile_files {

namespace {

std::string refusal(const auto& work) { return test::refusal(work, ErrorKind::BadFile); }

std::string refusal(const std::string& bytes, const char* name)
{
    return refusal([&] { return parse_mesh(bytes, name, "mm"); });
}

/// One block as VTK packs it, lengths of 32 bits.
std::string packed(const std::string& raw)
{
    uLongf size = compressBound(static_cast<uLong>(raw.size()));
    std::string data(size, '\0');
    REQUIRE(compress2(reinterpret_cast<Bytef*>(data.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
                      static_cast<uLong>(raw.size()), 9) == Z_OK);
    data.resize(size);
    const auto raw_size = static_cast<std::uint32_t>(raw.size());
    return as_bytes<std::uint32_t>({1, raw_size, raw_size, static_cast<std::uint32_t>(size)}) + data;
}

std::string appended(const char* type, const char* name, std::size_t offset)
{
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>", type, name, offset);
}

std::string vtp(const std::string& pieces, const std::string& data, bool compressed)
{
    return fmt::format(
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"{}><PolyData>{}</PolyData>"
        "<AppendedData encoding=\"raw\">_{}</AppendedData></VTKFile>",
        compressed ? " compressor=\"vtkZLibDataCompressor\"" : "", pieces, data);
}

const std::string four_points =
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
    "0 0 0 1 0 0 0 2 0 0 0 3</DataArray></Points>";

std::string ascii_cells(const char* type, const char* connectivity, const char* offsets)
{
    return fmt::format(
        "<Polys><DataArray type=\"{0}\" Name=\"connectivity\" format=\"ascii\">{1}</DataArray>"
        "<DataArray type=\"{0}\" Name=\"offsets\" format=\"ascii\">{2}</DataArray></Polys>",
        type, connectivity, offsets);
}

/// A tetrahedron of which one coordinate is `word`, in each text format.
std::string with_coordinate(const std::string& format, const std::string& word)
{
    if (format == "x.obj") return "v 0 0 0\nv 1 0 0\nv 0 " + word + " 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    if (format == "x.vtk")
        return "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0 1 0 0 0 " + word +
               " 0 0 0 3\nPOLYGONS 4 16\n3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2\n";
    if (format == "x.ply")
        return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
               "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 " +
               word + " 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    if (format == "x.stl")
        return "solid x\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 " + word +
               " 0\nendloop\nendfacet\nendsolid x\n";
    const std::string cells = ascii_cells("Int32", "0 2 1 0 1 3", "3 6");
    return "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\"><Points><DataArray "
           "type=\"Float64\" "
           "format=\"ascii\">0 0 0 1 0 0 0 " +
           word + " 0 0 0 3</DataArray></Points>" + cells + "</Piece></PolyData></VTKFile>";
}

std::string polygon_of(const std::vector<std::array<double, 2>>& corners)
{
    std::string text, face = "f";
    for (std::size_t k = 0; k < corners.size(); ++k) {
        text += fmt::format("v {:.6f} {:.6f} 0\n", corners[k][0], corners[k][1]);
        face += fmt::format(" {}", k + 1);
    }
    return text + face + "\n";
}

}  // namespace

TEST_SUITE("io/hostile_files")
{
    TEST_CASE(
        "property: a coordinate that is no number, or beyond a thousand kilometres, is refused by its vertex in every format")
    {
        for (const char* format : {"x.stl", "x.obj", "x.ply", "x.vtp", "x.vtk"})
            for (const char* word : {"nan", "inf", "-1e30", "1e400", "1000000001"}) {
                CAPTURE(format);
                CAPTURE(word);
                const std::string said = refusal(with_coordinate(format, word), format);
                if (std::string(format) == "x.vtp" && std::string(word) == "1e400") CHECK(has(said, "1e400"));
                else CHECK(has(said, "vertex 3 (counted from 1)"));
            }
        for (const char* format : {"x.stl", "x.obj", "x.ply", "x.vtp", "x.vtk"})
            CHECK(refusal(with_coordinate(format, "999999999"), format).empty());
    }

    TEST_CASE("property: a number of points whose coordinates are beyond 64 bits is not taken for a small one")
    {
        // 3 x 12297829382473034411 is 1 in 64 bits
        const std::string text =
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"12297829382473034411\">"
            "<Points><DataArray type=\"Float64\" format=\"ascii\">0</DataArray></Points></Piece></PolyData></VTKFile>";
        CHECK(has(refusal(text, "x.vtp"), "12297829382473034411"));
    }

    TEST_CASE("property: indices that are no numbers, or overflow when pieces are put together, are refused")
    {
        const auto piece = [](const char* type, const char* connectivity, const char* offsets) {
            return "<Piece NumberOfPoints=\"4\">" + four_points + ascii_cells(type, connectivity, offsets) + "</Piece>";
        };
        const std::string good = piece("Int64", "0 1 2", "3");
        CHECK(refusal(vtp(good + good, "", false), "x.vtp").empty());
        CHECK(has(refusal(vtp(good + piece("Int64", "0 1 2", "9223372036854775807"), "", false), "x.vtp"), "damaged"));
        CHECK(has(refusal(vtp(good + piece("Int64", "0 1 9223372036854775807", "3"), "", false), "x.vtp"), "not there"));
        for (const double index : {std::numeric_limits<double>::quiet_NaN(), 1e300, -1e300}) {
            const std::string corners = as_bytes<double>({0, 1, index}), data = as_bytes<std::uint32_t>({24}) + corners;
            const std::string cells = "<Piece NumberOfPoints=\"4\">" + four_points + "<Polys>" +
                                      appended("Float64", "connectivity", 0) +
                                      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>";
            CHECK(has(refusal(vtp(cells, data, false), "x.vtp"), "not there"));
        }
    }

    TEST_CASE("property: what a .vtp unpacks to is bounded by its size: by zlib, and by pieces that share a block")
    {
        const std::vector<std::int32_t> zeros(1 << 22, 0);  // 16 MB in 16 kB
        const std::string connectivity = packed(as_bytes(zeros)), ends = packed(as_bytes<std::int32_t>({1 << 22}));
        const std::string bomb = "<Piece NumberOfPoints=\"4\">" + four_points + "<Polys>" + appended("Int32", "connectivity", 0) +
                                 appended("Int32", "offsets", connectivity.size()) + "</Polys></Piece>";
        CHECK(has(refusal(vtp(bomb, connectivity + ends, true), "x.vtp"), "unpack to more than 32 times"));

        const std::vector<float> points(3 * 20000, 1.0f);
        const std::string block = as_bytes<std::uint32_t>({static_cast<std::uint32_t>(4 * points.size())}) + as_bytes(points);
        std::string pieces;
        for (int k = 0; k < 500; ++k)
            pieces += "<Piece NumberOfPoints=\"20000\"><Points>" + appended("Float32", "p", 0) + "</Points>" +
                      ascii_cells("Int32", "0 1 2", "3") + "</Piece>";
        CHECK(has(refusal(vtp(pieces, block, false), "x.vtp"), "unpack to more than 32 times"));
    }

    TEST_CASE("property: a point array that packs a thousandfold does not keep a mesh from being read")
    {
        const std::string labels = packed(as_bytes(std::vector<double>(1 << 20, 7.0)));
        const std::string piece = "<Piece NumberOfPoints=\"4\">" + four_points +
                                  ascii_cells("Int32", "0 2 1 0 1 3 1 2 3 0 3 2", "3 6 9 12") + "<PointData>" +
                                  appended("Float64", "label", 0) + "</PointData></Piece>";
        CHECK(refusal(vtp(piece, labels, true), "x.vtp").empty());
    }

    TEST_CASE("property: more triangles than any writer gets into the bytes are refused before they are made")
    {
        std::vector<std::uint8_t> strip(60000);
        for (std::size_t k = 0; k < strip.size(); ++k) strip[k] = static_cast<std::uint8_t>(k % 4);
        const std::string corners = packed(as_bytes(strip)), ends = packed(as_bytes<std::int32_t>({60000}));
        const std::string piece = "<Piece NumberOfPoints=\"4\">" + four_points + "<Strips>" +
                                  appended("UInt8", "connectivity", 0) + appended("Int32", "offsets", corners.size()) +
                                  "</Strips></Piece>";
        CHECK(has(refusal(vtp(piece, corners + ends, true), "x.vtp"), "59998 triangles"));
    }

    TEST_CASE("property: polygons that cut themselves and convex ones of thousands of corners are cut; the work has a limit")
    {
        std::mt19937 rng(3);
        std::uniform_real_distribution<double> place(-10, 10);
        std::vector<std::array<double, 2>> tangled(300), round(3000);
        for (auto& p : tangled) p = {place(rng), place(rng)};
        for (std::size_t k = 0; k < round.size(); ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(round.size());
            round[k] = {10 * std::cos(angle), 10 * std::sin(angle)};
        }
        CHECK(parse_mesh(polygon_of(tangled), "x.obj", "mm").triangles.size() == tangled.size() - 2);
        WorkBudget work("cutting its polygons into triangles", 1e6);
        CHECK(has(refusal([&] { work.spend(1e6 + 1); }),
                  "too tangled: cutting its polygons into triangles takes more than 1 million steps"));
        CHECK(parse_mesh(polygon_of(round), "x.obj", "mm").triangles.size() == round.size() - 2);
    }

    TEST_CASE("property: words of a file that a terminal would obey are not handed on")
    {
        const std::string escape = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS \x1b]0;owned\x07 float\n";
        const std::string said = refusal(escape, "x.vtk");
        CHECK(has(said, "owned"));
        CHECK(std::all_of(said.begin(), said.end(), [](char c) { return c >= ' ' && c <= '~'; }));
        CHECK(refusal("# vtk DataFile Version 3.0\nx\n" + std::string(100000, 'a') + "\n", "x.vtk").size() < 300);
    }

    TEST_CASE("regression: lines of no points are no centreline")
    {
        const std::string said = refusal([] {
            (void)parse_centreline(
                "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Float64\" "
                "format=\"ascii\">0 0 0</DataArray></Points><Lines><DataArray type=\"Int32\" Name=\"connectivity\" "
                "format=\"ascii\"></DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">0 0</DataArray></Lines>"
                "<PointData><DataArray type=\"Float64\" Name=\"MaximumInscribedSphereRadius\" format=\"ascii\">1</DataArray>"
                "</PointData></Piece></PolyData></VTKFile>",
                "x.vtp", "mm");
        });
        CHECK(has(said, "got no line"));
    }

    TEST_CASE("property: a centreline's places and radii are bounded, too")
    {
        const auto line = [](const char* place, const char* radius) {
            return refusal([&] {
                (void)parse_centreline(
                    fmt::format(
                        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"2\"><Points><DataArray type=\"Float64\" "
                        "format=\"ascii\">0 0 0 {} 0 0</DataArray></Points><Lines><DataArray type=\"Int32\" "
                        "Name=\"connectivity\" format=\"ascii\">0 1</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
                        "format=\"ascii\">2</DataArray></Lines><PointData><DataArray type=\"Float64\" "
                        "Name=\"MaximumInscribedSphereRadius\" format=\"ascii\">1 {}</DataArray></PointData></Piece></PolyData>"
                        "</VTKFile>",
                        place, radius),
                    "x.vtp", "mm");
            });
        };
        CHECK(line("10", "1").empty());
        for (const char* place : {"nan", "2e9", "1e300"})
            CHECK(has(line(place, "1"), "expected coordinates within 1000000 m and a radius above 0"));
        for (const char* radius : {"nan", "0", "-1", "1e300"})
            CHECK(has(line("10", radius), "expected coordinates within 1000000 m and a radius above 0"));
    }

    TEST_CASE("property: every hostile mesh of the shared data is refused in one line or reported within its own box")
    {
        const auto shared = test::shared_folder_or_skip();
        if (!shared) return;
        if (!std::filesystem::is_directory(*shared / "hostile")) return test::skip("no shared hostile files");
        int meshes = 0;
        for (const auto& entry : std::filesystem::directory_iterator(*shared / "hostile")) {
            const std::string kind = entry.path().extension().string();
            if (kind != ".stl" && kind != ".obj" && kind != ".ply" && kind != ".vtp" && kind != ".vtk") continue;
            ++meshes;
            CAPTURE(entry.path().filename().string());
            const std::string said = refusal([&] {
                WallMesh mesh = read_mesh(entry.path(), "mm");
                const RepairReport report = repair(mesh);
                Box3 box;
                for (const Vec3& v : mesh.vertices) box.extend(v);
                const double slack = 0.01 * box.diagonal().norm();
                const Centreline line = extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops));
                for (std::size_t i = 0; i < line.points.size(); ++i) {
                    CHECK(box.exteriorDistance(line.points[i]) <= slack);
                    CHECK(line.radius[i] <= box.diagonal().norm());
                }
            });
            CHECK(said.find('\n') == std::string::npos);
        }
        CHECK(meshes > 0);
    }
}

}  // namespace seldinger::test::test_hostile_files
