// The line on a terminal that follows a run or a batch, redrawn four times a second.
#include "progress.h"
#include "core/clock.h"
#include "core/note.h"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>

namespace seldinger::apps {

Progress::Progress(const Scene& scene, bool quiet) : scene_(scene), on_(!quiet && isatty(STDERR_FILENO)) {}

Progress::~Progress()
{
    if (drawn_) note("\r\033[K");
}

void Progress::show(const Recorder& recorder, double wall)
{
    if (!on_) return;
    const auto now = Clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(250);
    const double done = static_cast<double>(recorder.tally().steps), all = static_cast<double>(scene_.steps());
    note(fmt::format("\r\033[Kstep {:.0f} of {:.0f}, inserted {:.2f} cm, {:.2f} x real time, {:.0f} s left", done, all,
                     1e2 * recorder.readings().inserted, done * scene_.dt / wall, wall * (all - done) / done));
    drawn_ = true;
}

BatchProgress::BatchProgress(std::size_t runs, bool quiet) : runs_(runs), on_(!quiet && isatty(STDERR_FILENO)) {}

BatchProgress::~BatchProgress()
{
    if (drawn_) note("\r\033[K");
}

void BatchProgress::show(std::size_t done, std::size_t world, std::size_t worlds, const BatchWorld& state, double rate)
{
    if (!on_) return;
    const auto now = Clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(250);
    // runs of one world end together: within it the steps tell how far they are
    const double inside = static_cast<double>(state.step_count()) / static_cast<double>(std::max(1L, state.steps_in_all()));
    const double fraction =
        (static_cast<double>(done) + inside * static_cast<double>(state.running())) / static_cast<double>(runs_);
    constexpr int width = 24;
    const int filled = std::min(width, static_cast<int>(fraction * width));
    note(fmt::format("\r\033[K[{:#<{}}{:.<{}}] {} of {} runs, world {} of {}, step {} of {}, {:.0f} wire-steps/s", "", filled, "",
                     width - filled, done, runs_, world + 1, worlds, state.step_count(), state.steps_in_all(), rate));
    drawn_ = true;
}

}  // namespace seldinger::apps
