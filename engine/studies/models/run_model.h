#pragma once
// Runs one scene under one model: times the steps, keeps the observables, reports the run's behaviour, stops early on request.

#include "models/classify.h"
#include "models/trajectory.h"

#include <functional>
#include <limits>

namespace seldinger {

struct RunPlan {
    double until = 0;        // [s]; 0: the scene's duration
    double interval = 0;     // between samples [s]; 0: a fortieth of `until`. Steps are as long as the model says or a little
                             // shorter, so that a whole number of them fills it
    double average = 0.020;  // forces are means over this time before a sample [s]
    bool peaks = false;           // keep Trajectory::peaks: contacts are then read throughout, outside of what is timed
    bool processor_time = false;  // the two limits below are of processor time: fair on a machine that does other things too
    int repeats = 1;              // at most so many timed runs
    double repeat_wall = std::numeric_limits<double>::infinity();  // no repeat is begun once the steps of all took this [s]
    double wall_limit = std::numeric_limits<double>::infinity();   // of the steps of one run [s]; it then stops, incomplete
    FailureLimits limits;                                          // radius infinite: the wire's own
    bool end_on_blow_up = true;      // energy made from nothing ends the run; values that are not finite do in any case
    std::function<bool()> stop;      // asked between samples; true ends the run, incomplete. May be empty
    std::function<bool()> stop_now;  // the same, asked after every step
    /// Sees every sample as it is taken, with the wall and processor time of the steps so far [s]; false ends the run there,
    /// incomplete, as a run that has shown enough. May be empty.
    std::function<bool(const Sample&, double wall, double cpu)> after_sample;
};

/// Seconds that the computation took per simulated second: the median of the repeats, and the two ends. A static scene has no
/// simulated time: then seconds per solution.
struct Cost {
    double wall = 0, lowest = 0, highest = 0;
    double cpu = 0, cpu_lowest = 0,
           cpu_highest = 0;  // of all threads: steadier than wall time on a machine that does other things
    int repeats = 0;
};

/// A run as a table keeps it (run_store.h).
struct RunRecord {
    Cost cost;
    Outcome outcome = Outcome::Hold;
    bool complete = false;        // reached the end
    bool over_limit = false;      // stopped by wall_limit
    double failed_at = 0;         // of a run that broke off by itself [s]
    double simulated = 0;         // [s]
    double wall_limit = 0;        // under which it was run [s]
    int nodes = 0, contacts = 0;  // at most
    double wall_move = 0;         // farthest that an elastic wall has gone, of the samples [m]
    long wall_far_steps = 0;      // StepWallFar
    FailureReadings readings;     // a table keeps steps, jitter, overlap, outside, iterations
};

struct ModelRun : RunRecord {
    Trajectory trajectory;
    Verdict verdict;
    bool stopped = false;  // by plan.stop or plan.stop_now
};

/// @throws Error when the model cannot run in the scene (see why_not)
[[nodiscard]] ModelRun run_model(const StudyScene& scene, const Model& model, const RunPlan& plan,
                                 const std::vector<Baseline>& baselines = {});

}  // namespace seldinger
