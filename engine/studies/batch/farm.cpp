// Plans, claims by rename and lock, and results of a farm's tasks.
#include "batch/farm.h"

#include "core/bytes.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "core/fnv1a.h"
#include "core/sealed_file.h"
#include "io/json_text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace seldinger {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view rows_magic = "SELFARM5";
// beyond what any farm has, and little enough to be listed in memory
constexpr std::size_t most_tasks = 1'000'000, most_items = 10'000'000, last_frame = 1'000'000'000;

std::string number(std::size_t task) { return fmt::format("{:06}", task); }

std::string as_json(const FarmPlan& plan)
{
    Json out;
    out["kind"] = plan.kind == FarmKind::Sweep ? "sweep" : "frames";
    out["source"] = plan.source.string();
    if (plan.kind == FarmKind::Sweep) out["sweep"] = plan.sweep.string(), out["set"] = plan.overrides;
    else out["first"] = plan.first, out["render"] = plan.render, out["files"] = plan.files;
    out[plan.kind == FarmKind::Sweep ? "runs" : "frames"] = plan.items;
    out["tasks"] = plan.tasks;
    out["key"] = plan.key;
    return json_text(out, 2) + "\n";
}

/// Opened and locked, or -1: another living worker has the lock, or the file is not there (any more).
int open_locked(const FilePlace& file)
{
    const int fd = openat(file.start(), file.name().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (fd < 0 && errno == ELOOP)
        throw Error(ExitCode::BadFile, file.path().string() + ": is a link, where a farm has plain files. Fix: make a new farm");
    if (fd < 0) return -1;
    if (struct stat status {}; fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(fd);
        throw Error(ExitCode::BadFile, file.path().string() + ": is a pipe or a device, where a farm has plain files. Fix: make a new farm");
    }
    // a look at the farm holds the lock for a moment
    for (int attempt = 0; attempt < 3; ++attempt) {
        if (flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
        if (errno != EWOULDBLOCK && errno != EINTR) {
            close(fd);
            throw Error(ExitCode::BadFile,
                        fmt::format("{}: this file system has no locks, which show whether a worker is alive; put "
                                    "the farm's folder on one that has (NFS, Lustre mounted with flock)",
                                    file.path().string()));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    close(fd);
    return -1;
}

/// 000012@W in running/, or empty.
std::string running_name(const Folder& running, std::size_t task)
{
    const std::string start = number(task) + "@";
    for (const std::string& name : running.names())
        if (name.starts_with(start)) return name;
    return {};
}

constexpr const char* mark = ".farm";

}  // namespace

std::string farm_key(const std::vector<std::string>& texts)
{
    std::uint64_t hash = fnv1a_start;
    for (const std::string& text : texts) {
        const std::uint64_t size = text.size();  // so that "ab", "c" is not "a", "bc"
        hash = fnv1a(text.data(), text.size(), fnv1a(&size, sizeof size, hash));
    }
    return fmt::format("{:016x}", hash);
}

void write_farm(const Folder& dir, const FarmPlan& plan)
{
    if (dir.has("farm.json")) {
        const FarmPlan there = read_farm(dir);
        if (there.key != plan.key || there.tasks != plan.tasks)
            throw Error(ExitCode::BadScene,
                        fmt::format("{}: holds a farm of another scene, sweep, options, version or number of tasks ({}); give "
                                    "the same again to continue it, or another folder with -o",
                                    dir.path().string(), there.tasks));
        return;
    }
    for (const char* folder : {"running", "done", "rows", "log", "tasks"}) (void)dir.make(folder);
    const Folder todo = dir.make("todo");
    for (std::size_t t = 0; t < plan.tasks; ++t) write_file(todo / number(t), "");
    write_file(dir / "farm.json", as_json(plan), Durable::Yes);  // last: a folder without it was never begun
}

FarmPlan read_farm(const Folder& dir)
{
    const fs::path file = dir.path() / "farm.json";
    if (!dir.has("farm.json"))
        throw Error(ExitCode::BadFile, dir.path().string() + ": no farm.json in it; give the folder that `seldinger farm -o` made");
    try {
        const Json in = Json::parse(read_file(dir / "farm.json"));
        const auto count = [&](const char* key, std::size_t most) {
            const Json& value = in.at(key);
            if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most)
                throw Error(ExitCode::BadFile, fmt::format("{}: {} out of range; make the farm again in another folder", file.string(), key));
            return value.get<std::size_t>();
        };
        FarmPlan plan;
        plan.kind = in.at("kind") == "sweep" ? FarmKind::Sweep : FarmKind::Frames;
        plan.source = in.at("source").get<std::string>();
        if (plan.kind == FarmKind::Sweep) {
            plan.sweep = in.at("sweep").get<std::string>();
            plan.overrides = in.at("set").get<std::vector<std::string>>();
        } else {
            plan.first = count("first", last_frame);
            plan.render = in.at("render").get<std::vector<std::string>>();
            plan.files = in.value("files", plan.files);
            if (plan.files.empty() || !std::all_of(plan.files.begin(), plan.files.end(), leads_below))
                throw Error(ExitCode::BadFile, file.string() + ": got files outside of the farm's folder; expected names below it. Fix: make the "
                                                               "farm again in another folder");
        }
        plan.items = count(plan.kind == FarmKind::Sweep ? "runs" : "frames", most_items);
        plan.tasks = count("tasks", std::min(plan.items, most_tasks));
        plan.key = in.at("key").get<std::string>();
        if (plan.tasks < 1) throw Error(ExitCode::BadFile, file.string() + ": has no tasks; make the farm again in another folder");
        return plan;
    } catch (const nlohmann::json::exception& error) {
        throw Error(ExitCode::BadFile,
                    fmt::format("{}: is damaged ({}); make the farm again in another folder", file.string(), error.what()));
    }
}

std::string farm_worker()
{
    const char *job = std::getenv("SLURM_ARRAY_JOB_ID"), *task = std::getenv("SLURM_ARRAY_TASK_ID");
    if (job && task) {
        std::string name = fmt::format("slurm-{}_{}", job, task);
        std::replace(name.begin(), name.end(), '/', '_');  // of a file in running/
        return name;
    }
    char host[256] = "host";
    (void)gethostname(host, sizeof host - 1);
    return fmt::format("{}-{}", host, getpid());
}

// ---------------------------------------------------------------- claims

std::optional<TaskClaim> TaskClaim::take(const Folder& dir, std::size_t task, const std::string& worker)
{
    const std::string waiting = number(task), mine = waiting + "@" + worker;
    if (dir.inner("done").has(waiting)) return std::nullopt;
    const Folder todo = dir.inner("todo"), running = dir.inner("running");
    // the lock comes before the rename, so that a task in running/ without a lock has a dead worker
    if (const int lock = open_locked(todo / waiting); lock >= 0) {
        if (todo.rename(waiting, running, mine)) return TaskClaim(dir, task, mine, lock, false);
        close(lock);
    }
    const std::string theirs = running_name(running, task);
    if (theirs.empty()) return std::nullopt;
    const int lock = open_locked(running / theirs);
    if (lock < 0) return std::nullopt;
    if (running.rename(theirs, running, mine)) return TaskClaim(dir, task, mine, lock, true);
    close(lock);
    return std::nullopt;
}

TaskClaim::TaskClaim(Folder dir, std::size_t task, std::string name, int lock, bool taken_over)
    : dir_(std::move(dir)), task_(task), name_(std::move(name)), lock_(lock), taken_over_(taken_over)
{
}

TaskClaim::TaskClaim(TaskClaim&& other) noexcept
    : dir_(std::move(other.dir_)),
      task_(other.task_),
      name_(std::move(other.name_)),
      lock_(other.lock_),
      taken_over_(other.taken_over_)
{
    other.lock_ = -1;
}

TaskClaim::~TaskClaim()
{
    if (lock_ >= 0) close(lock_);
}

void TaskClaim::move_to(const char* folder)
{
    (void)dir_.inner("running").rename(name_, dir_.inner(folder), number(task_));
    close(lock_);
    lock_ = -1;
}

void TaskClaim::finish() { move_to("done"); }
void TaskClaim::give_back() { move_to("todo"); }

// ---------------------------------------------------------------- log and results

void log_event(const Folder& dir, std::size_t task, const std::string& worker, const TaskEvent& event)
{
    AppendFile log(dir.inner("log") / (number(task) + ".csv"), AppendFile::everything);
    if (log.size() == 0) log.append("unix_s,event,worker,process_s,work_s,message\n");  // new, or the disk was full when it was
    const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    log.append(
        fmt::format("{:.3f},{},{},{:.4f},{:.4f},{}\n", now, event.event, worker, event.process_s, event.work_s, event.message));
}

void write_rows(const Folder& dir, const FarmPlan& plan, std::size_t task, const std::vector<BatchRow>& rows)
{
    std::vector<std::uint8_t> bytes;
    put_bytes(bytes, plan.key.data(), plan.key.size());
    put_rows(bytes, rows);
    write_sealed(dir.inner("rows") / (number(task) + ".rows"), rows_magic, bytes);
}

// A batch there that is none of this farm's would be resumed, replaced and removed like one: the mark tells them apart. An empty folder
// is one that a worker was killed in before it had marked it, or after.
Folder open_task_folder(const Folder& dir, const FarmPlan& plan, std::size_t task)
{
    const Folder own = dir.inner("tasks").make(number(task));
    if (!own.has(mark)) {
        remove_leftovers(own);
        if (!own.names().empty())
            throw Error(ExitCode::BadFile, fmt::format("{}: holds files of others (it has no {}). Fix: move it away",
                                                       own.path().string(), mark));
        write_file(own / mark, plan.key);
    } else if (read_file(own / mark, 64) != plan.key) {
        throw Error(ExitCode::BadFile, own.path().string() + ": is of another farm. Fix: move it away");
    }
    return own;
}

void close_task_folder(const Folder& dir, std::size_t task)
{
    const Folder tasks = dir.inner("tasks");
    if (tasks.inner(number(task)).remove(mark) == 0) (void)tasks.remove(number(task));
}

std::string frame_file(const std::string& pattern, std::size_t frame)
{
    constexpr std::string_view digits = "######";
    std::string name = pattern;
    if (const std::size_t at = name.find(digits); at != std::string::npos) name.replace(at, digits.size(), fmt::format("{:06}", frame));
    return name;
}

bool has_result(const Folder& dir, const FarmPlan& plan, std::size_t task)
{
    if (plan.kind == FarmKind::Sweep) return dir.inner("rows").has(number(task) + ".rows");
    const FarmPlan::Part part = plan.part(task);
    for (std::size_t i = part.begin; i < part.end; ++i)
        for (const std::string& pattern : plan.files)
            if (!dir.has_below(frame_file(pattern, plan.first + i))) return false;
    return true;
}

void reopen_if_lost(const Folder& dir, const FarmPlan& plan, std::size_t task)
{
    const Folder done = dir.inner("done");
    if (done.has_file(number(task)) && !has_result(dir, plan, task)) (void)done.rename(number(task), dir.inner("todo"), number(task));
}

std::optional<std::vector<BatchRow>> read_rows(const Folder& dir, const FarmPlan& plan, std::size_t task, std::size_t instruments)
{
    const Folder folder = dir.inner("rows");
    const std::string name = number(task) + ".rows";
    if (!folder.has(name)) return std::nullopt;
    const fs::path file = folder.path() / name;
    const std::vector<std::uint8_t> bytes = read_sealed(folder / name, rows_magic);
    const std::uint8_t *at = bytes.data(), *end = at + bytes.size();
    std::string key(std::min(plan.key.size(), bytes.size()), ' ');
    take_bytes(at, end, key.data(), key.size());
    const FarmPlan::Part part = plan.part(task);
    if (key != plan.key) throw Error(ExitCode::BadFile, file.string() + ": is of another farm; remove it and do the task again");
    std::vector<BatchRow> rows;
    try {
        rows = take_rows(at, end);
    } catch (const Error& error) {
        throw Error(error.code(), fmt::format("{}: {}; remove it and do the task again", file.string(), error.what()));
    }
    if (at != end || rows.size() != part.end - part.begin || !are_sound(rows, part.begin, part.end, instruments))
        throw Error(ExitCode::BadFile, file.string() + ": is corrupt: a value is out of range; remove it and do the task again");
    return rows;
}

}  // namespace seldinger
