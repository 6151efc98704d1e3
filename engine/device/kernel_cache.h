#pragma once
// The folder where PoCL keeps compiled kernels: whether it can be written to, and whether what is in it is whole. PoCL itself ends
// in "does not build", in no device at all, or by a signal where it is not.

#include <filesystem>
#include <string>

namespace seldinger::device {

/// Before PoCL first looks: takes out compiled kernels that are cut off (mapping one ends the process by SIGBUS); where the
/// folder cannot be written to, says so on stderr and has PoCL use a folder of this process alone, which goes at its end.
void prepare_kernel_cache();

/// What PoCL uses, by its own rules: POCL_CACHE_DIR, else pocl/kcache in XDG_CACHE_HOME or ~/.cache.
[[nodiscard]] std::filesystem::path kernel_cache_folder();

/// For the line of a build that failed: the folder, and what to do about it.
[[nodiscard]] std::string kernel_cache_advice();

/// Removes the shared objects and bitcode files of PoCL in `dir` that are shorter than they say themselves: those that lie where PoCL
/// puts them, under the names that it gives (HH/HASH/KERNEL/SIZE/), and no links. Other things in the folder are somebody's. @return how many
int remove_cut_kernels(const std::filesystem::path& dir);

}  // namespace seldinger::device
