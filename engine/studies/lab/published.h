#pragma once
// The published method as models. docs/published-method.md has the assumptions where its description is silent.

#include "models/model.h"

#include <string_view>

namespace seldinger {

/// One linearised step, Lankarani-Nikravesh damping, sgn(v) friction, in the published layer or another detection.
[[nodiscard]] Model published_method(Detection detection = Detection::Layer);

/// The same with the settings under which it does most in a benchmark, as bench/published_at_best.py has found them; in scenes
/// that were not searched, with those that did best in most.
/// @param benchmark  lab/benchmarks.h  @param frame  in steps of a display, 1/60 s; else in any step
[[nodiscard]] Model published_at_best(std::string_view benchmark, bool frame);

}  // namespace seldinger
