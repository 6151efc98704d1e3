#pragma once
// Where the shared reference data are: public patients' vessels and reference scenes that are not part of the project.

#include "support/skip.h"

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace seldinger::test {

/// The folder named by SELDINGER_SHARED, or `shared` beside the source folder; nothing when no data are there.
inline std::optional<std::filesystem::path> shared_folder()
{
    const char* given = std::getenv("SELDINGER_SHARED");
    const std::filesystem::path path =
        given ? std::filesystem::path(given) : std::filesystem::path(SEL_SOURCE_DIR) / ".." / "shared";
    std::error_code ignored;
    if (!std::filesystem::is_directory(path / "vessels", ignored) || !std::filesystem::is_directory(path / "scenes", ignored))
        return std::nullopt;
    return std::filesystem::canonical(path);
}

/// The same; when nothing is there the test case counts as skipped.
inline std::optional<std::filesystem::path> shared_folder_or_skip()
{
    auto folder = shared_folder();
    if (!folder) skip("no shared reference data (set SELDINGER_SHARED)");
    return folder;
}

}  // namespace seldinger::test
