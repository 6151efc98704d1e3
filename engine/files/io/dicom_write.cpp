// Data elements of an X-ray angiographic image.
#include "io/dicom_write.h"

#include "core/check.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/fnv1a.h"
#include "io/binary_text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

namespace seldinger {
namespace {

constexpr const char* storage_class = "1.2.840.10008.5.1.4.1.1.12.1";
constexpr const char* little_endian = "1.2.840.10008.1.2.1";

/// Data elements, which must come in rising order.
class Elements {
public:
    void put(std::uint16_t group, std::uint16_t element, const char* vr, std::string value)
    {
        const std::uint32_t tag = std::uint32_t(group) << 16 | element;
        SEL_ASSERT(tag > last_);
        last_ = tag;
        if (value.size() % 2) value += std::strcmp(vr, "UI") == 0 || vr[0] == 'O' ? '\0' : ' ';
        put_number(bytes_, group, 2);
        put_number(bytes_, element, 2);
        bytes_ += vr;
        const bool wide = std::strcmp(vr, "OB") == 0 || std::strcmp(vr, "OW") == 0 || std::strcmp(vr, "SQ") == 0;
        if (wide) put_number(bytes_, 0, 2);
        put_number(bytes_, value.size(), wide ? 4 : 2);
        bytes_ += value;
    }
    void number(std::uint16_t group, std::uint16_t element, std::uint16_t value)
    {
        std::string bytes;
        put_number(bytes, value, 2);
        put(group, element, "US", bytes);
    }
    /// Decimal text of at most 16 bytes.
    void decimal(std::uint16_t group, std::uint16_t element, double value) { put(group, element, "DS", decimal_text(value)); }
    static std::string decimal_text(double value) { return fmt::format("{:.10g}", std::abs(value) < 1e-9 ? 0.0 : value); }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    std::uint32_t last_ = 0;
};

/// 2.25 and a 64-bit hash in decimal [PS3.5 B.2], of a text and its purpose.
std::string uid(const std::string& identity, const char* what)
{
    return fmt::format("2.25.{}", fnv1a(what, std::strlen(what), fnv1a(identity.data(), identity.size())));
}

std::string joined(const std::vector<double>& values)
{
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i) text += (i ? "\\" : "") + Elements::decimal_text(values[i] - values[0]);
    return text;
}

bool moves(const AngiographicImage& image)
{
    for (std::size_t i = 1; i < image.primary.size(); ++i)
        if (image.primary[i] != image.primary[0] || image.secondary[i] != image.secondary[0]) return true;
    return false;
}

void put_identity(Elements& e, const AngiographicImage& image)
{
    e.put(0x0008, 0x0008, "CS", "ORIGINAL\\PRIMARY\\SINGLE PLANE");
    e.put(0x0008, 0x0016, "UI", storage_class);
    e.put(0x0008, 0x0018, "UI", uid(image.identity, "image"));
    e.put(0x0008, 0x0020, "DA", "");
    e.put(0x0008, 0x0030, "TM", "");
    e.put(0x0008, 0x0050, "SH", "");
    e.put(0x0008, 0x0060, "CS", "XA");
    e.put(0x0008, 0x0070, "LO", "Seldinger");
    e.put(0x0008, 0x0090, "PN", "");
    e.put(0x0008, 0x103e, "LO", image.description.substr(0, 64));
    e.put(0x0008, 0x1090, "LO", "simulated fluoroscopy");
    e.put(0x0010, 0x0010, "PN", "Simulated^Patient");
    e.put(0x0010, 0x0020, "LO", "SIMULATED");
    e.put(0x0010, 0x0030, "DA", "");
    e.put(0x0010, 0x0040, "CS", "");
}

void put_acquisition(Elements& e, const AngiographicImage& image, std::size_t frames)
{
    if (image.contrast) e.put(0x0018, 0x0010, "LO", "IODINE");
    if (image.kvp > 0) e.decimal(0x0018, 0x0060, image.kvp);
    else e.put(0x0018, 0x0060, "DS", "");
    if (frames > 1) e.decimal(0x0018, 0x1063, 1e3 * image.frame_time);
    e.decimal(0x0018, 0x1110, 1e3 * image.sid);
    e.decimal(0x0018, 0x1111, 1e3 * image.sod);
    e.decimal(0x0018, 0x1114, image.sid / image.sod);
    e.put(0x0018, 0x1150, "IS", "");
    e.put(0x0018, 0x1151, "IS", "");
    e.put(0x0018, 0x1155, "CS", "SC");
    e.put(0x0018, 0x1164, "DS", Elements::decimal_text(1e3 * image.pixel) + "\\" + Elements::decimal_text(1e3 * image.pixel));
    const bool turning = moves(image);
    e.put(0x0018, 0x1500, "CS", turning ? "DYNAMIC" : "STATIC");
    e.decimal(0x0018, 0x1510, image.primary[0]);
    e.decimal(0x0018, 0x1511, image.secondary[0]);
    if (turning) e.put(0x0018, 0x1520, "DS", joined(image.primary));
    if (turning) e.put(0x0018, 0x1521, "DS", joined(image.secondary));
}

void put_picture(Elements& e, const AngiographicImage& image, std::size_t frames)
{
    e.put(0x0020, 0x000d, "UI", uid(image.identity, "study"));
    e.put(0x0020, 0x000e, "UI", uid(image.identity, "series"));
    e.put(0x0020, 0x0010, "SH", "");
    e.put(0x0020, 0x0011, "IS", "1");
    e.put(0x0020, 0x0013, "IS", "1");
    e.put(0x0020, 0x0020, "CS", "");
    e.put(0x0020, 0x0060, "CS", "");
    e.number(0x0028, 0x0002, 1);
    e.put(0x0028, 0x0004, "CS", "MONOCHROME2");
    if (frames > 1) {
        e.put(0x0028, 0x0008, "IS", fmt::format("{}", frames));
        e.put(0x0028, 0x0009, "AT", std::string("\x18\x00\x63\x10", 4));  // frames follow each other by Frame Time
    }
    e.number(0x0028, 0x0010, static_cast<std::uint16_t>(image.rows));
    e.number(0x0028, 0x0011, static_cast<std::uint16_t>(image.columns));
    e.number(0x0028, 0x0100, 16);
    e.number(0x0028, 0x0101, 12);
    e.number(0x0028, 0x0102, 11);
    e.number(0x0028, 0x0103, 0);
    e.put(0x0028, 0x1040, "CS", image.logarithmic ? "LOG" : "LIN");
    e.put(0x0028, 0x1050, "DS", "2048");
    e.put(0x0028, 0x1051, "DS", "4096");
    std::string pixels(2 * image.grey.size(), '\0');
    for (std::size_t i = 0; i < image.grey.size(); ++i) {
        pixels[2 * i] = static_cast<char>(image.grey[i] & 0xff);
        pixels[2 * i + 1] = static_cast<char>(image.grey[i] >> 8);
    }
    e.put(0x7fe0, 0x0010, "OW", std::move(pixels));
}

}  // namespace

std::string dicom_file(const AngiographicImage& image)
{
    const std::size_t size = static_cast<std::size_t>(image.columns) * image.rows, frames = size ? image.grey.size() / size : 0;
    SEL_ASSERT(frames > 0 && image.grey.size() == frames * size && image.primary.size() == frames &&
               image.secondary.size() == frames);
    Elements meta;
    meta.put(0x0002, 0x0001, "OB", std::string("\x00\x01", 2));
    meta.put(0x0002, 0x0002, "UI", storage_class);
    meta.put(0x0002, 0x0003, "UI", uid(image.identity, "image"));
    meta.put(0x0002, 0x0010, "UI", little_endian);
    meta.put(0x0002, 0x0012, "UI", uid("seldinger", "implementation"));
    Elements data;
    put_identity(data, image);
    put_acquisition(data, image, frames);
    put_picture(data, image, frames);
    std::string file(128, '\0');
    file += "DICM";
    Elements length;
    std::string group;
    put_number(group, meta.bytes().size(), 4);
    length.put(0x0002, 0x0000, "UL", group);
    return file + length.bytes() + meta.bytes() + data.bytes();
}

void write_dicom(const std::filesystem::path& path, const AngiographicImage& image)
{
    if (std::filesystem::is_directory(path))
        throw Error(ErrorKind::BadFile,
                    path.string() + ": got a folder; expected the name of a DICOM file. Fix: name one, for example run.dcm");
    if (2 * image.grey.size() > 0xfffffff0ull)
        throw Error(ErrorKind::BadFile, fmt::format("{}: got {} GiB of pixels; expected less than the 4 GiB of a DICOM picture. "
                                                    "Fix: give fewer --frames or a smaller --size",
                                                    path.string(), (2 * image.grey.size()) >> 30));
    make_folder_of(path);
    write_file(path, dicom_file(image));
}

}  // namespace seldinger
