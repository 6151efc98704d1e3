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

constexpr int most_taken = 1000;  // names beside a file that somebody else has; more is no accident

[[noreturn]] void fail_writing(const std::filesystem::path& path, int error)
{
    const char* advice = error == ENOSPC || error == EFBIG || error == EDQUOT ? "free some space or choose another folder with -o"
                                                                              : "choose a folder that can be written to with -o";
    throw Error(ErrorKind::BadFile, fmt::format("{}: cannot be written: {}; {}", path.string(), std::strerror(error), advice));
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

/// What a place can hold that is written anew: nothing, a plain file, or a link (which is replaced, and not followed).
void check_place(const FilePlace& place)
{
    struct stat status {};
    if (::fstatat(place.start(), place.name().c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) return;
    if (S_ISREG(status.st_mode) || S_ISLNK(status.st_mode)) return;
    throw Error(ErrorKind::BadFile, fmt::format("{}: is {}; give the name of a file", place.path().string(),
                                               S_ISDIR(status.st_mode) ? "a folder" : "a pipe or a device, which would be lost"));
}

}  // namespace

std::string read_file(const FilePlace& place, std::uint64_t most)
{
    const std::string path = place.path().string();
    auto fail = [&](int error) {
        const bool backslash = error == ENOENT && path.find('\\') != std::string::npos;
        throw Error(ErrorKind::BadFile, fmt::format("{}: cannot be read: {}; {}", path, std::strerror(error),
                                                   backslash ? "write / between folders, not \\" : "check the path"));
    };
    // without waiting: opening a pipe that no one writes to would never return
    const int fd =
        ::openat(place.start(), place.name().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | place.read_flags());
    if (fd < 0 && errno == ELOOP && place.read_flags() != 0)
        throw Error(ErrorKind::BadFile, path + ": is a link; expected a file in this folder. Fix: put the file itself there");
    if (fd < 0) fail(errno);
    struct stat status {};
    if (::fstat(fd, &status) == 0 && !S_ISREG(status.st_mode)) {
        ::close(fd);
        if (S_ISDIR(status.st_mode)) fail(EISDIR);
        throw Error(ErrorKind::BadFile, path + ": is a pipe or a device, which may have no end; give a file");
    }
    if (static_cast<std::uint64_t>(status.st_size) > most) {
        ::close(fd);
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got {} bytes; expected at most {}. Fix: check that this is the right file", path,
                                status.st_size, most));
    }
    std::string content;
    content.reserve(static_cast<std::size_t>(status.st_size));
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

NewFile::NewFile(FilePlace place) : place_(std::move(place)), own_(place_)
{
    check_place(place_);
    const std::string name = place_.path().filename().string();
    for (int taken = 0;; ++taken) {
        own_ = place_.beside(fmt::format("{}.{}{}.tmp", name, taken > 0 ? fmt::format("{}.", taken) : "", ::getpid()));
        fd_ = ::openat(own_.start(), own_.name().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (fd_ >= 0) return;
        if (errno != EEXIST || taken == most_taken) fail_writing(place_.path(), errno);
    }
}

NewFile::~NewFile()
{
    if (fd_ < 0) return;
    ::close(fd_);
    ::unlinkat(own_.start(), own_.name().c_str(), 0);
}

void NewFile::write(std::string_view content)
{
    if (const int error = write_all(fd_, content); error != 0) fail_writing(place_.path(), error);
}

void NewFile::put_in_place(Durable durable)
{
    if (durable == Durable::Yes && ::fsync(fd_) != 0) fail_writing(place_.path(), errno);
    check_place(place_);  // something else may have come there while a film was made
    const int closed = ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno;
    const bool moved = closed == 0 && ::renameat(own_.start(), own_.name().c_str(), place_.start(), place_.name().c_str()) == 0;
    if (moved) return;
    const int error = closed != 0 ? closed : errno;
    ::unlinkat(own_.start(), own_.name().c_str(), 0);
    fail_writing(place_.path(), error);
}

void write_file(const FilePlace& place, std::string_view content, Durable durable)
{
    NewFile file(place);
    file.write(content);
    file.put_in_place(durable);
}

void make_folder(const std::filesystem::path& path)
{
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (!error && !std::filesystem::is_directory(path, error) && !error) error = std::make_error_code(std::errc::not_a_directory);
    if (error) fail_writing(path, error.value());
}

void make_folder_of(const std::filesystem::path& file)
{
    if (file.has_parent_path()) make_folder(file.parent_path());
}

Folder make_own_folder(const std::filesystem::path& path)
{
    make_folder_of(path);
    return Folder(path.parent_path()).make(path.filename().string());
}

AppendFile::AppendFile(const FilePlace& place, std::uint64_t keep) : path_(place.path())
{
    const auto refuse = [&](const char* what) {
        if (fd_ >= 0) ::close(std::exchange(fd_, -1));
        throw Error(ErrorKind::BadFile, fmt::format("{}: {}; remove it, or choose another folder with -o", path_.string(), what));
    };
    // not through a link, which may lead out of the folder, nor into a pipe that nobody reads
    fd_ = ::openat(place.start(), place.name().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (fd_ < 0 && errno != ELOOP && errno != ENXIO) fail_writing(path_, errno);
    struct stat status {};
    const bool known = fd_ >= 0 && ::fstat(fd_, &status) == 0;
    if (fd_ < 0 || (known && !S_ISREG(status.st_mode))) refuse("is a link or no plain file");
    if (known && status.st_nlink > 1) refuse("has a second name elsewhere (a hard link), which would be written to as well");
    const auto size = static_cast<std::uint64_t>(status.st_size);
    size_ = keep == everything ? size : keep;
    const bool too_short = known && size < size_;
    if (!known || too_short || ::ftruncate(fd_, static_cast<off_t>(size_)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0) {
        const int error = errno;
        ::close(std::exchange(fd_, -1));
        if (too_short)
            throw Error(ErrorKind::BadFile,
                        fmt::format("{}: is shorter than its checkpoint says; run again with --overwrite", path_.string()));
        fail_writing(path_, error);
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
