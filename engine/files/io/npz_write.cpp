// Writes .npy headers and arrays (numbers, fixed-width Unicode) into an uncompressed zip.
#include "io/npz_write.h"

#include "core/check.h"
#include "core/error.h"
#include "core/file_io.h"
#include "io/binary_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <functional>
#include <numeric>

namespace seldinger {
namespace {

/// Code points of a UTF-8 text; a byte that is not UTF-8 counts as one.
std::vector<std::uint32_t> code_points(const std::string& text)
{
    std::vector<std::uint32_t> points;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc0 ? 1 : 0;
        std::uint32_t point = more == 0 ? lead : lead & (0x3f >> more);
        bool whole = i + more < text.size();
        for (int k = 1; k <= more && whole; ++k) {
            const auto next = static_cast<unsigned char>(text[i + k]);
            whole = (next & 0xc0) == 0x80;
            point = point << 6 | (next & 0x3f);
        }
        points.push_back(whole ? point : lead);
        i += whole ? more + 1 : 1;
    }
    return points;
}

/// What the local header and the central directory say alike. Time stamp: 1980-01-01, so that the same table has the same bytes.
std::string common_header(const std::string& name, const std::string& content)
{
    std::string header;
    put_number(header, 20, 2);     // version needed
    put_number(header, 0x800, 2);  // names are UTF-8
    put_number(header, 0, 2);      // stored
    put_number(header, 0, 2);      // time
    put_number(header, 0x21, 2);   // date
    put_number(header, crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())), 4);
    put_number(header, content.size(), 4);
    put_number(header, content.size(), 4);
    put_number(header, name.size(), 2);
    put_number(header, 0, 2);  // no extra field
    return header;
}

std::string npy_file(const std::string& dtype, const std::vector<std::size_t>& shape, std::string_view data)
{
    std::string sizes = fmt::format("{}", fmt::join(shape, ", "));
    if (shape.size() == 1) sizes += ",";
    std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", dtype, sizes);
    header.append(63 - (10 + header.size()) % 64, ' ');  // data begin at a multiple of 64 bytes, after a line end
    header += '\n';
    std::string file("\x93NUMPY\x01\x00", 8);
    put_number(file, header.size(), 2);
    return file.append(header).append(data);
}

}  // namespace

void NpzWriter::add_array(const std::string& name, const std::string& dtype, const std::vector<std::size_t>& shape,
                          std::string_view data)
{
    entries_.push_back({name + ".npy", npy_file(dtype, shape, data)});
}

void NpzWriter::add(const std::string& name, std::span<const double> values)
{
    add_array(name, "<f8", {values.size()}, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

void NpzWriter::add(const std::string& name, std::span<const double> values, const std::vector<std::size_t>& shape)
{
    add_array(name, "<f8", shape, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

void NpzWriter::add(const std::string& name, std::span<const std::int64_t> values)
{
    add_array(name, "<i8", {values.size()}, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

void NpzWriter::add(const std::string& name, std::span<const std::string> values)
{
    std::size_t width = 1;
    std::vector<std::vector<std::uint32_t>> rows;
    for (const std::string& text : values) {
        rows.push_back(code_points(text));
        width = std::max(width, rows.back().size());
    }
    std::string data;
    for (const auto& row : rows) {
        for (const std::uint32_t point : row) put_number(data, point, 4);
        data.append(4 * (width - row.size()), '\0');
    }
    add_array(name, fmt::format("<U{}", width), {values.size()}, data);
}

std::string NpzWriter::finish() const
{
    std::string file, directory;
    for (const Entry& entry : entries_) {
        const std::string header = common_header(entry.name, entry.content);
        directory += std::string("PK\x01\x02", 4);
        put_number(directory, 20, 2);  // made by
        directory += header;
        put_number(directory, 0, 2);  // no comment
        put_number(directory, 0, 2);  // disk
        put_number(directory, 0, 2);  // binary
        put_number(directory, 0, 4);
        put_number(directory, file.size(), 4);
        directory += entry.name;
        file += std::string("PK\x03\x04", 4) + header + entry.name + entry.content;
    }
    if (file.size() + directory.size() > 0xffffffffull || entries_.size() > 0xffff)
        throw Error(ErrorKind::BadFile,
                    ".npz file: got arrays of more than 4 GiB; expected less. Fix: split the sweep, or write fewer frames");
    const std::size_t at = file.size();
    file += directory + std::string("PK\x05\x06", 4);
    put_number(file, 0, 4);  // one disk
    put_number(file, entries_.size(), 2);
    put_number(file, entries_.size(), 2);
    put_number(file, directory.size(), 4);
    put_number(file, at, 4);
    put_number(file, 0, 2);
    return file;
}

void write_npy(const FilePlace& place, std::span<const float> values, const std::vector<std::size_t>& shape)
{
    SEL_ASSERT(std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies()) == values.size());
    write_file(place, npy_file("<f4", shape, {reinterpret_cast<const char*>(values.data()), values.size_bytes()}));
}

}  // namespace seldinger
