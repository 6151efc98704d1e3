// Reading legacy .vtk polydata. The format: VTK File Formats, "Simple Legacy Formats"; binary values are big-endian.
#include "io/vtk_legacy.h"

#include "core/error.h"
#include "io/safe_cast.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

namespace seldinger {
namespace {

class LegacyReader {
public:
    LegacyReader(const std::string& bytes, const std::string& name) : name_(name), file_(bytes) {}

    PolyData read()
    {
        read_header();
        PolyData data;
        for (std::string key = lower(word()); !key.empty(); key = lower(word())) {
            if (key == "points") {
                const std::size_t point_count = count("POINTS");
                const std::vector<double> xyz = values<double>(3 * point_count, lower(word()), "POINTS");
                for (std::size_t i = 0; i < point_count; ++i) data.points.push_back({xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
            } else if (key == "polygons") read_cells(data.polys, "POLYGONS");
            else if (key == "triangle_strips") read_cells(data.strips, "TRIANGLE_STRIPS");
            else if (key == "lines") read_cells(data.lines, "LINES");
            else if (key == "vertices") read_cells(data.verts, "VERTICES");
            else if (key == "metadata") skip_metadata();
            else if (key == "cell_data" || key == "point_data" || key == "field") break;
            else
                fail(fmt::format("\"{}\" where a section of polydata is expected; the file may be truncated or damaged",
                                 excerpt(key)));
        }
        if (data.points.empty()) fail("no POINTS section");
        for (const PolyCells* cells : {&data.polys, &data.strips, &data.lines, &data.verts})
            check_cells(*cells, data.points.size());
        return data;
    }

private:
    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error(ExitCode::BadFile, fmt::format("{}: {}", name_, message));
    }

    static std::string lower(std::string text)
    {
        for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
        return text;
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
            fail(fmt::format("{}: \"{}\" where a count is expected", section, excerpt(text)));
        // even a digit and a blank per item would not fit: the count lies, and must not size a buffer
        if (value > file_.size() / 2) fail(fmt::format("{} announces {} items, more than the file has bytes", section, value));
        return value;
    }
    void read_header()
    {
        if (line().rfind("# vtk DataFile", 0) != 0) fail("does not begin with \"# vtk DataFile\"");
        line();  // title
        const std::string encoding = lower(word());
        if (encoding != "ascii" && encoding != "binary")
            fail(fmt::format("\"{}\" where ASCII or BINARY is expected", excerpt(encoding)));
        binary_ = encoding == "binary";
        if (lower(word()) != "dataset") fail("no DATASET line");
        const std::string kind = word();
        if (lower(kind) != "polydata") fail(fmt::format("holds DATASET {}, POLYDATA is expected", excerpt(kind)));
    }
    void skip_metadata()
    {
        line();
        while (at_ < file_.size() && !line().empty()) {
        }
    }

    template <class Source, class Target>
    std::vector<Target> binary_values(std::size_t n, const char* section)
    {
        line();  // data start behind the line's end
        if ((file_.size() - at_) / sizeof(Source) < n)
            fail(fmt::format("{} is cut off: {} values announced, {} there", section, n, (file_.size() - at_) / sizeof(Source)));
        std::vector<Target> result(n);
        for (std::size_t i = 0; i < n; ++i, at_ += sizeof(Source)) {
            char bytes[sizeof(Source)];
            std::memcpy(bytes, file_.data() + at_, sizeof(Source));
            if constexpr (std::endian::native == std::endian::little) std::reverse(bytes, bytes + sizeof(Source));
            Source value;
            std::memcpy(&value, bytes, sizeof(Source));
            result[i] = safe_cast<Target>(value);
        }
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
        if (binary_) {
            if (type == "float") return binary_values<float, Target>(n, section);
            if (type == "double") return binary_values<double, Target>(n, section);
            if (type == "int" || type == "vtktypeint32") return binary_values<std::int32_t, Target>(n, section);
            if (type == "vtktypeint64" || type == "long" || type == "vtkidtype")
                return binary_values<std::int64_t, Target>(n, section);
            fail(fmt::format("{} has type \"{}\"; float, double, int and vtktypeint64 are read", section, excerpt(type)));
        }
        std::vector<Target> result(n);
        for (std::size_t i = 0; i < n; ++i) {
            const std::string text = word();
            if (text.empty()) fail(fmt::format("{} is cut off: {} values announced, {} there", section, n, i));
            if (!parse(text, result[i])) fail(fmt::format("{}: \"{}\" where a number is expected", section, excerpt(text)));
        }
        return result;
    }

    void check_cells(const PolyCells& cells, std::size_t point_count) const
    {
        for (const std::int64_t index : cells.connectivity)
            if (index < 0 || index >= static_cast<std::int64_t>(point_count))
                fail(fmt::format("a cell names point {}, only 0 to {} exist", index, point_count - 1));
        std::int64_t before = 0;
        for (const std::int64_t offset : cells.offsets) {
            if (offset < before || offset > static_cast<std::int64_t>(cells.connectivity.size()))
                fail("offsets run backwards or past the end");
            before = offset;
        }
    }

    void read_cells(PolyCells& cells, const char* section)
    {
        const std::size_t first = count(section), second = count(section);
        const std::size_t back = at_;
        if (lower(word()) == "offsets") {  // 5.1: first = offsets, second = connectivity
            cells.offsets = values<std::int64_t>(first, lower(word()), section);
            if (lower(word()) != "connectivity") fail(fmt::format("{}: CONNECTIVITY is expected after OFFSETS", section));
            cells.connectivity = values<std::int64_t>(second, lower(word()), section);
            if (!cells.offsets.empty()) cells.offsets.erase(cells.offsets.begin());  // they begin with 0; PolyCells does not
            return;
        }
        at_ = back;
        const auto list = values<std::int64_t>(second, "int", section);
        std::size_t at = 0;
        for (std::size_t cell = 0; cell < first; ++cell) {
            if (at >= list.size() || list[at] < 0 || static_cast<std::size_t>(list[at]) > list.size() - at - 1)
                fail(fmt::format("{}: cell {} runs past the end of the list", section, cell));
            const auto n = static_cast<std::size_t>(list[at]);
            cells.connectivity.insert(cells.connectivity.end(), list.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                                      list.begin() + static_cast<std::ptrdiff_t>(at + 1 + n));
            cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
            at += n + 1;
        }
    }

    const std::string& name_;
    const std::string& file_;
    std::size_t at_ = 0;
    bool binary_ = false;
};

}  // namespace

PolyData parse_legacy_vtk(const std::string& bytes, const std::string& name) { return LegacyReader(bytes, name).read(); }

}  // namespace seldinger
