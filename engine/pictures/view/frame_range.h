#pragma once
// Which frames of a run are drawn, names of their pictures, and rate of a film.

#include "view/frame_choice.h"
#include "view/run_folder.h"

#include <filesystem>
#include <string>

namespace seldinger {

struct FrameRange {
    std::size_t first = 0, last = 0;  // both included
    [[nodiscard]] std::size_t count() const { return last - first + 1; }
};

/// @throws Error BadScene: frames that the run does not have
[[nodiscard]] FrameRange frames_asked(const FrameChoice& choice, std::size_t count);

/// The folder of choice.output is made. @param alone,series  default names in the run's folder, without ending: "picture",
/// "frame"
/// @throws Error BadFile: a folder has that name
[[nodiscard]] std::filesystem::path picture_path(const std::filesystem::path& dir, const FrameChoice& choice, const char* alone,
                                                 const char* series, std::size_t index);

/// Films of fewer frames a second jerk.
inline constexpr double least_film_rate = 15;  // [1/s]
/// The chosen rate; else real time, or faster where real time is below least_film_rate. [1/s]
[[nodiscard]] double film_rate(const FrameChoice& choice, const RunFolder& run, const FrameRange& range);

}  // namespace seldinger
