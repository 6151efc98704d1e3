// Reading legacy .vtk polydata. The format: VTK File Formats, "Simple Legacy Formats"; binary values are big-endian.
#include "io/vtp_read.h"

#include "core/error.h"
#include "io/binary_text.h"
#include "io/damaged_file.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>

namespace seldinger {
namespace {

class LegacyReader {
public:
    LegacyReader(const std::string& bytes, const std::string& name, PolyParts parts) : name_(name), file_(bytes), parts_(parts) {}

    PolyData read()
    {
        PolyData data;
        read_header(data);
        for (std::string key = lower_case(word()); !key.empty(); key = lower_case(word())) {
            if (parts_ == PolyParts::Remarks && key == "points") return data;
            if (key == "point_data" || key == "cell_data") {
                if (parts_ != PolyParts::All) break;
                read_attributes(key == "point_data" ? data.point_data : data.cell_data, data);
            } else if (!read_section(key, data)) {
                refuse_section(key);
            }
        }
        if (data.points.empty()) damaged("got no POINTS section; expected one");
        for (const PolyCells* cells : {&data.polys, &data.strips, &data.lines, &data.verts})
            check_cells(*cells, data.points.size());
        return data;
    }

private:
    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error(ErrorKind::BadFile, fmt::format("{}: {}", name_, message));
    }
    [[noreturn]] void damaged(const std::string& what) const { refuse_damaged(name_, what); }
    [[noreturn]] void cut_off(const char* section, std::size_t announced, const char* what, std::size_t there) const
    {
        damaged(fmt::format("{} is cut off: got {} {}; expected {}", section, there, what, announced));
    }

    std::string line()
    {
        const std::size_t end = std::min(file_.find('\n', at_), file_.size());
        std::string text = file_.substr(at_, end - at_);
        at_ = std::min(end + 1, file_.size());
        if (!text.empty() && text.back() == '\r') text.pop_back();
        return text;
    }
    static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
    std::string word()
    {
        while (at_ < file_.size() && is_space(file_[at_])) ++at_;
        const std::size_t start = at_;
        while (at_ < file_.size() && !is_space(file_[at_])) ++at_;
        return file_.substr(start, at_ - start);
    }
    std::size_t count(const char* section)
    {
        const std::string text = word();
        std::size_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc{} || end != text.data() + text.size())
            damaged(fmt::format("{}: got \"{}\"; expected a count", section, excerpt(text)));
        // even a digit and a blank per item would not fit: the count lies, and must not size a buffer
        if (value > file_.size() / 2)
            damaged(
                fmt::format("got {}, which announces {} items; expected no more than the file has bytes for", section, value));
        return value;
    }
    [[noreturn]] void refuse_section(const std::string& key) const
    {
        fail(fmt::format("got \"{}\"; expected a section of polydata (POINTS, POLYGONS, TRIANGLE_STRIPS, LINES, VERTICES, FIELD, "
                         "METADATA, POINT_DATA, CELL_DATA): the file is truncated or damaged. Fix: export it again, for example "
                         "from ParaView as .vtp",
                         excerpt(key)));
    }
    /// @return false: not a section of the geometry
    bool read_section(const std::string& key, PolyData& data)
    {
        if (key == "points") read_points(data);
        else if (key == "polygons") read_cells(data.polys, "POLYGONS");
        else if (key == "triangle_strips") read_cells(data.strips, "TRIANGLE_STRIPS");
        else if (key == "lines") read_cells(data.lines, "LINES");
        else if (key == "vertices") read_cells(data.verts, "VERTICES");
        else if (key == "metadata") skip_metadata();
        else if (key == "field") read_field(parts_ == PolyParts::All ? &data.field_data : nullptr, &data.remarks);
        else return false;
        return true;
    }
    void read_points(PolyData& data)
    {
        const std::size_t point_count = count("POINTS");
        const std::vector<double> xyz = values<double>(3 * point_count, lower_case(word()), "POINTS");
        for (std::size_t i = 0; i < point_count; ++i) data.points.push_back({xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
    }

    void read_header(PolyData& data)
    {
        if (line().rfind("# vtk DataFile", 0) != 0)
            fail(
                "got no \"# vtk DataFile\" in its first line; expected a legacy VTK file. Fix: name the file after its format, "
                "or export it again");
        data.remarks = line() + "\n";  // the title
        const std::string encoding = lower_case(word());
        if (encoding != "ascii" && encoding != "binary")
            damaged(fmt::format("got encoding \"{}\"; expected ASCII or BINARY", excerpt(encoding)));
        binary_ = encoding == "binary";
        if (lower_case(word()) != "dataset") damaged("got no DATASET line; expected DATASET POLYDATA");
        const std::string kind = word();
        if (lower_case(kind) != "polydata")
            fail(fmt::format("got DATASET {}; expected POLYDATA. Fix: extract its surface (ParaView: Extract Surface, VTK: "
                             "vtkGeometryFilter) and save that",
                             excerpt(kind)));
    }
    void skip_metadata()
    {
        line();
        while (at_ < file_.size() && !line().empty()) {
        }
    }

    template <class Target>
    std::vector<Target> binary_values(std::size_t n, Scalar stored, const char* section)
    {
        if (stored.kind == 'b') {  // flags are no quantity
            skip_bytes(bytes_of(stored, n), section);
            return std::vector<Target>(n);
        }
        line();  // data start behind the line's end
        if ((file_.size() - at_) / stored.bytes < n) cut_off(section, n, "values", (file_.size() - at_) / stored.bytes);
        std::vector<Target> result(n);
        with_type(stored, [&](auto zero) {
            for (Target& value : result) {
                value = safe_cast<Target>(number_at<decltype(zero)>(file_.data() + at_, true));
                at_ += stored.bytes;
            }
        });
        return result;
    }
    static bool parse(const std::string& text, double& value)
    {
        const auto read = number(text);
        value = read.value_or(0);
        return read.has_value();
    }
    static bool parse(const std::string& text, std::int64_t& value)
    {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc{} && end == text.data() + text.size();
    }
    template <class Target>
    std::vector<Target> values(std::size_t n, const std::string& type, const char* section)
    {
        if (binary_) return binary_values<Target>(n, scalar(type, section), section);
        std::vector<Target> result(n);
        for (std::size_t i = 0; i < n; ++i) {
            const std::string text = word();
            if (text.empty()) cut_off(section, n, "values", i);
            if (!parse(text, result[i])) refuse_number(name_, fmt::format("{}: ", section), excerpt(text));
        }
        return result;
    }

    /// Type words of VTK's own writers, in lower case. "long" has eight bytes where these are written (Linux, macOS).
    Scalar scalar(const std::string& type, const char* section) const
    {
        constexpr Scalar int8{'i', 1}, uint8{'u', 1}, int16{'i', 2}, uint16{'u', 2}, int32{'i', 4}, uint32{'u', 4}, int64{'i', 8},
            uint64{'u', 8}, real32{'f', 4}, real64{'f', 8}, bit{'b', 0};
        constexpr Scalar id = int32;  // VTK writes its own indices as int, whatever their width in memory
        constexpr std::pair<std::string_view, Scalar> names[] = {
            {"bit", bit},            {"char", int8},          {"signed_char", int8},     {"unsigned_char", uint8},
            {"short", int16},        {"unsigned_short", uint16}, {"int", int32},         {"unsigned_int", uint32},
            {"long", int64},         {"unsigned_long", uint64},  {"float", real32},      {"double", real64},
            {"vtkidtype", id},       {"vtktypeint8", int8},   {"vtktypeuint8", uint8},   {"vtktypeint16", int16},
            {"vtktypeuint16", uint16}, {"vtktypeint32", int32}, {"vtktypeuint32", uint32}, {"vtktypeint64", int64},
            {"vtktypeuint64", uint64}, {"vtktypefloat32", real32}, {"vtktypefloat64", real64}};
        for (const auto& [name, kind] : names)
            if (type == name) return kind;
        damaged(fmt::format("{}: got type \"{}\"; expected one of VTK's (float, double, int, vtktypeint64, unsigned_char, ...)",
                            section, excerpt(type)));
    }
    static std::size_t bytes_of(Scalar stored, std::size_t n) { return stored.kind == 'b' ? (n + 7) / 8 : n * stored.bytes; }
    void skip_bytes(std::size_t n, const char* section)
    {
        line();  // data start behind the line's end
        if (file_.size() - at_ < n) cut_off(section, n, "bytes", file_.size() - at_);
        at_ += n;
    }
    /// As values(), for numbers that nobody asks for.
    void skip_values(std::size_t n, const std::string& type)
    {
        if (binary_) return skip_bytes(bytes_of(scalar(type, "FIELD"), n), "FIELD");
        for (std::size_t i = 0; i < n; ++i)
            if (word().empty()) cut_off("FIELD", n, "values", i);
    }

    /// Names and ASCII strings have blanks and control characters as %20.
    static std::string decoded(std::string_view text)
    {
        std::string plain;
        for (std::size_t i = 0; i < text.size(); ++i) {
            unsigned value = 0;
            if (text[i] == '%' && i + 2 < text.size() &&
                std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16).ptr == text.data() + i + 3) {
                plain.push_back(static_cast<char>(value));
                i += 2;
            } else {
                plain.push_back(text[i]);
            }
        }
        return plain;
    }
    /// One string of a string array. Binary ones follow their length, whose first two bits tell its width.
    std::string string_value()
    {
        if (!binary_) return decoded(line());
        if (at_ >= file_.size()) damaged("FIELD is cut off in its strings: got the end of the file; expected more bytes");
        const auto first = static_cast<unsigned char>(file_[at_]);
        const std::size_t width = first >> 6 == 3 ? 1 : first >> 6 == 2 ? 2 : first >> 6 == 1 ? 4 : 8;
        if (file_.size() - at_ < width) damaged("FIELD is cut off in its strings: got the end of the file; expected more bytes");
        std::uint64_t length = first & 0x3fu;
        for (std::size_t k = 1; k < width; ++k) length = length << 8 | static_cast<unsigned char>(file_[at_ + k]);
        at_ += width;
        if (file_.size() - at_ < length) damaged("FIELD is cut off in its strings: got the end of the file; expected more bytes");
        at_ += length;
        return file_.substr(at_ - length, std::min<std::size_t>(length, most_remarks));
    }

    /// FIELD name n, then n arrays: name, components, tuples, type, values; each may have a METADATA block behind it.
    /// @param into     null: the numbers are skipped
    /// @param remarks  strings are added to it as NAME=value, as headers of STL files have them; may be null
    void read_field(std::map<std::string, PolyArray>* into, std::string* remarks)
    {
        word();  // the field's name
        for (std::size_t left = count("FIELD"); left > 0; --left) {
            std::string name = word();
            for (; lower_case(name) == "metadata"; name = word()) skip_metadata();
            name = decoded(name);
            if (name.empty()) damaged(fmt::format("FIELD is cut off: got no name; expected {} more arrays", left));
            const std::size_t components = count("FIELD"), tuples = count("FIELD");
            if (components > 0 && tuples > 8 * file_.size() / components)
                damaged(fmt::format("got FIELD, which announces {} x {} items; expected no more than the file has bytes for",
                                    components, tuples));
            const std::size_t n = components * tuples;
            const std::string type = lower_case(word());
            if (type == "string" || type == "vtkstdstring" || type == "utf8_string") {
                line();
                for (std::size_t k = 0; k < n; ++k) {
                    if (at_ >= file_.size()) cut_off("FIELD", n, "strings", k);
                    const std::string text = string_value();
                    if (remarks && remarks->size() < most_remarks) *remarks += name + "=" + text + "\n";
                }
            } else if (type == "variant") {  // text in both encodings: a type number and a value each
                for (std::size_t k = 0; k < 2 * n; ++k)
                    if (word().empty()) cut_off("FIELD", n, "variants", k / 2);
            } else if (into) {
                (*into)[name] = {static_cast<int>(std::max<std::size_t>(1, components)), values<double>(n, type, "FIELD")};
            } else {
                skip_values(n, type);
            }
        }
    }

    /// POINT_DATA n or CELL_DATA n, up to the next section.
    void read_attributes(std::map<std::string, PolyArray>& into, PolyData& data)
    {
        const std::size_t n = count("POINT_DATA");
        while (true) {
            const std::size_t back = at_;
            const std::string key = lower_case(word());
            if (key == "point_data" || key == "cell_data" || key.empty()) {
                at_ = back;
                return;
            }
            if (key == "field") read_field(&into, nullptr);
            else if (!read_attribute(key, n, into) && !read_section(key, data)) refuse_section(key);
        }
    }
    bool read_attribute(const std::string& key, std::size_t n, std::map<std::string, PolyArray>& into)
    {
        const auto take = [&](const std::string& name, const std::string& type, std::size_t components) {
            if (components > 8 * file_.size() / std::max<std::size_t>(n, 1))
                damaged(fmt::format("got {}, which announces {} components; expected no more than the file has bytes for",
                                    excerpt(name), components));
            into[decoded(name)] = {static_cast<int>(components), values<double>(n * components, type, "POINT_DATA")};
        };
        if (key == "scalars") {
            const std::string name = word(), type = lower_case(word());
            TextWords rest(std::string_view(file_).substr(at_));
            const std::string_view components = TextWords(rest.line()).word();  // left out: one
            const std::size_t width = components.empty() ? 1 : count("SCALARS");
            const std::size_t back = at_;
            if (lower_case(word()) == "lookup_table") word();
            else at_ = back;
            take(name, type, width);
        } else if (key == "color_scalars" || key == "lookup_table") {
            const std::string name = word();
            const std::size_t second = count("COLOR_SCALARS");
            const bool table = key == "lookup_table";
            if (!table && second > 8 * file_.size() / std::max<std::size_t>(n, 1))
                damaged(fmt::format(
                    "got COLOR_SCALARS, which announces {} components; expected no more than the file has bytes for", second));
            skip_values(table ? 4 * second : n * second, "unsigned_char");
        } else if (key == "texture_coordinates") {
            const std::string name = word();
            const std::size_t dimension = count("TEXTURE_COORDINATES");
            take(name, lower_case(word()), dimension);
        } else {
            constexpr std::pair<std::string_view, std::size_t> plain[] = {
                {"vectors", 3},    {"normals", 3},      {"tensors", 9},   {"tensors6", 6},
                {"global_ids", 1}, {"pedigree_ids", 1}, {"edge_flags", 1}};
            const auto* at = std::find_if(std::begin(plain), std::end(plain), [&](const auto& p) { return p.first == key; });
            if (at == std::end(plain)) return false;
            const std::string name = word();
            take(name, lower_case(word()), at->second);
        }
        return true;
    }

    void check_cells(const PolyCells& cells, std::size_t point_count) const
    {
        for (const std::int64_t index : cells.connectivity)
            if (index < 0 || index >= static_cast<std::int64_t>(point_count))
                damaged(fmt::format("got point {} in a cell; expected 0 to {}", index, point_count - 1));
        std::int64_t before = 0;
        for (const std::int64_t offset : cells.offsets) {
            if (offset < before || offset > static_cast<std::int64_t>(cells.connectivity.size()))
                damaged(fmt::format("got offset {} of cells; expected {} to {}", offset, before, cells.connectivity.size()));
            before = offset;
        }
    }

    void read_cells(PolyCells& cells, const char* section)
    {
        const std::size_t first = count(section), second = count(section);
        const std::size_t back = at_;
        if (lower_case(word()) == "offsets") {  // 5.1: first = offsets, second = connectivity
            cells.offsets = values<std::int64_t>(first, lower_case(word()), section);
            if (lower_case(word()) != "connectivity")
                damaged(fmt::format("{}: got no CONNECTIVITY; expected it after OFFSETS", section));
            cells.connectivity = values<std::int64_t>(second, lower_case(word()), section);
            if (!cells.offsets.empty()) cells.offsets.erase(cells.offsets.begin());  // they begin with 0; PolyCells does not
            return;
        }
        at_ = back;
        const auto list = values<std::int64_t>(second, "int", section);
        std::size_t at = 0;
        for (std::size_t cell = 0; cell < first; ++cell) {
            if (at >= list.size() || list[at] < 0 || static_cast<std::size_t>(list[at]) > list.size() - at - 1)
                damaged(fmt::format("{}: got cell {}, which runs past the end of the list; expected it inside", section, cell));
            const auto n = static_cast<std::size_t>(list[at]);
            cells.connectivity.insert(cells.connectivity.end(), list.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                                      list.begin() + static_cast<std::ptrdiff_t>(at + 1 + n));
            cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
            at += n + 1;
        }
    }

    const std::string& name_;
    const std::string& file_;
    PolyParts parts_;
    std::size_t at_ = 0;
    bool binary_ = false;
};

}  // namespace

PolyData parse_legacy_vtk(const std::string& bytes, const std::string& name, PolyParts parts)
{
    return LegacyReader(bytes, name, parts).read();
}

}  // namespace seldinger
