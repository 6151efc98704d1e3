// Runs plot scripts with Debian's python3.
#include "assets.h"

#include "core/child_process.h"
#include "core/note.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

std::string python()
{
    // Debian's own: another python3 ahead of it in PATH need not have its packages
    return fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
}

}  // namespace

bool draw_with(const std::string& script, const std::vector<std::string>& paths)
{
    std::vector<std::string> words = {python(), (assets_folder() / script).string()};
    for (const std::string& path : paths) words.push_back(path.starts_with('-') ? "./" + path : path);  // no option of the script
    const pid_t script_run = start_program(words);
    if (script_run > 0 && wait_for_program(script_run) == 0) return true;
    if (script_run < 0) {
        note(fmt::format("seldinger: no pictures: {}\n",
                         why_not_started(words.front(), "on Debian, as root: apt-get install python3-matplotlib")));
        return false;
    }
    note(fmt::format("seldinger: no pictures: {} failed; it needs python3-matplotlib; to draw them: {}\n", script,
                     fmt::join(words, " ")));
    return false;
}

}  // namespace seldinger::apps
