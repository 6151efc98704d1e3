// Looks for the assets folder: environment, beside the program, source tree, where it was installed.
#include "core/assets.h"

#include "core/error.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <vector>

namespace seldinger {

namespace fs = std::filesystem;

namespace {

/// Whether nobody but the owner of `program` (or who runs it, or root) can have put the folder there: plot scripts in it are
/// executed. In a folder that all may write to, such as /tmp, the sticky bit protects an entry's owner.
bool is_ours(const fs::path& place, const fs::path& program)
{
    struct stat file {}, at {}, above {};
    std::error_code unreadable;
    const fs::path whole = fs::canonical(place, unreadable);
    if (unreadable || ::stat(program.c_str(), &file) != 0) return false;
    for (fs::path one = whole;; one = one.parent_path()) {
        const fs::path parent = one.parent_path();
        if (::lstat(one.c_str(), &at) != 0 || ::lstat(parent.c_str(), &above) != 0) return false;
        if ((at.st_mode & S_IWOTH) != 0 && (one == whole || (at.st_mode & S_ISVTX) == 0)) return false;
        const bool owned = at.st_uid == 0 || at.st_uid == ::geteuid() || at.st_uid == file.st_uid;
        if ((above.st_mode & S_IWOTH) != 0 && !owned) return false;
        if (one == parent) return true;
    }
}

}  // namespace

fs::path assets_folder()
{
    std::vector<fs::path> places;
    std::error_code unreadable;
    if (const char* named = std::getenv("SELDINGER_ASSETS")) places.emplace_back(named);
    const fs::path program = fs::read_symlink("/proc/self/exe", unreadable), around = program.parent_path().parent_path();
    if (!program.empty())
        for (const fs::path& beside : {around / "assets", around / "share" / "seldinger"})
            if (is_ours(beside, program)) places.push_back(beside);
    // of a program elsewhere that is linked with the library
    places.emplace_back(SEL_SOURCE_ASSETS);
    places.emplace_back(SEL_INSTALLED_ASSETS);
    for (const fs::path& place : places)
        if (fs::exists(place / "scenes", unreadable)) return place;
    throw Error(ExitCode::BadFile,
                fmt::format("the program's scenes were not found beside it; set SELDINGER_ASSETS to the project's "
                            "folder \"assets\" (looked in {})",
                            places.front().string()));
}

}  // namespace seldinger
