// Each encoding of the same triangle must give the same numbers.
#include "core/error.h"
#include "io/vtp_read.h"
#include "support/refusal.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstring>

namespace seldinger::test::test_vtp_read {

namespace {

const std::vector<double> coordinates = {0, 0, 0, 1.5, 0, 0, 0, -2.25, 1e-3};
const std::vector<std::int64_t> corners = {0, 1, 2}, ends = {3};

template <typename T>
std::string raw(const std::vector<T>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <typename T>
std::string head(std::initializer_list<std::size_t> lengths)
{
    std::string bytes;
    for (std::size_t n : lengths) {
        const T v = static_cast<T>(n);
        bytes.append(reinterpret_cast<const char*>(&v), sizeof(T));
    }
    return bytes;
}

std::string base64(const std::string& bytes)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t v = 0;
        for (std::size_t k = i; k < i + 3; ++k) v = (v << 8) | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= bytes.size() - i ? letters[(v >> (18 - 6 * k)) & 63] : '=';
    }
    return text;
}

/// Blocks of at most 40 bytes, so that there is more than one.
template <typename T>
std::string packed_head_and_body(const std::string& bytes, std::string& body)
{
    constexpr std::size_t block = 40;
    const std::size_t count = (bytes.size() + block - 1) / block, last = bytes.size() % block;
    std::string header = head<T>({count, block, last});
    for (std::size_t i = 0; i < count; ++i) {
        const std::string part = bytes.substr(i * block, block);
        uLongf size = compressBound(static_cast<uLong>(part.size()));
        std::string packed(size, '\0');
        REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(part.data()),
                         static_cast<uLong>(part.size())) == Z_OK);
        header += head<T>({size});
        body += packed.substr(0, size);
    }
    return header;
}

/// A file with three arrays, each given as the attributes and the text of its DataArray.
std::string file(const std::string& root, const std::array<std::string, 3>& how, const std::array<std::string, 3>& text,
                 const std::string& appended = {})
{
    const auto array = [&](int k, const char* type, const char* name) {
        return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" {}>{}</DataArray>", type, name,
                           k == 0 ? 3 : 1, how[k], text[k]);
    };
    return "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" " + root +
           "><PolyData><Piece NumberOfPoints=\"3\"><Points>" + array(0, "Float64", "Points") + "</Points><Polys>" +
           array(1, "Int64", "connectivity") + array(2, "Int64", "offsets") + "</Polys></Piece></PolyData>" + appended +
           "</VTKFile>";
}

const std::array<std::string, 3> blocks = {raw(coordinates), raw(corners), raw(ends)};

void check_triangle(const std::string& bytes)
{
    const PolyData data = parse_poly_data(bytes, "triangle.vtp");
    REQUIRE(data.points.size() == 3);
    for (int i = 0; i < 9; ++i) CHECK(data.points[i / 3][i % 3] == coordinates[i]);
    CHECK(data.polys.connectivity == corners);
    CHECK(data.polys.offsets == ends);
}

void check_damaged(const std::string& bytes, const std::string& word)
{
    check_refused([&] { return parse_poly_data(bytes, "triangle.vtp"); }, {"triangle.vtp: ", word}, ErrorKind::BadFile);
}

const std::string ascii = "format=\"ascii\"", binary = "format=\"binary\"";

}  // namespace

TEST_SUITE("core/vtp_read")
{
    TEST_CASE("twin: ascii, base64 and appended arrays of both header widths read alike")
    {
        check_triangle(file("", {ascii, ascii, ascii}, {"0 0 0\n1.5 0 0\n 0 -2.25 1e-3", "0 1 2", "3"}));

        std::array<std::string, 3> together, apart, at;
        std::string tail, tail64;
        for (int k = 0; k < 3; ++k) {
            together[k] = "\n  " + base64(head<std::uint32_t>({blocks[k].size()}) + blocks[k]) + "\n";
            apart[k] = base64(head<std::uint64_t>({blocks[k].size()})) + base64(blocks[k]);
            at[k] = fmt::format("format=\"appended\" offset=\"{}\"", tail.size());
            tail += head<std::uint32_t>({blocks[k].size()}) + blocks[k];
        }
        check_triangle(file("", {binary, binary, binary}, together));
        check_triangle(file("header_type=\"UInt64\"", {binary, binary, binary}, apart));
        check_triangle(file("", at, {}, "<AppendedData encoding=\"raw\">_" + tail + "</AppendedData>"));
        for (int k = 0; k < 3; ++k) {
            at[k] = fmt::format("format=\"appended\" offset=\"{}\"", tail64.size());
            tail64 += base64(head<std::uint64_t>({blocks[k].size()}) + blocks[k]);
        }
        check_triangle(
            file("header_type=\"UInt64\"", at, {}, "<AppendedData encoding=\"base64\">\n _" + tail64 + "</AppendedData>"));
    }

    TEST_CASE("twin: zlib-compressed arrays read alike, inline and appended")
    {
        std::array<std::string, 3> text, at;
        std::string tail;
        for (int k = 0; k < 3; ++k) {
            std::string body;
            const std::string header = packed_head_and_body<std::uint32_t>(blocks[k], body);
            text[k] = base64(header) + base64(body);
            at[k] = fmt::format("format=\"appended\" offset=\"{}\"", tail.size());
            tail += header + body;
        }
        const std::string root = "compressor=\"vtkZLibDataCompressor\"";
        check_triangle(file(root, {binary, binary, binary}, text));
        check_triangle(file(root, at, {}, "<AppendedData encoding=\"raw\">_" + tail + "</AppendedData>"));
    }

    TEST_CASE("regression: text does not use the compressor that its head names")
    {
        const std::array<std::string, 3> text = {"0 0 0 1.5 0 0 0 -2.25 1e-3", "0 1 2", "3"};
        for (const char* compressor : {"vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"})
            check_triangle(file(fmt::format("compressor=\"{}\"", compressor), {ascii, ascii, ascii}, text));
    }

    TEST_CASE("regression: damage is named and never read past")
    {
        const std::array<std::string, 3> good = {"0 0 0 1.5 0 0 0 -2.25 1e-3", "0 1 2", "3"};
        check_damaged("", "got no VTK XML file");
        check_damaged("<VTKFile type=\"UnstructuredGrid\"/>", "expected PolyData");
        check_damaged(file("", {ascii, ascii, ascii}, {"0 0 0 1.5", good[1], good[2]}), "expected 3 x 3");
        check_damaged(file("", {ascii, ascii, ascii}, {"0 0 0 1.5 zero", good[1], good[2]}), "\"zero");
        check_damaged(file("", {ascii, ascii, ascii}, {good[0], "0 1 7", good[2]}), "which is not there");
        check_damaged(file("", {ascii, ascii, ascii}, {good[0], good[1], "9"}), "damaged");
        check_damaged(file("compressor=\"vtkLZ4DataCompressor\"", {ascii, ascii, binary}, {good[0], good[1], base64(blocks[2])}),
                      "vtkLZ4DataCompressor");
        const std::string far = "format=\"appended\" offset=\"100000\"";
        check_damaged(file("", {far, ascii, ascii}, good, "<AppendedData encoding=\"raw\">_xx</AppendedData>"), "beyond the end");
        const std::string cut = base64(head<std::uint32_t>({72}) + blocks[0].substr(0, 66));
        const std::string huge = base64(head<std::uint32_t>({4000u}));
        check_damaged(file("", {binary, ascii, ascii}, {cut, good[1], good[2]}), "got an array of");
        check_damaged(file("", {binary, ascii, ascii}, {huge, good[1], good[2]}), "announces 4000 bytes");
    }
}

}  // namespace seldinger::test::test_vtp_read
