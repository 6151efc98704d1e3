// The cache folder's own rules (private, silent, bounded) on the project's folders and files.
#include "core/cache_folder.h"

#include "core/error.h"
#include "core/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <vector>

namespace seldinger {
namespace {

// by age alone: the process may be another machine's that shares the home (core/file_lock.h asks for it by number)
constexpr std::time_t abandoned_age = 3600;  // [s] no file takes as long to be written

/// XDG_CACHE_HOME counts where it is absolute [XDG Base Directory Specification]. Empty: there is no home.
std::filesystem::path caches_of_user()
{
    const char* given = std::getenv("XDG_CACHE_HOME");
    if (given && *given == '/') return given;
    const char* home = std::getenv("HOME");
    return home && *home == '/' ? std::filesystem::path(home) / ".cache" : std::filesystem::path();
}

bool look(const FilePlace& file, struct stat& status)
{
    return ::fstatat(file.start(), file.name().c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
}

}  // namespace

CacheFolder::CacheFolder()
{
    const std::filesystem::path base = caches_of_user();
    if (base.empty()) return;
    try {
        make_folder(base);
        (void)::mkdir((base / "seldinger").c_str(), 0700);
        folder_ = Folder(base).inner("seldinger");
    } catch (const Error&) {
    }
}

std::optional<CacheFolder::Entry> CacheFolder::read(const std::string& name) const
{
    const FilePlace file = *folder_ / name;
    struct stat status {};
    if (!look(file, status)) return std::nullopt;
    Entry entry;
    entry.foreign = !S_ISREG(status.st_mode) || status.st_uid != ::geteuid();
    if (entry.foreign) return entry;
    try {
        entry.bytes = read_file(file);
    } catch (const Error&) {
        return std::nullopt;
    }
    (void)::utimensat(file.start(), file.name().c_str(), nullptr, AT_SYMLINK_NOFOLLOW);
    return entry;
}

void CacheFolder::write(const std::string& name, std::string_view content) const
{
    try {
        write_file(*folder_ / name, content);
    } catch (const Error&) {
    }
}

void CacheFolder::remove(const std::string& name) const { (void)folder_->remove(name); }

void CacheFolder::trim(std::string_view ending, std::uint64_t most) const
{
    struct File {
        timespec used;
        std::uint64_t bytes;
        std::string name;
    };
    std::vector<std::string> names;
    try {
        names = folder_->names();
    } catch (const Error&) {  // may be entered and not listed
    }
    std::vector<File> files;
    std::uint64_t total = 0;
    for (const std::string& name : names) {
        struct stat status {};
        if (!look(*folder_ / name, status) || !S_ISREG(status.st_mode)) continue;
        if (name.ends_with(".tmp") && std::time(nullptr) - status.st_mtime > abandoned_age) remove(name);
        if (!name.ends_with(ending)) continue;
        files.push_back({status.st_mtim, static_cast<std::uint64_t>(status.st_size), name});
        total += files.back().bytes;
    }
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) {
        return a.used.tv_sec != b.used.tv_sec ? a.used.tv_sec < b.used.tv_sec : a.used.tv_nsec < b.used.tv_nsec;
    });
    for (auto file = files.begin(); file != files.end() && total > most; ++file) {
        remove(file->name);
        total -= file->bytes;
    }
}

}  // namespace seldinger
