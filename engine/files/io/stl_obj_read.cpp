// Parses binary and ASCII STL and OBJ; text coordinates become doubles, polygons of OBJ become triangles.
#include "io/mesh_readers.h"

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
    throw Error(ErrorKind::BadFile, fmt::format("{}: {}", name, message));
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
bool is_ascii_stl(const std::string& bytes)
{
    return same_word(TextWords(without_mark(bytes)).word().substr(0, 5), "solid") && has_word(bytes, "facet");
}

/// Facets of a binary STL. Writers that cannot go back to the header leave the count 0 or all ones; others append to the file and
/// keep the count, or pad the end. A count above the facets that are there means that the file was cut short.
/// @param note  out: what the count says otherwise
std::uint64_t binary_triangles(const std::string& bytes, const std::string& name, std::string& note)
{
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
        fail(name, "got text in UTF-16; expected plain text or binary STL. Fix: save it as UTF-8 or ASCII");
    if (bytes.size() < stl_header)
        refuse_damaged(name,
                       fmt::format("got {} bytes; expected {} or more in an STL file", bytes.size(), stl_header + stl_record));
    const std::uint32_t announced = announced_triangles(bytes);
    const std::uint64_t there = (bytes.size() - stl_header) / stl_record, left_over = (bytes.size() - stl_header) % stl_record;
    const bool unknown = announced == 0 || announced == ~std::uint32_t{0};
    if (left_over == 0 && (unknown || announced < there)) {
        if (there > 0)
            note = fmt::format("The file's header announces {} triangles, its body holds {}: all of these were read.", announced,
                               there);
        return there;
    }
    if (left_over > 0 && announced == there && there > 0)
        note = fmt::format("The file has {} bytes behind its {} triangles; they were left out.", left_over, there);
    else if (left_over > 0 || announced != there)
        refuse_damaged(
            name,
            fmt::format("got a header that announces {} triangles and {} bytes behind it; expected {} bytes for each triangle",
                        announced, bytes.size() - stl_header, stl_record));
    return there;
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
    PolyData data;
    const std::uint64_t count = binary_triangles(bytes, name, data.note);
    if (count == 0) fail(name, "got no triangles; expected a surface. Fix: export the mesh again");
    data.points.reserve(3 * count);
    for (std::uint64_t t = 0; t < count; ++t) {
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
    if (bytes.rfind("endsolid") == std::string::npos && !has_word(bytes, "endsolid"))
        refuse_damaged(name, "got no \"endsolid\"; expected one at the end of an ASCII STL");
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
    const bool fits =
        bytes.size() >= stl_header && bytes.size() == stl_header + stl_record * std::uint64_t{announced_triangles(bytes)};
    return !fits && is_ascii_stl(bytes) ? parse_ascii_stl(bytes, name) : parse_binary_stl(bytes, name);
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
