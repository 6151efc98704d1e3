#pragma once
// One line on stderr that follows a run; nothing when stderr is not a terminal.

#include "scene/recorder.h"

#include <chrono>

namespace seldinger::apps {

class Progress {
public:
    Progress(const Scene& scene, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    /// @param wall  of the loop so far [s]
    void show(const Recorder& recorder, double wall);

private:
    const Scene& scene_;
    bool on_ = false, drawn_ = false;
    std::chrono::steady_clock::time_point next_{};
};

}  // namespace seldinger::apps
