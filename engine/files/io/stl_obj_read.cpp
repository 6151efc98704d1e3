// Parses binary and ASCII STL and OBJ; text coordinates become doubles, polygons of OBJ become triangles.
#include "io/stl_obj_read.h"

#include "core/error.h"
#include "io/damaged_file.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <array>
#include <bit>
#include <cstring>

namespace seldinger {
namespace {

[[noreturn]] void fail(const std::string& name, const std::string& message)
{
    throw Error(ExitCode::BadFile, fmt::format("{}: {}", name, message));
}

double number_in(TextWords& words, const std::string& name, const std::string& where)
{
    const std::string_view word = words.word();
    if (const auto value = number(word)) return *value;
    refuse_number(name, fmt::format("{}: ", where), excerpt(word));
}

std::array<double, 3> point_in(TextWords& words, const std::string& name, const std::string& where)
{
    std::array<double, 3> point;
    for (double& c : point) c = number_in(words, name, where);
    return point;
}

constexpr std::size_t stl_header = 84, stl_record = 50;  // [bytes]

std::uint32_t announced_triangles(const std::string& bytes)
{
    std::uint32_t count;
    std::memcpy(&count, bytes.data() + stl_header - 4, 4);
    return count;
}

/// ASCII begins with "solid" in any case, behind blanks and a byte-order mark. Binary headers may say "solid" too.
bool is_binary_stl(const std::string& bytes, const std::string& name)
{
    if (bytes.size() >= stl_header &&
        bytes.size() == stl_header + stl_record * static_cast<std::uint64_t>(announced_triangles(bytes)))
        return true;
    if (same_word(TextWords(without_mark(bytes)).word().substr(0, 5), "solid") && has_word(bytes, "facet")) return false;
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
        fail(name, "got text in UTF-16; expected plain text or binary STL. Fix: save it as UTF-8 or ASCII");
    if (bytes.size() < stl_header) refuse_damaged(name, fmt::format("got {} bytes; expected {} or more in an STL file", bytes.size(), stl_header + stl_record));
    refuse_damaged(name, fmt::format("got a header that announces {} triangles; expected {}, as many as the file has bytes for", announced_triangles(bytes),
                                     (bytes.size() - stl_header) / stl_record));
}

void close_polygon(PolyData& data)
{
    const auto before = data.polys.offsets.empty() ? 0 : data.polys.offsets.back();
    const auto end = static_cast<std::int64_t>(data.points.size());
    for (std::int64_t k = before; k < end; ++k) data.polys.connectivity.push_back(k);
    data.polys.offsets.push_back(end);
}

PolyData parse_binary_stl(const std::string& bytes, const std::string& name)
{
    static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");
    const std::uint32_t count = announced_triangles(bytes);
    if (count == 0) fail(name, "got no triangles; expected a surface. Fix: export the mesh again");
    PolyData data;
    data.points.reserve(3 * static_cast<std::size_t>(count));
    for (std::uint32_t t = 0; t < count; ++t) {
        float corners[9];  // behind the normal, which is not needed
        std::memcpy(corners, bytes.data() + stl_header + stl_record * t + 12, sizeof corners);
        for (int c = 0; c < 9; c += 3) data.points.push_back({corners[c], corners[c + 1], corners[c + 2]});
        close_polygon(data);
    }
    return data;
}

PolyData parse_ascii_stl(const std::string& bytes, const std::string& name)
{
    // looked for from the end, where it is, before capitals are looked for everywhere
    if (bytes.rfind("endsolid") == std::string::npos && !has_word(bytes, "endsolid")) refuse_damaged(name, "got no \"endsolid\"; expected one at the end of an ASCII STL");
    PolyData data;
    TextWords words(without_mark(bytes));
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
        if (same_word(word, "solid") || same_word(word, "endsolid")) words.line();  // a name, of any words
        else if (same_word(word, "vertex"))
            data.points.push_back(point_in(words, name, fmt::format("facet {}", data.polys.offsets.size() + 1)));
        else if (same_word(word, "endloop")) close_polygon(data);
    }
    return data;
}

std::int64_t corner_of_face(std::string_view word, std::size_t vertex_count, const std::string& name)
{
    const std::string_view first = word.substr(0, word.find('/'));
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(first.data(), first.data() + first.size(), index);
    if (error != std::errc{} || end != first.data() + first.size() || index == 0)
        refuse_damaged(name, fmt::format("got \"{}\"; expected the number of a face's vertex", excerpt(word)));
    return index > 0 ? index - 1 : static_cast<std::int64_t>(vertex_count) + index;  // negative: counted back from here
}

/// A line of an OBJ, with its continuation lines (backslash at the end).
std::string_view obj_line(TextWords& lines, std::string& joined)
{
    std::string_view line = lines.line();
    if (!line.ends_with('\\')) return line;
    joined.clear();
    while (line.ends_with('\\') && !lines.at_end()) {
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        line = lines.line();
    }
    joined.append(line);
    return joined;
}

}  // namespace

PolyData parse_stl(const std::string& bytes, const std::string& name)
{
    return is_binary_stl(bytes, name) ? parse_binary_stl(bytes, name) : parse_ascii_stl(bytes, name);
}

PolyData parse_obj(const std::string& bytes, const std::string& name)
{
    PolyData data;
    std::string joined;
    for (TextWords lines(without_mark(bytes)); !lines.at_end();) {
        TextWords words(obj_line(lines, joined));
        const std::string_view key = words.word();
        if (key == "v") {
            data.points.push_back(point_in(words, name, fmt::format("vertex {}", data.points.size() + 1)));
        } else if (key == "f") {
            for (std::string_view word = words.word(); !word.empty(); word = words.word())
                data.polys.connectivity.push_back(corner_of_face(word, data.points.size(), name));
            data.polys.offsets.push_back(static_cast<std::int64_t>(data.polys.connectivity.size()));
        }
    }
    for (const std::int64_t index : data.polys.connectivity)  // a face may come before its vertices
        if (index < 0 || index >= static_cast<std::int64_t>(data.points.size()))
            refuse_damaged(name, fmt::format("got vertex {} in a face; expected 1 to {}", index + 1, data.points.size()));
    return data;
}

}  // namespace seldinger
