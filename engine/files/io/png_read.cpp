// Lets libpng read a file's bytes from memory.
#include "io/png_read.h"

#include "core/error.h"
#include "core/file_io.h"

#include <fmt/format.h>
#include <png.h>

namespace seldinger {
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
