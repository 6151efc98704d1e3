#pragma once
// What every view of `seldinger render` takes: frames, names, film; and the line that follows it.

#include "core/error.h"
#include "stop_signal.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#ifdef SEL_WITH_VIEW
    #include "view/frame_range.h"
#endif

namespace seldinger::apps {

class CommandLine;

struct FrameArguments {
    std::string frames, output, video, labels, farm, preview;
    int threads = 0, parent = 0;
    std::optional<double> fps;
    bool resume = false, numbered = false, quiet = false, label_vessel = false;

    void declare(CommandLine& command);
#ifdef SEL_WITH_VIEW
    /// @throws Error BadScene
    [[nodiscard]] FrameChoice choice() const;
#endif
};

/// Files of each frame of a farm whose `render` has these further options: "frame_######.png", "labels/frame_v2_######.json".
/// @throws Error BadFile, BadScene
[[nodiscard]] std::vector<std::string> files_of_frame(const std::vector<std::string>& words);

/// That the run of a farm's pictures is the one that the farm was made of. @throws Error BadScene
void check_farm_of(const std::filesystem::path& farm, const std::filesystem::path& run);

/// "AxB" or "A:B". @throws Error BadScene
[[nodiscard]] std::pair<int, int> two_numbers(const std::string& text, char between, const char* option, const char* form);

#ifdef SEL_WITH_VIEW
/// Frames done, frames per second and time left on a terminal's stderr; ends the drawing between two frames when a signal asks.
class FrameWatch {
public:
    FrameWatch();
    /// Throws Error TimeLimit or Interrupted after a signal.
    [[nodiscard]] FrameProgress progress() const;

private:
    StopSignal listening_;
    bool shows_;
};

void print_files(const PictureFiles& files);
#endif

}  // namespace seldinger::apps
