// Starts ffmpeg, feeds it 8-bit grey and renames what it wrote.
#include "io/film_write.h"

#include "core/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string>

extern char** environ;

namespace seldinger {
namespace {

/// ffmpeg's command line: grey in, pictures of odd size padded by a pixel.
std::vector<std::string> command_line(const std::filesystem::path& file, int width, int height, double rate,
                                      const char* container)
{
    return {"ffmpeg",     "-y",
            "-loglevel",  "error",
            "-f",         "rawvideo",
            "-pix_fmt",   "gray",
            "-s",         fmt::format("{}x{}", width, height),
            "-r",         fmt::format("{:.6g}", rate),
            "-i",         "-",
            "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-c:v",       "libx264",
            "-crf",       "16",
            "-pix_fmt",   "yuv420p",
            "-f",         container,
            file.string()};
}

const char* container_of(const std::filesystem::path& path)
{
    const std::string ending = path.extension().string();
    if (ending == ".mp4") return "mp4";
    if (ending == ".mov") return "mov";
    if (ending == ".mkv") return "matroska";
    throw Error(ExitCode::BadFile, path.string() + ": expected a film's name that ends in .mp4, .mov or .mkv");
}

}  // namespace

FilmWriter::FilmWriter(const std::filesystem::path& path, int width, int height, double rate) : path_(path), partial_(path)
{
    const char* container = container_of(path);
    if (std::filesystem::is_directory(path))
        throw Error(ExitCode::BadFile, path.string() + ": is a folder, expected the name of a film");
    partial_ += ".part";
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error(ExitCode::BadFile, path.string() + ": no pipe to ffmpeg could be opened");
    std::vector<std::string> words = command_line(partial_, width, height, rate, container);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    const int problem = posix_spawnp(&encoder_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    pipe_ = ends[1];
    if (problem != 0) {
        encoder_ = -1;
        close(pipe_);
        pipe_ = -1;
        throw Error(ExitCode::BadFile,
                    path.string() + ": a film needs ffmpeg, which is not installed (Debian: apt-get install ffmpeg)");
    }
}

FilmWriter::~FilmWriter()
{
    if (encoder_ < 0) return;
    wait_for_end();
    std::error_code ignored;
    std::filesystem::remove(partial_, ignored);
}

int FilmWriter::wait_for_end()
{
    if (pipe_ >= 0) close(pipe_);
    pipe_ = -1;
    int status = -1;
    if (encoder_ >= 0)
        while (waitpid(encoder_, &status, 0) < 0 && errno == EINTR) {
        }
    encoder_ = -1;
    return status;
}

void FilmWriter::fail(const std::string& why)
{
    wait_for_end();
    std::error_code ignored;
    std::filesystem::remove(partial_, ignored);
    throw Error(ExitCode::BadFile, path_.string() + ": " + why);
}

void FilmWriter::add(const std::vector<std::uint16_t>& grey)
{
    std::vector<std::uint8_t> bytes(grey.size());
    for (std::size_t i = 0; i < grey.size(); ++i) bytes[i] = static_cast<std::uint8_t>(grey[i] >> 4);
    // an encoder that has gone is said here, not by a signal
    const auto before = std::signal(SIGPIPE, SIG_IGN);
    bool gone = false;
    for (std::size_t done = 0; done < bytes.size() && !gone;) {
        const ssize_t wrote = write(pipe_, bytes.data() + done, bytes.size() - done);
        if (wrote > 0) done += static_cast<std::size_t>(wrote);
        else gone = errno != EINTR;
    }
    std::signal(SIGPIPE, before);
    if (gone) fail("ffmpeg ended before the film did; is the disk full?");
}

void FilmWriter::finish()
{
    if (wait_for_end() != 0) fail("ffmpeg could not finish the film; is the disk full, or is it without libx264?");
    std::error_code problem;
    std::filesystem::rename(partial_, path_, problem);
    if (problem) fail("cannot be written; is the folder read-only?");
}

}  // namespace seldinger
