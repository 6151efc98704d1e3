#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

namespace seldinger::apps {

Progress::Progress(const Scene& scene, bool quiet) : scene_(scene), on_(!quiet && isatty(STDERR_FILENO)) {}

Progress::~Progress()
{
    if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::show(const Recorder& recorder, double wall)
{
    if (!on_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(250);
    const double done = static_cast<double>(recorder.tally().steps), all = static_cast<double>(scene_.steps());
    fmt::print(stderr, "\r\033[Kstep {:.0f} of {:.0f}, inserted {:.2f} cm, {:.2f} x real time, {:.0f} s left", done, all,
               1e2 * recorder.readings().inserted, done * scene_.dt / wall, wall * (all - done) / done);
    drawn_ = true;
}

}  // namespace seldinger::apps
