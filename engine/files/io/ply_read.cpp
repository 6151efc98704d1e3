// Parses PLY headers and elements, ascii and binary of either byte order, and checks announced counts against the file's size.
#include "io/mesh_readers.h"

#include "core/error.h"
#include "io/binary_text.h"
#include "io/damaged_file.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

namespace seldinger {
namespace {

std::optional<Scalar> scalar_named(std::string_view word)
{
    constexpr Scalar int8{'i', 1}, uint8{'u', 1}, int16{'i', 2}, uint16{'u', 2}, int32{'i', 4}, uint32{'u', 4}, real32{'f', 4},
        real64{'f', 8};
    constexpr std::pair<std::string_view, Scalar> names[] = {
        {"char", int8},     {"int8", int8},      {"uchar", uint8},   {"uint8", uint8},   {"short", int16}, {"int16", int16},
        {"ushort", uint16}, {"uint16", uint16},  {"int", int32},     {"int32", int32},   {"uint", uint32}, {"uint32", uint32},
        {"float", real32},  {"float32", real32}, {"double", real64}, {"float64", real64}};
    for (const auto& [name, type] : names)
        if (word == name) return type;
    return std::nullopt;
}

struct Property {
    std::string name;
    Scalar type;
    std::optional<Scalar> count;  // a list's
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

enum class Encoding { Ascii, Little, Big };

class PlyReader {
public:
    PlyReader(const std::string& bytes, const std::string& name) : name_(name), words_(without_mark(bytes)) { read_header(); }

    PolyData read()
    {
        PolyData data;
        for (const Element& element : elements_) {
            check_room(element);
            if (element.name == "vertex") read_vertices(element, data);
            else if (element.name == "face") read_faces(element, data);
            else skip(element);
        }
        for (const std::int64_t index : data.polys.connectivity)
            if (index < 0 || index >= static_cast<std::int64_t>(data.points.size()))
                damaged(fmt::format("got vertex {} in a face; expected 0 to {}", index,
                                    static_cast<std::int64_t>(data.points.size()) - 1));
        return data;
    }

private:
    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error(ErrorKind::BadFile, fmt::format("{}: {}", name_, message));
    }
    [[noreturn]] void damaged(const std::string& what) const { refuse_damaged(name_, what); }

    Scalar scalar_in(TextWords& words, std::string_view line) const
    {
        if (const auto type = scalar_named(words.word())) return *type;
        damaged(fmt::format("PLY header: got \"{}\"; expected a type of PLY (float, double, int, uchar, ...)", excerpt(line)));
    }

    void read_header()
    {
        if (TextWords(words_.line()).word() != "ply")
            fail(
                "got no \"ply\" in its first line; expected a PLY file. Fix: name the file after its format, or export it again");
        bool format = false, end = false;
        while (!end && !words_.at_end()) {
            const std::string_view line = words_.line();
            TextWords words(line);
            const std::string_view key = words.word();
            if (key == "format") {
                read_format(words.word());
                format = true;
            } else if (key == "element") {
                read_element(words, line);
            } else if (key == "property") {
                read_property(words, line);
            } else if (key == "end_header") {
                end = true;
            } else if (!key.empty() && key != "comment" && key != "obj_info") {
                damaged(fmt::format("PLY header: got \"{}\"; expected format, element, property, comment or end_header",
                                    excerpt(line)));
            }
        }
        if (!end) damaged("PLY header: got no end_header; expected one in a line of its own");
        if (!format) damaged("PLY header: got no format; expected ascii, binary_little_endian or binary_big_endian");
        body_ = words_.rest();
        const auto faces = std::find_if(elements_.begin(), elements_.end(), [](const Element& e) { return e.name == "face"; });
        if (faces != elements_.end() && faces->count > 0) return;
        for (const Element& element : elements_)
            if (element.name == "tristrips")
                fail("got triangle strips; expected faces. Fix: open it in MeshLab or Blender and export it again");
        fail("got no faces; expected a surface. Fix: make a mesh of the points (MeshLab: Surface Reconstruction)");
    }

    void read_format(std::string_view word)
    {
        if (word == "ascii") encoding_ = Encoding::Ascii;
        else if (word == "binary_little_endian") encoding_ = Encoding::Little;
        else if (word == "binary_big_endian") encoding_ = Encoding::Big;
        else
            damaged(fmt::format("PLY header: got format \"{}\"; expected ascii, binary_little_endian or binary_big_endian",
                                excerpt(word)));
    }

    void read_element(TextWords& words, std::string_view line)
    {
        Element element;
        element.name = words.word();
        const std::string_view count = words.word();
        const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (error != std::errc{} || end != count.data() + count.size())
            damaged(fmt::format("PLY header: got \"{}\"; expected element NAME COUNT", excerpt(line)));
        elements_.push_back(std::move(element));
    }

    void read_property(TextWords& words, std::string_view line)
    {
        if (elements_.empty()) damaged("PLY header: got a property first; expected an element before it");
        Property property;
        TextWords look = words;
        if (look.word() == "list") {
            words.word();
            property.count = scalar_in(words, line);
        }
        property.type = scalar_in(words, line);
        property.name = words.word();
        elements_.back().properties.push_back(std::move(property));
    }

    /// The fewest bytes that a value can take.
    std::size_t least(Scalar type) const { return encoding_ == Encoding::Ascii ? 2 : type.bytes; }  // a digit and a space
    std::size_t room() const
    {
        return encoding_ == Encoding::Ascii ? words_.rest().size() + 1 : body_.size();  // the last digit needs no space
    }

    void check_room(const Element& element) const
    {
        std::size_t each = 0;
        for (const Property& p : element.properties) each += least(p.count ? *p.count : p.type);
        if (each > 0 && element.count > room() / each)
            damaged(fmt::format("got a header that announces {} x {}; expected no more than the file has bytes for",
                                element.count, excerpt(element.name)));
    }

    double value(Scalar type)
    {
        if (encoding_ == Encoding::Ascii) {
            const std::string_view word = words_.word();
            if (const auto read = number(word)) return *read;
            refuse_number(name_, "", excerpt(word));
        }
        if (body_.size() < type.bytes)
            damaged("got the end of the file in its data; expected as many values as the header announces");
        const char* from = body_.data();
        body_.remove_prefix(type.bytes);
        return with_type(
            type, [&](auto zero) { return static_cast<double>(number_at<decltype(zero)>(from, encoding_ == Encoding::Big)); });
    }

    std::size_t list_length(const Property& list)
    {
        const double n = value(*list.count);
        if (!(n >= 0) || n != std::floor(n) || n > static_cast<double>(room() / least(list.type)))
            damaged(fmt::format("got a list that announces {} items; expected no more than the file has bytes for", n));
        return static_cast<std::size_t>(n);
    }

    void skip(const Property& property)
    {
        const std::size_t n = property.count ? list_length(property) : 1;
        for (std::size_t k = 0; k < n; ++k) (void)value(property.type);
    }
    void skip(const Element& element)
    {
        if (element.properties.empty()) return;
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const Property& property : element.properties) skip(property);
    }

    void read_vertices(const Element& element, PolyData& data)
    {
        int axis_of[3] = {-1, -1, -1};
        for (std::size_t p = 0; p < element.properties.size(); ++p)
            for (int d = 0; d < 3; ++d)
                if (!element.properties[p].count && element.properties[p].name == std::string(1, static_cast<char>('x' + d)))
                    axis_of[d] = static_cast<int>(p);
        if (std::min({axis_of[0], axis_of[1], axis_of[2]}) < 0)
            fail("got vertices without x, y and z; expected all three. Fix: export the mesh again");
        data.points.reserve(data.points.size() + element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            std::array<double, 3> point{};
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                const auto axis = std::find(axis_of, axis_of + 3, static_cast<int>(p));
                if (axis == axis_of + 3) skip(element.properties[p]);
                else point[static_cast<std::size_t>(axis - axis_of)] = value(element.properties[p].type);
            }
            data.points.push_back(point);
        }
    }

    static bool is_corners(const Property& p) { return p.count && (p.name == "vertex_indices" || p.name == "vertex_index"); }

    void read_faces(const Element& element, PolyData& data)
    {
        if (std::count_if(element.properties.begin(), element.properties.end(), is_corners) != 1)
            fail("got faces without a list vertex_indices; expected one. Fix: export the mesh again");
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const Property& property : element.properties) {
                if (!is_corners(property)) {
                    skip(property);
                    continue;
                }
                const std::size_t n = list_length(property);
                for (std::size_t k = 0; k < n; ++k) data.polys.connectivity.push_back(corner(property.type));
                data.polys.offsets.push_back(static_cast<std::int64_t>(data.polys.connectivity.size()));
            }
    }

    std::int64_t corner(Scalar type)
    {
        const double index = value(type);
        if (!(std::abs(index) <= 4294967295.0) || index != std::floor(index))
            damaged(fmt::format("got {}; expected the number of a face's vertex", index));
        return static_cast<std::int64_t>(index);
    }

    const std::string& name_;
    TextWords words_;
    std::string_view body_;  // of a binary file: what is not read yet
    std::vector<Element> elements_;
    Encoding encoding_ = Encoding::Ascii;
};

}  // namespace

PolyData parse_ply(const std::string& bytes, const std::string& name) { return PlyReader(bytes, name).read(); }

}  // namespace seldinger
