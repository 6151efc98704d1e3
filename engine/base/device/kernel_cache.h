#pragma once
// PoCL's cache folder: whether it can be written to, and whether its contents are complete. PoCL 3.1 takes both for granted.

#include "core/file_lock.h"
#include "device/compiler_watch.h"

#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::device {

/// Call before PoCL first reads its cache. Removes truncated kernels. If the folder cannot
/// be written to, or has a link or a device in place of a kernel, prints a note. PoCL then uses a folder of this process alone,
/// which is removed at its end.
void prepare_kernel_cache();

/// What PoCL uses, by its own rules: POCL_CACHE_DIR, else pocl/kcache in XDG_CACHE_HOME or ~/.cache.
[[nodiscard]] std::filesystem::path kernel_cache_folder();

/// Whether this process says on stderr, once, that kernels are being compiled (some 20 s at a first start). Off until asked for.
void tell_compiling(bool on);

/// Around one call of the compiler. Says so before it where no kernel is in the cache, and after it where the compiler has just
/// written one: later ones follow. Reading cached kernels takes milliseconds, and no note is printed.
class CompilerCall {
public:
    CompilerCall();
    ~CompilerCall();
    CompilerCall(const CompilerCall&) = delete;
    CompilerCall& operator=(const CompilerCall&) = delete;

private:
    timespec begun_{};
};

/// While it lives no other process compiles what is called so, on this cache: the first one compiles, the others wait for it and
/// then read what it has kept. A process that dies gives its turn away. After two minutes one goes on without its turn, and says
/// so once.
class CompilerTurn {
public:
    /// @param what  program, options, device and kernel: compiled alike wherever it is called the same
    explicit CompilerTurn(const std::string& what);

private:
    CompilerBusy busy_;
    FileLock lock_;
};

/// Folders of the cache in which PoCL has put a program at `since` or later whose bitcode has `mark` in it.
[[nodiscard]] std::vector<std::filesystem::path> new_programs(const timespec& since, const std::string& mark);

/// Copies a compiled kernel from one program's folder to another's, if it is in the one and not in the other.
void copy_kernel(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& kernel);

/// For the line of a build that failed: the folder, and what to do about it.
[[nodiscard]] std::string kernel_cache_advice();

/// Removes truncated shared objects and bitcode files of PoCL in `folder`: those under PoCL's paths and names
/// (HH/HASH/KERNEL/SIZE/), and no links. Other things in the folder are somebody's.
/// @return the first entry under such a name that PoCL has not made: a link, a pipe, a device, a file for a folder; empty: there
/// is none
[[nodiscard]] std::filesystem::path clean_kernel_cache(const std::filesystem::path& dir);

}  // namespace seldinger::device
