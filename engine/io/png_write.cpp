// Writes RGB rows as PNG by libpng, into memory first and then to the file.
#include "io/png_write.h"

#include "core/check.h"
#include "core/error.h"

#include <png.h>

#include <fstream>

namespace seldinger {

void write_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& pixels)
{
    SEL_ASSERT(pixels.size() == 3 * static_cast<std::size_t>(width) * height);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::vector<char> bytes(size);
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr)) {
        throw Error(ExitCode::BadFile, path.string() + ": " + image.message);
    }
    std::filesystem::path partial = path;
    partial += ".part";
    std::ofstream stream(partial, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(size));
    stream.close();
    std::error_code problem;
    if (stream) std::filesystem::rename(partial, path, problem);
    if (!stream || problem) {
        std::filesystem::remove(partial, problem);
        throw Error(ExitCode::BadFile, path.string() + ": cannot be written; is the disk full or the folder read-only?");
    }
}

}  // namespace seldinger
