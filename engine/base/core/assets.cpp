// Looks for the assets folder: environment, beside the program, beside the shared library or, of a static one, in the source tree and
// where it was installed.
#include "core/assets.h"

#include "core/error.h"

#include <dlfcn.h>
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

/// Folders to look in for a program that is linked with the library.
std::vector<fs::path> places_of_library()
{
#if defined(SEL_SOURCE_ASSETS)
    return {SEL_SOURCE_ASSETS, SEL_INSTALLED_ASSETS};
#else
    Dl_info code{};
    std::error_code unreadable;
    if (::dladdr(reinterpret_cast<const void*>(&places_of_library), &code) == 0) return {};
    const fs::path library = fs::canonical(code.dli_fname, unreadable);
    std::vector<fs::path> places;
    // PREFIX/lib/x86_64-linux-gnu/glibc-hwcaps/x86-64-v3/libseldinger.so at most
    fs::path around = library;
    for (int up = 0; up < 5 && around.has_relative_path(); ++up) {
        around = around.parent_path();
        for (const fs::path& beside : {around / "assets", around / "share" / "seldinger"})
            if (is_ours(beside, library)) places.push_back(beside);
    }
    return places;
#endif
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
    for (const fs::path& place : places_of_library()) places.push_back(place);
    for (const fs::path& place : places)
        if (fs::exists(place / "scenes", unreadable)) return place;
    throw Error(ExitCode::BadFile,
                fmt::format("the program's scenes were not found beside it; set SELDINGER_ASSETS to the project's "
                            "folder \"assets\" (looked in {})",
                            places.empty() ? std::string("no folder: none lies beside it") : places.front().string()));
}

}  // namespace seldinger
