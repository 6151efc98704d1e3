// Reading .vtp. The format: VTK File Formats, "XML File Formats", and vtkXMLDataParser for what it leaves open.
#include "core/error.h"
#include "scene/vtk_polydata.h"

#include <pugixml.hpp>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace seldinger {

void bad_file(const std::filesystem::path& path, const std::string& message)
{
    throw Error(ExitCode::BadFile, fmt::format("{}: {}", path.string(), message));
}

std::string read_whole_file(const std::filesystem::path& path)
{
    std::error_code code;
    if (!std::filesystem::exists(path, code)) bad_file(path, "no such file");
    if (std::filesystem::is_directory(path, code)) bad_file(path, "is a folder, a mesh file is expected");
    std::ifstream in(path, std::ios::binary);
    if (!in) bad_file(path, "cannot be opened for reading");
    std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    if (in.bad()) bad_file(path, "reading it failed");
    if (bytes.empty()) bad_file(path, "the file is empty");
    return bytes;
}

std::string base64_encode(std::string_view bytes)
{
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= bytes.size() - i ? kDigits[(group >> (18 - 6 * k)) & 63] : '=';
    }
    return text;
}

namespace {

/// Bytes of base64 text. Padding may stand inside: VTK encodes an array's header and its data one after the other.
/// Stops at the first character that is no base64.
std::string base64_decode(std::string_view text)
{
    static const auto table = [] {
        std::array<std::int8_t, 256> t;
        t.fill(-1);
        for (int i = 0; i < 26; ++i) { t[static_cast<std::size_t>('A' + i)] = static_cast<std::int8_t>(i);
                                       t[static_cast<std::size_t>('a' + i)] = static_cast<std::int8_t>(26 + i); }
        for (int i = 0; i < 10; ++i) t[static_cast<std::size_t>('0' + i)] = static_cast<std::int8_t>(52 + i);
        t['+'] = 62;
        t['/'] = 63;
        return t;
    }();
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t group = 0;
    int digits = 0, padding = 0;
    for (const char c : text) {
        if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
        const int value = table[static_cast<unsigned char>(c)];
        if (c == '=') ++padding;
        else if (value < 0 || padding > 0) break;
        group = group << 6 | static_cast<std::uint32_t>(std::max(value, 0));
        if (++digits < 4) continue;
        for (int k = 0; k < 3 - padding; ++k) bytes += static_cast<char>(group >> (16 - 8 * k) & 255);
        group = 0;
        digits = padding = 0;
    }
    return bytes;
}

template <class T>
T swapped(T value)
{
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    std::reverse(bytes.begin(), bytes.end());
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
}

class VtpReader {
public:
    explicit VtpReader(const std::filesystem::path& path) : path_(path), file_(read_whole_file(path))
    {
        cut_appended_data();
        const pugi::xml_parse_result parsed = document_.load_buffer(file_.data(), file_.size());
        if (!parsed) fail(fmt::format("not well-formed XML at byte {} ({}); the file may be truncated", parsed.offset, parsed.description()));
        read_header();
    }

    VtkPolyData read()
    {
        VtkPolyData data;
        std::size_t pieces = 0;
        for (const pugi::xml_node piece : document_.child("VTKFile").child("PolyData").children("Piece")) {
            read_piece(piece, data);
            ++pieces;
        }
        if (pieces == 0) fail("no <Piece> in <PolyData>");
        return data;
    }

private:
    [[noreturn]] void fail(const std::string& message) const { bad_file(path_, message); }

    /// Raw appended bytes are not XML: they are cut out between the underscore and the closing tag.
    void cut_appended_data()
    {
        const std::size_t tag = file_.find("<AppendedData");
        if (tag == std::string::npos) return;
        const std::size_t open_end = file_.find('>', tag), underscore = file_.find('_', open_end);
        const std::size_t close = file_.rfind("</AppendedData>");
        if (open_end == std::string::npos || underscore == std::string::npos || close == std::string::npos || close < underscore)
            fail("<AppendedData> has no end; the file is truncated");
        const std::string_view head(file_.data() + tag, open_end - tag);
        appended_is_base64_ = head.find("base64") != std::string_view::npos;
        appended_ = file_.substr(underscore + 1, close - underscore - 1);
        has_appended_ = true;
        file_.erase(open_end + 1, close - open_end - 1);
    }

    void read_header()
    {
        const pugi::xml_node root = document_.child("VTKFile");
        if (!root) fail("no <VTKFile> element");
        if (std::string_view(root.attribute("type").value()) != "PolyData")
            fail(fmt::format("holds {}, PolyData is expected", root.attribute("type").value()));
        const std::string_view order = root.attribute("byte_order").as_string("LittleEndian");
        swap_ = (order == "BigEndian") != (std::endian::native == std::endian::big);
        wide_header_ = std::string_view(root.attribute("header_type").as_string("UInt32")) == "UInt64";
        const std::string_view compressor = root.attribute("compressor").value();
        compressed_ = !compressor.empty();
        if (compressed_ && compressor != "vtkZLibDataCompressor")
            fail(fmt::format("compressed with {}; write it with zlib or without compression", compressor));
    }

    [[nodiscard]] std::uint64_t header_word(const std::string& bytes, std::size_t index, const std::string& name) const
    {
        const std::size_t width = wide_header_ ? 8 : 4;
        if (bytes.size() < (index + 1) * width) fail(fmt::format("array {} is cut off in its header", name));
        if (wide_header_) {
            std::uint64_t word;
            std::memcpy(&word, bytes.data() + index * 8, 8);
            return swap_ ? swapped(word) : word;
        }
        std::uint32_t word;
        std::memcpy(&word, bytes.data() + index * 4, 4);
        return swap_ ? swapped(word) : word;
    }

    /// Takes the header off and inflates. `stream` may run on behind the array.
    [[nodiscard]] std::string unpack(const std::string& stream, const std::string& name) const
    {
        const std::size_t width = wide_header_ ? 8 : 4;
        const std::uint64_t first = header_word(stream, 0, name);
        if (!compressed_) {
            if (stream.size() - width < first)
                fail(fmt::format("array {} is cut off: {} bytes announced, {} there", name, first, stream.size() - width));
            return stream.substr(width, first);
        }
        if (first == 0) return {};
        const std::uint64_t block_size = header_word(stream, 1, name), last_size = header_word(stream, 2, name);
        if (first > stream.size() / width) fail(fmt::format("array {} is cut off: {} blocks announced", name, first));
        std::size_t at = (3 + first) * width;
        std::string bytes;
        for (std::uint64_t block = 0; block < first; ++block) {
            const std::uint64_t packed = header_word(stream, 3 + block, name);
            const std::uint64_t size = block + 1 == first && last_size != 0 ? last_size : block_size;
            if (at > stream.size() || packed > stream.size() - at)
                fail(fmt::format("array {} is cut off in block {} of {}", name, block + 1, first));
            // zlib expands at most 1032-fold: a larger promise is a broken header, and would ask for absurd memory
            if (size > 1032 * packed + 64) fail(fmt::format("array {} has a broken header in block {}", name, block + 1));
            const std::size_t before = bytes.size();
            bytes.resize(before + size);
            uLongf got = size;
            if (uncompress(reinterpret_cast<Bytef*>(bytes.data() + before), &got, reinterpret_cast<const Bytef*>(stream.data() + at),
                           packed) != Z_OK || got != size)
                fail(fmt::format("array {} does not decompress in block {} of {}", name, block + 1, first));
            at += packed;
        }
        return bytes;
    }

    template <class Source, class Target>
    void convert(const std::string& bytes, std::vector<Target>& values, const std::string& name) const
    {
        if (bytes.size() % sizeof(Source) != 0) fail(fmt::format("array {} has {} bytes, not whole values", name, bytes.size()));
        values.resize(bytes.size() / sizeof(Source));
        for (std::size_t i = 0; i < values.size(); ++i) {
            Source value;
            std::memcpy(&value, bytes.data() + i * sizeof(Source), sizeof(Source));
            values[i] = static_cast<Target>(swap_ ? swapped(value) : value);
        }
    }

    template <class Target>
    [[nodiscard]] std::vector<Target> parse_ascii(std::string_view text, const std::string& name) const
    {
        std::vector<Target> values;
        const char *at = text.data(), *const end = at + text.size();
        while (true) {
            while (at < end && (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t')) ++at;
            if (at == end) return values;
            Target value{};
            const auto [next, error] = std::from_chars(at, end, value);
            if (error == std::errc::invalid_argument)
                fail(fmt::format("array {} holds \"{}\" where a number is expected", name, std::string(at, std::min(end, at + 12))));
            values.push_back(value);
            at = next;
        }
    }

    template <class Target>
    [[nodiscard]] std::vector<Target> read_array(const pugi::xml_node array) const
    {
        const std::string name = fmt::format("\"{}\"", array.attribute("Name").as_string("Points"));
        if (!array) fail("a <DataArray> is missing");
        const std::string_view format = array.attribute("format").as_string("ascii");
        if (format == "ascii") return parse_ascii<Target>(array.child_value(), name);
        std::string bytes;
        if (format == "binary") {
            bytes = unpack(base64_decode(array.child_value()), name);
        } else if (format == "appended") {
            const std::uint64_t offset = array.attribute("offset").as_ullong();
            if (!has_appended_ || offset > appended_.size()) fail(fmt::format("array {} lies beyond the end of the appended data", name));
            // appended arrays need no copy of what follows them, but base64 must be decoded from its own start
            bytes = appended_is_base64_ ? unpack(base64_decode(std::string_view(appended_).substr(offset)), name)
                                        : unpack(appended_.substr(offset), name);
        } else {
            fail(fmt::format("array {} has unknown format \"{}\"", name, format));
        }
        std::vector<Target> values;
        const std::string_view type = array.attribute("type").value();
        if (type == "Float32") convert<float>(bytes, values, name);
        else if (type == "Float64") convert<double>(bytes, values, name);
        else if (type == "Int8") convert<std::int8_t>(bytes, values, name);
        else if (type == "UInt8") convert<std::uint8_t>(bytes, values, name);
        else if (type == "Int16") convert<std::int16_t>(bytes, values, name);
        else if (type == "UInt16") convert<std::uint16_t>(bytes, values, name);
        else if (type == "Int32") convert<std::int32_t>(bytes, values, name);
        else if (type == "UInt32") convert<std::uint32_t>(bytes, values, name);
        else if (type == "Int64") convert<std::int64_t>(bytes, values, name);
        else if (type == "UInt64") convert<std::uint64_t>(bytes, values, name);
        else fail(fmt::format("array {} has unknown type \"{}\"", name, type));
        return values;
    }

    void read_cells(const pugi::xml_node piece, const char* name, const char* count_name, std::size_t first_point, VtkCells& cells) const
    {
        const auto count = static_cast<std::size_t>(piece.attribute(count_name).as_ullong());
        const pugi::xml_node node = piece.child(name);
        if (count == 0) return;
        const auto connectivity = read_array<std::int64_t>(node.find_child_by_attribute("DataArray", "Name", "connectivity"));
        const auto offsets = read_array<std::int64_t>(node.find_child_by_attribute("DataArray", "Name", "offsets"));
        if (offsets.size() != count)
            fail(fmt::format("{} announces {} cells, its offsets hold {}", count_name, count, offsets.size()));
        if (offsets.back() != static_cast<std::int64_t>(connectivity.size()))
            fail(fmt::format("{}: offsets end at {}, {} indices are there", name, offsets.back(), connectivity.size()));
        const auto before = static_cast<std::int64_t>(cells.connectivity.size());
        for (const std::int64_t index : connectivity) cells.connectivity.push_back(index + static_cast<std::int64_t>(first_point));
        for (const std::int64_t offset : offsets) cells.offsets.push_back(before + offset);
    }

    void read_piece(const pugi::xml_node piece, VtkPolyData& data) const
    {
        const std::size_t first_point = data.points.size() / 3;
        const auto count = static_cast<std::size_t>(piece.attribute("NumberOfPoints").as_ullong());
        if (count == 0) return;
        const auto points = read_array<double>(piece.child("Points").child("DataArray"));
        if (points.size() != 3 * count)
            fail(fmt::format("NumberOfPoints is {}, but {} coordinates are there ({} expected)", count, points.size(), 3 * count));
        data.points.insert(data.points.end(), points.begin(), points.end());
        read_cells(piece, "Polys", "NumberOfPolys", first_point, data.polygons);
        read_cells(piece, "Strips", "NumberOfStrips", first_point, data.strips);
        read_cells(piece, "Lines", "NumberOfLines", first_point, data.lines);
        for (const pugi::xml_node array : piece.child("PointData").children("DataArray")) {
            if (array.attribute("NumberOfComponents").as_uint(1) != 1 || std::string_view(array.attribute("type").value()) == "String") continue;
            auto& scalars = data.point_scalars[array.attribute("Name").value()];
            scalars.resize(first_point, 0.0);  // a piece before may lack this array
            const auto values = read_array<double>(array);
            if (values.size() != count)
                fail(fmt::format("point array \"{}\" holds {} values for {} points", array.attribute("Name").value(), values.size(), count));
            scalars.insert(scalars.end(), values.begin(), values.end());
        }
    }

    std::filesystem::path path_;
    std::string file_, appended_;
    pugi::xml_document document_;
    bool has_appended_ = false, appended_is_base64_ = false, swap_ = false, wide_header_ = false, compressed_ = false;
};

}  // namespace

void check_cells(const std::filesystem::path& path, const VtkCells& cells, std::size_t point_count, const char* name)
{
    for (std::size_t i = 0; i < cells.size(); ++i)
        if (cells.offsets[i + 1] < cells.offsets[i] || cells.offsets[i + 1] > static_cast<std::int64_t>(cells.connectivity.size()))
            bad_file(path, fmt::format("{} {}: its offsets run backwards or past the end", name, i));
    for (const std::int64_t index : cells.connectivity)
        if (index < 0 || index >= static_cast<std::int64_t>(point_count))
            bad_file(path, fmt::format("a {} names point {}, only 0 to {} exist", name, index, static_cast<std::int64_t>(point_count) - 1));
}

VtkPolyData read_vtp(const std::filesystem::path& path) { return VtpReader(path).read(); }

}  // namespace seldinger
