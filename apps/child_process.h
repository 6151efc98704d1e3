#pragma once
// The program as a second process: its memory returns to the system when it ends.

#include <string>
#include <vector>

namespace seldinger::apps {

struct ChildEnd {
    int code = 0;     // exit code, or 128 + the signal that ended it
    std::string out;  // what it wrote to stdout
};

/// Runs this program with these arguments; its stderr is ours. A signal that asks us to stop is passed on to it once.
/// @param input  for its stdin   @throws Error Stopped: no process could be made
[[nodiscard]] ChildEnd run_self(const std::vector<std::string>& arguments, const std::string& input);

}  // namespace seldinger::apps
