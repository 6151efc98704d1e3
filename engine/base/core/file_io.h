#pragma once
// Files that are never half written. Whole files appear under their name only when complete (temporary name, then rename);
// tables that grow are appended row by row, so that a kill at any moment leaves every row that was written.
// Every write is checked: a full disk is an Error(BadFile) at once, and an existing file stays. Nothing is written through a
// link, into a file that has a second name, or in the place of a pipe or a device.

#include "core/folder.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace seldinger {

enum class Durable { No, Yes };  // Yes: survives a power cut too (fsync), for checkpoints

/// The whole file as bytes. @throws Error BadFile when it is missing, unreadable, no plain file (a folder; a pipe or a device,
/// which may give nothing or have no end), or has more than `most` bytes
[[nodiscard]] std::string read_file(const FilePlace& place, std::uint64_t most = ~std::uint64_t{0});

/// Replaces the file in one go; of a link or of a file with two names that name alone. @throws Error BadFile; the old file, if
/// any, is then untouched
void write_file(const FilePlace& place, std::string_view content, Durable durable = Durable::No);

/// A file with a temporary name beside its final place (NAME.PID.tmp), which must not have existed: links and files of others
/// stay untouched. Goes again unless it is put in place.
class NewFile {
public:
    /// @throws Error BadFile: the folder cannot be written to, or a folder, a pipe or a device is in the place
    explicit NewFile(FilePlace place);
    ~NewFile();
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;

    [[nodiscard]] int fd() const { return fd_; }
    /// @throws Error BadFile
    void write(std::string_view content);
    void put_in_place(Durable durable = Durable::No);

private:
    FilePlace place_, own_;
    int fd_ = -1;
};

/// Makes a folder and its parents. @throws Error BadFile
void make_folder(const std::filesystem::path& path);
/// The folder of a file that a user names. @throws Error BadFile
void make_folder_of(const std::filesystem::path& file);

/// A folder below or beside one that a user gave, under a name of this program's choice. It is made if there is none. A link in
/// its place, which somebody else may have put there, is refused. @throws Error BadFile
[[nodiscard]] Folder make_own_folder(const std::filesystem::path& path);

/// A file that grows at its end. Each append() is one write to the system: nothing is held back in this process.
class AppendFile {
public:
    AppendFile() = default;
    static constexpr std::uint64_t everything = ~std::uint64_t{0};
    /// Opens for appending after cutting the file to `keep` bytes (0: starts anew; everything: uncut). @throws Error BadFile
    AppendFile(const FilePlace& place, std::uint64_t keep);
    ~AppendFile();
    AppendFile(const AppendFile&) = delete;
    AppendFile& operator=(const AppendFile&) = delete;
    AppendFile(AppendFile&& other) noexcept { swap(other); }
    AppendFile& operator=(AppendFile&& other) noexcept
    {
        swap(other);
        return *this;
    }

    /// @throws Error BadFile; a part of a row that a full disk let through is cut off again
    void append(std::string_view row);
    void sync();
    [[nodiscard]] std::uint64_t size() const { return size_; }

private:
    void swap(AppendFile& other) noexcept;
    std::filesystem::path path_;
    int fd_ = -1;
    std::uint64_t size_ = 0;
};

}  // namespace seldinger
