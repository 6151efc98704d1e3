#pragma once
// One writer to a folder or to a file that grows: the second one is refused in one line. The lock is the system's own
// (flock), so that it ends with the process, however that ends. Who only reads takes none.

#include "core/folder.h"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace seldinger {

class FileLock {
public:
    FileLock() = default;
    /// Locks a folder by a file ".lock" in it, makes the folder where it is missing, and removes what a killed process has left
    /// half written there (name.PID.tmp). A folder that was made and stayed empty goes with the lock.
    /// @throws Error BadFile: another process writes there, the folder cannot be written to, or the lock's name belongs to a
    /// link, to a file with a second name or to a file with contents
    [[nodiscard]] static FileLock of_folder(const std::filesystem::path& dir);
    /// The same of a folder that is open.
    [[nodiscard]] static FileLock of_folder(const Folder& folder);
    /// Locks one file that is to be written, by "FILE.lock" beside it.
    /// @param patience  how long to wait for another process to end its writing     @throws Error BadFile
    [[nodiscard]] static FileLock of_file(const FilePlace& file, std::chrono::milliseconds patience = {});
    /// The same; nothing where another process has it. @throws Error BadFile
    [[nodiscard]] static std::optional<FileLock> if_free(const FilePlace& file);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;
    FileLock(FileLock&& other) noexcept { swap(other); }
    FileLock& operator=(FileLock&& other) noexcept
    {
        swap(other);
        return *this;
    }

private:
    FileLock(const std::filesystem::path& what, FilePlace lock, std::chrono::milliseconds patience = {}, bool refuses = true);
    void swap(FileLock& other) noexcept;

    FilePlace lock_{""};
    std::filesystem::path folder_, made_;  // made_: the first folder that there was not
    int fd_ = -1;
};

/// Removes files NAME.PID.tmp of processes that are no more.
void remove_leftovers(const Folder& folder);

}  // namespace seldinger
