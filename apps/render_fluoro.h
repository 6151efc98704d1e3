#pragma once
// The options of `seldinger render --view fluoro`, and what they and the run's scene come to.

#include "render_frames.h"

#include <filesystem>
#include <optional>
#include <string>

namespace seldinger::apps {

class CommandLine;

/// Absent: what the scene's [carm] says, or its defaults.
struct FluoroArguments {
    std::optional<std::string> c_arm, body, mask;
    std::optional<double> sid, sod, field, kvp, kev, photons, blur;
    std::optional<std::int64_t> seed;
    std::string raw, dicom;
    bool no_noise = false, no_contrast = false, logarithmic = false;

    void declare(CommandLine& command);
    /// The first option given that only --view fluoro takes, or empty.
    [[nodiscard]] std::string first_given() const;
};

/// @param width,height  pixels. @param frames  which, and where to
ExitCode render_fluoro_view(const std::filesystem::path& dir, const FluoroArguments& arguments, int width, int height,
                            const FrameArguments& frames);

}  // namespace seldinger::apps
