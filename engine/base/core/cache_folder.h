#pragma once
// The user's cache folder: files that can be made again at any time. Every failure is silent, since a cache only saves time.
//
// Processes share the folder without locks: a file appears whole or not at all (core/file_io.h), and
// who reads a file that another process removes still has it open. Links in the folder are followed neither for reading nor for
// writing.

#include "core/folder.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace seldinger {

class CacheFolder {
public:
    /// The folder "seldinger" under XDG_CACHE_HOME, else under ~/.cache; made where it is missing.
    CacheFolder();

    [[nodiscard]] bool is_open() const { return folder_.has_value(); }
    /// For messages.
    [[nodiscard]] std::string path_of(const std::string& name) const { return (folder_->path() / name).string(); }

    struct Entry {
        std::string bytes;
        bool foreign = false;  // a link, no plain file, or another user's: not read
    };
    /// @return nothing where there is no such file or it cannot be read. Marks the file as used now
    [[nodiscard]] std::optional<Entry> read(const std::string& name) const;
    /// Replaces the file in one go, where it can.
    void write(const std::string& name, std::string_view content) const;
    void remove(const std::string& name) const;
    /// Removes the longest unused files of that ending until those left have at most `most` bytes, and temporary files that a
    /// killed process left an hour ago.
    void trim(std::string_view ending, std::uint64_t most) const;

private:
    std::optional<Folder> folder_;
};

}  // namespace seldinger
