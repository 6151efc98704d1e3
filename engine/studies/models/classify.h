#pragma once
// Whether a run held, and if not, how it failed: the measured criteria of the stability map (docs/stability.md), from what every
// step reports. One watch per wire; it sees each step once, keeps a handful of numbers, and has no say in the run.
//
//   blow-up   a value is not finite, or kinetic energy that no work accounts for (below)
//   gave up   a sub-step found no state, or missed the tolerance and took its best trial
//   escape    a node or an edge was outside the lumen
//   overlap   deeper than twice the law's static indentation under the scene's load, or than the wire's radius
//   jitter    step-to-step jitter of the hand force above 10 % of max(mean, 1 mN)
//
// Jitter of one step is min(|f_k - f_{k-1}|, |f_{k+1} - f_k|) if the force turns round at k, else 0. That is the peak-to-peak
// value of a force that alternates, and 0 on any rise or fall. A second difference would not do. For a smooth force that varies
// over T it is (2 pi dt/T)^2/2 of its amplitude, 20 % at ten steps to T. It would call a wire that arrives at a wall within ten
// long steps a jitter. The value that 10 % of the steps of a window (and three at least) exceed is compared with the mean |f| of
// the same window. Real turns (a released tip, a wire set moving within one step) are no jitter unless they come every ten steps.
//
// Energy. B = kinetic + elastic + gravitational - work done on the wire can only fall, but for what contact springs give back, at
// most S = (normal + friction) * overlap. Generated energy is the largest rise of B above the least B + S before it. It is a
// blow-up when it shows as kinetic energy and exceeds 10 % of all energy properly exchanged: kinetic at the start, |work|, and
// the largest fall of the stored energy. A tenth: the work is a sum over steps (trapezoid in the hand's force). A hand that
// changes its speed within a step does work that forces at the ends of steps do not show, up to m v^2 of the length inside (an
// inelastic jerk). It counts as unknown (`jerk`). Below 1 uJ, 1 mN over 1 mm, nothing is judged.

#include "engine.h"
#include "solve/energy_balance.h"

#include <array>
#include <limits>
#include <span>
#include <vector>

namespace seldinger {

enum class Outcome { Hold, Jitter, Overlap, Escape, GaveUp, BlowUp };  // from harmless to hopeless

[[nodiscard]] const char* name(Outcome outcome);  // "hold", "jitter", "overlap", "escape", "gave-up", "blow-up"

/// What counts as failure for one wire in one scene.
struct FailureLimits {
    double radius = std::numeric_limits<double>::infinity();              // of the wire, the smallest [m]
    double static_indentation = std::numeric_limits<double>::infinity();  // of the law under the scene's largest static load [m];
                                                                          // infinity where impacts, not a static load, press
    double jitter = 0.10;  // of max(mean |hand force|, force_floor) [-]; more by what the force honestly does between such steps
    double force_floor = 1e-3;  // [N]
    int jitter_window = 50;     // steps
    EnergyLimits energy;
};

/// What a watch has measured so far.
struct FailureReadings {
    long steps = 0;
    double overlap = 0;         // deepest [m]
    double outside = 0;         // farthest [m]
    double jitter = 0;          // worst window: upper tenth / max(mean |f|, floor) [-]
    double energy_made = 0;     // [J]
    double hand_force = 0;      // largest |f| [N]
    long touching = 0;          // steps with a contact force
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

/// Jitter of one force, window by window; see the top.
class JitterMeter {
public:
    explicit JitterMeter(const FailureLimits& limits);
    /// The force at the end of the next step [N]. @return what the window that it completes shows [-]; else a negative number
    double add(double force);
    /// What the steps since the last full window show, where they are enough to say something; else a negative number.
    [[nodiscard]] double rest() const;

private:
    [[nodiscard]] double of_window() const;
    int length_;
    double floor_;
    double last_ = 0, before_ = 0, sum_ = 0;
    long forces_ = 0;
    std::vector<double> window_;
};

/// The worst window of a force given at the end of every step [N]. [-]
[[nodiscard]] double jitter_of(std::span<const double> forces, const FailureLimits& limits);

class FailureWatch {
public:
    /// @param start  readings before the first step observed: where energies are counted from
    FailureWatch(const FailureLimits& limits, const WireReadings& start);

    /// One accepted step. @param report  of the step, all wires together: a sub-step that one wire gives up is counted for all
    /// @param work  done on the wire in this step by loads, links and moving holds [J]; the hand's f d(inserted) + M d(turned) is
    ///              counted here
    /// @param carried_in  by material that was fed, fed_energy() [J]
    /// @param jerk  work that the hand may have done unseen in changing its speed, jerk_energy() [J]
    void observe(const StepReport& report, const WireReadings& now, double work = 0, double carried_in = 0, double jerk = 0);

    [[nodiscard]] Verdict verdict() const;

private:
    void note(Outcome outcome);
    void note_jitter(double ratio);
    void watch_energy(const WireReadings& now, const EnergyInput& input);

    FailureLimits limits_;
    FailureReadings seen_;
    std::array<long, 6> first_step_{-1, -1, -1, -1, -1, -1};
    WireReadings last_;
    JitterMeter jitter_;
    EnergyBalance balance_;
    long iterations_ = 0;
};

/// Energy [J] that material brings in when the fed length of the wire changes from `from` to `to` [m] at `speed` [m/s]. It has
/// two parts: height, and the momentum flux rho A v^2 per metre with which the introducer accelerates the material. Negative when
/// material leaves.
[[nodiscard]] double fed_energy(const WorldSetup& setup, int wire, double from, double to, double speed);

/// m |v^2 - v_0^2| of the wire that is inside, `inside` metres of it, when the feed goes from speed v_0 to v [m/s]. [J]
[[nodiscard]] double jerk_energy(const WorldSetup& setup, int wire, double inside, double speed_before, double speed);

}  // namespace seldinger
