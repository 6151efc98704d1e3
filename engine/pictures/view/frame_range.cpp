// Checks a range of frames against a run, names pictures and finds a film's rate.
#include "view/frame_range.h"

#include "core/error.h"
#include "core/file_io.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {

FrameRange frames_asked(const FrameChoice& choice, std::size_t count)
{
    if (choice.first < 0 && choice.last < 0) return {count - 1, count - 1};
    if (choice.first < 0 || choice.last < choice.first || static_cast<std::size_t>(choice.last) >= count)
        throw Error(ErrorKind::BadScene,
                    fmt::format("--frames {}:{}: expected A:B with 0 <= A <= B <= {}, the run has {} frame{}", choice.first,
                                choice.last, count - 1, count, count == 1 ? "" : "s"));
    return {static_cast<std::size_t>(choice.first), static_cast<std::size_t>(choice.last)};
}

std::filesystem::path picture_path(const std::filesystem::path& dir, const FrameChoice& choice, const char* alone,
                                   const char* series, std::size_t index)
{
    if (choice.labels_in.empty() && choice.output.has_parent_path()) make_folder(choice.output.parent_path());
    const bool single = !choice.numbered && (choice.first < 0 || (choice.first == choice.last && !choice.output.empty()));
    if (!single) {
        const std::filesystem::path stem =
            choice.output.empty() ? dir / series : choice.output.parent_path() / choice.output.stem();
        return fmt::format("{}_{:06}.png", stem.string(), index);
    }
    const std::filesystem::path whole = choice.output.empty() ? dir / fmt::format("{}.png", alone) : choice.output;
    if (std::filesystem::is_directory(whole))
        throw Error(ErrorKind::BadFile, whole.string() + ": got a folder; expected the name of a picture, e.g. picture.png");
    return whole;
}

double film_rate(const FrameChoice& choice, const RunFolder& run, const FrameRange& range)
{
    if (choice.rate > 0) return choice.rate;
    const double span = run.frames[range.last].time - run.frames[range.first].time;
    return span > 0 ? std::clamp(static_cast<double>(range.count() - 1) / span, least_film_rate, 60.0) : least_film_rate;
}

}  // namespace seldinger
