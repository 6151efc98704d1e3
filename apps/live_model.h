#pragma once
// The model of a live session where it is chosen by `plan`.

#include "scene/scene.h"

#include <filesystem>
#include <string>

namespace seldinger::apps {

struct LiveModelWish {
    std::string tolerance;         // a length, as the user wrote it; empty: the scene's own model
    double rate = 1000;            // steps a second
    double budget = 300;           // to choose in, by the clock [s]: a busy machine needs several times the 30 s of an idle one
    std::filesystem::path trials;  // folder of the trial runs: what it holds already is not run again
    int device = -1;
    bool quiet = false;
};

/// A model of the scene that stays within the tolerance and keeps the rate: the first that `seldinger plan --enough` finds.
/// @throws Error NotFeasible: there is none, or the budget ended first; BadScene: the tolerance is no length
[[nodiscard]] Scene model_for(const Scene& scene, const LiveModelWish& wish);

}  // namespace seldinger::apps
