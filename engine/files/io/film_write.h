#pragma once
// Makes a film of pictures, through a pipe to the system's ffmpeg.

#include "core/file_io.h"

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

enum class FilmPixels { Grey12, Rgb };

/// H.264 in MP4, frames as they come. The file appears under its name only once finish() has returned. The encoder gets an open
/// file and a pipe, never a path: it would take run-10:00 for a protocol and %d for a number.
class FilmWriter {
public:
    /// @param rate  frames per second. @throws Error BadFile: no ffmpeg, a folder by that name, an ending other than .mp4, .mkv
    /// or .mov
    FilmWriter(const std::filesystem::path& path, int width, int height, double rate, FilmPixels pixels = FilmPixels::Grey12);
    /// Film of pictures as PNG files, all of one size.
    FilmWriter(const std::filesystem::path& path, double rate);
    ~FilmWriter();
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;

    /// 12-bit grey, rows from the top. @throws Error BadFile: ffmpeg has ended, a full disk for instance
    void add(const std::vector<std::uint16_t>& grey);
    /// 3 bytes a pixel, rows from the top. @throws Error BadFile
    void add(const std::vector<std::uint8_t>& rgb);
    /// The bytes of a PNG file. @throws Error BadFile
    void add_png(std::string_view file);
    /// @throws Error BadFile
    void finish();

private:
    FilmWriter(const std::filesystem::path& path, const std::vector<std::string>& input);
    void put(const void* bytes, std::size_t size);
    [[noreturn]] void fail(const std::string& why);
    int wait_for_end();
    std::filesystem::path path_;
    std::optional<NewFile> file_;
    int pipe_ = -1;
    int said_ = -1;  // what ffmpeg complains of
    pid_t encoder_ = -1;
};

}  // namespace seldinger
