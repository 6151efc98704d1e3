// Reads, writes and removes files of the cache folder by POSIX calls relative to the open folder.
#include "core/cache_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <vector>

namespace seldinger {
namespace {

constexpr std::time_t leftover_age = 3600;  // [s] no file takes as long to be written

/// XDG_CACHE_HOME counts where it is absolute [XDG Base Directory Specification]. Empty: there is no home.
std::filesystem::path caches_of_user()
{
    const char* given = std::getenv("XDG_CACHE_HOME");
    if (given && *given == '/') return given;
    const char* home = std::getenv("HOME");
    return home && *home == '/' ? std::filesystem::path(home) / ".cache" : std::filesystem::path();
}

bool read_all(int fd, std::string& bytes)
{
    for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t got = ::read(fd, bytes.data() + at, bytes.size() - at);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += static_cast<std::size_t>(got);
    }
    return true;
}

bool write_all(int fd, std::string_view bytes)
{
    while (!bytes.empty()) {
        const ssize_t put = ::write(fd, bytes.data(), bytes.size());
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
}

}  // namespace

CacheFolder::CacheFolder()
{
    const std::filesystem::path base = caches_of_user();
    if (base.empty()) return;
    path_ = base / "seldinger";
    std::error_code ignored;
    std::filesystem::create_directories(base, ignored);
    (void)::mkdir(path_.c_str(), 0700);
    fd_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

CacheFolder::~CacheFolder()
{
    if (fd_ >= 0) ::close(fd_);
}

std::string CacheFolder::path_of(const std::string& name) const { return path_ + "/" + name; }

std::optional<CacheFolder::Entry> CacheFolder::read(const std::string& name) const
{
    Entry entry;
    const int fd = ::openat(fd_, name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY);
    if (fd < 0) {
        if (errno != ELOOP) return std::nullopt;
        entry.foreign = true;
        return entry;
    }
    struct stat status {};
    const bool known = ::fstat(fd, &status) == 0;
    entry.foreign = known && (!S_ISREG(status.st_mode) || status.st_uid != ::geteuid());
    bool read = known;
    if (known && !entry.foreign) {
        entry.bytes.resize(static_cast<std::size_t>(status.st_size));
        read = read_all(fd, entry.bytes);
        (void)::futimens(fd, nullptr);
    }
    ::close(fd);
    if (!read) return std::nullopt;
    return entry;
}

bool CacheFolder::write(const std::string& name, std::string_view content) const
{
    static std::atomic<unsigned> count = 0;
    const std::string temporary = fmt::format("{}.{}-{}-{:x}.tmp", name, ::getpid(), count++, std::time(nullptr));
    const int fd = ::openat(fd_, temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0) return false;
    bool done = write_all(fd, content);
    done = ::close(fd) == 0 && done;
    done = done && ::renameat(fd_, temporary.c_str(), fd_, name.c_str()) == 0;
    if (!done) ::unlinkat(fd_, temporary.c_str(), 0);
    return done;
}

void CacheFolder::remove(const std::string& name) const { (void)::unlinkat(fd_, name.c_str(), 0); }

void CacheFolder::trim(std::string_view ending, std::uint64_t most) const
{
    struct File {
        timespec used;
        std::uint64_t bytes;
        std::string name;
    };
    DIR* listing = ::fdopendir(::openat(fd_, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!listing) return;
    std::vector<File> files;
    std::uint64_t total = 0;
    while (const dirent* at = ::readdir(listing)) {
        const std::string name = at->d_name;
        struct stat status {};
        if (::fstatat(fd_, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(status.st_mode)) continue;
        if (name.ends_with(".tmp") && std::time(nullptr) - status.st_mtime > leftover_age) remove(name);
        if (!name.ends_with(ending)) continue;
        files.push_back({status.st_mtim, static_cast<std::uint64_t>(status.st_size), name});
        total += files.back().bytes;
    }
    ::closedir(listing);
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) {
        return a.used.tv_sec != b.used.tv_sec ? a.used.tv_sec < b.used.tv_sec : a.used.tv_nsec < b.used.tv_nsec;
    });
    for (auto file = files.begin(); file != files.end() && total > most; ++file) {
        remove(file->name);
        total -= file->bytes;
    }
}

}  // namespace seldinger
