// Plans a scene for a live session.
#include "live_model.h"

#include "quantity.h"
#include "stop_signal.h"
#include "study/planner.h"

#include <fmt/format.h>
#include <unistd.h>

namespace seldinger::apps {

Scene model_for(const Scene& scene, const std::string& tolerance, double rate, const std::filesystem::path& trials, int device, bool quiet)
{
    PlanOptions what;
    what.goals.tolerance = parse_length("--tolerance", tolerance);
    what.goals.rate = rate;
    what.trials = trials;
    what.device = device;
    what.stop = [] { return stop_asked_for() != 0; };
    const bool shows = !quiet && isatty(STDERR_FILENO) != 0;
    if (shows) what.progress = [](const std::string& doing) { fmt::print(stderr, "\r\033[K{}", doing); };
    const Plan plan = make_plan(load_study_scene(scene, device), what);
    if (shows) fmt::print(stderr, "\r\033[K");
    if (plan.status == PlanStatus::Interrupted) throw Error(ExitCode::Interrupted, "interrupted while the model was being chosen");
    if (!plan.chosen) throw Error(ExitCode::NotFeasible, plan.message);
    if (!quiet)
        fmt::print(stderr, "model: {}; within {:.2g} mm, {:.2g} s of computation a second where it is slowest\n", label(plan.chosen->model),
                   1e3 * plan.chosen->error, plan.chosen->slowest);
    Scene chosen = plan.chosen->scene;
    chosen.task = scene.task;
    if (chosen.dt > 1 / rate) chosen.dt = 1 / rate;
    return chosen;
}

}  // namespace seldinger::apps
