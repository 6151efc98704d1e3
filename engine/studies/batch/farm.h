#pragma once
// A batch, or a run's frames, cut into whole tasks that any number of machines do from one shared folder.
//
//   farm.json          the work, its division, and the key that every result must carry
//   todo/000012        a task without a worker
//   running/000012@W   worker W does it and holds a lock on this file; once W is dead the lock is free and the task may be taken
//   done/000012        finished: never done again
//   rows/000012.rows   results of a sweep's task, complete or absent
//   log/000012.csv     history of the task
//   tasks/000012/      its batch while it runs, marked by .farm with the plan's key; removed with it
//
// All of it is reached from the open folder and never through a link. Only a task's own folder is removed, by its mark and the
// names that a batch gives: a farm may come from somebody else, or lie where others write.
//
// A task moves from one folder to the next by rename, which only one worker can win. The results of a task depend on the plan
// and its number alone, so the merged table has the same bits for any cut, any number of machines and any failures.

#include "core/folder.h"
#include "batch/batch_table.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace seldinger {

enum class FarmKind { Sweep, Frames };

struct FarmPlan {
    FarmKind kind = FarmKind::Sweep;
    std::filesystem::path source;        // scene file or run folder, absolute
    std::filesystem::path sweep;         // as it was given
    std::vector<std::string> overrides;  // of --set
    std::vector<std::string> render;     // further options of `render`
    std::vector<std::string> files = {"frame_######.png"};  // that each frame has in the folder, ###### its number
    std::size_t first = 0;               // frame
    std::size_t items = 0, tasks = 0;    // runs or frames, and how many tasks they are cut into
    std::string key;                     // 16 hex digits: differs when scene, sweep, vessel, options or version do

    struct Part {
        std::size_t begin, end;  // items
    };
    /// Tasks differ by one item at most.
    [[nodiscard]] Part part(std::size_t task) const { return {task * items / tasks, (task + 1) * items / tasks}; }
    [[nodiscard]] const char* item_word() const { return kind == FarmKind::Sweep ? "run" : "frame"; }
};

/// 16 hex digits over texts in order.
[[nodiscard]] std::string farm_key(const std::vector<std::string>& texts);

/// Writes farm.json and one file in todo/ per task; with the same plan there already, leaves all as it is.
/// @throws Error BadScene: another plan is there, BadFile
void write_farm(const Folder& dir, const FarmPlan& plan);
/// @throws Error BadFile: not a farm's folder, or damaged
[[nodiscard]] FarmPlan read_farm(const Folder& dir);

/// "slurm-JOB_TASK" in an array job, which Slurm never runs twice at once, so that a requeued task takes over from itself; else
/// host and process.
[[nodiscard]] std::string farm_worker();

/// The right to do a task. Dropped without finish() or give_back() it is that of a dead worker.
class TaskClaim {
public:
    /// @return nothing where the task is finished or another living worker has it. @throws Error BadFile
    [[nodiscard]] static std::optional<TaskClaim> take(const Folder& dir, std::size_t task,
                                                       const std::string& worker);
    TaskClaim(TaskClaim&& other) noexcept;
    TaskClaim& operator=(TaskClaim&&) = delete;
    ~TaskClaim();

    [[nodiscard]] bool taken_over() const { return taken_over_; }  // from a worker that is dead
    void finish();
    void give_back();

private:
    TaskClaim(Folder dir, std::size_t task, std::string name, int lock, bool taken_over);
    void move_to(const char* folder);
    Folder dir_;
    std::size_t task_;
    std::string name_;  // in running/
    int lock_;
    bool taken_over_;
};

/// A line of a task's log. Only the worker that holds the claim writes it.
struct TaskEvent {
    std::string event;                 // began, taken-over, stopped, failed, finished
    double process_s = 0, work_s = 0;  // since the process began; of that in the loop itself
    std::string message;               // of a failure
};
void log_event(const Folder& dir, std::size_t task, const std::string& worker, const TaskEvent& event);

void write_rows(const Folder& dir, const FarmPlan& plan, std::size_t task, const std::vector<BatchRow>& rows);
/// Nothing where there are none. @param instruments  of a run, BatchRow::instruments @throws Error BadFile: damaged, or of another plan
[[nodiscard]] std::optional<std::vector<BatchRow>> read_rows(const Folder& dir, const FarmPlan& plan,
                                                             std::size_t task, std::size_t instruments);

/// tasks/000012, made where there is none. @throws Error BadFile: holds what this farm did not put there
[[nodiscard]] Folder open_task_folder(const Folder& dir, const FarmPlan& plan, std::size_t task);
/// When its batch has gone: nothing else that may be in it goes.
void close_task_folder(const Folder& dir, std::size_t task);

/// A file of a frame, below the farm's folder. @param pattern  of FarmPlan::files
[[nodiscard]] std::string frame_file(const std::string& pattern, std::size_t frame);

/// Whether all that a task is to leave is there.
[[nodiscard]] bool has_result(const Folder& dir, const FarmPlan& plan, std::size_t task);

/// A finished task whose result somebody has removed is to be done again.
void reopen_if_lost(const Folder& dir, const FarmPlan& plan, std::size_t task);

enum class TaskState { Todo, Running, Lost, Done };
struct FarmReport {
    std::vector<TaskState> state;                                  // of each task
    std::size_t began = 0, begun_again = 0, finished_again = 0;    // events; finished_again must stay 0
    std::vector<std::pair<std::size_t, std::string>> failed;       // tasks not done whose last event is a failure, and why
    double work_s = 0, overhead_median_s = 0, overhead_max_s = 0;  // of finished tasks: process less loop

    [[nodiscard]] std::size_t count(TaskState s) const;
    /// "3, 17-19"
    [[nodiscard]] std::string list_missing() const;
};
/// Where each task stands. One whose result is there is done, whatever became of its worker. @throws Error BadFile
[[nodiscard]] std::vector<TaskState> task_states(const Folder& dir, const FarmPlan& plan);
/// The same, with what the logs say. @throws Error BadFile
[[nodiscard]] FarmReport look_at_farm(const Folder& dir, const FarmPlan& plan);

/// "3, 17-19" of increasing numbers.
[[nodiscard]] std::string list_ranges(const std::vector<std::size_t>& numbers, const char* between = ", ");

}  // namespace seldinger
