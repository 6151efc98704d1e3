#pragma once
// Whether a run held, and if not, how it failed: the measured criteria of the stability map (design section 5), from what every
// step reports. One watch per wire; it sees each step once, keeps a handful of numbers, and has no say in the run.
//
//   blow-up   a value is not finite, or kinetic energy that nothing has paid for (below)
//   gave up   a sub-step found no state, or missed the tolerance and took its best trial
//   escape    a node or an edge was outside the lumen
//   overlap   deeper than twice the law's static indentation under the scene's load, or than the wire's radius
//   jitter    step-to-step jitter of the hand force above 10 % of max(mean, 1 mN)
//
// Jitter of one step is |f_k - (f_{k-1} + f_{k+1})/2|: 0 on any ramp, the peak-to-peak value of a force that alternates. What a
// quarter of the steps of a window exceed is compared with the mean |f| of the same window: honest jumps (a tip let go, a wire
// set moving within one step) are no jitter unless they come every dozen steps.
//
// Energy. B = kinetic + elastic + gravitational - work done on the wire can only fall, but for what contact springs give back, at
// most S = (normal + friction) * overlap. What was made is the largest rise of B above the least B + S before it. It is a blow-up
// when it shows as kinetic energy and exceeds a tenth of all energy that was honestly turned over: kinetic at the start, |work|,
// and the largest fall of the stored energy. A tenth: the work is a sum over steps (trapezoid in the hand's force). Below 1 uJ,
// 1 mN over 1 mm, nothing is judged: a base edge that starts to move in one step makes and loses that much.

#include "engine.h"

#include <array>
#include <limits>
#include <vector>

namespace seldinger {

enum class Outcome { Hold, Jitter, Overlap, Escape, GaveUp, BlowUp };  // from harmless to hopeless

[[nodiscard]] const char* name(Outcome outcome);  // "hold", "jitter", "overlap", "escape", "gave-up", "blow-up"

/// What counts as failure for one wire in one scene.
struct FailureLimits {
    double radius = std::numeric_limits<double>::infinity();              // of the wire, the smallest [m]
    double static_indentation = std::numeric_limits<double>::infinity();  // of the law under the scene's largest static load [m];
                                                                          // infinity where impacts, not a static load, press
    double jitter = 0.10;                                                 // of max(mean |hand force|, force_floor) [-]
    double force_floor = 1e-3;                                            // [N]
    int jitter_window = 50;                                               // steps
    double energy_made = 0.10;                                            // of the energy turned over [-]
    double energy_floor = 1e-6;                                           // [J]
};

/// What a watch has measured so far.
struct FailureReadings {
    long steps = 0;
    double overlap = 0;         // deepest [m]
    double outside = 0;         // farthest [m]
    double jitter = 0;          // worst window: upper quartile / max(mean |f|, floor) [-]
    double energy_made = 0;     // [J]
    double hand_force = 0;      // largest |f| [N]
    int sub_steps = 1;          // most in one step
    int newton_iterations = 0;  // most in one solve
    double mean_iterations = 0;
};

/// The worst thing that happened, and when each kind happened first.
struct Verdict {
    Outcome outcome = Outcome::Hold;
    std::array<long, 6> first_step{-1, -1, -1, -1, -1, -1};  // [Outcome], counted from 1; -1: never. Hold is unused
    FailureReadings readings;
    [[nodiscard]] bool held() const { return outcome == Outcome::Hold; }
    [[nodiscard]] bool had(Outcome kind) const { return first_step[static_cast<int>(kind)] >= 0; }
};

class FailureWatch {
public:
    /// @param start  readings before the first step observed: where energies are counted from
    FailureWatch(const FailureLimits& limits, const WireReadings& start);

    /// One accepted step. @param report  of the step, all wires together: a sub-step that one wire gives up is counted for all
    /// @param work  done on the wire in this step by loads, links and moving holds [J]; the hand's f d(inserted) + M d(turned) is
    ///              counted here
    /// @param carried_in  by material that was fed, fed_energy() [J]
    void observe(const StepReport& report, const WireReadings& now, double work = 0, double carried_in = 0);

    [[nodiscard]] Verdict verdict() const;

private:
    void note(Outcome outcome);
    void watch_force(double force);
    void close_window();
    void watch_energy(const WireReadings& now, double work, double carried_in);

    FailureLimits limits_;
    FailureReadings seen_;
    std::array<long, 6> first_step_{-1, -1, -1, -1, -1, -1};
    WireReadings last_;
    // jitter: the last two forces, and those of the window
    double force_1_ = 0, force_2_ = 0, force_sum_ = 0;
    long forces_ = 0;
    std::vector<double> window_;
    // energy
    double work_ = 0, carried_ = 0, turned_over_ = 0, least_ = 0, most_stored_ = 0, most_released_ = 0;
    long iterations_ = 0;
};

/// Energy that material brings in when the wire's fed length goes from `from` to `to` [m] at `speed` [m/s]: its height, and the
/// rho A v^2 per metre with which a guide accelerates it (momentum flux, design section 1). Negative when it leaves. [J]
[[nodiscard]] double fed_energy(const WorldSetup& setup, int wire, double from, double to, double speed);

}  // namespace seldinger
