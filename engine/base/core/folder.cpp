// Opens folders without following links in them, and reads, renames and removes by their descriptors.
#include "core/folder.h"

#include "core/check.h"
#include "core/error.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_folder(const fs::path& path, const std::string& what)
{
    throw Error(ErrorKind::BadFile, path.string() + ": " + what);
}

/// Neither a path out of the folder nor a path down: a file's list may name its neighbours.
bool is_name(const std::string& name)
{
    return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos &&
           name.find('\0') == std::string::npos;
}

void check_name(const fs::path& folder, const std::string& name)
{
    if (!is_name(name)) fail_folder(folder, fmt::format("got \"{}\"; expected the name of a file in this folder", name));
}

std::shared_ptr<const int> handle_of(int fd)
{
    return {new int(fd), [](const int* owned) {
                ::close(*owned);
                delete owned;
            }};
}

}  // namespace

bool leads_below(const fs::path& path)
{
    return !path.empty() &&
           std::all_of(path.begin(), path.end(), [](const fs::path& part) { return part != "/" && is_name(part.string()); });
}

int FilePlace::start() const { return handle_ ? *handle_ : AT_FDCWD; }
int FilePlace::read_flags() const { return handle_ ? O_NOFOLLOW : 0; }

FilePlace FilePlace::beside(const std::string& name) const
{
    FilePlace other = *this;
    other.path_.replace_filename(name);
    return other;
}

// O_PATH: a folder that may be entered but not listed is one too
Folder Folder::at(const fs::path& path)
{
    const int fd = ::open(path.empty() ? "." : path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) fail_folder(path, fmt::format("cannot be opened as a folder: {}; check the path", std::strerror(errno)));
    Folder folder;
    folder.handle_ = handle_of(fd);
    folder.path_ = path;
    return folder;
}

int Folder::fd() const
{
    SEL_ASSERT(handle_);
    return *handle_;
}

Folder Folder::inner(const std::string& name) const
{
    check_name(path_, name);
    const int there = ::openat(fd(), name.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (there < 0 && (errno == ENOTDIR || errno == ELOOP))
        fail_folder(path_ / name, "is a link or no folder; nothing is done through it. Fix: remove it, or take another folder");
    if (there < 0) fail_folder(path_ / name, fmt::format("cannot be opened as a folder: {}", std::strerror(errno)));
    Folder folder;
    folder.handle_ = handle_of(there);
    folder.path_ = path_ / name;
    return folder;
}

Folder Folder::make(const std::string& name) const
{
    check_name(path_, name);
    if (::mkdirat(fd(), name.c_str(), 0777) != 0 && errno != EEXIST)
        fail_folder(path_ / name,
                    fmt::format("cannot be made: {}; choose a folder that can be written to", std::strerror(errno)));
    return inner(name);
}

FilePlace Folder::operator/(const std::string& name) const
{
    check_name(path_, name);
    (void)fd();
    FilePlace place(path_ / name);
    place.handle_ = handle_;
    return place;
}

bool Folder::has(const std::string& name) const
{
    struct stat status {};
    return is_name(name) && ::fstatat(fd(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
}

bool Folder::has_below(const fs::path& file) const
{
    Folder at = *this;
    for (const fs::path& part : file.parent_path()) {
        if (!at.has(part.string())) return false;
        at = at.inner(part.string());
    }
    return at.has(file.filename().string());
}

std::vector<std::string> Folder::names() const
{
    const int listed = ::openat(fd(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR* stream = listed < 0 ? nullptr : ::fdopendir(listed);
    if (!stream) {
        const int error = errno;
        if (listed >= 0) ::close(listed);
        fail_folder(path_, fmt::format("cannot be read: {}", std::strerror(error)));
    }
    std::vector<std::string> names;
    while (const dirent* entry = ::readdir(stream))
        if (std::strcmp(entry->d_name, ".") != 0 && std::strcmp(entry->d_name, "..") != 0) names.emplace_back(entry->d_name);
    ::closedir(stream);
    std::sort(names.begin(), names.end());
    return names;
}

bool Folder::rename(const std::string& name, const Folder& to, const std::string& new_name) const
{
    check_name(path_, name), check_name(to.path_, new_name);
    if (::renameat(fd(), name.c_str(), to.fd(), new_name.c_str()) == 0) return true;
    if (errno == ENOENT) return false;
    fail_folder(path_ / name, fmt::format("cannot be renamed ({})", std::strerror(errno)));
}

int Folder::remove(const std::string& name) const
{
    check_name(path_, name);
    struct stat status {};
    if (::fstatat(fd(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT ? 0 : errno;
    const bool is_folder = S_ISDIR(status.st_mode);
    if (!is_folder && !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode)) return EPERM;
    return ::unlinkat(fd(), name.c_str(), is_folder ? AT_REMOVEDIR : 0) == 0 || errno == ENOENT ? 0 : errno;
}

}  // namespace seldinger
