#pragma once
// One line on stderr that follows a run; nothing when stderr is not a terminal.

#include "batch/batch.h"
#include "core/clock.h"
#include "record/recorder.h"

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
    Clock::time_point next_{};
};

/// The same for a batch, with a bar of the runs that are done.
class BatchProgress {
public:
    BatchProgress(std::size_t runs, bool quiet);
    ~BatchProgress();
    BatchProgress(const BatchProgress&) = delete;
    BatchProgress& operator=(const BatchProgress&) = delete;
    /// @param done  runs  @param world  index of the one being run, of `worlds`  @param rate  wire-steps per second so far
    void show(std::size_t done, std::size_t world, std::size_t worlds, const BatchWorld& state, double rate);

private:
    std::size_t runs_;
    bool on_ = false, drawn_ = false;
    Clock::time_point next_{};
};

}  // namespace seldinger::apps
