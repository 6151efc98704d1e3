// Looks for the assets folder: environment, beside the program, source tree, where it was installed.
#include "core/assets.h"

#include "core/error.h"

#include <fmt/format.h>

#include <cstdlib>
#include <vector>

namespace seldinger {

namespace fs = std::filesystem;

fs::path assets_folder()
{
    std::vector<fs::path> places;
    std::error_code unreadable;
    if (const char* named = std::getenv("SELDINGER_ASSETS")) places.emplace_back(named);
    const fs::path program = fs::read_symlink("/proc/self/exe", unreadable).parent_path();
    if (!program.empty())
        places.insert(places.end(), {program.parent_path() / "assets", program.parent_path() / "share" / "seldinger"});
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
