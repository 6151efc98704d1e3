// Whether a score that was read from a file can be one.
#include "run/score_numbers.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace seldinger {

bool is_sound(const ScoreNumbers& s)
{
    const std::initializer_list<double> sums = {s.time,        s.path_length,     s.advanced,   s.pulled_back,    s.wall_force,  s.wall_force_mean, s.wall_force_max,
                       s.patch_force, s.patch_force_max, s.patch_force_max_time, s.time_above, s.hand_force_max, s.fluoroscopy, s.contrast,        s.force_time};
    const std::initializer_list<double> any = {s.distance, s.reached_at_m, s.reached_at_s, s.tip[0], s.tip[1], s.tip[2], s.inserted, s.turned, s.run};
    return std::all_of(sums.begin(), sums.end(), [](double v) { return std::isfinite(v) && v >= 0; }) &&
           std::all_of(any.begin(), any.end(), [](double v) { return std::isfinite(v); }) && s.direction >= -1 && s.direction <= 1 &&
           s.reached <= 1 && s.failed <= 1 && s.has_tip <= 1 && s.begun <= 1;
}

}  // namespace seldinger
