// Starts ffmpeg, feeds it pixels or pictures, and puts the finished film in place.
#include "io/film_write.h"

#include "core/child_process.h"
#include "core/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string>

namespace seldinger {
namespace {

/// What ffmpeg reads: pixels.
std::vector<std::string> pixel_words(int width, int height, double rate, FilmPixels pixels)
{
    return {"-f", "rawvideo", "-pix_fmt", pixels == FilmPixels::Rgb ? "rgb24" : "gray", "-s", fmt::format("{}x{}", width, height),
            "-r", fmt::format("{:.6g}", rate)};
}

std::vector<std::string> png_words(double rate)
{
    return {"-f", "image2pipe", "-c:v", "png", "-framerate", fmt::format("{:.6g}", rate)};
}

/// ffmpeg's command line, from its standard input to the file that is its standard output. Opened by this name it is that file,
/// and can be gone back in, as MP4 needs; pictures of odd size are padded by a pixel.
std::vector<std::string> command_line(const std::vector<std::string>& input, const char* container)
{
    std::vector<std::string> words = {"ffmpeg", "-y", "-loglevel", "error"};
    words.insert(words.end(), input.begin(), input.end());
    for (const char* word : {"-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-preset", "veryfast", "-crf",
                             "18", "-pix_fmt", "yuv420p", "-f", container, "file:/proc/self/fd/1"})
        words.emplace_back(word);
    return words;
}

/// A file in memory for what ffmpeg says: version 5.1 ends with 0 although it could not write the end of a film, and only says
/// so.
int memory_file() { return memfd_create("ffmpeg", MFD_CLOEXEC); }

/// @return the first line, or empty; closes the file
std::string first_line(int& said)
{
    char text[300] = {};
    if (said >= 0 && pread(said, text, sizeof text - 1, 0) < 0) text[0] = 0;
    if (said >= 0) close(said);
    said = -1;
    const std::string all = text;
    return all.substr(0, all.find('\n'));
}

/// @param input, said, output  its standard input, error and output. @throws Error BadFile: there is no ffmpeg, or no process for
/// it
pid_t start_ffmpeg(const std::filesystem::path& film, const std::vector<std::string>& words, int input, int said, int output)
{
    const pid_t process = start_program(words, input, said, output);
    if (process < 0)
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got no ffmpeg; expected it for a film: {}", film.string(),
                                why_not_started("ffmpeg", "on Debian, as root: apt-get install ffmpeg")));
    return process;
}

std::string unfinished(const std::string& said)
{
    if (!said.empty())
        return fmt::format("got \"{}\" from ffmpeg; expected a finished film. Fix: give another name or --size", said);
    return "got an unfinished film from ffmpeg; expected a whole one. Fix: free some space, and check that ffmpeg has libx264";
}

const char* container_of(const std::filesystem::path& path)
{
    const std::string ending = path.extension().string();
    if (ending == ".mp4") return "mp4";
    if (ending == ".mov") return "mov";
    if (ending == ".mkv") return "matroska";
    throw Error(ErrorKind::BadFile, fmt::format("{}: got the ending \"{}\"; expected .mp4, .mov or .mkv. Fix: rename the film",
                                                path.string(), ending));
}

}  // namespace

FilmWriter::FilmWriter(const std::filesystem::path& path, int width, int height, double rate, FilmPixels pixels)
    : FilmWriter(path, pixel_words(width, height, rate, pixels))
{
}

FilmWriter::FilmWriter(const std::filesystem::path& path, double rate) : FilmWriter(path, png_words(rate)) {}

FilmWriter::FilmWriter(const std::filesystem::path& path, const std::vector<std::string>& input) : path_(path)
{
    const char* container = container_of(path);
    if (std::filesystem::is_directory(path))
        throw Error(ErrorKind::BadFile,
                    path.string() + ": got a folder; expected the name of a film. Fix: name one, for example film.mp4");
    make_folder_of(path);
    file_.emplace(path);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw Error(
            ErrorKind::BadFile,
            path.string() +
                ": got no pipe to ffmpeg; expected one. Fix: close other programs, or raise the limit of open files (ulimit -n)");
    pipe_ = ends[1];
    // room for a picture of 1024 x 1024, so that the next one is drawn while ffmpeg encodes; where that is not allowed, it stays
    // small
    (void)fcntl(pipe_, F_SETPIPE_SZ, 1 << 20);
    try {
        encoder_ = start_ffmpeg(path, command_line(input, container), ends[0], said_ = memory_file(), file_->fd());
    } catch (...) {
        close(ends[0]);
        close(pipe_);
        if (said_ >= 0) close(said_);
        throw;
    }
    close(ends[0]);
}

FilmWriter::~FilmWriter()
{
    (void)first_line(said_);
    if (encoder_ >= 0) wait_for_end();
}

int FilmWriter::wait_for_end()
{
    if (pipe_ >= 0) close(pipe_);
    pipe_ = -1;
    int status = -1;
    if (encoder_ >= 0) status = wait_for_program(encoder_);
    encoder_ = -1;
    return status;
}

void FilmWriter::fail(const std::string& why)
{
    wait_for_end();
    file_.reset();
    throw Error(ErrorKind::BadFile, path_.string() + ": " + why);
}

void FilmWriter::add(const std::vector<std::uint16_t>& grey)
{
    std::vector<std::uint8_t> bytes(grey.size());
    for (std::size_t i = 0; i < grey.size(); ++i) bytes[i] = static_cast<std::uint8_t>(grey[i] >> 4);
    put(bytes.data(), bytes.size());
}

void FilmWriter::add(const std::vector<std::uint8_t>& rgb) { put(rgb.data(), rgb.size()); }

void FilmWriter::add_png(std::string_view file) { put(file.data(), file.size()); }

void FilmWriter::put(const void* pixels, std::size_t size)
{
    const auto* bytes = static_cast<const char*>(pixels);
    // an encoder that has gone is said here, not by a signal
    const auto before = std::signal(SIGPIPE, SIG_IGN);
    bool gone = false;
    for (std::size_t done = 0; done < size && !gone;) {
        const ssize_t wrote = write(pipe_, bytes + done, size - done);
        if (wrote > 0) done += static_cast<std::size_t>(wrote);
        else gone = errno != EINTR;
    }
    std::signal(SIGPIPE, before);
    if (!gone) return;
    wait_for_end();
    const std::string said = first_line(said_);
    fail(said.empty() ? "got an early end of ffmpeg; expected a whole film. Fix: free some space" : unfinished(said));
}

void FilmWriter::finish()
{
    const int status = wait_for_end();
    const std::string said = first_line(said_);
    if (status != 0 || !said.empty()) fail(unfinished(said));
    file_->put_in_place();
    file_.reset();
}

}  // namespace seldinger
