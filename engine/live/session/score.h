#pragma once
// The score sheet of a live session, as JSON and as a page, and which instruments a hand can hold.

#include "scene/scene.h"
#include "run/score.h"

#include <string>
#include <vector>

namespace seldinger {

/// Instruments of the first system of a world made from this that a hand can hold: those that are fed.
[[nodiscard]] std::vector<int> live_instruments(const WorldSetup& setup);

/// The score sheet as JSON.
[[nodiscard]] std::string score_json(const Scene& scene, const ScoreNumbers& score);
/// And as a page, without anything from outside.
[[nodiscard]] std::string score_page(const Scene& scene, const ScoreNumbers& score);

}  // namespace seldinger
