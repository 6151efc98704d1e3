#pragma once
// Which frames of a run are drawn, and into which files.

#include <cstddef>
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
    double rate = 0;               // of the film [1/s]; 0: real time, or faster where that would be below 15 a second
    std::filesystem::path labels;  // folder of the labels beside each picture (docs/labels.md); empty: none
    std::filesystem::path
        labels_in;  // the folder that `labels` lies below, reached through no link; empty: `labels` is a path of its own
    bool label_vessel = false;     // the lumen's thickness too
    std::filesystem::path preview;  // a sheet of some pictures with their labels drawn in, in place of all else; empty: none
};

/// Written files, and warnings for their reader.
struct PictureFiles {
    std::vector<std::filesystem::path> paths;
    std::vector<std::string> warnings;
};

}  // namespace seldinger
