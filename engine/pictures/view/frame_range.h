#pragma once
// Range of frames to draw, names of their pictures, and rate of a film.

#include "view/run_folder.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace seldinger {

/// After each frame: frames done, of how many, seconds since the start. It may throw, to stop.
using FrameProgress = std::function<void(std::size_t, std::size_t, double)>;

/// What every kind of picture is asked for with.
struct FrameChoice {
    int first = -1, last = -1;     // frames A:B of wire.pvd, counted from 0, both included; -1: only the last frame
    std::filesystem::path output;  // NAME.png: that, or NAME_######.png of several frames; empty: in the run's folder
    bool numbered = false;         // NAME_######.png of one frame too
    bool resume = false;           // pictures that are there already stay
    std::filesystem::path film;    // empty: none
    double rate = 0;               // of the film [1/s]; 0: film_rate() decides
    std::filesystem::path labels;  // folder of the labels beside each picture (label_files.h); empty: none
    std::filesystem::path labels_in;  // the folder that `labels` lies below, reached through no link; empty: `labels` is a path of its own
    bool label_vessel = false;     // the lumen's thickness too
    std::filesystem::path preview;  // a sheet of some pictures with their labels drawn in, in place of all else; empty: none
};

/// Written files, and warnings for their reader.
struct PictureFiles {
    std::vector<std::filesystem::path> paths;
    std::vector<std::string> warnings;
};

struct FrameRange {
    std::size_t first = 0, last = 0;  // both included
    [[nodiscard]] std::size_t count() const { return last - first + 1; }
};

/// @throws Error BadScene: frames that the run does not have
[[nodiscard]] FrameRange frames_asked(const FrameChoice& choice, std::size_t count);

/// The folder of choice.output is made. @param alone,series  default names in the run's folder, without ending: "picture", "frame"
/// @throws Error BadFile: a folder has that name
[[nodiscard]] std::filesystem::path picture_path(const std::filesystem::path& dir, const FrameChoice& choice, const char* alone,
                                                 const char* series, std::size_t index);

/// Films of fewer frames a second jerk.
inline constexpr double least_film_rate = 15;  // [1/s]
/// The chosen rate; else real time, or faster where real time is below least_film_rate. [1/s]
[[nodiscard]] double film_rate(const FrameChoice& choice, const RunFolder& run, const FrameRange& range);

}  // namespace seldinger
