// Report on a farm's folder: state of each task, number of starts, overhead of a task.
#include "batch/farm.h"

#include "core/error.h"
#include "core/file_io.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace seldinger {
namespace {

/// The task that a file's name begins with, or `tasks`.
std::size_t task_of(const std::string& name, std::size_t tasks)
{
    char* end = nullptr;
    const unsigned long task = std::strtoul(name.c_str(), &end, 10);
    return end == name.c_str() ? tasks : std::min<std::size_t>(task, tasks);
}

bool worker_lives(const FilePlace& file)
{
    const int fd = openat(file.start(), file.name().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (fd < 0) return true;  // has just moved on
    const bool lives = flock(fd, LOCK_SH | LOCK_NB) != 0;
    close(fd);
    return lives;
}

/// Contents of one task's log.
struct Story {
    std::size_t began = 0, finished = 0;
    double process = 0, work = 0;  // of the attempt that finished [s]
    std::string last, message;
};

Story read_story(const Folder& log, const std::string& name)
{
    Story story;
    if (!log.has(name)) return story;
    std::istringstream lines(read_file(log / name));
    std::string line, cell[6];
    while (std::getline(lines, line)) {
        if (line.starts_with("unix_s,")) continue;  // the head; logs of earlier versions may be without
        std::istringstream cells(line);
        for (int k = 0; k < 5; ++k) std::getline(cells, cell[k], ',');
        std::getline(cells, cell[5]);  // a message may hold commas
        story.last = cell[1], story.message = cell[5];
        story.began += cell[1] == "began" || cell[1] == "taken-over";
        if (cell[1] != "finished") continue;
        story.finished++;
        story.process = std::strtod(cell[3].c_str(), nullptr), story.work = std::strtod(cell[4].c_str(), nullptr);
    }
    return story;
}

}  // namespace

std::size_t FarmReport::count(TaskState s) const { return static_cast<std::size_t>(std::count(state.begin(), state.end(), s)); }

std::string list_ranges(const std::vector<std::size_t>& numbers, const char* between)
{
    std::string text;
    for (std::size_t k = 0, end = 0; k < numbers.size(); k = end) {
        for (end = k + 1; end < numbers.size() && numbers[end] == numbers[end - 1] + 1;) ++end;
        if (!text.empty()) text += between;
        text += end - k == 1 ? fmt::format("{}", numbers[k]) : fmt::format("{}-{}", numbers[k], numbers[end - 1]);
    }
    return text;
}

std::string FarmReport::list_missing() const
{
    std::vector<std::size_t> missing;
    for (std::size_t t = 0; t < state.size(); ++t)
        if (state[t] != TaskState::Done) missing.push_back(t);
    return list_ranges(missing);
}

std::vector<TaskState> task_states(const Folder& dir, const FarmPlan& plan)
{
    std::vector<TaskState> states(plan.tasks, TaskState::Todo);
    const Folder running = dir.inner("running");
    for (const std::string& name : running.names())
        if (const std::size_t t = task_of(name, plan.tasks); t < plan.tasks)
            states[t] = worker_lives(running / name) ? TaskState::Running : TaskState::Lost;
    for (std::size_t t = 0; t < plan.tasks; ++t)
        if (has_result(dir, plan, t)) states[t] = TaskState::Done;
    return states;
}

FarmReport look_at_farm(const Folder& dir, const FarmPlan& plan)
{
    FarmReport report;
    report.state = task_states(dir, plan);
    const Folder log = dir.inner("log");
    std::vector<double> overheads;
    for (std::size_t t = 0; t < plan.tasks; ++t) {
        const Story story = read_story(log, fmt::format("{:06}.csv", t));
        report.began += story.began;
        if (story.began > 1) report.begun_again += story.began - 1;
        if (story.finished > 1) report.finished_again += story.finished - 1;
        if (story.last == "failed" && report.state[t] != TaskState::Done) report.failed.emplace_back(t, story.message);
        if (story.finished == 0) continue;
        report.work_s += story.work;
        overheads.push_back(story.process - story.work);
    }
    if (!overheads.empty()) {
        std::sort(overheads.begin(), overheads.end());
        report.overhead_median_s = overheads[overheads.size() / 2];
        report.overhead_max_s = overheads.back();
    }
    return report;
}

}  // namespace seldinger
