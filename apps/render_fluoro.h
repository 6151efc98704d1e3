#pragma once
// The options of `seldinger render --view fluoro`, combined with those of the run's scene.

#include "pictures/xray.h"
#include "render_frames.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

class CommandLine;

struct FluoroArguments : XrayOptions {
    std::vector<std::string> arms;  // positions of the detector, a view each
    std::filesystem::path views;     // sweep of [carm] and [contrast], a view for each of its runs
    bool no_noise = false, no_contrast = false;

    void declare(CommandLine& command);
    /// The first option given that only --view fluoro takes, or empty.
    [[nodiscard]] std::string first_given() const;
    /// How many views a frame has. @throws Error BadFile, BadScene: the sweep
    [[nodiscard]] std::size_t view_count() const;
};

/// @param width,height  pixels. @param frames  which, and where to
ErrorKind render_fluoro_view(const std::filesystem::path& dir, const FluoroArguments& arguments, int width, int height,
                            const FrameArguments& frames);

}  // namespace seldinger::apps
