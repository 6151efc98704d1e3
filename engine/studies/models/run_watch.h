#pragma once
// Feeds a run's FailureWatch (classify.h) with data that readings lack: the work of holds and loads on the wire.

#include "models/classify.h"
#include "models/simulation.h"

namespace seldinger {

class RunWatch {
public:
    /// @param scene  as run. Other sources of work are not measured here: springs, dead moments, loads or moving holds elsewhere
    ///               than at tip and base, an elastic wall. With them the engine's own audit alone judges the energy
    /// @param limits  radius 0 or infinite: the wire's own
    RunWatch(const Scene& scene, const WorldSetup& setup, FailureLimits limits, bool end_on_blow_up, const Simulation& start);

    /// After every step. @return false when the run is over: not finite, gave up, or, if told so, more energy than was put in
    bool after_step(const Simulation& simulation, const StepReport& report, double t);
    [[nodiscard]] Verdict verdict() const { return watch_.verdict(); }

private:
    [[nodiscard]] double work_of_step(const WireReadings& now, const std::vector<Vec3>& shape, double t);

    const Scene& scene_;
    const WorldSetup& setup_;
    FailureWatch watch_;
    bool end_on_blow_up_;
    WireReadings last_;
    Vec3 tip_, base_;
    double turned_ = 0, t_ = 0, speed_ = 0;
};

}  // namespace seldinger
