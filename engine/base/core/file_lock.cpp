// Takes and releases locks by flock on a separate file; finds files that a killed process left half written.
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
#include <thread>
#include <utility>
#include <vector>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

constexpr std::time_t leftover_age = 60;  // [s] no file takes as long to be written

/// Whether `fd` is still the file of that name: whoever had the lock before may have removed it in between.
bool still_there(int fd, const FilePlace& lock)
{
    struct stat opened {
    }, named{};
    return ::fstat(fd, &opened) == 0 && ::fstatat(lock.start(), lock.name().c_str(), &named, AT_SYMLINK_NOFOLLOW) == 0 &&
           opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

constexpr long unnamed = 0, no_lock = -1;

/// The process that the lock names; unnamed while it is new; no_lock of a file in which anything else stands.
long holder(int fd)
{
    struct stat status {};
    char text[32] = {};
    // a second name: writing here would write there
    if (::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode) || status.st_nlink > 1) return no_lock;
    const ssize_t got = ::pread(fd, text, sizeof text, 0);
    if (got == 0) return unnamed;
    long pid = 0;
    const auto [end, error] = std::from_chars(text, text + std::max<ssize_t>(got, 0), pid);
    return error == std::errc() && pid > 0 && end + 1 == text + got && *end == '\n' ? pid : no_lock;
}

[[noreturn]] void refuse(const FilePlace& lock)
{
    throw Error(ErrorKind::BadFile, lock.path().string() +
                                        ": is not a lock file (a link, a file with a second name or "
                                        "with something in it); move it away, or choose another folder with -o");
}

constexpr int lockless = -1, held = -2;

/// @param refuses  where another process holds it
/// @return a descriptor that holds the lock; lockless where the file system knows no locks; held
int take(const fs::path& what, const FilePlace& lock, std::chrono::milliseconds patience, bool refuses)
{
    constexpr std::chrono::milliseconds pause{20};  // between two tries
    for (;; patience -= pause) {
        const int fd = ::openat(lock.start(), lock.name().c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (fd < 0 && errno == ELOOP) refuse(lock);
        if (fd < 0)
            throw Error(ErrorKind::BadFile, fmt::format("{}: cannot be written: {}; {}", what.string(), std::strerror(errno),
                                                       errno == ENOSPC ? "free some space or choose another place with -o"
                                                                       : "choose a place that can be written to with -o"));
        const long by = holder(fd);
        if (by == no_lock) {
            ::close(fd);
            refuse(lock);
        }
        if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
            const int error = errno;
            ::close(fd);
            if (error == EINTR) continue;
            if (error != EWOULDBLOCK) return lockless;
            if (patience > pause) {
                std::this_thread::sleep_for(pause);
                continue;
            }
            if (!refuses) return held;
            throw Error(ErrorKind::BadFile, fmt::format("{}: is being written by another run{}; wait for its end, stop it, or "
                                                       "choose another place with -o",
                                                       what.string(), by == unnamed ? "" : fmt::format(", process {}", by)));
        }
        if (still_there(fd, lock)) return fd;
        ::close(fd);
    }
}

/// The process in a name NAME.PID.tmp; 0 for other names.
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

FileLock::FileLock(const fs::path& what, FilePlace lock, std::chrono::milliseconds patience, bool refuses)
    : lock_(std::move(lock))
{
    fd_ = take(what, lock_, patience, refuses);
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
    FileLock lock = of_folder(Folder(dir));
    lock.folder_ = dir;
    lock.made_ = made;
    return lock;
}

FileLock FileLock::of_folder(const Folder& folder)
{
    FileLock lock(folder.path(), folder / ".lock");
    remove_leftovers(folder);
    return lock;
}

FileLock FileLock::of_file(const FilePlace& file, std::chrono::milliseconds patience)
{
    const fs::path& path = file.path();
    if (file.start() == AT_FDCWD && path.has_parent_path()) make_folder(path.parent_path());
    return {path, file.beside(path.filename().string() + ".lock"), patience};
}

std::optional<FileLock> FileLock::if_free(const FilePlace& file)
{
    FileLock lock(file.path(), file.beside(file.path().filename().string() + ".lock"), {}, false);
    return lock.fd_ == held ? std::nullopt : std::optional(std::move(lock));
}

FileLock::~FileLock()
{
    if (fd_ < 0) return;
    // held until it is closed: nobody else has it under this name
    if (still_there(fd_, lock_)) ::unlinkat(lock_.start(), lock_.name().c_str(), 0);
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

void remove_leftovers(const Folder& folder)
{
    std::vector<std::string> names;
    try {
        names = folder.names();
    } catch (const Error&) {  // may be entered and not listed
    }
    for (const std::string& name : names) {
        const pid_t pid = writer_of(name);
        if (pid == 0) continue;
        const FilePlace file = folder / name;
        struct stat status {};
        if (::fstatat(file.start(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode)) continue;
        const bool gone = pid == ::getpid() || (::kill(pid, 0) != 0 && errno == ESRCH);  // ours: the number came round again
        if (gone || std::time(nullptr) - status.st_mtime > leftover_age) (void)folder.remove(name);
    }
}

}  // namespace seldinger
