#pragma once
// From a scene to a finished folder: the loop that steps, records, saves and stops.

#include "core/error.h"
#include "record/recorder.h"
#include "scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

struct RunOptions {
    std::filesystem::path dir;
    std::vector<std::string> overrides;  // of --set
    std::filesystem::path replay;        // record of a live session; empty: the scene's key frames
    FolderUse use = FolderUse::Refuse;
    double time_limit = 0;  // [s] from the call on, loading included; 0: none
    int device = -1;
    bool estimate = true;   // the error that the step's length leaves (bands/step_twin.h)
    bool asked_estimate = false;  // for it, where it is dear
    bool quiet = false;
};

struct RunOutcome {
    ErrorKind code = ErrorKind::None;
    std::string summary;  // JSON
    std::string message;  // one line for stderr; empty when the run is done
};

/// Always takes at least one step, so that a short limit and --resume in turn come to an end. @throws Error
[[nodiscard]] RunOutcome run_scene(const Scene& scene, const RunOptions& options);

}  // namespace seldinger::apps
