#pragma once
// A folder that is open. Operations below it stay in that folder, even if its name changes meanwhile. They never follow a link: a
// link in it, or in the place of a folder in it, is refused. So nothing outside of a folder that came from somebody else, or that
// others write to, is read, written or removed.

#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace seldinger {

/// Where a file lies: a path that a user gave, in which links are followed as far as the file's own folder, or a name in a
/// Folder.
class FilePlace {
public:
    template <class Path>
        requires std::is_convertible_v<Path, std::filesystem::path>
    FilePlace(const Path& path) : path_(path)  // NOLINT: a path is a place
    {
    }

    /// The descriptor that name() starts from, or AT_FDCWD.
    [[nodiscard]] int start() const;
    [[nodiscard]] const std::string name() const { return handle_ ? path_.filename().string() : path_.string(); }
    /// For messages, and for operations by name alone.
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// O_NOFOLLOW in a Folder, else 0: a user's own link to a file that is to be read is followed.
    [[nodiscard]] int read_flags() const;
    /// Another file beside it.
    [[nodiscard]] FilePlace beside(const std::string& name) const;

private:
    friend class Folder;
    std::shared_ptr<const int> handle_;  // of the folder; none: a path of its own
    std::filesystem::path path_;
};

/// Whether a path is one of names, which leads from a folder to something below it.
[[nodiscard]] bool leads_below(const std::filesystem::path& path);

/// Names are of files: none with a "/" in it, nor "..". @throws Error BadFile otherwise
class Folder {
public:
    Folder() = default;
    /// The folder that a user names; links that lead to it are followed. @throws Error BadFile
    template <class Path>
        requires std::is_convertible_v<Path, std::filesystem::path>
    Folder(const Path& path) : Folder(at(path))  // NOLINT: a path names a folder
    {
    }

    /// A folder in this one. @throws Error BadFile: there is none, or a link in its place
    [[nodiscard]] Folder inner(const std::string& name) const;
    /// The same, made where there is nothing.
    [[nodiscard]] Folder make(const std::string& name) const;
    [[nodiscard]] FilePlace operator/(const std::string& name) const;

    /// Whether anything has that name, a link that leads nowhere too.
    [[nodiscard]] bool has(const std::string& name) const;
    /// The same of a path of names; without a link on the way. @throws Error BadFile: a link in the place of a folder
    [[nodiscard]] bool has_below(const std::filesystem::path& file) const;
    /// Its entries, in the order of the names. @throws Error BadFile
    [[nodiscard]] std::vector<std::string> names() const;
    /// Into another folder or under another name; of a link the link itself. @return false: there is no `name` (any more)
    /// @throws Error BadFile
    bool rename(const std::string& name, const Folder& to, const std::string& new_name) const;
    /// Removes a file, a link itself, or an empty folder; never a folder's contents. @return 0 where it is gone now or was not
    /// there, or errno
    int remove(const std::string& name) const;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    static Folder at(const std::filesystem::path& path);
    [[nodiscard]] int fd() const;
    std::shared_ptr<const int> handle_;
    std::filesystem::path path_;
};

}  // namespace seldinger
