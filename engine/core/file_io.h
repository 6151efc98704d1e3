#pragma once
// Files that are never half written. Whole files appear under their name only when complete (temporary name, then rename);
// tables that grow are appended row by row, so that a kill at any moment leaves every row that was written.
// Every write is checked: a full disk is an Error(BadFile) at once, and what was there before stays.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace seldinger {

enum class Durable { No, Yes };  // Yes: survives a power cut too (fsync), for checkpoints

/// The whole file as bytes. @throws Error BadFile when it is missing, unreadable, no plain file (a folder; a pipe or a device, which
/// may give nothing or have no end), or has more than `most` bytes
[[nodiscard]] std::string read_file(const std::filesystem::path& path, std::uint64_t most = ~std::uint64_t{0});

/// Replaces `path` in one go. @throws Error BadFile; the old file, if any, is then untouched
void write_file(const std::filesystem::path& path, std::string_view content, Durable durable = Durable::No);

/// Makes a folder and its parents. @throws Error BadFile
void make_folder(const std::filesystem::path& path);

/// A file that grows at its end. Each append() is one write to the system: nothing is held back in this process.
class AppendFile {
public:
    AppendFile() = default;
    /// Opens for appending after cutting the file to `keep` bytes (0: starts anew). @throws Error BadFile
    AppendFile(const std::filesystem::path& path, std::uint64_t keep);
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
