#pragma once
// Pictures into a film, through a pipe to the system's ffmpeg.

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace seldinger {

/// H.264 in MP4, frames as they come. The file appears under its name when finish() has returned, and not at all otherwise.
class FilmWriter {
public:
    /// @param rate  frames per second. @throws Error BadFile: no ffmpeg, a folder by that name, an ending other than .mp4, .mkv
    /// or .mov
    FilmWriter(const std::filesystem::path& path, int width, int height, double rate);
    ~FilmWriter();
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;

    /// 12-bit grey, rows from the top. @throws Error BadFile: ffmpeg has ended, a full disk for instance
    void add(const std::vector<std::uint16_t>& grey);
    /// @throws Error BadFile
    void finish();

private:
    [[noreturn]] void fail(const std::string& why);
    int wait_for_end();
    std::filesystem::path path_, partial_;
    int pipe_ = -1;
    pid_t encoder_ = -1;
};

}  // namespace seldinger
