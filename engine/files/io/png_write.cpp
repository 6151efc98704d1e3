// Writes rows as PNG by libpng, into memory first and then to the file.
#include "io/png_write.h"

#include "core/check.h"
#include "core/error.h"
#include "core/file_io.h"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <string>

namespace seldinger {
namespace {

/// What libpng writes goes to the end of a string.
void append(png_structp png, png_bytep data, png_size_t size)
{
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

/// Grey pixels as bytes, 16-bit ones big-endian.
struct GreyRows {
    int width, height, bits;
    const png_byte* rows;
    int significant;  // bits that count; 0: all of them, which is not said
    bool long_runs;   // of the same value
};

/// libpng leaves by longjmp: nothing in here has a destructor. @return false: it has given up
bool encode_grey(png_structp png, png_infop info, const GreyRows& grey, std::string& file)
{
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_write_fn(png, &file, append, nullptr);
    png_set_compression_level(png, 1);  // noise does not compress: more takes time, not bytes
    if (grey.long_runs) png_set_compression_strategy(png, Z_RLE);
    png_set_filter(png, 0, grey.bits == 16 ? PNG_FILTER_SUB : PNG_FILTER_NONE);
    png_set_IHDR(png, info, grey.width, grey.height, grey.bits, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (grey.significant > 0) {
        png_color_8 bits{};
        bits.gray = static_cast<png_byte>(grey.significant);
        png_set_sBIT(png, info, &bits);
    }
    png_write_info(png, info);
    const std::size_t row_bytes = static_cast<std::size_t>(grey.width) * grey.bits / 8;
    for (int row = 0; row < grey.height; ++row) png_write_row(png, grey.rows + row * row_bytes);
    png_write_end(png, info);
    return true;
}

void write_grey(const FilePlace& place, const GreyRows& grey)
{
    std::string file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    const bool whole = info && encode_grey(png, info, grey, file);
    png_destroy_write_struct(&png, &info);
    if (!whole)
        throw Error(
            ErrorKind::BadFile,
            place.path().string() + ": got a picture that libpng cannot encode; expected a PNG. Fix: give a smaller --size");
    write_file(place, file);
}

}  // namespace

void write_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& pixels)
{
    const std::size_t count = static_cast<std::size_t>(width) * height;
    SEL_ASSERT(pixels.size() == 3 * count || pixels.size() == 4 * count);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = pixels.size() == 3 * count ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::vector<char> bytes(size);
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr)) {
        throw Error(ErrorKind::BadFile, path.string() + ": " + image.message);
    }
    write_file(path, {bytes.data(), size});
}

void write_grey_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint16_t>& grey)
{
    SEL_ASSERT(grey.size() == static_cast<std::size_t>(width) * height);
    std::vector<png_byte> rows;
    rows.reserve(2 * grey.size());
    for (const std::uint16_t g : grey) {
        rows.push_back(static_cast<png_byte>(g >> 4));
        rows.push_back(static_cast<png_byte>((g & 15) << 4 | g >> 8));
    }
    write_grey(path, {width, height, 16, rows.data(), 12, false});
}

void write_label_png(const FilePlace& place, int width, int height, std::span<const std::uint8_t> labels)
{
    SEL_ASSERT(labels.size() == static_cast<std::size_t>(width) * height);
    write_grey(place, {width, height, 8, labels.data(), 0, true});
}

void write_label_png(const FilePlace& place, int width, int height, std::span<const std::uint16_t> values)
{
    SEL_ASSERT(values.size() == static_cast<std::size_t>(width) * height);
    std::vector<png_byte> rows;
    rows.reserve(2 * values.size());
    for (const std::uint16_t v : values)
        rows.push_back(static_cast<png_byte>(v >> 8)), rows.push_back(static_cast<png_byte>(v & 255));
    write_grey(place, {width, height, 16, rows.data(), 0, false});
}

// Lets libpng read a file's bytes from memory.

namespace {

constexpr png_uint_32 most_side = 8192;
constexpr std::uint64_t most_png_bytes = 1u << 27;

/// Bit depth and colour type of the header [PNG 11.2.2]: the simple reader would change others without a word.
bool is_grey_8(const std::string& file)
{
    return file.size() > 25 && file[24] == 8 && file[25] == PNG_COLOR_TYPE_GRAY;
}

}  // namespace

LabelImage read_label_png(const std::filesystem::path& path)
{
    const std::string file = read_file(path, most_png_bytes);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    const auto fail = [&](const std::string& what) -> void {
        png_image_free(&image);
        throw Error(ErrorKind::BadFile,
                    path.string() + ": got " + what +
                        "; expected a mask of 8-bit grey as `render --labels` writes it. Fix: render it again");
    };
    if (!png_image_begin_read_from_memory(&image, file.data(), file.size()))
        fail(fmt::format("\"{}\" from libpng", image.message));
    if (!is_grey_8(file)) fail("another kind of PNG");
    if (image.width > most_side || image.height > most_side)
        fail(fmt::format("{} x {} pixels, more than 8192 x 8192", image.width, image.height));
    image.format = PNG_FORMAT_GRAY;
    LabelImage out{static_cast<int>(image.width), static_cast<int>(image.height),
                   std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
    if (!png_image_finish_read(&image, nullptr, out.labels.data(), 0, nullptr))
        fail(fmt::format("\"{}\" from libpng", image.message));
    return out;
}

}  // namespace seldinger
