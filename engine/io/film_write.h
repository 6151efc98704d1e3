#pragma once
// Pictures into a film, through a pipe to the system's ffmpeg.

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace seldinger {

enum class FilmPixels { Grey12, Rgb };

/// H.264 in MP4, frames as they come. The file appears under its name when finish() has returned, and not at all otherwise.
class FilmWriter {
public:
    /// @param rate  frames per second. @throws Error BadFile: no ffmpeg, a folder by that name, an ending other than .mp4, .mkv
    /// or .mov
    FilmWriter(const std::filesystem::path& path, int width, int height, double rate, FilmPixels pixels = FilmPixels::Grey12);
    ~FilmWriter();
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;

    /// 12-bit grey, rows from the top. @throws Error BadFile: ffmpeg has ended, a full disk for instance
    void add(const std::vector<std::uint16_t>& grey);
    /// 3 bytes a pixel, rows from the top. @throws Error BadFile
    void add(const std::vector<std::uint8_t>& rgb);
    /// @throws Error BadFile
    void finish();

private:
    void put(const std::uint8_t* bytes, std::size_t size);
    [[noreturn]] void fail(const std::string& why);
    int wait_for_end();
    std::filesystem::path path_, partial_;
    int pipe_ = -1;
    int said_ = -1;  // what ffmpeg complains of
    pid_t encoder_ = -1;
};

/// A film of the pictures PATTERN ("frame_%06d.png") from number `first` on. The file appears when it is complete, and not at all
/// otherwise. @throws Error BadFile
void write_film_of(const std::filesystem::path& pattern, std::size_t first, std::size_t count, double rate,
                   const std::filesystem::path& path);

}  // namespace seldinger
