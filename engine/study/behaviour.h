#pragma once
// Did a run hold, and if not, how did it fail? The measured criteria of docs/speed-accuracy.md ("Where methods fail").

#include "study/simulation.h"

#include <string_view>
#include <vector>

namespace seldinger {

enum class Verdict { Hold, Jitter, Overlap, Escape, BlowUp, GaveUp };  // from mild to bad

[[nodiscard]] std::string_view word_of(Verdict verdict);  // "hold", "jitter", "overlap", "escape", "blow-up", "gave up"

/// What counts as failed.
struct BehaviourLimits {
    double overlap = 0;     // [m]; 0: the wire's radius. A caller that knows the law's static indentation gives twice that
    double outside = 1e-9;  // axis beyond the wall [m]: rounding of coordinates a metre from the origin, no more
    double jitter = 0.10;   // of max(mean hand force, 1 mN)
    double energy = 2;      // mechanical energy over all that can have been put in; 2: work is summed by the step's end value
};

struct Behaviour {
    Verdict verdict = Verdict::Hold;
    double failed_at = 0;     // [s]; of BlowUp and GaveUp: when the run ended
    double jitter = 0;        // step-to-step, of max(mean hand force, 1 mN) [-]; see BehaviourWatch
    double overlap = 0;       // deepest [m]
    double outside = 0;       // farthest beyond the wall [m]
    double energy_ratio = 0;  // largest (kinetic + elastic) over what was put in [-]; 0 where that is not known
    long steps = 0, halved = 0, best_effort = 0,
         newton = 0;  // steps; with sub-steps; that missed the tolerance; iterations in all
};

/// Watches a run step by step.
///
/// Jitter is the 90th percentile of |f_{k+1} - 2 f_k + f_{k-1}| / 2 over the steps: the step-to-step change of a force that
/// alternates, 0 for one that grows steadily, and blind to a few true events (first touch, a snap), which are no jitter.
///
/// Energy: kinetic + elastic of a wire can never exceed what it began with, plus the work of hand and loads (positive parts),
/// plus the whole wire's weight times its length and half its mass times the squared feed speed. Where a scene puts work in by
/// other ways (springs, moving or turning holds elsewhere than at the base, dead moments) the criterion is left out.
class BehaviourWatch {
public:
    BehaviourWatch(const Scene& scene, const BehaviourLimits& limits);
    /// After every step. @return false when the run is over: not finite, gave up or more energy than was put in
    bool after_step(const Simulation& simulation, const StepReport& report, double t);
    [[nodiscard]] Behaviour result() const;

private:
    void add_work(const WireReadings& now, const std::vector<Vec3>& shape, double t);
    [[nodiscard]] double jitter() const;

    const Scene& scene_;
    BehaviourLimits limits_;
    Behaviour seen_;
    bool knows_work_ = true, ended_ = false;
    double put_in_ = 0;  // [J]
    double last_inserted_ = 0, last_turned_ = 0;
    Vec3 last_tip_ = Vec3::Zero(), last_base_ = Vec3::Zero();
    std::vector<double> hand_force_;  // per step [N]
};

}  // namespace seldinger
