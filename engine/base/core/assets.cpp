// Looks for the assets folder: environment, around the shared library, around the program.
#include "core/assets.h"

#include "core/error.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
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

/// Adds the folders to look in around a program or a library: it may be
/// PREFIX/lib/x86_64-linux-gnu/glibc-hwcaps/x86-64-v3/libseldinger.so.
void add_places_around(const fs::path& file, std::vector<fs::path>& places)
{
    fs::path around = file;
    for (int up = 0; up < 5 && around.has_relative_path(); ++up) {
        around = around.parent_path();
        for (const fs::path& beside : {around / "assets", around / "share" / "seldinger"})
            if (is_ours(beside, file)) places.push_back(beside);
    }
}

/// The shared library that this is in; empty in a program that has the engine in it.
fs::path own_library()
{
    Dl_info code{};
    std::error_code unreadable;
    if (::dladdr(reinterpret_cast<const void*>(&own_library), &code) == 0) return {};
    // of a program it is what the shell was given, which may name another file here
    const fs::path named(code.dli_fname);
    return named.is_absolute() ? fs::canonical(named, unreadable) : fs::path();
}

}  // namespace

fs::path assets_folder()
{
    std::vector<fs::path> places;
    std::error_code unreadable;
    if (const char* named = std::getenv("SELDINGER_ASSETS")) places.emplace_back(named);
    add_places_around(own_library(), places);
    add_places_around(fs::read_symlink("/proc/self/exe", unreadable), places);
    for (const fs::path& place : places)
        if (fs::exists(place / "scenes", unreadable)) return place;
    throw Error(ErrorKind::BadFile,
                fmt::format("the program's scenes were not found beside it; set SELDINGER_ASSETS to the project's "
                            "folder \"assets\" (looked in {})",
                            places.empty() ? std::string("no folder: none lies beside it") : places.front().string()));
}

std::string scene_file(const std::string& word)
{
    const fs::path path(word);
    std::error_code unreadable;
    const bool leads_out = path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
    if (path.empty() || leads_out || path.has_extension() || fs::exists(path, unreadable)) return word;
    try {
        for (const char* folder : {"", "reference"})
            if (const fs::path file = assets_folder() / "scenes" / folder / (word + ".toml");
                fs::is_regular_file(file, unreadable))
                return file.string();
    } catch (const Error&) {  // no scenes come with this program
    }
    return word;
}

}  // namespace seldinger
