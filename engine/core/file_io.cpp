// Writes whole files by a temporary name and rename, and growing tables row by row, by POSIX calls that are all checked.
#include "core/file_io.h"

#include "core/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <utility>

namespace seldinger {
namespace {

[[noreturn]] void fail_writing(const std::filesystem::path& path, int error)
{
    const char* advice = error == ENOSPC || error == EFBIG || error == EDQUOT ? "free some space or choose another folder with -o"
                                                                              : "choose a folder that can be written to with -o";
    throw Error(ExitCode::BadFile, fmt::format("{}: cannot be written: {}; {}", path.string(), std::strerror(error), advice));
}

/// Writes all bytes; @return 0 or errno
int write_all(int fd, std::string_view bytes)
{
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd, bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

}  // namespace

std::string read_file(const std::filesystem::path& path, std::uint64_t most)
{
    auto fail = [&](int error) {
        throw Error(ExitCode::BadFile,
                    fmt::format("{}: cannot be read: {}; check the path", path.string(), std::strerror(error)));
    };
    // without waiting: opening a pipe that no one writes to would never return
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0) fail(errno);
    struct stat status {};
    if (::fstat(fd, &status) == 0 && !S_ISREG(status.st_mode)) {
        ::close(fd);
        if (S_ISDIR(status.st_mode)) fail(EISDIR);
        throw Error(ExitCode::BadFile, path.string() + ": is a pipe or a device, which may have no end; give a file");
    }
    if (static_cast<std::uint64_t>(status.st_size) > most) {
        ::close(fd);
        throw Error(ExitCode::BadFile, fmt::format("{}: has {} bytes, at most {} are read here; is it the right file?",
                                                   path.string(), status.st_size, most));
    }
    std::string content;
    char block[1 << 16];
    for (;;) {
        const ssize_t got = ::read(fd, block, sizeof block);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            const int error = errno;
            ::close(fd);
            fail(error);
        }
        if (got == 0) break;
        content.append(block, static_cast<std::size_t>(got));
    }
    ::close(fd);
    return content;
}

void write_file(const std::filesystem::path& path, std::string_view content, Durable durable)
{
    const std::filesystem::path temporary = path.string() + fmt::format(".{}.tmp", ::getpid());
    const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd < 0) fail_writing(path, errno);
    int error = write_all(fd, content);
    if (error == 0 && durable == Durable::Yes && ::fsync(fd) != 0) error = errno;
    if (::close(fd) != 0 && error == 0) error = errno;
    if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail_writing(path, error);
    }
}

void make_folder(const std::filesystem::path& path)
{
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (!error && !std::filesystem::is_directory(path, error) && !error) error = std::make_error_code(std::errc::not_a_directory);
    if (error) fail_writing(path, error.value());
}

AppendFile::AppendFile(const std::filesystem::path& path, std::uint64_t keep) : path_(path), size_(keep)
{
    // not through a link, which may lead out of the folder, nor into a pipe that nobody reads
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (fd_ < 0 && errno != ELOOP && errno != ENXIO) fail_writing(path, errno);
    struct stat status {};
    if (fd_ < 0 || (::fstat(fd_, &status) == 0 && !S_ISREG(status.st_mode))) {
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
        throw Error(ExitCode::BadFile, path.string() + ": is a link or no plain file; remove it, or choose another folder with -o");
    }
    const bool known = ::fstat(fd_, &status) == 0;
    const bool too_short = known && static_cast<std::uint64_t>(status.st_size) < keep;
    if (!known || too_short || ::ftruncate(fd_, static_cast<off_t>(keep)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0) {
        const int error = errno;
        ::close(std::exchange(fd_, -1));
        if (too_short)
            throw Error(ExitCode::BadFile,
                        fmt::format("{}: is shorter than its checkpoint says; run again with --overwrite", path.string()));
        fail_writing(path, error);
    }
}

AppendFile::~AppendFile()
{
    if (fd_ >= 0) ::close(fd_);
}

void AppendFile::append(std::string_view row)
{
    const int error = write_all(fd_, row);
    if (error != 0) {
        // cutting needs no space; when even that fails the error below says all that can be said
        if (::ftruncate(fd_, static_cast<off_t>(size_)) == 0) ::lseek(fd_, 0, SEEK_END);
        fail_writing(path_, error);
    }
    size_ += row.size();
}

void AppendFile::sync()
{
    if (fd_ >= 0 && ::fsync(fd_) != 0) fail_writing(path_, errno);
}

void AppendFile::swap(AppendFile& other) noexcept
{
    std::swap(path_, other.path_);
    std::swap(fd_, other.fd_);
    std::swap(size_, other.size_);
}

}  // namespace seldinger
