#pragma once
// The options of `seldinger render --view fluoro`, combined with those of the run's scene.

#include "render_frames.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace seldinger::apps {

class CommandLine;

/// Absent: what the scene's [carm] says, or its defaults.
struct FluoroArguments {
    std::vector<std::string> c_arm;  // a view each
    std::filesystem::path views;     // sweep of [carm] and [contrast], a view for each of its runs
    std::optional<std::string> body, mask;
    std::optional<double> sid, sod, field, kvp, kev, photons, blur;
    std::optional<std::int64_t> seed;
    std::string raw, dicom;
    bool no_noise = false, no_contrast = false, logarithmic = false;

    void declare(CommandLine& command);
    /// The first option given that only --view fluoro takes, or empty.
    [[nodiscard]] std::string first_given() const;
    /// How many views a frame has. @throws Error BadFile, BadScene: the sweep
    [[nodiscard]] std::size_t view_count() const;
};

/// @param width,height  pixels. @param frames  which, and where to
ExitCode render_fluoro_view(const std::filesystem::path& dir, const FluoroArguments& arguments, int width, int height,
                            const FrameArguments& frames);

}  // namespace seldinger::apps
