// Reads the options that every view has, and follows the frames as they are drawn.
#include "render_frames.h"

#include "command_line.h"
#include "commands.h"
#include "core/note.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <csignal>

namespace seldinger::apps {

void FrameArguments::declare(CommandLine& command)
{
    command.add_option("--frames", frames, "frames A to B, counted from 0 (default: the last one)")->type_name("A:B");
    command.add_option("-o", output, "picture to write (default: in DIR); several frames: NAME_######.png")
        ->type_name("FILE.png");
    command.add_option("--video", video, "film to write (needs ffmpeg)")->type_name("FILE.mp4");
    command.add_option("--fps", fps, "frames per second of the film (default: real time, at least 15)")->type_name("N");
    command.add_option("--labels", labels, "folder for the ground truth of every picture: NAME.json and NAME_mask.png")
        ->type_name("DIR");
    command.add_option("--farm", farm)->hidden();  // of these pictures: others write in its folder, and --labels lies below it
    command.add_option("--parent", parent)->hidden();  // a farm's process: ends with it
    command.add_flag("--label-vessel", label_vessel, "with --labels: also the lumen's thickness along each ray, NAME_lumen.png");
    command.add_option("--preview", preview, "one sheet of 16 pictures with their labels drawn in; nothing else is written")
        ->type_name("FILE.png");
    command.add_flag("--resume", resume, "skip pictures that exist already");
    command.add_flag("--numbered", numbered, "number the picture (NAME_######.png) even if it is the only one");
    command.add_option("--threads", threads, "threads of the host (default: all cores)")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command.add_flag("--quiet", quiet, "print no file names");
}

std::pair<int, int> two_numbers(const std::string& text, char between, const char* option, const char* form)
{
    int a = 0, b = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, a);
    if (first.ec == std::errc() && first.ptr != end && *first.ptr == between) {
        const auto second = std::from_chars(first.ptr + 1, end, b);
        if (second.ec == std::errc() && second.ptr == end && a >= 0 && b >= 0) return {a, b};
    }
    throw Error(ErrorKind::BadScene, fmt::format("{}: got \"{}\"; expected {}", option, text, form));
}

#ifdef SEL_WITH_VIEW
FrameChoice FrameArguments::choice() const
{
    FrameChoice choice;
    if (!frames.empty()) {
        const auto [first, last] = two_numbers(frames, ':', "--frames", "FIRST:LAST, e.g. 0:99,");
        choice.first = first, choice.last = last;
    }
    if (fps && video.empty())
        throw Error(ErrorKind::BadScene, "--fps: got no --video; expected a film. Fix: give --video FILE.mp4");
    if (fps && !(*fps >= 0.1 && *fps <= 240))
        throw Error(ErrorKind::BadScene, fmt::format("--fps: got {}; expected frames per second from 0.1 to 240", *fps));
    if (label_vessel && labels.empty())
        throw Error(ErrorKind::BadScene, "--label-vessel: got no --labels; expected a folder. Fix: give --labels DIR");
    if (!preview.empty() && !video.empty())
        throw Error(ErrorKind::BadScene, "--preview: only the sheet is written. Fix: leave out --video");
    if (!preview.empty() && !labels.empty())
        throw Error(ErrorKind::BadScene,
                    "--preview: only the sheet is written. Fix: leave out --labels, or run render once for each");
    if (!farm.empty() && !labels.empty() && !leads_below(labels))
        throw Error(
            ErrorKind::BadScene,
            fmt::format("--labels: got {}; expected a folder below that of the farm. Fix: give a name, --labels labels", labels));
    for (const std::string& file : {preview, farm.empty() ? labels : std::string()})
        if (!file.empty() && std::filesystem::is_directory(file) != (file == labels) && std::filesystem::exists(file))
            throw Error(ErrorKind::BadFile, fmt::format("{}: got a {}; expected the name of a {}", file,
                                                        file == labels ? "file" : "folder", file == labels ? "folder" : "file"));
    choice.labels = labels, choice.labels_in = farm, choice.label_vessel = label_vessel, choice.preview = preview;
    choice.output = output, choice.film = video;
    choice.rate = fps.value_or(0);
    choice.resume = resume, choice.numbered = numbered;
    return choice;
}

FrameWatch::FrameWatch() : shows_(isatty(STDERR_FILENO)) {}

FrameProgress FrameWatch::progress() const
{
    return [shows = shows_](std::size_t done, std::size_t all, double seconds) {
        const auto n = static_cast<double>(done);
        if (shows)
            note(fmt::format("\r\033[Kframe {} of {}, {:.1f} frames/s, {:.0f} s left{}", done, all, n / seconds,
                             seconds * static_cast<double>(all - done) / n, done == all ? "\r\033[K" : ""));
        const int signal = done < all ? stop_asked_for() : 0;
        if (signal == 0) return;
        if (shows) note("\r\033[K");
        throw Error(signal == SIGINT ? ErrorKind::Interrupted : ErrorKind::TimeLimit,
                    fmt::format("stopped after {} of {} frames; run again with --resume", done, all));
    };
}

void print_files(const PictureFiles& files)
{
    std::string text;
    for (const auto& path : files.paths) text += path.string() + "\n";
    print(text);
    for (const std::string& warning : files.warnings) note("seldinger: warning: " + warning + "\n");
}
#endif

}  // namespace seldinger::apps
