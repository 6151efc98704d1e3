// Takes and gives back locks by flock on a file of their own; finds files that a killed process left half written.
#include "core/file_lock.h"

#include "core/error.h"
#include "core/file_io.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <ctime>
#include <utility>
#include <vector>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

constexpr std::time_t leftover_age = 60;  // [s] no file takes as long to be written

/// Whether `fd` is still the file of that name: whoever had the lock before may have removed it in between.
bool still_there(int fd, const fs::path& path)
{
    struct stat opened {
    }, named{};
    return ::fstat(fd, &opened) == 0 && ::lstat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

/// ", process 123" where the lock says so.
std::string holder(int fd)
{
    char text[32] = {};
    const ssize_t got = ::pread(fd, text, sizeof text - 1, 0);
    long pid = 0;
    if (got <= 0 || std::from_chars(text, text + got, pid).ec != std::errc() || pid <= 0) return "";
    return fmt::format(", process {}", pid);
}

/// @return a descriptor that holds the lock; -1 where the file system knows no locks
int take(const fs::path& what, const fs::path& lock, FileLock::Wait wait)
{
    for (;;) {
        const int fd = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (fd < 0)
            throw Error(ExitCode::BadFile, fmt::format("{}: cannot be written: {}; {}", what.string(), std::strerror(errno),
                                                       errno == ENOSPC ? "free some space or choose another place with -o"
                                                                       : "choose a place that can be written to with -o"));
        if (::flock(fd, wait == FileLock::Wait::Yes ? LOCK_EX : LOCK_EX | LOCK_NB) != 0) {
            const int error = errno;
            const std::string by = holder(fd);
            ::close(fd);
            if (error == EINTR) continue;
            if (error != EWOULDBLOCK) return -1;
            throw Error(ExitCode::BadFile, fmt::format("{}: is being written by another run{}; wait for its end, stop it, or "
                                                       "choose another place with -o",
                                                       what.string(), by));
        }
        if (still_there(fd, lock)) return fd;
        ::close(fd);
    }
}

/// The process that a name NAME.PID.tmp speaks of; 0 for other names.
pid_t writer_of(const std::string& name)
{
    if (!name.ends_with(".tmp")) return 0;
    const std::string stem = name.substr(0, name.size() - 4);
    const std::size_t dot = stem.rfind('.');
    if (dot == std::string::npos || dot == 0) return 0;
    pid_t pid = 0;
    const char* end = stem.data() + stem.size();
    const auto [at, error] = std::from_chars(stem.data() + dot + 1, end, pid);
    return error == std::errc() && at == end && pid > 0 ? pid : 0;
}

}  // namespace

FileLock::FileLock(fs::path what, fs::path lock, Wait wait) : lock_(std::move(lock))
{
    fd_ = take(what, lock_, wait);
    if (fd_ < 0) return;
    const std::string pid = fmt::format("{}\n", ::getpid());
    // whom to name is a help and no more: a full disk may leave it out
    if (::ftruncate(fd_, 0) == 0) (void)!::pwrite(fd_, pid.data(), pid.size(), 0);
}

FileLock FileLock::of_folder(const fs::path& dir)
{
    std::error_code ignored;
    fs::path made;
    for (fs::path at = dir; !at.empty() && !fs::exists(at, ignored); at = at.parent_path()) {
        made = at;
        if (at == at.parent_path()) break;
    }
    make_folder(dir);
    FileLock lock(dir, dir / ".lock");
    lock.folder_ = dir;
    lock.made_ = made;
    remove_leftovers(dir);
    return lock;
}

FileLock FileLock::of_file(const fs::path& file, Wait wait)
{
    if (file.has_parent_path()) make_folder(file.parent_path());
    return {file, file.string() + ".lock", wait};
}

FileLock::~FileLock()
{
    if (fd_ < 0) return;
    ::unlink(lock_.c_str());  // held until it is closed: nobody else has it under this name
    if (!made_.empty() && ::rmdir(folder_.c_str()) == 0)
        for (fs::path at = folder_; at != made_ && at.has_parent_path();)
            if (at = at.parent_path(); ::rmdir(at.c_str()) != 0) break;
    ::close(fd_);
}

void FileLock::swap(FileLock& other) noexcept
{
    std::swap(lock_, other.lock_);
    std::swap(made_, other.made_);
    std::swap(folder_, other.folder_);
    std::swap(fd_, other.fd_);
}

void remove_leftovers(const fs::path& dir)
{
    std::error_code error;
    std::vector<fs::path> left;
    for (fs::directory_iterator at(dir, error), end; !error && at != end; at.increment(error)) {
        const pid_t pid = writer_of(at->path().filename().string());
        struct stat status {};
        if (pid == 0 || ::lstat(at->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
        const bool gone = pid == ::getpid() || (::kill(pid, 0) != 0 && errno == ESRCH);  // ours: the number came round again
        if (gone || std::time(nullptr) - status.st_mtime > leftover_age) left.push_back(at->path());
    }
    for (const fs::path& path : left) ::unlink(path.c_str());
}

}  // namespace seldinger
