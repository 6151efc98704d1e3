// Parses VTK PolyData: XML by pugixml, arrays by encoding (ascii, base64, appended), blocks by zlib.
#include "io/vtp_read.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/binary_text.h"
#include "io/damaged_file.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <zlib.h>
#include <pugixml.hpp>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

static_assert(std::endian::native == std::endian::little, "binary arrays are copied as they lie in the file");

namespace seldinger {
namespace {

/// What all arrays of one file share.
struct FileFacts {
    std::string name;
    std::size_t header_bytes = 4;  // width of the lengths before a block
    std::string compressor;  // empty: none. Text does not use it, though writers name it
    bool appended_base64 = false;
    std::string_view appended;       // after the '_'
    mutable std::uint64_t room = 0;  // bytes that may still be taken, in all arrays together
};

[[noreturn]] void fail(const FileFacts& file, const std::string& what)
{
    throw Error(ErrorKind::BadFile, file.name + ": " + what);
}

/// Takes `bytes` off what the file may still fill.
void charge(const FileFacts& file, std::uint64_t bytes)
{
    if (bytes > file.room)
        fail(file, fmt::format("got arrays that unpack to more than {0} times the file's size; expected {0} times at most: "
                               "damaged, or made to fill "
                               "the memory. Fix: export the mesh again",
                               most_unpacked));
    file.room -= bytes;
}

/// Decodes base64 from the front of `text` until `wanted` bytes are there or the text ends; spaces are skipped. '=' ends one
/// encoded run and another may follow. @param used  characters taken
std::string decode_base64(std::string_view text, std::size_t wanted, std::size_t& used)
{
    const auto value = [](char c) {
        if (c >= 'A' && c <= 'Z') return c - 'A';
        if (c >= 'a' && c <= 'z') return c - 'a' + 26;
        if (c >= '0' && c <= '9') return c - '0' + 52;
        return c == '+' ? 62 : c == '/' ? 63 : -1;
    };
    std::string bytes;
    std::uint32_t bits = 0;
    int letters = 0, padding = 0;
    for (used = 0; used < text.size() && bytes.size() < wanted; ++used) {
        const int v = value(text[used]);
        if (v < 0 && text[used] != '=') continue;
        bits = (bits << 6) | static_cast<std::uint32_t>(v < 0 ? 0 : v);
        padding += v < 0;
        if (++letters < 4) continue;
        for (int k = 0; k < 3 - padding; ++k) bytes.push_back(static_cast<char>((bits >> (16 - 8 * k)) & 0xffu));
        bits = 0, letters = 0, padding = 0;
    }
    return bytes;
}

/// A run of bytes that is either raw or base64 text.
class ByteSource {
public:
    ByteSource(const FileFacts& file, std::string_view bytes, bool base64) : file_(file), bytes_(bytes), base64_(base64) {}

    /// The next `count` bytes. Base64 comes in groups of three bytes: what the last group held beyond `count` is kept for the
    /// next call, so lengths and data may be encoded together or one after the other.
    std::string take(std::size_t count)
    {
        std::string out = surplus_.substr(0, count);
        surplus_.erase(0, out.size());
        std::size_t used = count - out.size();
        if (base64_ && used > 0) {
            out += decode_base64(bytes_, count - out.size(), used);
        } else {
            out += bytes_.substr(0, used);
        }
        if (out.size() < count)
            refuse_damaged(file_.name, fmt::format("got an array of {} bytes; expected {}", out.size(), count));
        charge(file_, used);
        bytes_.remove_prefix(std::min(used, bytes_.size()));
        surplus_ += out.substr(count);
        out.resize(count);
        return out;
    }

private:
    const FileFacts& file_;
    std::string_view bytes_;
    bool base64_;
    std::string surplus_;
};

std::uint64_t read_length(const std::string& bytes, std::size_t index, std::size_t width)
{
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + index * width, width);
    return length;
}

/// [blocks][block size][last block's size, 0: full][compressed size of each], then the blocks.
std::string take_compressed(const FileFacts& file, ByteSource& source)
{
    constexpr std::uint64_t most_blocks = 1u << 26;
    const std::size_t width = file.header_bytes;
    std::string head = source.take(3 * width);
    const std::uint64_t blocks = read_length(head, 0, width), full = read_length(head, 1, width),
                        last = read_length(head, 2, width);
    if (blocks == 0) return {};
    if (blocks > most_blocks || full > (1ull << 32))
        refuse_damaged(file.name, fmt::format("got a compressed array of {} x {} bytes; expected {} blocks of 4 GiB at most",
                                              blocks, full, most_blocks));
    const std::string sizes = source.take(blocks * width);
    std::string out;
    for (std::uint64_t i = 0; i < blocks; ++i) {
        const std::string packed = source.take(read_length(sizes, i, width));
        uLongf size = static_cast<uLongf>(i + 1 == blocks && last ? last : full);
        // zlib unpacks at most 1032-fold: a larger promise is a damaged length, and would ask for absurd memory
        if (size > 1032 * packed.size() + 64)
            refuse_damaged(file.name, fmt::format("got {} bytes that unpack to {}; expected 1032 times as many at most",
                                                  packed.size(), size));
        charge(file, size);
        const std::size_t start = out.size();
        out.resize(start + size);
        if (uncompress(reinterpret_cast<Bytef*>(out.data() + start), &size, reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())) != Z_OK) {
            refuse_damaged(file.name, "got a compressed array that does not unpack; expected data of zlib");
        }
        out.resize(start + size);
    }
    return out;
}

std::string take_block(const FileFacts& file, std::string_view bytes, bool base64)
{
    ByteSource source(file, bytes, base64);
    if (file.compressor == "vtkZLibDataCompressor") return take_compressed(file, source);
    if (!file.compressor.empty())
        fail(file, fmt::format("got data compressed by {}; expected zlib or none. Fix: save it again with \"Compressor Type\" "
                               "ZLib or None (ParaView)",
                               excerpt(file.compressor)));
    const std::uint64_t count = read_length(source.take(file.header_bytes), 0, file.header_bytes);
    if (count > bytes.size())
        refuse_damaged(file.name, fmt::format("got an array that announces {} bytes; expected no more than the file has", count));
    return source.take(count);
}

template <typename Stored, typename Wanted>
void convert(const FileFacts& file, const std::string& bytes, std::vector<Wanted>& values)
{
    const std::size_t count = bytes.size() / sizeof(Stored);
    charge(file, sizeof(Wanted) * static_cast<std::uint64_t>(count));
    values.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        Stored v;
        std::memcpy(&v, bytes.data() + i * sizeof(Stored), sizeof(Stored));
        values[i] = safe_cast<Wanted>(v);
    }
}

template <typename Wanted>
void convert_named(const FileFacts& file, const std::string& type, const std::string& bytes, std::vector<Wanted>& values)
{
    constexpr std::pair<std::string_view, Scalar> names[] = {
        {"Float64", {'f', 8}}, {"Float32", {'f', 4}}, {"Int64", {'i', 8}},  {"UInt64", {'u', 8}}, {"Int32", {'i', 4}},
        {"UInt32", {'u', 4}},  {"Int16", {'i', 2}},   {"UInt16", {'u', 2}}, {"Int8", {'i', 1}},   {"UInt8", {'u', 1}}};
    for (const auto& [name, stored] : names)
        if (type == name) return with_type(stored, [&](auto zero) { convert<decltype(zero)>(file, bytes, values); });
    refuse_damaged(
        file.name,
        fmt::format("got an array of type \"{}\"; expected one of VTK's (Float64, Float32, Int64, UInt8, ...)", excerpt(type)));
}

template <typename Wanted>
void parse_ascii(const FileFacts& file, std::string_view text, std::vector<Wanted>& values)
{
    const char *at = text.data(), *end = text.data() + text.size();
    while (true) {
        while (at != end && (*at == ' ' || *at == '\n' || *at == '\t' || *at == '\r')) ++at;
        if (at == end) return;
        Wanted v{};
        const auto [after, problem] = std::from_chars(at, end, v);
        if (problem != std::errc() || after == at) {
            const std::size_t begin = text.find_last_of(" \n\t\r", static_cast<std::size_t>(at - text.data()));
            const std::string_view rest = text.substr(begin == std::string_view::npos ? 0 : begin + 1);
            refuse_number(file.name, "", excerpt(rest.substr(0, rest.find_first_of(" \n\t\r"))));
        }
        values.push_back(v);
        at = after;
    }
}

template <typename Wanted>
std::vector<Wanted> read_values(const FileFacts& file, const pugi::xml_node& array, std::string type = {})
{
    std::vector<Wanted> values;
    if (type.empty()) type = array.attribute("type").as_string();
    const std::string format = array.attribute("format").as_string("ascii");
    const std::string_view text = array.text().get();
    if (type == "String") return values;
    if (format == "ascii") {
        parse_ascii(file, text, values);
    } else if (format == "binary") {
        convert_named(file, type, take_block(file, text, true), values);
    } else if (format == "appended") {
        const auto offset = array.attribute("offset").as_ullong();
        if (offset >= file.appended.size())
            refuse_damaged(file.name, fmt::format("got an array at offset {}, beyond the end of the file; expected less than {}",
                                                  offset, file.appended.size()));
        convert_named(file, type, take_block(file, file.appended.substr(offset), file.appended_base64), values);
    } else {
        refuse_damaged(file.name, fmt::format("got array format \"{}\"; expected ascii, binary or appended", excerpt(format)));
    }
    return values;
}

void read_named(const FileFacts& file, const pugi::xml_node& parent, std::map<std::string, PolyArray>& arrays)
{
    for (const pugi::xml_node& node : parent.children("DataArray")) {
        PolyArray& array = arrays[node.attribute("Name").as_string()];
        array.components = std::max(1, node.attribute("NumberOfComponents").as_int(1));
        const std::vector<double> values = read_values<double>(file, node);
        array.values.insert(array.values.end(), values.begin(), values.end());
    }
}

/// An array of strings: VTK writes Array, others DataArray.
bool is_text(const pugi::xml_node& node)
{
    const std::string_view name = node.name();
    return (name == "Array" || name == "DataArray") && node.attribute("type").as_string() == std::string_view("String");
}

/// Strings of the cells, one each.
void read_names(const FileFacts& file, const pugi::xml_node& parent, std::map<std::string, std::vector<std::string>>& names)
{
    for (const pugi::xml_node& node : parent.children()) {
        if (!is_text(node)) continue;
        std::vector<std::string>& list = names[node.attribute("Name").as_string()];
        std::string text;
        for (const std::uint8_t c : read_values<std::uint8_t>(file, node, "UInt8")) {
            if (c != 0) text.push_back(static_cast<char>(c));
            else list.push_back(std::exchange(text, {}));
        }
    }
}

/// Strings of the field data, as remarks. VTK stores their bytes, each string ended by 0.
void read_strings(const FileFacts& file, const pugi::xml_node& parent, std::string& remarks)
{
    for (const pugi::xml_node& node : parent.children()) {
        if (!is_text(node) || remarks.size() >= most_remarks) continue;
        std::string text;
        for (const std::uint8_t c : read_values<std::uint8_t>(file, node, "UInt8")) {
            if (text.size() == most_remarks) break;
            text.push_back(c == 0 ? '\n' : static_cast<char>(c));
        }
        remarks += fmt::format("{}={}\n", node.attribute("Name").as_string(), text);
    }
}

/// One of the two arrays of cells, gathered from all nodes of that name.
std::vector<std::int64_t> read_indices(const FileFacts& file, const pugi::xml_node& cells, const char* name)
{
    std::vector<std::int64_t> all;
    for (const pugi::xml_node& node : cells.children("DataArray")) {
        if (node.attribute("Name").as_string() != std::string_view(name)) continue;
        const std::vector<std::int64_t> values = read_values<std::int64_t>(file, node);
        all.insert(all.end(), values.begin(), values.end());
    }
    return all;
}

void read_cells(const FileFacts& file, const pugi::xml_node& piece, const char* kind, std::int64_t first_point,
                std::int64_t points, PolyCells& cells)
{
    const std::vector<std::int64_t> connectivity = read_indices(file, piece.child(kind), "connectivity"),
                                    offsets = read_indices(file, piece.child(kind), "offsets");
    const auto shift = static_cast<std::int64_t>(cells.connectivity.size()),
               count = static_cast<std::int64_t>(connectivity.size());
    for (const std::int64_t v : connectivity) {
        if (v < 0 || v >= points)
            refuse_damaged(file.name, fmt::format("{}: got point {}, which is not there; expected 0 to {}", kind, v, points - 1));
        cells.connectivity.push_back(v + first_point);
    }
    std::int64_t before = 0;
    for (const std::int64_t offset : offsets) {
        if (offset < before || offset > count)
            refuse_damaged(file.name, fmt::format("{}: got offset {}; expected {} to {}", kind, offset, before, count));
        cells.offsets.push_back(offset + shift);
        before = offset;
    }
    if (before != count)
        refuse_damaged(file.name,
                       fmt::format("{}: got offsets that end at {}; expected the number of indices, {}", kind, before, count));
    const pugi::xml_attribute announced = piece.attribute((std::string("NumberOf") + kind).c_str());
    if (announced && announced.as_ullong() != offsets.size())
        refuse_damaged(file.name, fmt::format("NumberOf{}: got {}; expected {}, as many as there are", kind,
                                              excerpt(announced.value()), offsets.size()));
}

void read_piece(const FileFacts& file, const pugi::xml_node& piece, PolyParts parts, PolyData& data)
{
    const auto first_point = static_cast<std::int64_t>(data.points.size());
    const std::vector<double> xyz = read_values<double>(file, piece.child("Points").child("DataArray"));
    const std::uint64_t count = piece.attribute("NumberOfPoints").as_ullong();
    if (xyz.size() % 3 != 0 || xyz.size() / 3 != count)  // 3 x count may be beyond 64 bits
        refuse_damaged(file.name, fmt::format("got {} coordinates; expected 3 x {}", xyz.size(), count));
    for (std::size_t i = 0; i < count; ++i) data.points.push_back({xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
    const auto points = static_cast<std::int64_t>(count);
    read_cells(file, piece, "Verts", first_point, points, data.verts);
    read_cells(file, piece, "Lines", first_point, points, data.lines);
    read_cells(file, piece, "Strips", first_point, points, data.strips);
    read_cells(file, piece, "Polys", first_point, points, data.polys);
    if (parts == PolyParts::Geometry) return;
    read_named(file, piece.child("PointData"), data.point_data);
    read_named(file, piece.child("CellData"), data.cell_data);
    read_names(file, piece.child("CellData"), data.cell_names);
}

}  // namespace

PolyData parse_poly_data(const std::string& bytes, const std::string& name, PolyParts parts)
{
    FileFacts file;
    file.name = name;
    file.room = std::max(most_unpacked * static_cast<std::uint64_t>(bytes.size()), kLeastUnpacked);
    // raw appended bytes are not XML: cut them off before parsing, and close the element they were in
    std::string xml = bytes;
    const std::size_t tail = bytes.find("<AppendedData");
    if (tail != std::string::npos) {
        const std::size_t opened = bytes.find('>', tail), start = bytes.find('_', opened);
        if (start == std::string::npos) refuse_damaged(file.name, "got no '_' in AppendedData; expected one before the data");
        file.appended = std::string_view(bytes).substr(start + 1);
        file.appended_base64 = bytes.substr(tail, opened - tail).find("base64") != std::string::npos;
        xml = bytes.substr(0, tail) + "</VTKFile>";
    }
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
    const pugi::xml_node root = document.child("VTKFile");
    if (!parsed || !root)
        fail(file, fmt::format("got no VTK XML file ({}); expected one. Fix: name the file after its format, or export it again",
                               parsed.description()));
    if (const std::string type = root.attribute("type").as_string(); type != "PolyData")
        fail(file,
             fmt::format(
                 "got \"{}\"; expected PolyData. Fix: extract its surface (ParaView: Extract Surface) and save that as .vtp",
                 excerpt(type)));
    if (root.attribute("byte_order").as_string("LittleEndian") != std::string("LittleEndian"))
        fail(file,
             "got big-endian data; expected little-endian. Fix: open it in ParaView and save it again with \"Byte Order\" "
             "little-endian");
    file.header_bytes = root.attribute("header_type").as_string() == std::string("UInt64") ? 8 : 4;
    file.compressor = root.attribute("compressor").as_string();

    PolyData data;
    const pugi::xml_node poly = root.child("PolyData");
    if (parts == PolyParts::All) read_named(file, poly.child("FieldData"), data.field_data);
    read_strings(file, poly.child("FieldData"), data.remarks);
    if (parts == PolyParts::Remarks) return data;
    for (const pugi::xml_node& piece : poly.children("Piece")) read_piece(file, piece, parts, data);
    return data;
}

PolyData read_poly_data(const FilePlace& place, PolyParts parts)
{
    return parse_poly_data(read_file(place), place.path().string(), parts);
}

}  // namespace seldinger
