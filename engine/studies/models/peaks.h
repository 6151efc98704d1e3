#pragma once
// The peaks of a run's forces, and their largest error.
//
// A peak is the largest mean over 20 ms (RunPlan::average) at any time of the run. There are three: of |hand force| and of
// friction, sums over all wires [N], and of the largest force per length of any wire on the wall (contact/force_per_length.h)
// [N/m]. Values of one step are none: a hand that starts at once and a wire that strikes give more the shorter the step is.
//
// A peak is one number, so that two runs may agree in it by chance where nothing else agrees. A refinement's movement therefore
// counts as at least half of the previous one (first order: the movement without chance).

#include "math/span_means.h"

#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace seldinger {

inline constexpr int peak_count = 3;
using Peaks = std::array<double, peak_count>;  // hand force [N], friction [N], force per length [N/m]
struct PeakWord {
    std::string_view word, says;  // in JSON; in sentences
};
inline constexpr std::array<PeakWord, peak_count> peak_words = {
    {{"hand_force_n", "hand force"}, {"friction_n", "friction"}, {"force_per_length_n_per_m", "force per length"}}};

/// |a - b|, one by one.
[[nodiscard]] Peaks difference(const Peaks& a, const Peaks& b);

/// The remainder after the last of these movements, see the top. Infinite where there is none.
[[nodiscard]] Peaks peaks_left(const std::vector<Peaks>& moved);

/// How far peaks may be off.
struct PeakGoal {
    double tolerance = 0;     // 0: not asked
    bool is_relative = true;  // of each peak; else [N], of a force per length on one diameter of the wire
    double diameter = 0;      // [m]

    [[nodiscard]] bool asked() const { return tolerance > 0; }
    /// For peaks that should be `right`. A fraction is one of 1 mN at least: no hand feels less.
    [[nodiscard]] Peaks allowed(const Peaks& right) const;
    /// error + uncertainty within `share` of what is allowed; true where nothing was asked.
    [[nodiscard]] bool holds(const Peaks& error, const Peaks& uncertainty, const Peaks& right, double share = 1) const;
};

/// Takes in a run step by step.
class PeakMeter {
public:
    /// @param span  that a mean is over [s]
    explicit PeakMeter(double span) : hand_(span), friction_(span), per_length_(span) {}
    /// Of one step of `dt` [s].
    void add(double hand_force, double friction, double dt) { hand_.add(std::abs(hand_force), dt), friction_.add(friction, dt); }
    /// @param time  that it stands for: to the look before [s]
    void look(double per_length, double time) { per_length_.add(per_length, time); }
    [[nodiscard]] Peaks peaks() const { return {hand_.largest(), friction_.largest(), per_length_.largest()}; }

private:
    SpanMeans hand_, friction_, per_length_;
};

}  // namespace seldinger
